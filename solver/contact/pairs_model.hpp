// gather = "pairs": a spring and a dashpot of its own for every pair of triangles closer than the margin (triangle_contacts.hpp), and for
// every feature of other pairs. For comparison only.
#pragma once

#include "solver/contact/potential_model.hpp"
#include "solver/features/triangle_contacts.hpp"

namespace scree {

struct PairsModel {
  static constexpr Gathering kGathering = Gathering::pairs;
  static constexpr bool kDampsEachFeature = true;
  static constexpr bool kHasEdgeLanes = false;
  template <class Law>
  using NormalLaw = Law;

  static bool list(const PairView& view, double skin, MeshDistanceScratch& scratch, CandidateLists& lists) {
    if (view.geometry != PairGeometry::two_meshes) return list_closed_form(view, skin, scratch, lists);
    return list_triangle_contacts(view.a, view.b, view.reach, skin, view.radius_a, view.radius_b, scratch, lists);
  }

  static void weigh(const PairView&, const PullView&, double, const CandidateLists&, PairFeatures&) {}
  static void find_features(const PairView& view, double moved, CandidateLists& lists, PairFeatures& features) {
    if (built_with::kMeshes && view.geometry == PairGeometry::two_meshes)
      triangle_contact_features(view.a, view.b, view.reach, moved, lists, features.list);
    else
      find_closed_form(view, moved, lists, features.list);
  }

  template <class Law>
  static PushSum potential(const PairFeatures& features, const PairLaw& pair_law, const Law& law, FeatureForces& forces,
                           PairForce& result) {
    double largest = 0;
    for (const ContactFeature& f : features.list) largest = std::max(largest, depth_in_reach<Law>(pair_law, f));
    result.largest_overlap = std::max(0.0, overlap_at<Law>(pair_law, largest));
    if constexpr (PullingLaw<Law>) {
      forces.pull.assign(features.list.size(), 0);
      forces.pull_force = forces.pull_torque = {};
    }
    PushSum sum;
    for (std::size_t j = 0; j < features.list.size(); ++j) {
      const ContactFeature& f = features.list[j];
      // a potential of a single feature: through the same roots as that of many, to the same bits
      const double r = depth_in_reach<Law>(pair_law, f) / largest, depth = largest * std::sqrt(std::sqrt(std::sqrt(power7(r) * r)));
      if (!(depth > 0)) continue;
      const double D = overlap_at<Law>(pair_law, depth), share = power7(depth_in_reach<Law>(pair_law, f) / depth);
      const PushAndPull at = PushAndPull::of(law, D);
      // minima of a ball share (surface_minima.hpp): U is the sum of a_j U(d_j)
      sum.energy += f.weight * at.push_energy;
      const double force = f.weight * at.push * share;
      forces.push[j] = force;
      if (D > 0) forces.push_per_overlap[j] = force / D;
      sum.force += force;
      result.force += force * f.n;
      result.torque += cross(f.x, force * f.n);
      if constexpr (PullingLaw<Law>) {
        result.elastic -= f.weight * at.pull_energy;
        forces.pull[j] = f.weight * at.pull * share;
        forces.pull_force -= forces.pull[j] * f.n;
        forces.pull_torque -= cross(f.x, forces.pull[j] * f.n);
      }
      if (f.faded) {
        const double energy = at.push_energy - at.pull_energy;
        result.force -= energy * f.weight_gradient.force;
        result.torque -= energy * f.weight_gradient.couple;
        if (forces.wants_from_weight) forces.from_weight[j] -= energy * f.weight_gradient.force;
      }
    }
    result.elastic += sum.energy;
    return sum;
  }

  template <class Law>
  static void linearise(const LinearContact& contact, const Law& law) {
    double energy = 0;
    for (const ContactFeature& f : contact.features.list) energy += f.weight * PushAndPull::of(law, f.overlap).push_energy;
    for (const ContactFeature& f : contact.features.list) {
      if constexpr (PullingLaw<Law>)
        contact.result.add_mode(f.weight * law.pull_stiffness(f.overlap), 0, mode_of(contact.motion, f.x, f.n));
      if (!(f.overlap > 0)) continue;
      const double share = f.weight * law.energy(f.overlap) / energy;
      contact.add_point(f.x, f.n, f.weight * law.stiffness(f.overlap), f.weight * law.force(f.overlap),
                        contact.force.damping / std::sqrt(share), f.overlap, tangent_over_secant(law, f.overlap));
    }
  }
};

}  // namespace scree
