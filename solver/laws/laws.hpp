// Every contact law of the solver. A law is a normal law (normal.hpp says what it has) with a damping (damping.hpp); the list of them is
// core/storage/contact_laws.inc, from which cases and scene files have their words as well.
#pragma once

#include <tuple>

#include "core/storage/scene_words.hpp"
#include "solver/laws/attraction.hpp"
#include "solver/laws/barrier.hpp"
#include "solver/laws/damping.hpp"
#include "solver/laws/neck.hpp"
#include "solver/laws/normal.hpp"
#include "solver/laws/plastic.hpp"
#include "solver/laws/rolling.hpp"

namespace scree {

template <ContactLaw kName, class NormalLaw, class DampingLaw>
struct LawEntry {
  static constexpr ContactLaw kLaw = kName;
  using Normal = NormalLaw;
  using Damp = DampingLaw;
};

#define SCREE_CONTACT_LAW(name, word, normal, damping) LawEntry<ContactLaw::name, normal, damping>{},
inline constexpr std::tuple kLaws{
#include "core/storage/contact_laws.inc"
};
#undef SCREE_CONTACT_LAW

/// Calls action.operator()<Entry>() with the line of a law.
template <class Action>
void for_law(ContactLaw law, Action&& action) {
  const auto look = [&]<class Entry>(const Entry&) {
    if (Entry::kLaw == law) action.template operator()<Entry>();
  };
  std::apply([&](const auto&... entry) { (look(entry), ...); }, kLaws);
}

/// What a scene needs of the force loop; the choice is made once, outside of all loops.
struct LawChoice {
  ContactLaw law = ContactLaw::linear;
  Gathering gathering = Gathering::potential;  ///< the models are those of contact/contact_models.hpp
  double exponent = 1;                         ///< tangent over secant stiffness of the push, at least
  bool lag_corrected = true;                   ///< damping is corrected for its lag (laws/damping.hpp)
  bool friction = false;                       ///< some pair has friction
  bool rolling = false;                        ///< some pair has rolling or torsional resistance
  bool attraction = false;                     ///< some materials attract each other
  bool necks = false;                          ///< by necks (laws/neck.hpp)
  bool yields = false;                         ///< contacts of some materials are plastic (laws/plastic.hpp)
  bool remembers = false;                      ///< some only once they have touched
  bool needs_radius = false;                   ///< R* of the bodies enters
};

}  // namespace scree
