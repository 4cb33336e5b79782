// Facets of any number of vertices, as mesh files hold them, and triangles made of them.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/geometry/triangle_mesh.hpp"

namespace scree {

/// A triangle is degenerate when its height over its longest edge is at most this part of that edge. Just
/// above the rounding of double coordinates far from the origin; larger values would drop real slivers.
inline constexpr double kDegenerateHeight = 1e-12;

/// A mesh of polygons.
///
/// vertices  V x 3
/// corners   vertex indices of all facets, one facet behind the other
/// ends      for each facet, where its corners end
struct PolygonMesh {
  std::vector<Vec3> vertices;
  std::vector<std::int32_t> corners;
  std::vector<std::size_t> ends;

  std::size_t facet_count() const { return ends.size(); }
  std::span<const std::int32_t> facet(std::size_t f) const {
    const std::size_t start = f == 0 ? 0 : ends[f - 1];
    return {corners.data() + start, ends[f] - start};
  }
  /// Ends the facet whose corners were added last.
  void close_facet() { ends.push_back(corners.size()); }
};

struct PolygonCounts {
  std::int64_t too_few = 0;   ///< facets of fewer than three corners (points and lines), left out
  std::int64_t crossing = 0;  ///< polygons that cross themselves or enclose no area, cut as fans
};

/// A facet of more corners is refused: cutting it costs the square of their number.
inline constexpr std::size_t kLongestFacet = 20'000;

/// Cuts every facet into triangles that lie in it, whether it is convex or not, and adds no vertex.
///
/// How: ears are cut off, the one with the shortest new edge first, in the projection along the axis next to the facet's normal.
/// All triangles of a facet turn the same way in it, so those of a polygon that does not cross itself do not overlap and cover
/// it. A facet of four corners is cut from its first corner where both triangles turn that way.
/// Source: G. Meisters, Polygons have ears, 1975; for the normal: I. Sutherland, R. Sproull, R. Schumacker, A characterization of
/// ten hidden-surface algorithms, 1974 (Newell's).
/// in   polygons   indices within the vertices, facets of at most kLongestFacet corners
/// Fails: never.   Cost: O(corners), and n^2 for a facet of n > 4 corners.   Limits: a facet that is not flat is cut as its
/// projection; one with a hole must have a cut from its rim to the hole.
TriangleMesh triangulated(PolygonMesh&& polygons, PolygonCounts& counts);

}  // namespace scree
