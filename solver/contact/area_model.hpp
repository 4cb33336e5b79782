// gather = "area": two meshes, or a mesh and an analytic wall, have an elastic layer between their facing surfaces (area_pressure.hpp).
// What has a ball in it has the potential of a smooth cap in such a layer.
#pragma once

#include "solver/contact/potential_model.hpp"

namespace scree {

struct AreaModel {
  static constexpr Gathering kGathering = Gathering::area;
  static constexpr bool kDampsEachFeature = false;
  template <class Law>
  using NormalLaw = typename Law::InLayer;

  static bool list(const PairView& view, double skin, MeshDistanceScratch& scratch, CandidateLists& lists);
  static void weigh(const PairView&, const PullView&, PairFeatures&) {}
  static void find_features(const PairView& view, double moved, const CandidateLists& lists, PairFeatures& features);

  static PushSum potential(const PairFeatures& features, const PairLaw& pair_law, const LayerLaw& law, FeatureForces& forces,
                           PairForce& result) {
    return features.has_layer ? add_patches(features, law, forces, result)
                              : PotentialModel::potential(features, pair_law, law, forces, result);
  }

  static void linearise(const LinearContact& contact, const LayerLaw& law);

 private:
  static PushSum add_patches(const PairFeatures& features, const LayerLaw& law, FeatureForces& forces, PairForce& result);
};

}  // namespace scree
