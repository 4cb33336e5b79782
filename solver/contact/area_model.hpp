// gather = "area": two meshes, or a mesh and an analytic wall, have an elastic layer between their facing surfaces (area_pressure.hpp).
// What has a ball in it has the potential of a smooth cap in such a layer.
// Attraction is a traction over its range s: p = 2 w / s at touch and beyond, in proportion to how far the surfaces are within the range
// before, so that parting them takes the work w for each area, whatever their shape and mesh. It is the difference of two layers of the
// modulus p / s, that of the margins and one as much thicker as the range: U = -(2 w / s^2) (E(margin + s) - E(margin)), E = 1/2 int d^2
// dA. Flat surfaces part at p A, a ball at 2 pi w R* (Derjaguin) where the layer is stiff against the attraction.
#pragma once

#include "solver/contact/potential_model.hpp"

namespace scree {

struct AreaModel {
  static constexpr Gathering kGathering = Gathering::area;
  static constexpr bool kDampsEachFeature = false;
  static constexpr bool kHasEdgeLanes = false;
  template <class Law>
  using NormalLaw = typename Law::InLayer;

  static bool list(const PairView& view, double skin, MeshDistanceScratch& scratch, CandidateLists& lists);
  static void weigh(const PairView& view, const PullView& pull, double moved, const CandidateLists& lists, PairFeatures& features);
  static void find_features(const PairView& view, double moved, CandidateLists& lists, PairFeatures& features);

  template <class Law>
  static PushSum potential(const PairFeatures& features, const PairLaw& pair_law, const Law& law, FeatureForces& forces,
                           PairForce& result) {
    if (!features.has_layer) return PotentialModel::potential(features, pair_law, law, forces, result);
    const PushSum push = add_patches(features, law, forces, result);
    if constexpr (AttractingLaw<Law>) add_pulling_patches(features, law.attraction, forces, result);
    return push;
  }

  template <class Law>
  static void linearise(const LinearContact& contact, const Law& law) {
    if (!contact.features.has_layer) return PotentialModel::linearise(contact, law);
    linearise_patches(contact, law);
    if constexpr (AttractingLaw<Law>) linearise_pull(contact, law.attraction, law.kappa);
  }

 private:
  static void linearise_patches(const LinearContact& contact, const LayerLaw& law);
  static void linearise_pull(const LinearContact& contact, const Attraction& attraction, double kappa);
  static void add_pulling_patches(const PairFeatures& features, const Attraction& attraction, FeatureForces& forces, PairForce& result);
  static PushSum add_patches(const PairFeatures& features, const LayerLaw& law, FeatureForces& forces, PairForce& result);
};

}  // namespace scree
