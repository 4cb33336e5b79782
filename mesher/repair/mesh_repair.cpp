#include "mesher/repair/mesh_repair.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <numeric>
#include <set>

#include "core/base/index.hpp"
#include "core/geometry/half_edges.hpp"
#include "mesher/check/mesh_check.hpp"

namespace scree {

namespace {

bool has_repeated_vertex(const Triangle& t) { return t[0] == t[1] || t[1] == t[2] || t[2] == t[0]; }

/// Flips the longest edge of flat triangles. One pass; returns the number of flips.
std::int32_t flip_slivers(TriangleMesh& mesh) {
  std::vector<std::int32_t> slivers;
  for (std::int32_t t = 0; t < mesh.triangle_count(); ++t) {
    if (is_degenerate(mesh.corner(t, 0), mesh.corner(t, 1), mesh.corner(t, 2))) slivers.push_back(t);
  }
  if (slivers.empty()) return 0;
  const std::vector<HalfEdge> half = sorted_half_edges(mesh);
  const auto faces_of = [&](std::int32_t a, std::int32_t b) {
    const HalfEdge key{std::min(a, b), std::max(a, b), -1, 0, true};
    const auto first = std::lower_bound(half.begin(), half.end(), key);
    auto last = first;
    while (last != half.end() && last->low == key.low && last->high == key.high) ++last;
    return std::pair(first, last);
  };
  std::vector<char> touched(mesh.triangles.size(), 0);
  std::set<std::pair<std::int32_t, std::int32_t>> new_edges;
  std::int32_t flips = 0;
  for (std::int32_t t : slivers) {
    int longest = 0;
    double best = -1;
    for (int k = 0; k < 3; ++k) {
      const double l2 = squared_length(mesh.corner(t, (k + 1) % 3) - mesh.corner(t, k));
      if (l2 > best) best = l2, longest = k;
    }
    Triangle& sliver = mesh.triangles[at(t)];
    const std::int32_t a = sliver[at(longest)], b = sliver[at((longest + 1) % 3)], c = sliver[at((longest + 2) % 3)];
    const auto [first, last] = faces_of(a, b);
    if (last - first != 2 || first->is_forward == (first + 1)->is_forward) continue;
    const std::int32_t n = first->triangle == t ? (first + 1)->triangle : first->triangle;
    if (touched[at(t)] || touched[at(n)]) continue;
    Triangle& neighbour = mesh.triangles[at(n)];
    std::int32_t d = -1;
    for (std::int32_t v : neighbour) {
      if (v != a && v != b) d = v;
    }
    const std::pair diagonal(std::min(c, d), std::max(c, d));
    const auto [other_first, other_last] = faces_of(c, d);
    if (d < 0 || d == c || other_first != other_last || new_edges.contains(diagonal)) continue;
    sliver = {a, d, c};
    neighbour = {d, b, c};
    touched[at(t)] = touched[at(n)] = 1;
    new_edges.insert(diagonal);
    ++flips;
  }
  return flips;
}

}  // namespace

void drop_triangles(TriangleMesh& mesh, const std::vector<std::int32_t>& ascending) {
  if (ascending.empty()) return;
  std::size_t kept = at(ascending.front()), next = 0;
  for (std::size_t t = kept; t < mesh.triangles.size(); ++t) {
    if (next < ascending.size() && at(ascending[next]) == t) {
      ++next;
    } else {
      mesh.triangles[kept++] = mesh.triangles[t];
    }
  }
  mesh.triangles.resize(kept);
}

std::int32_t drop_unreferenced(TriangleMesh& mesh) {
  std::vector<std::int32_t> number(mesh.vertices.size(), -1);
  for (const Triangle& t : mesh.triangles) {
    for (std::int32_t v : t) number[at(v)] = 0;
  }
  std::int32_t kept = 0;
  for (std::size_t v = 0; v < number.size(); ++v) {
    if (number[v] < 0) continue;
    mesh.vertices[at(kept)] = mesh.vertices[v];
    number[v] = kept++;
  }
  const std::int32_t dropped = mesh.vertex_count() - kept;
  mesh.vertices.resize(at(kept));
  for (Triangle& t : mesh.triangles) {
    for (std::int32_t& v : t) v = number[at(v)];
  }
  return dropped;
}

std::vector<std::string> RepairCounts::sentences() const {
  std::vector<std::string> result;
  const auto say = [&](std::int32_t count, const char* one, const char* many) {
    if (count > 0) result.push_back(fmt::format("{} {}", count, count == 1 ? one : many));
  };
  say(slivers_flipped, "zero-area triangle removed by flipping an edge", "zero-area triangles removed by flipping an edge");
  say(degenerate_dropped, "zero-area triangle dropped", "zero-area triangles dropped");
  say(duplicates_dropped, "duplicate triangle dropped", "duplicate triangles dropped");
  say(vertices_unreferenced, "vertex that no triangle uses dropped", "vertices that no triangle uses dropped");
  say(triangles_turned, "triangle turned to face outward", "triangles turned to face outward");
  return result;
}

std::int32_t weld_equal_positions(TriangleMesh& mesh) {
  const auto less = [&](std::int32_t i, std::int32_t j) {
    const Vec3 &p = mesh.vertices[at(i)], &q = mesh.vertices[at(j)];
    if (p.x != q.x) return p.x < q.x;
    if (p.y != q.y) return p.y < q.y;
    if (p.z != q.z) return p.z < q.z;
    return i < j;
  };
  std::vector<std::int32_t> order(mesh.vertices.size()), first(mesh.vertices.size());
  std::iota(order.begin(), order.end(), 0);
  std::iota(first.begin(), first.end(), 0);
  order.erase(std::remove_if(order.begin(), order.end(), [&](std::int32_t v) { return !is_finite(mesh.vertices[at(v)]); }), order.end());
  std::sort(order.begin(), order.end(), less);
  for (std::size_t i = 1; i < order.size(); ++i) {
    if (mesh.vertices[at(order[i])] == mesh.vertices[at(order[i - 1])]) first[at(order[i])] = first[at(order[i - 1])];
  }
  std::vector<std::int32_t> number(mesh.vertices.size());
  std::int32_t kept = 0;
  for (std::int32_t v = 0; v < static_cast<std::int32_t>(number.size()); ++v) {
    if (first[at(v)] != v) {
      number[at(v)] = number[at(first[at(v)])];  // the first of a place has the smaller index: done already
      continue;
    }
    mesh.vertices[at(kept)] = mesh.vertices[at(v)];
    number[at(v)] = kept++;
  }
  const std::int32_t removed = mesh.vertex_count() - kept;
  mesh.vertices.resize(at(kept));
  for (Triangle& t : mesh.triangles) {
    for (std::int32_t& v : t) v = number[at(v)];
  }
  return removed;
}

RepairCounts clean_mesh(TriangleMesh& mesh, bool drop_all) {
  RepairCounts counts;
  if (!std::all_of(mesh.vertices.begin(), mesh.vertices.end(), [](const Vec3& p) { return is_finite(p); })) return counts;
  counts.vertices_welded = weld_equal_positions(mesh);

  counts.degenerate_dropped = static_cast<std::int32_t>(std::erase_if(mesh.triangles, has_repeated_vertex));

  const std::vector<std::int32_t> copies = duplicate_triangles(mesh);
  counts.duplicates_dropped = static_cast<std::int32_t>(copies.size());
  drop_triangles(mesh, copies);

  constexpr int kPasses = 16;  // a chain of slivers needs one pass for each; a cycle of flips would never end
  for (int pass = 0; pass < kPasses; ++pass) {
    const std::int32_t flips = flip_slivers(mesh);
    if (flips == 0) break;
    counts.slivers_flipped += flips;
  }
  if (drop_all) {
    std::vector<Triangle> with_area;
    for (std::int32_t t = 0; t < mesh.triangle_count(); ++t) {
      if (!is_degenerate(mesh.corner(t, 0), mesh.corner(t, 1), mesh.corner(t, 2))) with_area.push_back(mesh.triangles[at(t)]);
    }
    counts.degenerate_dropped += static_cast<std::int32_t>(mesh.triangles.size() - with_area.size());
    mesh.triangles = std::move(with_area);
  }
  // Vertices that only dropped triangles used go unreported: their triangles are reported.
  counts.vertices_unreferenced = drop_unreferenced(mesh);
  return counts;
}

std::int32_t turn_outward(TriangleMesh& mesh) {
  const TriangleMesh before = mesh;
  const std::vector<HalfEdge> half = sorted_half_edges(mesh);
  // neighbours over edges of exactly two triangles, and whether both run the same way along it
  struct Link {
    std::int32_t triangle;
    bool disagrees;
  };
  std::vector<std::vector<Link>> links(mesh.triangles.size());
  for_each_edge(half, [&](std::size_t i, std::size_t j) {
    if (j - i != 2) return;
    const bool disagrees = half[i].is_forward == half[i + 1].is_forward;
    links[at(half[i].triangle)].push_back({half[i + 1].triangle, disagrees});
    links[at(half[i + 1].triangle)].push_back({half[i].triangle, disagrees});
  });
  std::vector<int> turned(mesh.triangles.size(), -1);
  std::vector<std::int32_t> queue;
  for (std::int32_t seed = 0; seed < mesh.triangle_count(); ++seed) {
    if (turned[at(seed)] >= 0) continue;
    turned[at(seed)] = 0;
    queue.assign(1, seed);
    while (!queue.empty()) {
      const std::int32_t t = queue.back();
      queue.pop_back();
      for (const Link& link : links[at(t)]) {
        const int wanted = turned[at(t)] ^ (link.disagrees ? 1 : 0);
        if (turned[at(link.triangle)] < 0) {
          turned[at(link.triangle)] = wanted;
          queue.push_back(link.triangle);
        } else if (turned[at(link.triangle)] != wanted) {
          mesh = before;
          return -1;
        }
      }
    }
  }
  const auto reverse = [&](std::int32_t t) { std::swap(mesh.triangles[at(t)][1], mesh.triangles[at(t)][2]); };
  for (std::int32_t t = 0; t < mesh.triangle_count(); ++t) {
    if (turned[at(t)] == 1) reverse(t);
  }

  // sign of each component
  const MeshCheck check = check_mesh(mesh);
  std::int32_t count = 0;
  const std::vector<std::int32_t> component = find_components(mesh, count);
  for (std::int32_t t = 0; t < mesh.triangle_count(); ++t) {
    const MeshComponent& c = check.components[at(component[at(t)])];
    const bool should_be_inward = c.depth % 2 == 1;
    if ((c.volume < 0) != should_be_inward) reverse(t);
  }
  std::int32_t changed = 0;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) changed += mesh.triangles[t] != before.triangles[t] ? 1 : 0;
  return changed;
}

}  // namespace scree
