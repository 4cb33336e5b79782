// A shape as the time loop reads it: in its principal frame, with what its contacts need.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/geometry/bvh.hpp"
#include "core/geometry/features.hpp"
#include "core/storage/scene_file.hpp"

namespace scree {

/// A feature edge of a shape: from `start` along `along` (not unit).
struct ShapeEdge {
  Vec3 start, along;
};

/// What a step reads of an edge, next to each other.
struct EdgeRow {
  ShapeEdge ends;
  Vec3 into[2];             ///< into each of its faces: on the same side of the edge as the conormal, but without its root
  Vec3 conormal[2];         ///< see core/geometry/features.hpp; both are zero where there is no face
  std::int32_t corners[2];  ///< at its ends
  bool has_height[2];       ///< the face is high enough over the edge for its side to be known
};

/// A shape in its principal frame (origin at the centre of mass, inertia diagonal), scale 1.
/// A wall's surface keeps its file frame.
struct SolverShape {
  ShapeKind kind = ShapeKind::solid;
  double rounding = 0;  ///< radius of an analytic sphere about its only corner [m]
  double margin = 0;    ///< around the mesh [m]; 0 where all bodies have one margin (core/surface/touch_surface.hpp)
  TriangleMesh mesh;
  Bvh bvh;
  FeatureTable features;
  std::vector<EdgeRow> edge_rows;  ///< of every edge of `features`; empty for large shapes, of which a step reads few
  double radius = 0;               ///< bounding radius about the origin, rounding and margin included [m]
  double volume = 0;               ///< [m^3]
  double cell_size = 0;            ///< of a very large body, scale 1 [m]; 0: none
  double equivalent_radius = 0;    ///< of the ball of equal volume [m]; 0 for a surface
  Vec3 inertia;                    ///< principal moments for density 1 [m^5]
  Quat body_from_principal;
  /// Largest [r]x^T I^-1 [r]x over all surface points r, density 1, scale 1 [1/m^3]: what rotation adds to the inverse
  /// mass of a contact at worst. It is convex in r, so the corners decide. See derive_step_size.
  double rotational_mobility = 0;
  /// Largest |r x n| over the surface points r with their normals n [m]: how fast a spin of 1 rad/s moves the surface along its
  /// normal at most. 0 for a ball.
  double turning_arm = 0;
  bool isotropic = false;  ///< all three moments equal: no gyroscopic splitting needed
  /// The surface of a wall: every fold is a feature edge, touched from the side on which it is convex (core/geometry/features.hpp).
  bool is_two_sided = false;
  /// A solid without concave edges: a point outside has one nearest point on it and no other local minimum of the distance. Each of its
  /// points has one contact then (features/surface_minima.hpp).
  bool is_convex = false;
  /// A vertex may touch several of its faces at once: a solid that is not convex, or a surface with an edge inside, from one of its sides.
  bool has_valleys = false;

  /// A corner, and an edge, of `features`.
  const Vec3& corner(std::int32_t c) const {
    return mesh.vertices[static_cast<std::size_t>(features.corners[static_cast<std::size_t>(c)])];
  }
  ShapeEdge edge(std::int32_t e) const { return edge_rows.empty() ? ends_of_edge(e) : edge_rows[static_cast<std::size_t>(e)].ends; }
  /// Into one of the two faces of an edge; across the edge, a unit vector.
  Vec3 into_face(std::int32_t e, int side) const {
    return edge_rows.empty() ? find_into(e, side) : edge_rows[static_cast<std::size_t>(e)].into[side];
  }
  Vec3 edge_conormal(std::int32_t e, int side) const {
    return edge_rows.empty() ? conormal(mesh, features.edges[static_cast<std::size_t>(e)], side)
                             : edge_rows[static_cast<std::size_t>(e)].conormal[side];
  }
  bool has_height(std::int32_t e, int side) const {
    return edge_rows.empty() ? find_height(e, side) : edge_rows[static_cast<std::size_t>(e)].has_height[side];
  }
  /// The corner at one end.
  std::int32_t edge_corner(std::int32_t e, int end) const {
    return edge_rows.empty() ? find_edge_corner(e, end) : edge_rows[static_cast<std::size_t>(e)].corners[end];
  }

  /// Shapes of up to so many triangles have edge_rows.
  static constexpr std::size_t kMaxWithRows = 8192;

  /// Bytes held: at most 160 a triangle, and 240 with edge_rows.
  std::size_t memory() const;

 private:
  friend SolverShape make_solver_shape(const Shape& source, const Settings& settings);
  ShapeEdge ends_of_edge(std::int32_t e) const {
    const FeatureEdge& ends = features.edges[static_cast<std::size_t>(e)];
    const Vec3& start = mesh.vertices[static_cast<std::size_t>(ends.vertex_a)];
    return {start, mesh.vertices[static_cast<std::size_t>(ends.vertex_b)] - start};
  }
  std::int32_t find_edge_corner(std::int32_t e, int end) const {
    const FeatureEdge& ends = features.edges[static_cast<std::size_t>(e)];
    return features.corner_of[static_cast<std::size_t>(end == 0 ? ends.vertex_a : ends.vertex_b)];
  }
  Vec3 find_into(std::int32_t e, int side) const;
  bool find_height(std::int32_t e, int side) const;
};

/// Whether a mesh is one closed surface of which every edge is flat or convex.   Cost: O(T log T).
bool is_convex_surface(const TriangleMesh& mesh, const FeatureTable& features);

/// What the solver keeps of a shape as read.   in   settings   of the scene: where touch begins
SolverShape make_solver_shape(const Shape& source, const Settings& settings = {});

}  // namespace scree
