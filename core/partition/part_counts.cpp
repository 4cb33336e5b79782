#include "core/partition/part_counts.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "core/geometry/triangle_mesh.hpp"

namespace scree {

namespace {

/// Which boxes a ball may touch, without looking at all of them: boxes by the cells of a coarse grid.
class BoxGrid {
 public:
  explicit BoxGrid(const std::vector<Box3>& boxes) : boxes_(boxes) {
    for (const Box3& b : boxes) {
      if (!b.is_empty()) all_.add(b);
    }
    per_axis_ = std::max(1, static_cast<int>(2 * std::cbrt(static_cast<double>(boxes.size()))));
    cells_.resize(static_cast<std::size_t>(per_axis_) * static_cast<std::size_t>(per_axis_) * static_cast<std::size_t>(per_axis_));
    for (std::size_t part = 0; part < boxes.size(); ++part) {
      if (boxes[part].is_empty()) continue;
      for_each_cell(boxes[part], [&](std::vector<int>& cell) { cell.push_back(static_cast<int>(part)); });
    }
    seen_.assign(boxes.size(), -1);
  }

  /// Calls visit(part) once for every box within `reach` of a point.
  template <class Visit>
  void for_each_near(const Vec3& x, double reach, std::int64_t stamp, Visit&& visit) {
    const Box3 ball{x - Vec3{reach, reach, reach}, x + Vec3{reach, reach, reach}};
    for_each_cell(ball, [&](std::vector<int>& cell) {
      for (const int part : cell) {
        const auto p = static_cast<std::size_t>(part);
        if (seen_[p] == stamp) continue;
        seen_[p] = stamp;
        const Vec3 nearest = component_min(component_max(x, boxes_[p].lower), boxes_[p].upper);
        if (squared_length(x - nearest) < reach * reach) visit(part);
      }
    });
  }

 private:
  template <class Visit>
  void for_each_cell(const Box3& box, Visit&& visit) {
    int low[3], high[3];
    for (int k = 0; k < 3; ++k) {
      const double extent = all_.upper[k] - all_.lower[k];
      const double scale = extent > 0 ? per_axis_ / extent : 0;
      low[k] = std::clamp(static_cast<int>((box.lower[k] - all_.lower[k]) * scale), 0, per_axis_ - 1);
      high[k] = std::clamp(static_cast<int>((box.upper[k] - all_.lower[k]) * scale), 0, per_axis_ - 1);
    }
    for (int x = low[0]; x <= high[0]; ++x)
      for (int y = low[1]; y <= high[1]; ++y)
        for (int z = low[2]; z <= high[2]; ++z) {
          visit(cells_[static_cast<std::size_t>((x * per_axis_ + y) * per_axis_ + z)]);
        }
  }

  const std::vector<Box3>& boxes_;
  Box3 all_;
  int per_axis_ = 1;
  std::vector<std::vector<int>> cells_;
  std::vector<std::int64_t> seen_;
};

}  // namespace

PartCounts count_parts(std::span<const int> part, std::span<const Vec3> x, std::span<const double> reach, std::span<const double> work,
                       int parts) {
  const auto count = static_cast<std::size_t>(parts);
  PartCounts counts;
  for (std::vector<double>* numbers : {&counts.work, &counts.bodies, &counts.neighbours, &counts.ghosts, &counts.sent})
    numbers->assign(count, 0);
  std::vector<Box3> box(count);
  for (std::size_t i = 0; i < x.size(); ++i) {
    const auto p = static_cast<std::size_t>(part[i]);
    const Vec3 r{reach[i], reach[i], reach[i]};
    counts.work[p] += work[i];
    counts.bodies[p] += 1;
    box[p].add(x[i] - r);
    box[p].add(x[i] + r);
  }
  BoxGrid grid(box);
  std::vector<std::vector<int>> known(count);
  for (std::size_t i = 0; i < x.size(); ++i) {
    grid.for_each_near(x[i], reach[i], static_cast<std::int64_t>(i), [&](int other) {
      if (other == part[i]) return;
      const auto to = static_cast<std::size_t>(other), from = static_cast<std::size_t>(part[i]);
      counts.ghosts[to] += 1;
      counts.sent[from] += kBytesPerGhost;
      if (std::find(known[to].begin(), known[to].end(), part[i]) == known[to].end()) known[to].push_back(part[i]);
    });
  }
  for (std::size_t p = 0; p < count; ++p) counts.neighbours[p] = static_cast<double>(known[p].size());
  return counts;
}

}  // namespace scree
