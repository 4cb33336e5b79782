#include "solver/scene/density_weights.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace scree {

namespace {

using Cell = std::array<std::int32_t, 3>;

/// Points sorted into cubes as wide as the radius of search.
class PointGrid {
 public:
  PointGrid(const std::vector<Vec3>& points, double width) : width_(width) {
    lower_ = points.front();
    for (const Vec3& p : points)
      for (int k = 0; k < 3; ++k) lower_[k] = std::min(lower_[k], p[k]);
    entries_.reserve(points.size());
    for (std::size_t i = 0; i < points.size(); ++i) entries_.push_back({cell_of(points[i]), static_cast<std::int32_t>(i)});
    std::sort(entries_.begin(), entries_.end());
  }

  Cell cell_of(const Vec3& p) const {
    Cell cell;
    for (int k = 0; k < 3; ++k) cell[static_cast<std::size_t>(k)] = static_cast<std::int32_t>(std::floor((p[k] - lower_[k]) / width_));
    return cell;
  }

  /// Calls action(index) for the points of a cell and of those around it, always in the same order.
  template <class Action>
  void around(const Cell& cell, Action&& action) const {
    for (std::int32_t x = cell[0] - 1; x <= cell[0] + 1; ++x)
      for (std::int32_t y = cell[1] - 1; y <= cell[1] + 1; ++y) {
        // cells that differ in z alone lie side by side
        auto entry = std::lower_bound(entries_.begin(), entries_.end(), Entry{{x, y, cell[2] - 1}, -1});
        for (; entry != entries_.end() && entry->first[0] == x && entry->first[1] == y && entry->first[2] <= cell[2] + 1; ++entry)
          action(entry->second);
      }
  }

 private:
  using Entry = std::pair<Cell, std::int32_t>;
  double width_;
  Vec3 lower_;
  std::vector<Entry> entries_;
};

}  // namespace

std::vector<double> density_weights(const SolverShape& shape, double radius) {
  const auto count = static_cast<std::int32_t>(shape.features.corners.size());
  // cells of a millionth of a body still have indices of 32 bits
  if (!(radius > 1e-6 * shape.radius) || count < 2) return {};
  std::vector<Vec3> points;
  for (std::int32_t c = 0; c < count; ++c) points.push_back(shape.corner(c));
  const PointGrid grid(points, radius);
  std::vector<double> weights(points.size());
  const double r2 = radius * radius;
  bool clustered = false;
#pragma omp parallel for schedule(static) reduction(|| : clustered)
  for (std::int32_t i = 0; i < count; ++i) {
    const Vec3& p = points[static_cast<std::size_t>(i)];
    double others = 0;
    grid.around(grid.cell_of(p), [&](std::int32_t j) {
      const double y2 = squared_length(points[static_cast<std::size_t>(j)] - p) / r2;
      if (j != i && y2 < 1) others += (1 - y2) * (1 - y2);
    });
    weights[static_cast<std::size_t>(i)] = 1 / (1 + others);
    clustered = clustered || others > 0;
  }
  if (!clustered) return {};
  return weights;
}

double half_octave(double scale) {
  // exact comparisons, no logarithm whose last digit could differ elsewhere
  constexpr double kFourthRootOfTwo = 1.189207115002721;
  int exponent = 0;
  const double mantissa = std::frexp(scale * kFourthRootOfTwo, &exponent);
  const double lower = std::ldexp(1.0, exponent - 1);
  return mantissa < 0.5 * std::numbers::sqrt2 ? lower : lower * std::numbers::sqrt2;
}

const double* DensityWeights::find(const SolverShape& shape, std::int32_t index, double radius) {
  const std::lock_guard lock(mutex_);
  const auto [table, is_new] = tables_.try_emplace({index, radius});
  if (is_new) table->second = density_weights(shape, radius);
  return table->second.empty() ? nullptr : table->second.data();
}

const double* DensityWeights::of_body(const SolverShape& shape, std::int32_t index, double scale) {
  const double depth = of_ == Depth::of_shape ? shape.margin : depth_ / half_octave(scale);
  return find(shape, index, kDensityRadius * std::sqrt(shape.equivalent_radius * depth));
}

const double* DensityWeights::of_wall(const SolverShape& shape, std::int32_t index, double scale, double body_radius) {
  return find(shape, index, kDensityRadius * std::sqrt(body_radius * depth_) / scale);
}

std::vector<double> DensityWeights::of_worn_wall(const SolverShape& shape, double scale, double body_radius) const {
  return density_weights(shape, kDensityRadius * std::sqrt(body_radius * depth_) / scale);
}

DensityWeights::Summary DensityWeights::summary() const {
  const std::lock_guard lock(mutex_);
  Summary s;
  for (const auto& [key, table] : tables_) {
    if (table.empty()) continue;
    ++s.tables;
    s.bytes += table.capacity() * sizeof(double);
    s.least = std::min(s.least, *std::min_element(table.begin(), table.end()));
  }
  return s;
}

}  // namespace scree
