// gather = "pairs": a spring and a dashpot of its own for every pair of triangles closer than the margin (triangle_contacts.hpp), and for
// every feature of other pairs. For comparison only.
#pragma once

#include "solver/contact/potential_model.hpp"
#include "solver/contact/triangle_contacts.hpp"

namespace scree {

struct PairsModel {
  static constexpr Gathering kGathering = Gathering::pairs;
  static constexpr bool kDampsEachFeature = true;
  template <class Law>
  using NormalLaw = Law;

  static bool list(const PairView& view, double skin, MeshDistanceScratch& scratch, CandidateLists& lists) {
    if (view.geometry != PairGeometry::two_meshes) return list_closed_form(view, skin, scratch, lists);
    return list_triangle_contacts(view.a, view.b, view.margin, skin, view.radius_a, view.radius_b, scratch, lists);
  }

  static void find_features(const PairView& view, double moved, const CandidateLists& lists, PairFeatures& features) {
    if (built_with::kMeshes && view.geometry == PairGeometry::two_meshes)
      triangle_contact_features(view.a, view.b, view.margin, moved, lists, features.list);
    else
      find_closed_form(view, moved, lists, features.list);
  }

  template <class Law>
  static PushSum potential(const PairFeatures& features, const PairLaw&, const Law& law, FeatureForces& forces, PairForce& result) {
    for (const ContactFeature& f : features.list) result.largest_overlap = std::max(result.largest_overlap, f.overlap);
    double push = 0;
    for (std::size_t j = 0; j < features.list.size(); ++j) {
      const ContactFeature& f = features.list[j];
      // a potential of a single feature: through the same roots as that of many, to the same bits
      const double r = f.overlap / result.largest_overlap;
      const double D = result.largest_overlap * std::sqrt(std::sqrt(std::sqrt(power7(r) * r)));
      if (!(D > 0)) continue;
      result.elastic += law.energy(D);
      const double force = law.force(D) * power7(f.overlap / D);
      forces.push[j] = force;
      forces.push_per_overlap[j] = force / D;
      push += force;
      result.force += force * f.n;
      result.torque += cross(f.x, force * f.n);
    }
    return {push, result.elastic};
  }

  template <class Law>
  static void linearise(const LinearContact& contact, const Law& law) {
    for (const ContactFeature& f : contact.features.list) {
      const double share = law.energy(f.overlap) / contact.force.elastic;
      contact.add_point(f.x, f.n, law.stiffness(f.overlap), law.force(f.overlap), contact.force.damping / std::sqrt(share), f.overlap,
                        tangent_over_secant(law, f.overlap));
    }
  }
};

}  // namespace scree
