// Boxes of a bisection of space, and what can be said of them without Zoltan.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/geometry/vec3.hpp"

namespace scree {

/// Stands for infinity in outer sides: finite, so that JSON and HDF5 tools show it.
inline constexpr double kOuterSide = 1e300;

/// Leaf boxes of a bisection: box r belongs to rank r. Outer sides are +-kOuterSide.
struct CutBoxes {
  std::vector<Vec3> lower, upper;
  int rank_of(const Vec3& point) const;  ///< lower sides inclusive, so that every point has one owner
  /// Ranks whose box comes within `reach` of the given point box, ascending.
  void ranks_touching(const Vec3& box_lower, const Vec3& box_upper, std::vector<int>& ranks) const;
  /// Whether two boxes come closer than `reach` [m].
  bool are_within(std::size_t a, std::size_t b, double reach) const;
};

/// A point that is cut by hand.
struct WeightedPoint {
  Vec3 x;
  double weight;
  std::int64_t id;
};

/// Everything to the first part: what a bisection of nothing is.
CutBoxes whole_space_first(int parts);

/// Bisection of a handful of points, alike on every rank; a part without points gets an empty box. Sorts the points.
CutBoxes cut_few_points(std::span<WeightedPoint> points, int parts);

/// Orders the leaves of a bisection from lower to upper side, cut by cut from the root, so that the order is a function of
/// the geometry only.
CutBoxes ordered_by_cuts(const CutBoxes& boxes);

/// Whether the leaves share no volume. A part without points comes back from Zoltan as a box over its neighbours.
/// Cost: O(parts^2).
bool is_tiling(const CutBoxes& boxes);

/// Largest over mean of the weights per part.   1 when all weights are zero.
double imbalance(std::span<const double> work_per_part);

}  // namespace scree
