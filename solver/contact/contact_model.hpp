// How the contacts of a pair become its force: a contact model for each way of gathering, chosen once for a scene.
//
// A model is a structure without data. The loop over pairs, the contact law and the critical step are templates of it, so that no pair
// asks which one it is; the list of models is contact_models.hpp. A model has
//   kGathering          its word in a scene
//   kHasEdgeLanes       whether its features of two meshes are those of mesh_pair_features(), whose edges may be looked at in lanes
//   kDampsEachFeature   whether each feature is a dashpot of its own, by its own energy; else the pair has one damping
//   NormalLaw<Law>      what a law of laws.hpp is under this model; void where they do not go together
//   list                makes the candidates of a pair; returns false when its meshes intersect
//   find_features       features below the reach of a view at the present pose, in ascending key order, and what they share; overlaps
//                       count from the reach; candidates may get other slacks
//   weigh               what features count for by the cluster that they lie in, given the attraction of the pair (range 0: none); they
//                       are those of the pair's law alone now, and overlaps count from the margins. A model may add what is within the
//                       range of the attraction alone, from the candidates
//   potential<Law>      energy, force of each feature, and wrench
//   linearise<Law>      stiffness and damping of the pair as it is now
#pragma once

#include <concepts>
#include <vector>

#include "solver/built_with.hpp"
#include "solver/contact/pair_force.hpp"
#include "solver/contact/pair_stiffness.hpp"
#include "solver/features/area_pressure.hpp"
#include "solver/features/pair_view.hpp"

namespace scree {

template <class Model>
concept ContactModel = requires(const PairView& view, MeshDistanceScratch& scratch, CandidateLists& lists, PairFeatures& features) {
  { Model::kGathering } -> std::convertible_to<Gathering>;
  { Model::kDampsEachFeature } -> std::convertible_to<bool>;
  { Model::kHasEdgeLanes } -> std::convertible_to<bool>;
  { Model::list(view, 0.0, scratch, lists) } -> std::same_as<bool>;
  {Model::find_features(view, 0.0, lists, features)};
  {Model::weigh(view, PullView{}, 0.0, lists, features)};
};

/// Candidates of a pair with a closed form, which all models list alike: any but two meshes.
inline bool list_closed_form(const PairView& view, double skin, MeshDistanceScratch& scratch, CandidateLists& lists) {
  switch (view.geometry) {
    case PairGeometry::two_spheres:
      list_sphere_pair(view.a, view.b, view.reach, skin, view.radius_a, view.radius_b, lists);
      return true;
    case PairGeometry::body_zone:
      list_zone_pair(view.a, view.b, *view.zone, view.reach, skin, view.radius_a, lists);
      return true;
    case PairGeometry::sphere_mesh:
      return list_sphere_mesh_pair(view.a, view.b, view.reach, skin, view.radius_a, view.radius_b, scratch, lists);
    case PairGeometry::two_meshes:
      break;
  }
  SCREE_ASSERT(false, "two meshes have no closed form");
  return false;
}

/// Their features.
inline void find_closed_form(const PairView& view, double moved, const CandidateLists& lists, std::vector<ContactFeature>& features) {
  switch (view.geometry) {
    case PairGeometry::two_spheres:
      return sphere_pair_features(view.a, view.b, view.reach, features);
    case PairGeometry::body_zone:
      return zone_pair_features(view.a, view.pose, *view.zone, view.reach, moved, lists, features);
    case PairGeometry::sphere_mesh:
      if constexpr (built_with::kMeshes) sphere_mesh_features(view.a, view.b, view.reach, moved, lists, features);
      return;
    case PairGeometry::two_meshes:
      break;
  }
  SCREE_ASSERT(false, "two meshes have no closed form");
}

/// One potential for each cell, where one of the bodies has cells (wall_cells.hpp).
inline void share_among_cells(const PairView& view, PairFeatures& features) {
  features.has_cells = view.cells != CellSide::none && !features.list.empty();
  if (!features.has_cells) return;
  find_cell_shares(view.a, view.b, view.cell_size, view.cells, features.list, features.cells);
  features.cell_energy = energy_share(view.cells);
}

}  // namespace scree
