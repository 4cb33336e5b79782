// Impacts of fragments, which several of their pieces may take at once.
//
// A piece that bonds hold strikes with the mass of its fragment, not with its own. And of n pieces that begin to touch the same partner in
// one step, each would count the motion of the whole fragment: their wrenches are therefore added up, as those of the features of one
// contact are (contact/beginning.hpp), over all ranks. The impact is one, and pieces have shares of it by the speed at which each closes.
#pragma once

#include <array>
#include <vector>

#include "solver/contact/beginning.hpp"
#include "solver/effects/bonds/fragment_side.hpp"
#include "solver/neighbours/body_pair.hpp"
#include "solver/pairs/pair_observer.hpp"
#include "solver/state/run_state.hpp"

namespace scree {

/// A contact of a piece that begins, as of its fragment.
struct BegunOnFragment {
  FragmentSide first, second;  ///< by name; force and torque of unit pressures
  PairKey key;
  double overlaps, speed;
  Vec3 slip;                 ///< of the first against the second
  Vec3 on_first, on_second;  ///< sum of overlap times place from the centres of both sides [m^2]
};

/// in   begins   of this contact, which a fragment takes part in (PairMotion::is_bonded)
BegunOnFragment begun_on_fragment(const ParticleSet& p, const PairContact& c, const Beginning& begins);

/// What one of them has of the impact.
struct ShareOfImpact {
  double share = 0;                           ///< of all that begin together
  bool is_first = false;                      ///< the one that stands for the impact: the lowest key
  std::array<double, kImpactParts> energy{};  ///< of the whole impact [J]
};

/// For each of `mine`, which are counted on this rank. Collective.   Cost: a message round where there are several ranks
std::vector<ShareOfImpact> share_impacts(const RunState& s, const std::vector<BegunOnFragment>& mine);

}  // namespace scree
