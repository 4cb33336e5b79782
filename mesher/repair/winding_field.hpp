// Inside or outside of any set of triangles, closed or not: the generalised winding number, fast.
#pragma once

#include <vector>

#include "core/geometry/triangle_mesh.hpp"

namespace scree {

/// How often the surface winds around a point: 1 inside and 0 outside of a closed outward mesh, between them where it has
/// holes, 2 where two bodies overlap.
///
/// How: triangles in a tree; a group that is far from the point, measured by its size, counts as one small plane.
/// Source: G. Barill, N. Dickson, R. Schmidt, D. Levin, A. Jacobson, Fast winding numbers for soups and clouds,
/// SIGGRAPH 2018, first order; A. Jacobson, L. Kavan, O. Sorkine, Robust inside-outside segmentation using generalized
/// winding numbers, SIGGRAPH 2013.
/// Error: some percent of 1.   Cost: O(log T) a point.
class WindingField {
 public:
  explicit WindingField(const TriangleMesh& mesh);
  double at(const Vec3& point) const;

 private:
  struct Node {
    Vec3 centre, area;                            // area-weighted middle, sum of area vectors
    double radius = 0;                            // of the ball about the centre that holds the triangles
    std::int32_t first = 0, count = 0, skip = 0;  // range in order_; next node when this one is done
  };
  std::int32_t build(std::int32_t begin, std::int32_t end, std::vector<Vec3>& middle);
  const TriangleMesh& mesh_;
  std::vector<std::int32_t> order_;
  std::vector<Node> nodes_;
};

}  // namespace scree
