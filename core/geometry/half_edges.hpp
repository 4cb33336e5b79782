// Sorted half edges: the one structure from which topology is read.
#pragma once

#include <algorithm>
#include <cstdint>
#include <numeric>
#include <vector>

#include "core/geometry/triangle_mesh.hpp"

namespace scree {

/// The side of a triangle from its vertex k to k + 1, under its two vertices in ascending order.
struct HalfEdge {
  std::int32_t low, high;
  std::int32_t triangle;
  std::int8_t k;
  bool is_forward;  ///< runs from low to high
  bool operator<(const HalfEdge& o) const {
    if (low != o.low) return low < o.low;
    if (high != o.high) return high < o.high;
    return triangle != o.triangle ? triangle < o.triangle : k < o.k;
  }
};

/// Half edges of all triangles; those of one edge lie side by side.   Cost: O(T log T).
inline std::vector<HalfEdge> sorted_half_edges(const TriangleMesh& mesh) {
  const auto side = [&](std::int32_t t, std::int8_t k) {
    const Triangle& corners = mesh.triangles[static_cast<std::size_t>(t)];
    const std::int32_t a = corners[static_cast<std::size_t>(k)], b = corners[static_cast<std::size_t>((k + 1) % 3)];
    return HalfEdge{std::min(a, b), std::max(a, b), t, k, a < b};
  };
  // counted into one bucket for each lower vertex, then each small bucket sorted: three times as fast as one sort
  std::vector<std::size_t> start(mesh.vertices.size() + 1, 0);
  for (std::int32_t t = 0; t < mesh.triangle_count(); ++t) {
    for (std::int8_t k = 0; k < 3; ++k) ++start[static_cast<std::size_t>(side(t, k).low) + 1];
  }
  std::partial_sum(start.begin(), start.end(), start.begin());
  std::vector<HalfEdge> half(3 * mesh.triangles.size());
  std::vector<std::size_t> next(start.begin(), start.end() - 1);
  for (std::int32_t t = 0; t < mesh.triangle_count(); ++t) {
    for (std::int8_t k = 0; k < 3; ++k) {
      const HalfEdge h = side(t, k);
      half[next[static_cast<std::size_t>(h.low)]++] = h;
    }
  }
  for (std::size_t v = 0; v < mesh.vertices.size(); ++v) {
    std::sort(half.begin() + static_cast<std::ptrdiff_t>(start[v]), half.begin() + static_cast<std::ptrdiff_t>(start[v + 1]));
  }
  return half;
}

/// Calls visit(first, last) with the range of half edges of each edge.
template <class Visit>
void for_each_edge(const std::vector<HalfEdge>& half, const Visit& visit) {
  for (std::size_t i = 0; i < half.size();) {
    std::size_t j = i + 1;
    while (j < half.size() && half[j].low == half[i].low && half[j].high == half[i].high) ++j;
    visit(i, j);
    i = j;
  }
}

/// Triangles of the same three vertices as an earlier one, in either winding; ascending.   Cost: O(T log T).
inline std::vector<std::int32_t> duplicate_triangles(const TriangleMesh& mesh) {
  struct SortedTriangle {
    Triangle sorted;
    std::int32_t triangle;
  };
  std::vector<SortedTriangle> keys;
  keys.reserve(mesh.triangles.size());
  for (std::int32_t t = 0; t < mesh.triangle_count(); ++t) {
    keys.push_back({mesh.triangles[static_cast<std::size_t>(t)], t});
    std::sort(keys.back().sorted.begin(), keys.back().sorted.end());
  }
  std::sort(keys.begin(), keys.end(), [](const SortedTriangle& a, const SortedTriangle& b) {
    return a.sorted != b.sorted ? a.sorted < b.sorted : a.triangle < b.triangle;
  });
  std::vector<std::int32_t> found;
  for (std::size_t i = 1; i < keys.size(); ++i) {
    if (keys[i].sorted == keys[i - 1].sorted) found.push_back(keys[i].triangle);
  }
  std::sort(found.begin(), found.end());
  return found;
}

/// Disjoint sets; the smallest member names a set, so that numbering does not depend on the order of joins.
class DisjointSets {
 public:
  explicit DisjointSets(std::size_t count) : parent_(count) { std::iota(parent_.begin(), parent_.end(), 0); }
  std::int32_t find(std::int32_t i) {
    while (parent_[static_cast<std::size_t>(i)] != i) {
      std::int32_t& up = parent_[static_cast<std::size_t>(i)];
      up = parent_[static_cast<std::size_t>(up)];
      i = up;
    }
    return i;
  }
  void join(std::int32_t a, std::int32_t b) {
    a = find(a), b = find(b);
    if (a != b) parent_[static_cast<std::size_t>(std::max(a, b))] = std::min(a, b);
  }

 private:
  std::vector<std::int32_t> parent_;
};

}  // namespace scree
