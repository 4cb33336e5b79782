// Where the bodies of a population may lie.
#pragma once

#include <string>
#include <vector>

#include "core/placing/orientation.hpp"
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
/// The region of a scene. Throws InputError for a mesh that bounds no volume.   in   whose   "inlet 'feed'", for the message
Region region_of(const RegionShape& region, const std::vector<Shape>& shapes, const std::string& whose);
/// in   mesh   closed, outward, world coordinates.   Throws InputError when its signed volume is not > 0.
Region region_of(TriangleMesh mesh);

/// Turns a body as asked and moves it to a random place such that its bounding box lies within that of a region. Whether a region that is
/// no box holds it, is to be seen. Returns false where it is too large, as it is turned.
/// Uses the random numbers 0 to 5.
bool draw_place(const Region& region, const BodyOrientation& asked, const RandomNumbers& random, PlacedBody& body);

}  // namespace scree
