#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <set>
#include <vector>

#include "core/base/index.hpp"
#include "core/base/long_work.hpp"
#include "core/geometry/half_edges.hpp"
#include "mesher/repair/heal_mesh.hpp"

namespace scree {

namespace {

using Loop = std::vector<std::int32_t>;
using EdgeSet = std::set<std::pair<std::int32_t, std::int32_t>>;

double area_of(const TriangleMesh& mesh, std::int32_t a, std::int32_t b, std::int32_t c) {
  const Vec3& p = mesh.vertices[at(a)];
  return 0.5 * length(cross(mesh.vertices[at(b)] - p, mesh.vertices[at(c)] - p));
}

/// Loops along open edges, against the direction of their triangles, so that a filling continues the surface. A loop that
/// comes back to one of its vertices is cut off there.
std::vector<Loop> trace_loops(const std::vector<HalfEdge>& half) {
  std::multimap<std::int32_t, std::int32_t> next;
  for_each_edge(half, [&](std::size_t i, std::size_t j) {
    if (j - i != 1) return;
    const std::int32_t from = half[i].is_forward ? half[i].low : half[i].high, to = half[i].is_forward ? half[i].high : half[i].low;
    next.emplace(to, from);
  });
  std::vector<Loop> loops;
  while (!next.empty()) {
    Loop path{next.begin()->first};
    std::map<std::int32_t, std::size_t> place{{path[0], 0}};
    for (;;) {
      const auto step = next.find(path.back());
      if (step == next.end()) break;  // a dead end: edges that disagree about their direction
      const std::int32_t v = step->second;
      next.erase(step);
      const auto seen = place.find(v);
      if (seen == place.end()) {
        place[v] = path.size();
        path.push_back(v);
        continue;
      }
      loops.emplace_back(path.begin() + static_cast<std::ptrdiff_t>(seen->second), path.end());
      for (std::size_t i = seen->second + 1; i < path.size(); ++i) place.erase(path[i]);
      path.resize(seen->second + 1);
      if (path.size() == 1 && next.find(v) == next.end()) break;
    }
  }
  return loops;
}

/// Least-area triangulation of a loop; empty when every one would use an edge that the mesh has already.
std::vector<Triangle> least_area(const TriangleMesh& mesh, const Loop& loop, const EdgeSet& edges) {
  const std::size_t n = loop.size();
  constexpr double kForbidden = std::numeric_limits<double>::infinity();
  std::vector<double> cost(n * n, kForbidden);
  std::vector<std::size_t> apex(n * n, 0);
  const auto is_free = [&](std::size_t i, std::size_t k) {
    if (k == i + 1 || (i == 0 && k == n - 1)) return true;
    return !edges.contains(std::minmax(loop[i], loop[k]));
  };
  for (std::size_t i = 0; i + 1 < n; ++i) cost[i * n + i + 1] = 0;
  for (std::size_t width = 2; width < n; ++width) {
    for (std::size_t i = 0; i + width < n; ++i) {
      const std::size_t k = i + width;
      if (!is_free(i, k)) continue;
      for (std::size_t m = i + 1; m < k; ++m) {
        const double sum = cost[i * n + m] + cost[m * n + k];
        if (!(sum < cost[i * n + k])) continue;
        const double total = sum + area_of(mesh, loop[i], loop[m], loop[k]);
        if (total < cost[i * n + k]) cost[i * n + k] = total, apex[i * n + k] = m;
      }
    }
  }
  std::vector<Triangle> filling;
  if (!std::isfinite(cost[n - 1])) return filling;
  std::vector<std::pair<std::size_t, std::size_t>> stack{{0, n - 1}};
  while (!stack.empty()) {
    const auto [i, k] = stack.back();
    stack.pop_back();
    if (k < i + 2) continue;
    const std::size_t m = apex[i * n + k];
    filling.push_back({loop[i], loop[m], loop[k]});
    stack.push_back({i, m});
    stack.push_back({m, k});
  }
  return filling;
}

/// Cuts the ear with the shortest new edge, again and again.
std::vector<Triangle> ear_by_ear(const TriangleMesh& mesh, Loop loop, const EdgeSet& edges) {
  std::vector<Triangle> filling;
  while (loop.size() > 3) {
    std::size_t best = loop.size();
    double shortest = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < loop.size(); ++i) {
      const std::int32_t a = loop[i], c = loop[(i + 2) % loop.size()];
      const double l2 = squared_length(mesh.vertices[at(c)] - mesh.vertices[at(a)]);
      if (l2 < shortest && !edges.contains(std::minmax(a, c))) shortest = l2, best = i;
    }
    if (best == loop.size()) return {};
    const std::size_t middle = (best + 1) % loop.size();
    filling.push_back({loop[best], loop[middle], loop[(best + 2) % loop.size()]});
    loop.erase(loop.begin() + static_cast<std::ptrdiff_t>(middle));
  }
  filling.push_back({loop[0], loop[1], loop[2]});
  return filling;
}

}  // namespace

std::int32_t fill_holes(TriangleMesh& mesh, double most_area, double& filled, OpenHoles& left) {
  left = {};
  const std::vector<HalfEdge> half = sorted_half_edges(mesh);
  EdgeSet near_border;  // edges at border vertices: those that a filling might double
  std::vector<char> on_border(mesh.vertices.size(), 0);
  for_each_edge(half, [&](std::size_t i, std::size_t j) {
    if (j - i == 1) on_border[at(half[i].low)] = on_border[at(half[i].high)] = 1;
  });
  for (const HalfEdge& h : half) {
    if (on_border[at(h.low)] && on_border[at(h.high)]) near_border.insert({h.low, h.high});
  }
  struct Filling {
    std::vector<Triangle> triangles;
    double area;
  };
  std::vector<Filling> fillings;
  const std::vector<Loop> loops = trace_loops(half);
  LongWork work("filling holes", static_cast<double>(loops.size()));
  for (const Loop& loop : loops) {
    work.advance();
    if (loop.size() < 3) continue;
    Filling f{loop.size() <= kLongHole ? least_area(mesh, loop, near_border) : ear_by_ear(mesh, loop, near_border), 0};
    if (f.triangles.empty()) {
      ++left.impossible;
      continue;
    }
    for (const Triangle& t : f.triangles) {
      f.area += area_of(mesh, t[0], t[1], t[2]);
      for (std::size_t k = 0; k < 3; ++k) near_border.insert(std::minmax(t[k], t[(k + 1) % 3]));
    }
    fillings.push_back(std::move(f));
  }
  // the small ones first, as far as the area reaches
  std::stable_sort(fillings.begin(), fillings.end(), [](const Filling& a, const Filling& b) { return a.area < b.area; });
  std::int32_t closed = 0;
  for (const Filling& f : fillings) {
    if (filled + f.area > most_area || left.too_large > 0) {
      ++left.too_large;
      left.area += f.area;
      continue;
    }
    filled += f.area;
    mesh.triangles.insert(mesh.triangles.end(), f.triangles.begin(), f.triangles.end());
    ++closed;
  }
  return closed;
}

}  // namespace scree
