// Small repairs that change no shape: welding equal positions, dropping triangles without area, turning
// triangles outward. Everything is counted, so that the tool can say what it did.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/geometry/triangle_mesh.hpp"

namespace scree {

struct RepairCounts {
  std::int32_t vertices_welded = 0;        ///< vertices that had exactly the position of another
  std::int32_t slivers_flipped = 0;        ///< zero-area triangles given to their neighbour by an edge flip
  std::int32_t degenerate_dropped = 0;     ///< zero-area triangles dropped
  std::int32_t duplicates_dropped = 0;     ///< triangles of the same three vertices as an earlier one
  std::int32_t vertices_unreferenced = 0;  ///< vertices of no triangle, dropped
  std::int32_t triangles_turned = 0;       ///< winding reversed by turn_outward

  /// Whether anything but the weld was done.
  bool changes_triangles() const {
    return slivers_flipped + degenerate_dropped + duplicates_dropped + vertices_unreferenced + triangles_turned > 0;
  }
  /// One sentence for each repair that was made; the weld, which every STL needs, is not among them.
  std::vector<std::string> sentences() const;
};

/// Gives vertices of equal coordinates one index, keeping the first. No tolerance: nothing moves.
/// Returns the number of vertices removed. NaN coordinates are left alone.   Cost: O(V log V).
std::int32_t weld_equal_positions(TriangleMesh& mesh);

/// Removes triangles by index.   Cost: O(T).
void drop_triangles(TriangleMesh& mesh, const std::vector<std::int32_t>& ascending);

/// Removes vertices that no triangle uses; returns their number.   Cost: O(V + T).
std::int32_t drop_unreferenced(TriangleMesh& mesh);

/// Welds, then removes zero-area and duplicate triangles and vertices that nothing uses.
///
/// How: a triangle with a repeated vertex is dropped, which opens nothing. A flat triangle of three distinct
/// vertices has its middle vertex on the edge of a neighbour: the edge is flipped, so that the neighbour is
/// split at that vertex and no hole appears. Of triangles with the same three vertices the first is kept.
/// in   drop_all   also drop flat triangles that cannot be flipped; leaves T-junctions, so only for surfaces
/// A mesh with NaN coordinates is not touched.   Cost: O(T log T) for each of at most 16 passes.
RepairCounts clean_mesh(TriangleMesh& mesh, bool drop_all);

/// Makes the orientation consistent and outward: by walking over the edges of two triangles, then by the
/// signed volume and nesting of each closed component (a cavity faces its hollow).
/// Returns the number of triangles turned; -1, with the mesh unchanged, when a one-sided (Moebius) surface
/// has no consistent orientation.
/// Cost: O(T log T + components x T).
std::int32_t turn_outward(TriangleMesh& mesh);

}  // namespace scree
