// The repairs that a mesh from the wild needs to become a solid: what clean_mesh must not do, because it changes shape.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/geometry/triangle_mesh.hpp"

namespace scree {

struct HealOptions {
  double weld = 0;            ///< weld all vertices nearer than this part of the extent; 0: only along open edges
  double largest_fill = 0.2;  ///< holes are closed only if all fillings together are at most this part of the area
};

/// A vertex of an open edge is welded to another one nearer than this part of the extent: the rounding of
/// single-precision files, a few times over. Larger gaps are left to --weld or become filled holes.
inline constexpr double kBorderWeld = 1e-6;

/// Heals in the order that lets each step help the next; what it did is added to `steps`, a sentence each. Returns the smallest
/// `largest_fill` that would close the holes that it left open for their size; 0 when there are none.
///
///   weld        vertices along open edges that lie within rounding of each other (options.weld: all vertices)
///   split       open edges at the vertices that lie on them: T-junctions
///   drop fins   pieces of surface that end in the open and hang on edges of more than two triangles
///   drop walls  pieces inside the solid whose borders are edges of more than two triangles
///   cut         edges of an even number of triangles into pairs, each pair around one wedge of the solid
///   fill        holes, by the triangulation of least area (Liepa's, without its refinement)
///   turn        outward, by connectivity, signed volume and nesting
///   resolve     self-intersections: the triangles that cross and their neighbours are removed and the holes filled
///
/// Source: P. Liepa, Filling holes in meshes, SGP 2003, section 3; A. Gueziec et al., Cutting and stitching, 2001.
/// Fails: never; what could not be healed is still there, for check_mesh to tell.
/// Cost: O(T log T), and n^3 for a hole of n edges up to kLongHole.
double heal_mesh(TriangleMesh& mesh, const HealOptions& options, std::vector<std::string>& steps);

/// Holes of more edges are filled ear by ear instead of by least area.
inline constexpr std::size_t kLongHole = 300;

/// The components of a mesh as meshes of their own, in the order of find_components.
std::vector<TriangleMesh> components_of(const TriangleMesh& mesh);

/// Holes that stay open.
struct OpenHoles {
  std::int32_t too_large = 0;   ///< their fillings would exceed the limit of area
  std::int32_t impossible = 0;  ///< every filling would use an edge that the mesh has already
  double area = 0;              ///< of the fillings of those that are too large [m^2]
};

/// Closes holes, the smallest first, as long as all fillings are at most `most_area`; returns the number closed, and adds to
/// `filled` their area [m^2].
std::int32_t fill_holes(TriangleMesh& mesh, double most_area, double& filled, OpenHoles& left);

}  // namespace scree
