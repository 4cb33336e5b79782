#include "solver/contact/area_model.hpp"

#include <algorithm>

#include "solver/features/triangle_contacts.hpp"

namespace scree {

namespace {

void find_layer(const PairView& view, double margin, double moved, const CandidateLists& lists, std::vector<ContactFeature>& features,
                AreaContact& layer) {
  if (view.geometry == PairGeometry::two_meshes)
    area_features(view.a, view.b, margin, moved, layer_share_of_a(view.radius_a, view.radius_b), lists, features, layer);
  else
    area_zone_features(view.a, view.b, *view.zone, margin, moved, lists, features, layer);
}

bool has_layer(const PairView& view) {
  return view.geometry == PairGeometry::two_meshes || (view.geometry == PairGeometry::body_zone && view.a.shape->kind != ShapeKind::sphere);
}

}  // namespace

bool AreaModel::list(const PairView& view, double skin, MeshDistanceScratch& scratch, CandidateLists& lists) {
  if (!has_layer(view)) return list_closed_form(view, skin, scratch, lists);
  if (view.geometry == PairGeometry::two_meshes)
    return list_triangle_contacts(view.a, view.b, view.reach, skin, view.radius_a, view.radius_b, scratch, lists);
  list_area_zone(view.a, view.b, *view.zone, view.reach, skin, view.radius_a, lists);
  return true;
}

void AreaModel::find_features(const PairView& view, double moved, CandidateLists& lists, PairFeatures& features) {
  features.has_layer = has_layer(view);
  if (!features.has_layer) {
    find_closed_form(view, moved, lists, features.list);
    share_among_cells(view, features);
    return;
  }
  features.has_cells = false;
  features.pull_layer.patches.clear();
  find_layer(view, view.margin, moved, lists, features.list, features.layer);
  // overlaps count from the reach, as those of all models do here
  for (ContactFeature& f : features.list) f.overlap += view.reach - view.margin;
}

void AreaModel::weigh(const PairView& view, const PullView& pull, double moved, const CandidateLists& lists, PairFeatures& features) {
  if (!features.has_layer || !(pull.range > 0)) return;
  thread_local std::vector<ContactFeature> wider;
  find_layer(view, view.margin + pull.range, moved, lists, wider, features.pull_layer);
  // what touches is within the range too: both lists have ascending keys but for the side, and one order
  std::vector<AreaPatch>& patches = features.layer.patches;
  std::vector<AreaPatch> all(wider.size());
  std::size_t next = 0;
  for (std::size_t j = 0; j < wider.size(); ++j) {
    wider[j].overlap = std::min(0.0, wider[j].overlap - pull.range);
    if (next == features.list.size() || features.list[next].key != wider[j].key) continue;
    wider[j] = features.list[next];
    all[j] = patches[next++];
  }
  SCREE_ASSERT(next == features.list.size(), "patches that touch are not within the range of their attraction");
  features.list.swap(wider);
  patches.swap(all);
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
  for (std::size_t j = 0; j < patches.size() && sum > 0; ++j) forces.push_per_overlap[j] = forces.push[j] * sum / (2 * result.elastic);
  return {sum, result.elastic};
}

void AreaModel::add_pulling_patches(const PairFeatures& features, const Attraction& attraction, FeatureForces& forces, PairForce& result) {
  const std::vector<AreaPatch>&wider = features.pull_layer.patches, &patches = features.layer.patches;
  forces.pull.assign(features.list.size(), 0);
  forces.pull_force = forces.pull_torque = {};
  const double modulus = attraction.modulus;
  for (std::size_t j = 0; j < wider.size(); ++j) {
    const Vec3 force = modulus * (wider[j].gradient.force - patches[j].gradient.force);
    result.elastic -= modulus * (wider[j].energy - patches[j].energy);
    forces.pull[j] = modulus * (wider[j].force - patches[j].force);
    forces.pull_force += force;
    forces.pull_torque += modulus * (wider[j].gradient.couple - patches[j].gradient.couple);
    if (forces.wants_from_weight) forces.from_weight[j] += force + forces.pull[j] * features.list[j].n;
  }
}

void AreaModel::linearise_pull(const LinearContact& contact, const Attraction& attraction, double kappa) {
  if (!(attraction.modulus > kappa)) return;
  for (const AreaPoint& point : contact.features.pull_layer.points)
    contact.result.add_mode((attraction.modulus - kappa) * point.area, 0, mode_of(contact.motion, point.x, point.n));
}

void AreaModel::linearise_patches(const LinearContact& contact, const LayerLaw& law) {
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
