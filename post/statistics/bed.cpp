#include "post/statistics/bed.hpp"

#include <algorithm>
#include <cmath>

#include "core/base/numbers.hpp"

namespace scree {

namespace {

constexpr double kColumnWidth = 2;    // mean diameters: narrower and single particles make the surface rough
constexpr int kMaxColumns = 64;       // along an axis: bounds the memory, and so many are fine enough for any surface
constexpr std::size_t kLevels = 256;  // of the histogram of a column; places between are interpolated
constexpr double kInner = 0.1;        // of a column's solid that is left out below, and above
constexpr int kLines = 12;            // along each axis of a column, for a round container: 1 % of a column that it cuts
constexpr double kRim = 0.5;          // of the middle column's solid per area

struct Column {
  Box3 box;                    // its plan; along the vertical axis the inner part
  double solid = 0, area = 0;  // [m^3], [m^2] of the container's plan in it
};

/// Height below which a share of a column's solid lies.
double level_of(const double* histogram, double solid, double share, double low, double height) {
  double below = 0;
  for (std::size_t k = 0; k < kLevels; ++k) {
    if (below + histogram[k] >= share * solid && histogram[k] > 0) {
      return low + height / kLevels * (static_cast<double>(k) + (share * solid - below) / histogram[k]);
    }
    below += histogram[k];
  }
  return low + height;
}

/// Columns with what they hold of a frame.
std::vector<Column> columns_of(const FrameView& view) {
  const Container& container = view.facts.container;
  const int up = container.vertical, u = (up + 1) % 3, v = (up + 2) % 3;
  const Box3 bounds = container.room.bounds();
  const Vec3 extent = bounds.extent();
  const double height = view.highest - view.lowest;
  const auto count_of = [&](int axis) {
    return std::clamp(static_cast<int>(extent[axis] / (kColumnWidth * view.mean_diameter)), 1, kMaxColumns);
  };
  const int nu = count_of(u), nv = count_of(v);
  std::vector<Column> columns(static_cast<std::size_t>(nu * nv));
  std::vector<double> levels(columns.size() * kLevels);
  view.for_each_sample([&](const Vec3& p, double volume, std::size_t) {
    if (!container.holds(p)) return;
    const int i = static_cast<int>((p[u] - bounds.lower[u]) / extent[u] * nu),
              j = static_cast<int>((p[v] - bounds.lower[v]) / extent[v] * nv);
    const auto k = static_cast<std::size_t>(std::clamp(i, 0, nu - 1) * nv + std::clamp(j, 0, nv - 1));
    const double place = (p[up] - view.lowest) / height * static_cast<double>(kLevels);
    columns[k].solid += volume;
    levels[k * kLevels + static_cast<std::size_t>(std::clamp(place, 0.0, static_cast<double>(kLevels - 1)))] += volume;
  });
  for (int i = 0; i < nu; ++i) {
    for (int j = 0; j < nv; ++j) {
      const auto k = static_cast<std::size_t>(i * nv + j);
      Column& c = columns[k];
      if (!(c.solid > 0)) continue;
      c.box.lower[u] = bounds.lower[u] + extent[u] * i / nu;
      c.box.upper[u] = bounds.lower[u] + extent[u] * (i + 1) / nu;
      c.box.lower[v] = bounds.lower[v] + extent[v] * j / nv;
      c.box.upper[v] = bounds.lower[v] + extent[v] * (j + 1) / nv;
      c.box.lower[up] = level_of(&levels[k * kLevels], c.solid, kInner, view.lowest, height);
      c.box.upper[up] = level_of(&levels[k * kLevels], c.solid, 1 - kInner, view.lowest, height);
      const double thickness = c.box.upper[up] - c.box.lower[up];
      c.area = thickness > 0 ? container.volume_in(c.box, kLines) / thickness : 0;
    }
  }
  std::erase_if(columns, [](const Column& c) { return !(c.area > 0); });
  return columns;
}

}  // namespace

BedSolid bed_solid(const FrameView& view) {
  BedSolid bed{kNaN, kNaN};
  if (view.particles == 0 || !(view.highest > view.lowest)) return bed;
  std::vector<Column> columns = columns_of(view);
  double all = 0;
  for (const Column& c : columns) all += c.solid;
  Box3 whole = view.facts.container.room.bounds();
  const int up = view.facts.container.vertical;
  whole.lower[up] = view.lowest;
  whole.upper[up] = view.highest;
  if (const double room = view.facts.container.volume_in(whole); room > 0) bed.of_container = all / room;
  if (columns.empty()) return bed;

  // the middle column by solid
  std::sort(columns.begin(), columns.end(), [](const Column& a, const Column& b) { return a.solid * b.area < b.solid * a.area; });
  double middle = 0;
  double below = 0;
  for (const Column& c : columns) {
    below += c.solid;
    if (below < 0.5 * all) continue;
    middle = c.solid / c.area;
    break;
  }
  double solid = 0, room = 0;
  for (const Column& c : columns) {
    if (c.solid < kRim * middle * c.area) continue;
    solid += (1 - 2 * kInner) * c.solid;
    room += view.facts.container.volume_in(c.box, kLines);
  }
  if (room > 0) bed.fraction = solid / room;
  return bed;
}

}  // namespace scree
