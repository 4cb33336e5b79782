#include "mesher/fracture/voronoi_cells.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace scree {

namespace {

/// Excess of the radius within which other points can still cut a cell: far above the rounding of the distances that it bounds.
constexpr double kRadiusSlack = 1 + 1e-9;

VoronoiCell box_cell() {
  // sides -1: x = -, -2: x = +, -3: y = -, ... each borders on four others, counter-clockwise seen from outside
  return {{-1, {-5, -3, -6, -4}}, {-2, {-5, -4, -6, -3}}, {-3, {-5, -2, -6, -1}},
          {-4, {-5, -1, -6, -2}}, {-5, {-1, -4, -2, -3}}, {-6, {-1, -3, -2, -4}}};
}

/// Distance of the farthest vertex from generator i.
double farthest_vertex(const Generators& g, std::int32_t i, const VoronoiCell& cell) {
  double farthest = 0;
  for (const auto& [j, loop] : cell) {
    for (std::size_t k = 0; k < loop.size(); ++k) {
      const std::int32_t before = loop[(k + loop.size() - 1) % loop.size()];
      const Vec3 x = planes_point(g.plane(i, j), g.plane(i, before), g.plane(i, loop[k]));
      farthest = std::max(farthest, length(x - g.points()[static_cast<std::size_t>(i)]));
    }
  }
  return farthest;
}

/// Whether the cell became smaller.
bool cut_cell(const Generators& g, std::int32_t i, std::int32_t m, VoronoiCell& cell) {
  const CutPlane plane = g.plane(i, m);
  std::map<std::array<std::int32_t, 3>, bool> known;
  const auto is_inside = [&](std::int32_t a, std::int32_t b, std::int32_t c) {
    std::array<std::int32_t, 3> key{a, b, c};
    std::sort(key.begin(), key.end());
    const auto [it, is_new] = known.try_emplace(key, false);
    if (is_new) it->second = sign_at_planes(plane, g.plane(i, key[0]), g.plane(i, key[1]), g.plane(i, key[2])) > 0;
    return it->second;
  };
  std::map<std::int32_t, std::int32_t> next;  // around the new face
  for (auto face = cell.begin(); face != cell.end();) {
    const std::int32_t j = face->first;
    std::vector<std::int32_t>& loop = face->second;
    loop = cut_polygon(loop, m, [&](std::int32_t a, std::int32_t b) { return is_inside(j, a, b); });
    if (loop.empty()) {
      face = cell.erase(face);
      continue;
    }
    const auto at = std::find(loop.begin(), loop.end(), m);
    if (at != loop.end()) next[j] = at == loop.begin() ? loop.back() : *std::prev(at);
    ++face;
  }
  if (next.empty()) return false;
  std::vector<std::int32_t>& added = cell[m];
  const std::int32_t first = next.begin()->first;
  for (std::int32_t j = first; added.size() <= next.size();) {
    added.push_back(j);
    j = next.at(j);
    if (j == first) break;
  }
  return true;
}

}  // namespace

Generators::Generators(std::vector<Vec3> points) : points_(std::move(points)) {
  for (Vec3& p : points_) {
    for (int k = 0; k < 3; ++k) p[k] = kGrid * std::round(p[k] / kGrid);
  }
}

CutPlane Generators::plane(std::int32_t i, std::int32_t j) const {
  if (j < 0) {
    CutPlane side{{}, kBox};
    side.normal[(-j - 1) / 2] = (-j - 1) % 2 == 0 ? 1 : -1;
    return side;
  }
  const Vec3 &a = points_[static_cast<std::size_t>(i)], &b = points_[static_cast<std::size_t>(j)];
  return {2.0 * (a - b), squared_length(b) - squared_length(a)};
}

std::vector<VoronoiCell> voronoi_cells(const Generators& generators) {
  const std::int32_t n = generators.count();
  std::vector<VoronoiCell> cells;
  std::vector<std::pair<double, std::int32_t>> others;
  for (std::int32_t i = 0; i < n; ++i) {
    others.clear();
    for (std::int32_t j = 0; j < n; ++j) {
      const double distance = length(generators.points()[static_cast<std::size_t>(j)] - generators.points()[static_cast<std::size_t>(i)]);
      if (j != i && distance == 0) throw DegenerateCut();
      if (j != i) others.emplace_back(distance, j);
    }
    std::sort(others.begin(), others.end());
    VoronoiCell cell = box_cell();
    double reach = 2 * farthest_vertex(generators, i, cell);
    for (const auto& [distance, j] : others) {
      if (distance > kRadiusSlack * reach) break;
      if (cut_cell(generators, i, j, cell)) reach = 2 * farthest_vertex(generators, i, cell);
    }
    cells.push_back(std::move(cell));
  }
  return cells;
}

}  // namespace scree
