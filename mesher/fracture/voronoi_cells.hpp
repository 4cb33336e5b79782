// Voronoi cells of points in a box: which cells border each other, exactly.
#pragma once

#include <cstdint>
#include <map>
#include <vector>

#include "mesher/fracture/cut_signs.hpp"

namespace scree {

/// Points that own what is nearest to them. Coordinates are multiples of kGrid below 1 in size, so that the coefficients of bisector
/// planes are exact doubles: their offset is a sum of six squares of 24-bit numbers.
class Generators {
 public:
  static constexpr double kGrid = 0x1p-23;
  /// Half the side of the box that closes outer cells. A mesh lies within 1; more than that keeps the box's own vertices outside of it.
  static constexpr double kBox = 4;

  Generators() = default;
  /// Rounds the points to the grid.
  explicit Generators(std::vector<Vec3> points);

  std::int32_t count() const { return static_cast<std::int32_t>(points_.size()); }
  const std::vector<Vec3>& points() const { return points_; }
  /// What lies nearer to i than to j; j from -1 to -6 are the sides of the box.
  CutPlane plane(std::int32_t i, std::int32_t j) const;

 private:
  std::vector<Vec3> points_;
};

/// A convex cell as faces: for each neighbour (or side of the box) the neighbours that its face borders on, counter-clockwise seen from
/// outside. Two that follow each other, and the neighbour of the face itself, name a vertex.
using VoronoiCell = std::map<std::int32_t, std::vector<std::int32_t>>;

/// The cells of all points.
///
/// How: a box, cut by the bisectors of other points, the nearest first, until the next is further than twice the farthest vertex. Signs of
/// vertices are exact, so that the cells of both sides of a face agree.
/// Source: C. Rycroft, VORO++: A three-dimensional Voronoi cell library in C++, Chaos 19 (2009) 041111, for the order of cutting.
/// Fails: DegenerateCut where five or more points lie on one sphere, and for points at the same place.   Cost: O(n^2 log n), for
/// n of thousands.
std::vector<VoronoiCell> voronoi_cells(const Generators& generators);

/// Cuts a convex polygon, given by the labels of its edges, by a plane that becomes an edge of the given label. The vertex between the
/// edges of labels a and b (in this order) lies inside where inside(a, b). Empty when nothing is left.
template <class Inside>
std::vector<std::int32_t> cut_polygon(const std::vector<std::int32_t>& edges, std::int32_t label, Inside&& inside) {
  const std::size_t n = edges.size();
  std::vector<char> is_in(n);
  bool any_in = false, any_out = false;
  for (std::size_t k = 0; k < n; ++k) {
    is_in[k] = inside(edges[(k + n - 1) % n], edges[k]);
    (is_in[k] ? any_in : any_out) = true;
  }
  if (!any_out) return edges;
  std::vector<std::int32_t> kept;
  if (!any_in) return kept;
  for (std::size_t k = 0; k < n; ++k) {
    const bool end_is_in = is_in[(k + 1) % n];
    if (is_in[k] || end_is_in) kept.push_back(edges[k]);
    if (is_in[k] && !end_is_in) kept.push_back(label);
  }
  return kept;
}

}  // namespace scree
