// Every contact law of the solver, in one place. A law is a normal energy (normal.hpp) with a damping (damping.hpp); a new
// one, cohesive ones among them, is a struct in a file beside this and one line here.
#pragma once

#include <tuple>

#include "core/storage/scene_words.hpp"
#include "solver/laws/barrier.hpp"
#include "solver/laws/damping.hpp"
#include "solver/laws/normal.hpp"
#include "solver/laws/rolling.hpp"

namespace scree {

/// A line of the list: law of the case language, normal law, damping, whether it needs the bodies' radii.
template <class NormalLaw, class DampingLaw>
struct LawEntry {
  using Normal = NormalLaw;
  using Damp = DampingLaw;
  ContactLaw law;
  bool needs_radius = false;
};

inline constexpr std::tuple kLaws{
    LawEntry<LinearLaw, ViscousDamping>{ContactLaw::linear},
    LawEntry<LinearLaw, HuntCrossleyDamping>{ContactLaw::hunt_crossley},
    LawEntry<HertzLaw, ViscousDamping>{ContactLaw::hertz_mindlin, true},
};

/// What a scene needs of the force loop; the choice is made once, outside of all loops.
struct LawChoice {
  int law = 0;  ///< index in kLaws
  Gathering gathering = Gathering::potential;
  double exponent = 1;        ///< of the effective overlap in the normal force
  bool friction = false;      ///< some pair has friction
  bool rolling = false;       ///< some pair has rolling or torsional resistance
  bool needs_radius = false;  ///< R* of the bodies enters
};

}  // namespace scree
