// The mesh check: what is right and wrong with a triangle mesh that should become a rigid body.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "core/geometry/mass_properties.hpp"
#include "core/geometry/polygons.hpp"
#include "core/geometry/triangle_mesh.hpp"

namespace scree {

/// One piece of the mesh: triangles connected over shared edges.
struct MeshComponent {
  std::int32_t triangle_count = 0;
  bool is_closed = true;    ///< every edge has exactly two triangles
  bool is_oriented = true;  ///< neighbours agree on which side is outside
  double volume = 0;        ///< signed [m^3]; without meaning when open
  std::int32_t depth = 0;   ///< number of other closed components around it: 0 is a body, 1 a cavity in it
};

/// Where findings are [m]: the first kListedPlaces of each kind, middles of edges and triangles.
struct MeshPlaces {
  std::vector<Vec3> boundary_edges, non_manifold_edges, inconsistent_edges, non_manifold_vertices, t_junctions, degenerate_triangles,
      duplicate_triangles, self_intersections;
};
inline constexpr std::size_t kListedPlaces = 10;

/// What was found. Counts are exact; places are the first ones found.
struct MeshCheck {
  std::int32_t vertex_count = 0, triangle_count = 0;
  std::int32_t nonfinite_vertices = 0;  ///< NaN or infinite coordinates; when > 0 nothing below is computed
  std::int32_t first_nonfinite_vertex = -1;
  std::int32_t unreferenced_vertices = 0;
  std::int32_t degenerate_triangles = 0;    ///< zero area, see kDegenerateHeight
  std::int32_t duplicate_triangles = 0;     ///< copies of a triangle beyond the first, in either winding
  std::int32_t boundary_edges = 0;          ///< edges of one triangle: the mesh is open there
  std::int32_t boundary_loops = 0;          ///< connected chains of boundary edges: about one a hole
  std::int32_t non_manifold_edges = 0;      ///< edges of more than two triangles
  std::int32_t inconsistent_edges = 0;      ///< edges whose two triangles run the same way along it
  std::int32_t non_manifold_vertices = 0;   ///< vertices at which separate fans of triangles touch
  std::int32_t t_junctions = 0;             ///< boundary vertices that lie inside another boundary edge
  std::int32_t inverted_components = 0;     ///< closed, consistent, but inside out for where they lie
  std::int32_t overlapping_components = 0;  ///< bodies inside bodies: their volume would count twice
  std::int32_t crossing_pairs = 0;          ///< triangles without a common vertex that pass through each other
  std::int32_t crossing_components = 0;     ///< pairs of components that have a common volume and whose surfaces meet
  std::int32_t touching_components = 0;     ///< pairs of components whose surfaces meet without a common volume: a face on a face
  bool nesting_was_checked = true;          ///< false when there are too many components (kNestingWork)
  std::vector<MeshComponent> components;    ///< by first triangle
  std::int32_t euler_characteristic = 0;    ///< V - E + T of referenced vertices; 2 for one ball-like piece
  MeshPlaces places;
  Box3 bounds;          ///< [m]
  double area = 0;      ///< [m^2]
  MassProperties mass;  ///< density 1; has a meaning only when problems is empty

  std::vector<std::string> problems;  ///< why it cannot be a rigid body, with numbers; empty when it can
  std::vector<std::string> advice;    ///< what to do about them
  std::vector<std::string> remarks;   ///< worth knowing, no obstacle

  bool is_watertight() const { return triangle_count > 0 && boundary_edges == 0 && non_manifold_edges == 0; }
  bool is_solid() const { return problems.empty(); }
  double equivalent_diameter() const;  ///< of the ball of equal volume [m]; 0 when the volume is not > 0
};

/// A solid's volume is at least this part of area times extent, else it is called flat.
inline constexpr double kFlatVolume = 1e-12;
/// Part by which rounding may break the triangle inequality of the moments, which flat bodies meet with equality.
inline constexpr double kMomentRounding = 1e-9;
/// A boundary vertex is inside a boundary edge when it is closer than this part of the edge's length. Files
/// hold single precision, whose rounding is 6e-8 of the extent.
inline constexpr double kTJunctionDistance = 1e-6;
/// The nesting test costs components x triangles; above this many it is left out, and said so.
inline constexpr double kNestingWork = 2e8;

/// Checks topology, orientation and volume.
///
/// How: edges from sorted half edges; components by union-find over edges; nesting of components by their
/// winding numbers (A. van Oosterom, J. Strackee, The solid angle of a plane triangle, 1983).
/// in   mesh   equal positions already welded (see weld_equal_positions): topology is read from the indices
/// Fails: never.   Cost: O(T log T + components x T).
MeshCheck check_mesh(const TriangleMesh& mesh);

/// Readable table, several lines, each ended by a newline.
std::string table_of(const MeshCheck& check);

/// The verdict that a shape file keeps.
nlohmann::json json_of(const MeshCheck& check);

/// True when the triangle's height over its longest edge is at most kDegenerateHeight of that edge.
bool is_degenerate(const Vec3& a, const Vec3& b, const Vec3& c);

/// How often the surface winds around a point: 1 inside, 0 outside, for each closed outward component.
double winding_number(const TriangleMesh& mesh, const std::vector<std::int32_t>& triangles, const Vec3& point);

/// Component of each triangle, numbered by first triangle. Triangles are connected over shared edges.
std::vector<std::int32_t> find_components(const TriangleMesh& mesh, std::int32_t& component_count);

}  // namespace scree
