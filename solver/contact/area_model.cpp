#include "solver/contact/area_model.hpp"

#include <algorithm>

#include "solver/contact/triangle_contacts.hpp"

namespace scree {

namespace {

bool has_layer(const PairView& view) {
  return view.geometry == PairGeometry::two_meshes || (view.geometry == PairGeometry::body_zone && view.a.shape->kind != ShapeKind::sphere);
}

}  // namespace

bool AreaModel::list(const PairView& view, double skin, MeshDistanceScratch& scratch, CandidateLists& lists) {
  if (!has_layer(view)) return list_closed_form(view, skin, scratch, lists);
  if (view.geometry == PairGeometry::two_meshes)
    return list_triangle_contacts(view.a, view.b, view.margin, skin, view.radius_a, view.radius_b, scratch, lists);
  list_area_zone(view.a, view.b, *view.zone, view.margin, skin, view.radius_a, lists);
  return true;
}

void AreaModel::find_features(const PairView& view, double moved, const CandidateLists& lists, PairFeatures& features) {
  features.has_layer = has_layer(view);
  if (!features.has_layer) {
    find_closed_form(view, moved, lists, features.list);
    share_among_cells(view, features);
    return;
  }
  features.has_cells = false;
  if (view.geometry == PairGeometry::two_meshes)
    area_features(view.a, view.b, view.margin, moved, layer_share_of_a(view.radius_a, view.radius_b), lists, features.list, features.layer);
  else
    area_zone_features(view.a, view.b, *view.zone, view.margin, moved, lists, features.list, features.layer);
}

PushSum AreaModel::add_patches(const PairFeatures& features, const LayerLaw& law, FeatureForces& forces, PairForce& result) {
  const std::vector<AreaPatch>& patches = features.layer.patches;
  double sum = 0;
  for (std::size_t j = 0; j < patches.size(); ++j) {
    const AreaPatch& patch = patches[j];
    result.elastic += law.kappa * patch.energy;
    result.largest_overlap = std::max(result.largest_overlap, patch.largest_overlap);
    result.force -= law.kappa * patch.gradient.force;
    result.torque -= law.kappa * patch.gradient.couple;
    forces.push[j] = law.kappa * patch.force;
    if (forces.wants_from_weight) forces.from_weight[j] = -law.kappa * patch.gradient.force - forces.push[j] * features.list[j].n;
    sum += forces.push[j];
  }
  // F / D with U = F D / 2: kappa times the area where the overlap is even
  for (std::size_t j = 0; j < patches.size(); ++j) forces.push_per_overlap[j] = forces.push[j] * sum / (2 * result.elastic);
  return {sum, result.elastic};
}

void AreaModel::linearise(const LinearContact& contact, const LayerLaw& law) {
  if (!contact.features.has_layer) return PotentialModel::linearise(contact, law);
  double energy = 0, pressed = 0;
  for (const AreaPatch& patch : contact.features.layer.patches) {
    energy += patch.energy;
    pressed += patch.force;
  }
  if (!(energy > 0)) return;
  const double overlap = 2 * energy / pressed;
  for (const AreaPoint& point : contact.features.layer.points) {
    const double stiffness = law.kappa * point.area;
    contact.add_point(point.x, point.n, stiffness, stiffness * overlap, contact.force.damping, overlap, tangent_over_secant(law, overlap));
  }
}

}  // namespace scree
