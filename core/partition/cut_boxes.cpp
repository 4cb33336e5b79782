#include "core/partition/cut_boxes.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "core/base/error.hpp"

namespace scree {

namespace {

/// Orders the leaves of a bisection from lower to upper side, cut by cut from the root. Zoltan's own order
/// depends on which process it sent a half to; sorting by corners would swap boxes whenever two cuts of
/// different halves pass each other, and so move all their bodies.
void order_by_cuts(const CutBoxes& boxes, std::vector<std::size_t>& parts, std::size_t first, std::size_t last) {
  const std::size_t count = last - first;
  if (count < 2) return;
  const auto at = [&](std::size_t i) { return static_cast<std::ptrdiff_t>(i); };
  std::size_t best_left = 0;
  int best_axis = -1;
  double best_cut = 0;
  for (int axis = 0; axis < 3; ++axis) {
    for (std::size_t c = first; c < last; ++c) {
      const double cut = boxes.lower[parts[c]][axis];
      std::size_t left = 0;
      bool clean = true;
      for (std::size_t i = first; i < last && clean; ++i) {
        if (boxes.upper[parts[i]][axis] <= cut)
          ++left;
        else
          clean = boxes.lower[parts[i]][axis] >= cut;
      }
      if (!clean || left == 0 || left == count) continue;
      const auto uneven = [&](std::size_t n) { return n > count - n ? 2 * n - count : count - 2 * n; };
      if (best_axis < 0 || uneven(left) < uneven(best_left)) {
        best_left = left;
        best_axis = axis;
        best_cut = cut;
      }
    }
  }
  const auto begin = parts.begin() + at(first), end = parts.begin() + at(last);
  if (best_axis < 0) {
    // only boxes without points, all at one place: any order will do, as long as it is always the same
    std::sort(begin, end, [&](std::size_t a, std::size_t b) {
      for (int k = 0; k < 3; ++k) {
        if (boxes.lower[a][k] != boxes.lower[b][k]) return boxes.lower[a][k] < boxes.lower[b][k];
        if (boxes.upper[a][k] != boxes.upper[b][k]) return boxes.upper[a][k] < boxes.upper[b][k];
      }
      return false;
    });
    return;
  }
  std::stable_partition(begin, end, [&](std::size_t i) { return boxes.upper[i][best_axis] <= best_cut; });
  order_by_cuts(boxes, parts, first, first + best_left);
  order_by_cuts(boxes, parts, first + best_left, last);
}

/// Bisection of a handful of points, appended part by part; a part without points gets an empty box.
void cut_few(std::span<WeightedPoint> points, int parts, const Vec3& lower, const Vec3& upper, CutBoxes& boxes) {
  if (parts == 1) {
    boxes.lower.push_back(lower);
    boxes.upper.push_back(upper);
    return;
  }
  Vec3 low = upper, high = lower;
  double total = 0;
  for (const WeightedPoint& p : points) {
    low = component_min(low, p.x);
    high = component_max(high, p.x);
    total += p.weight;
  }
  int axis = 0;
  for (int k = 1; k < 3; ++k) {
    if (high[k] - low[k] > high[axis] - low[axis]) axis = k;
  }
  std::sort(points.begin(), points.end(), [axis](const WeightedPoint& a, const WeightedPoint& b) {
    return a.x[axis] != b.x[axis] ? a.x[axis] < b.x[axis] : a.id < b.id;
  });
  const int left_parts = (parts + 1) / 2;
  // the split between two different coordinates that comes closest to the wanted share of the work
  const double wanted = total * left_parts / parts;
  double cut = upper[axis], sum = 0, best_error = std::numeric_limits<double>::max();
  std::size_t left_count = points.size();
  for (std::size_t i = 0; i + 1 < points.size(); ++i) {
    sum += points[i].weight;
    if (points[i].x[axis] < points[i + 1].x[axis] && std::abs(sum - wanted) < best_error) {
      best_error = std::abs(sum - wanted);
      left_count = i + 1;
      const double middle = 0.5 * (points[i].x[axis] + points[i + 1].x[axis]);
      cut = middle > points[i].x[axis] ? middle : points[i + 1].x[axis];
    }
  }
  Vec3 left_upper = upper, right_lower = lower;
  left_upper[axis] = cut;
  right_lower[axis] = cut;
  cut_few(points.first(left_count), left_parts, lower, left_upper, boxes);
  cut_few(points.subspan(left_count), parts - left_parts, right_lower, upper, boxes);
}

}  // namespace

bool is_tiling(const CutBoxes& boxes) {
  for (std::size_t a = 0; a < boxes.lower.size(); ++a) {
    for (std::size_t b = 0; b < a; ++b) {
      bool overlap = true;
      for (int k = 0; k < 3; ++k) {
        overlap = overlap && std::max(boxes.lower[a][k], boxes.lower[b][k]) < std::min(boxes.upper[a][k], boxes.upper[b][k]);
      }
      if (overlap) return false;
    }
  }
  return true;
}

CutBoxes whole_space_first(int parts) {
  CutBoxes boxes;
  boxes.lower.assign(static_cast<std::size_t>(parts), Vec3{kOuterSide, -kOuterSide, -kOuterSide});
  boxes.upper.assign(static_cast<std::size_t>(parts), Vec3{kOuterSide, kOuterSide, kOuterSide});
  boxes.lower[0].x = -kOuterSide;
  return boxes;
}

CutBoxes cut_few_points(std::span<WeightedPoint> points, int parts) {
  CutBoxes boxes;
  cut_few(points, parts, {-kOuterSide, -kOuterSide, -kOuterSide}, {kOuterSide, kOuterSide, kOuterSide}, boxes);
  return boxes;
}

CutBoxes ordered_by_cuts(const CutBoxes& boxes) {
  std::vector<std::size_t> order(boxes.lower.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  order_by_cuts(boxes, order, 0, order.size());
  CutBoxes sorted;
  for (std::size_t part : order) {
    sorted.lower.push_back(boxes.lower[part]);
    sorted.upper.push_back(boxes.upper[part]);
  }
  return sorted;
}

bool CutBoxes::are_within(std::size_t a, std::size_t b, double reach) const {
  double squared = 0;
  for (int k = 0; k < 3; ++k) {
    const double gap = std::max({0.0, lower[a][k] - upper[b][k], lower[b][k] - upper[a][k]});
    squared += gap * gap;
  }
  return squared < reach * reach;
}

int CutBoxes::rank_of(const Vec3& point) const {
  for (std::size_t r = 0; r < lower.size(); ++r) {
    bool inside = true;
    for (int k = 0; k < 3 && inside; ++k) {
      // an outer side holds whatever lies beyond it
      const bool above = point[k] >= lower[r][k] || lower[r][k] <= -kOuterSide;
      const bool below = point[k] < upper[r][k] || (upper[r][k] >= kOuterSide && lower[r][k] < kOuterSide);
      inside = above && below;
    }
    if (inside) return static_cast<int>(r);
  }
  throw InternalError(fmt::format("no rank owns the point ({:g}, {:g}, {:g})", point.x, point.y, point.z));
}

void CutBoxes::ranks_touching(const Vec3& box_lower, const Vec3& box_upper, std::vector<int>& ranks) const {
  ranks.clear();
  for (std::size_t r = 0; r < lower.size(); ++r) {
    bool touches = true;
    for (int k = 0; k < 3 && touches; ++k) {
      touches = lower[r][k] < upper[r][k] && (box_upper[k] >= lower[r][k] || lower[r][k] <= -kOuterSide) &&
                (box_lower[k] <= upper[r][k] || upper[r][k] >= kOuterSide);
    }
    if (touches) ranks.push_back(static_cast<int>(r));
  }
}

double imbalance(std::span<const double> work_per_part) {
  const double sum = std::accumulate(work_per_part.begin(), work_per_part.end(), 0.0);
  if (!(sum > 0)) return 1;
  return *std::max_element(work_per_part.begin(), work_per_part.end()) * static_cast<double>(work_per_part.size()) / sum;
}

}  // namespace scree
