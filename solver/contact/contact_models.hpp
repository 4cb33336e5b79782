// The list of contact models, and the way from a scene's choice to the one that it takes.
#pragma once

#include <type_traits>

#include "solver/contact/area_model.hpp"
#include "solver/contact/pairs_model.hpp"
#include "solver/contact/potential_model.hpp"

namespace scree {

template <ContactModel... Models>
struct ModelList {
  /// Calls action.operator()<Model>() with the one of a way of gathering.
  template <class Action>
  static void choose(Gathering gathering, Action&& action) {
    ((Models::kGathering == gathering ? action.template operator()<Models>() : void()), ...);
  }
};

using ContactModels = ModelList<PotentialModel, AreaModel, PairsModel>;

/// Whether a law may have attraction beside it (laws/attraction.hpp) under a model.
template <class Model, class Normal>
inline constexpr bool kMayAttract = !std::is_same_v<Model, PairsModel> && !PullingLaw<Normal>;

/// Calls action.operator()<Model, Entry, Normal>() with the model of a scene, the line of its law, and what its normal law is under the
/// model, with its attraction.
template <class Action>
void for_chosen_law(const LawChoice& choice, Action&& action) {
  ContactModels::choose(choice.gathering, [&]<class Model>() {
    for_law(choice.law, [&]<class Entry>() {
      using Normal = typename Model::template NormalLaw<typename Entry::Normal>;
      if constexpr (!std::is_void_v<Normal>) {
        if constexpr (std::is_same_v<Model, PotentialModel> && PowerLaw<Normal> && !PullingLaw<Normal>) {
          if (choice.yields) return action.template operator()<Model, Entry, PlasticLaw<Normal>>();
        }
        if (!choice.attraction) return action.template operator()<Model, Entry, Normal>();
        if constexpr (std::is_same_v<Model, PotentialModel> && std::is_same_v<Normal, HertzLaw>) {
          if (choice.necks) return action.template operator()<Model, Entry, NeckLaw>();
        }
        if constexpr (kMayAttract<Model, Normal>) action.template operator()<Model, Entry, WithAttraction<Normal>>();
      }
    });
  });
}

}  // namespace scree
