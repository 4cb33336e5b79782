// Where the bodies of a population may lie.
#pragma once

#include "core/placing/placed_body.hpp"

namespace scree {

/// The inside of a box, cylinder, sphere or closed mesh.
struct Region {
  Box3 box;           ///< bounding box [m]
  double volume = 0;  ///< [m^3]
  Wall shape;         ///< box_inside, cylinder_inside, sphere_inside, or mesh
  PackShape mesh;     ///< in world coordinates, when it is a mesh

  bool is_mesh() const { return shape.kind == WallKind::mesh; }
  bool is_box() const { return shape.kind == WallKind::box_inside; }
  /// Whether a point lies inside, the sides included.
  bool contains(const Vec3& point) const;
  /// Whether the whole body lies inside, `gap` off the sides [m].   in   vertices   of the body, world
  bool holds(const PlacedBody& body, const std::vector<Vec3>& vertices, double gap, MeshDistanceScratch& scratch) const;
};

/// in   wall   of a kind that the solver knows by formula and that has an inside
Region region_of(const Wall& wall);
/// The region of a scene. Throws InputError for a mesh that bounds no volume.
Region region_of(const RegionShape& region, const std::vector<Shape>& shapes);
/// in   mesh   closed, outward, world coordinates.   Throws InputError when its signed volume is not > 0.
Region region_of(TriangleMesh mesh);

}  // namespace scree
