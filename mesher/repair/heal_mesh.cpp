#include "mesher/repair/heal_mesh.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <unordered_map>

#include "core/base/counted.hpp"
#include "core/base/index.hpp"
#include "core/geometry/half_edges.hpp"
#include "core/surface/self_intersections.hpp"
#include "mesher/check/mesh_check.hpp"
#include "mesher/repair/mesh_repair.hpp"

namespace scree {

namespace {

/// Rounds of removing and filling crossing triangles: each takes one ring more.
constexpr int kCrossingRounds = 6;
/// Share of the triangles that resolving self-intersections may remove in a round; more would be a guess of the shape.
constexpr double kMaxRemoved = 0.1;

std::vector<char> border_vertices(const TriangleMesh& mesh) {
  std::vector<char> on_border(mesh.vertices.size(), 0);
  const std::vector<HalfEdge> half = sorted_half_edges(mesh);
  for_each_edge(half, [&](std::size_t i, std::size_t j) {
    if (j - i == 1) on_border[at(half[i].low)] = on_border[at(half[i].high)] = 1;
  });
  return on_border;
}

/// Gives chosen vertices nearer than `reach` one index, each to the nearest earlier one; returns how many were welded.
std::int32_t weld_near(TriangleMesh& mesh, double reach, const std::vector<char>& chosen) {
  struct Hash {
    std::size_t operator()(const std::array<std::int64_t, 3>& c) const {
      return static_cast<std::size_t>(c[0] * 73856093 ^ c[1] * 19349663 ^ c[2] * 83492791);
    }
  };
  std::unordered_map<std::array<std::int64_t, 3>, std::vector<std::int32_t>, Hash> cells;
  const Vec3 origin = bounding_box(mesh).lower;
  std::vector<std::int32_t> same(mesh.vertices.size());
  std::int32_t welded = 0;
  for (std::int32_t v = 0; v < mesh.vertex_count(); ++v) {
    same[at(v)] = v;
    if (!chosen[at(v)]) continue;
    const Vec3 p = (1 / reach) * (mesh.vertices[at(v)] - origin);
    const std::array<std::int64_t, 3> cell{static_cast<std::int64_t>(p.x), static_cast<std::int64_t>(p.y), static_cast<std::int64_t>(p.z)};
    double best = reach * reach;
    for (std::int64_t i = -1; i <= 1; ++i) {
      for (std::int64_t j = -1; j <= 1; ++j) {
        for (std::int64_t k = -1; k <= 1; ++k) {
          const auto found = cells.find({cell[0] + i, cell[1] + j, cell[2] + k});
          if (found == cells.end()) continue;
          for (std::int32_t u : found->second) {
            const double d2 = squared_length(mesh.vertices[at(u)] - mesh.vertices[at(v)]);
            if (d2 <= best) best = d2, same[at(v)] = u;
          }
        }
      }
    }
    if (same[at(v)] == v)
      cells[cell].push_back(v);
    else
      ++welded;
  }
  if (welded == 0) return 0;
  for (Triangle& t : mesh.triangles) {
    for (std::int32_t& v : t) v = same[at(v)];
  }
  return welded;
}

/// Splits open edges at border vertices that lie on them; returns the number of splits.
std::int32_t split_at_t_junctions(TriangleMesh& mesh) {
  std::int32_t splits = 0;
  for (int round = 0; round < 64; ++round) {  // an edge is split once a round
    const std::vector<HalfEdge> half = sorted_half_edges(mesh);
    std::vector<HalfEdge> open;
    for_each_edge(half, [&](std::size_t i, std::size_t j) {
      if (j - i == 1) open.push_back(half[i]);
    });
    std::vector<std::pair<double, std::int32_t>> by_x;
    for (const HalfEdge& h : open) by_x.push_back({mesh.vertices[at(h.low)].x, h.low});
    for (const HalfEdge& h : open) by_x.push_back({mesh.vertices[at(h.high)].x, h.high});
    std::sort(by_x.begin(), by_x.end());
    by_x.erase(std::unique(by_x.begin(), by_x.end()), by_x.end());
    std::vector<char> touched(mesh.triangles.size(), 0);
    std::int32_t now = 0;
    for (const HalfEdge& h : open) {
      if (touched[at(h.triangle)]) continue;
      const Vec3 &a = mesh.vertices[at(h.low)], &b = mesh.vertices[at(h.high)];
      const Vec3 u = b - a;
      const double l2 = squared_length(u), reach = kTJunctionDistance * std::sqrt(l2);
      auto it = std::lower_bound(by_x.begin(), by_x.end(), std::pair(std::min(a.x, b.x) - reach, -1));
      for (; it != by_x.end() && it->first <= std::max(a.x, b.x) + reach; ++it) {
        const std::int32_t v = it->second;
        const Vec3 d = mesh.vertices[at(v)] - a;
        const double s = dot(d, u) / l2;
        if (v == h.low || v == h.high || s <= kTJunctionDistance || s >= 1 - kTJunctionDistance) continue;
        if (length(d - s * u) > reach) continue;
        const Triangle t = mesh.triangles[at(h.triangle)];
        const std::int32_t p = t[at(h.k)], q = t[at((h.k + 1) % 3)], r = t[at((h.k + 2) % 3)];
        if (v == r) continue;
        mesh.triangles[at(h.triangle)] = {p, v, r};
        mesh.triangles.push_back({v, q, r});
        touched[at(h.triangle)] = 1;
        ++now;
        break;
      }
    }
    if (now == 0) break;
    splits += now;
  }
  return splits;
}

/// Pieces of surface bounded by edges of one or of more than two triangles.
struct Patches {
  std::vector<std::int32_t> of;           ///< patch of each triangle
  std::vector<char> is_open, is_crossed;  ///< has edges of one triangle; of more than two
  std::vector<double> area;
};

Patches find_patches(const TriangleMesh& mesh, const std::vector<HalfEdge>& half) {
  DisjointSets sets(mesh.triangles.size());
  for_each_edge(half, [&](std::size_t i, std::size_t j) {
    if (j - i == 2) sets.join(half[i].triangle, half[i + 1].triangle);
  });
  Patches patches;
  patches.of.resize(mesh.triangles.size());
  std::map<std::int32_t, std::int32_t> number;
  for (std::int32_t t = 0; t < mesh.triangle_count(); ++t) {
    const auto [it, is_new] = number.emplace(sets.find(t), static_cast<std::int32_t>(number.size()));
    patches.of[at(t)] = it->second;
    if (is_new) patches.area.push_back(0);
    patches.area[at(it->second)] += 0.5 * length(cross(mesh.corner(t, 1) - mesh.corner(t, 0), mesh.corner(t, 2) - mesh.corner(t, 0)));
  }
  patches.is_open.assign(number.size(), 0);
  patches.is_crossed.assign(number.size(), 0);
  for_each_edge(half, [&](std::size_t i, std::size_t j) {
    for (std::size_t h = i; h < j; ++h) {
      if (j - i == 1) patches.is_open[at(patches.of[at(half[h].triangle)])] = 1;
      if (j - i > 2) patches.is_crossed[at(patches.of[at(half[h].triangle)])] = 1;
    }
  });
  return patches;
}

std::int32_t drop_patches(TriangleMesh& mesh, const Patches& patches, const std::vector<char>& drop) {
  std::vector<std::int32_t> dropped;
  for (std::int32_t t = 0; t < mesh.triangle_count(); ++t) {
    if (drop[at(patches.of[at(t)])]) dropped.push_back(t);
  }
  drop_triangles(mesh, dropped);
  return static_cast<std::int32_t>(dropped.size());
}

/// Drops open patches that hang on edges of more than two triangles, as long as there are any.
std::int32_t drop_fins(TriangleMesh& mesh) {
  std::int32_t dropped = 0;
  for (;;) {
    const std::vector<HalfEdge> half = sorted_half_edges(mesh);
    const Patches patches = find_patches(mesh, half);
    double whole = 0;
    for (double a : patches.area) whole += a;
    std::vector<char> drop(patches.is_open.size(), 0);
    for (std::size_t p = 0; p < drop.size(); ++p) {
      // what is most of the surface is no fin, but a surface with a hole
      drop[p] = patches.is_open[p] && patches.is_crossed[p] && patches.area[p] < 0.25 * whole;
    }
    const std::int32_t now = drop_patches(mesh, patches, drop);
    if (now == 0) return dropped;
    dropped += now;
  }
}

/// Drops patches whose middle lies inside what the others enclose: partitions and buried walls.
std::int32_t drop_inner_walls(TriangleMesh& mesh) {
  std::int32_t dropped = 0;
  for (int round = 0; round < 64; ++round) {
    const std::vector<HalfEdge> half = sorted_half_edges(mesh);
    const Patches patches = find_patches(mesh, half);
    std::size_t odd = 0;
    for_each_edge(half, [&](std::size_t i, std::size_t j) { odd += (j - i) > 2 && (j - i) % 2 == 1; });
    if (odd == 0 || patches.area.size() > 64) return dropped;
    std::int32_t now = 0;
    for (std::size_t p = 0; p < patches.area.size() && now == 0; ++p) {
      if (!patches.is_crossed[p]) continue;
      TriangleMesh rest{mesh.vertices, {}};
      std::int32_t sample = -1;
      double largest = -1;
      for (std::int32_t t = 0; t < mesh.triangle_count(); ++t) {
        if (patches.of[at(t)] != static_cast<std::int32_t>(p)) {
          rest.triangles.push_back(mesh.triangles[at(t)]);
          continue;
        }
        const double a = length(cross(mesh.corner(t, 1) - mesh.corner(t, 0), mesh.corner(t, 2) - mesh.corner(t, 0)));
        if (a > largest) largest = a, sample = t;
      }
      const std::vector<HalfEdge> rest_half = sorted_half_edges(rest);
      bool is_closed = !rest.triangles.empty();
      for_each_edge(rest_half, [&](std::size_t i, std::size_t j) { is_closed = is_closed && j - i == 2; });
      if (!is_closed || turn_outward(rest) < 0) continue;
      std::vector<std::int32_t> all(rest.triangles.size());
      for (std::size_t t = 0; t < all.size(); ++t) all[t] = static_cast<std::int32_t>(t);
      const Vec3 middle = (1.0 / 3) * (mesh.corner(sample, 0) + mesh.corner(sample, 1) + mesh.corner(sample, 2));
      if (winding_number(rest, all, middle) < 0.5) continue;
      now = mesh.triangle_count() - rest.triangle_count();
      mesh = std::move(rest);
    }
    if (now == 0) return dropped;
    dropped += now;
  }
  return dropped;
}

/// Parts the surface at edges of an even number of triangles: neighbours around a wedge of the solid stay together.
/// Triangles must be oriented outward as far as their patches go. Returns the number of edges parted.
std::int32_t part_edges(TriangleMesh& mesh) {
  const std::vector<HalfEdge> half = sorted_half_edges(mesh);
  DisjointSets corners(3 * mesh.triangles.size());
  const auto corner_at = [&](const HalfEdge& h, std::int32_t vertex) {
    const Triangle& t = mesh.triangles[at(h.triangle)];
    for (std::int32_t k = 0; k < 3; ++k) {
      if (t[at(k)] == vertex) return 3 * h.triangle + k;
    }
    return 3 * h.triangle;
  };
  const auto join = [&](const HalfEdge& g, const HalfEdge& h) {
    corners.join(corner_at(g, g.low), corner_at(h, g.low));
    corners.join(corner_at(g, g.high), corner_at(h, g.high));
  };
  std::int32_t parted = 0;
  for_each_edge(half, [&](std::size_t i, std::size_t j) {
    if (j - i == 2) join(half[i], half[i + 1]);
    if (j - i <= 2) return;
    // around the edge by angle, looking from low to high
    const Vec3 &a = mesh.vertices[at(half[i].low)], &b = mesh.vertices[at(half[i].high)];
    const Vec3 axis = normalised(b - a);
    const auto opposite = [&](const HalfEdge& h) { return mesh.vertices[at(mesh.triangles[at(h.triangle)][at((h.k + 2) % 3)])] - a; };
    const Vec3 first = opposite(half[i]);
    const Vec3 x = normalised(first - dot(first, axis) * axis), y = cross(axis, x);
    std::vector<std::pair<double, std::size_t>> around;
    for (std::size_t h = i; h < j; ++h) {
      const Vec3 d = opposite(half[h]);
      around.push_back({h == i ? 0.0 : std::atan2(dot(d, y), dot(d, x)), h});
      if (around.back().first < 0) around.back().first += 2 * std::numbers::pi;
    }
    std::sort(around.begin(), around.end());
    const std::size_t n = around.size();
    bool alternates = n % 2 == 0;
    for (std::size_t k = 0; k < n; ++k) {
      alternates = alternates && half[around[k].second].is_forward != half[around[(k + 1) % n].second].is_forward;
    }
    if (!alternates) return;  // left as it is; check_mesh will tell
    // a triangle that runs from high to low has the solid at growing angles: pair it with the next one
    for (std::size_t k = 0; k < n; ++k) {
      if (!half[around[k].second].is_forward) join(half[around[k].second], half[around[(k + 1) % n].second]);
    }
    ++parted;
  });
  if (parted == 0) return 0;
  std::vector<std::int32_t> owner(mesh.vertices.size(), -1);
  std::map<std::pair<std::int32_t, std::int32_t>, std::int32_t> copies;
  for (std::int32_t c = 0; c < 3 * mesh.triangle_count(); ++c) {
    std::int32_t& v = mesh.triangles[at(c / 3)][at(c % 3)];
    const std::int32_t fan = corners.find(c);
    if (owner[at(v)] < 0) owner[at(v)] = fan;
    if (owner[at(v)] == fan) continue;
    const auto [it, is_new] = copies.emplace(std::pair(v, fan), mesh.vertex_count());
    if (is_new) mesh.vertices.push_back(Vec3(mesh.vertices[at(v)]));
    v = it->second;
  }
  return parted;
}

std::int32_t count_edges_above_two(const TriangleMesh& mesh) {
  std::int32_t count = 0;
  const std::vector<HalfEdge> half = sorted_half_edges(mesh);
  for_each_edge(half, [&](std::size_t i, std::size_t j) { count += j - i > 2 ? 1 : 0; });
  return count;
}

/// Where edges of one or of more than two triangles are left, removes the triangles at their vertices and fills the holes;
/// keeps the result only when it is closed. Returns the number of triangles removed.
std::int32_t recut(TriangleMesh& mesh, double most_area, double filled) {
  TriangleMesh trial = mesh;
  std::int32_t removed = 0;
  for (int round = 0; round < kCrossingRounds; ++round) {
    std::vector<char> bad(trial.vertices.size(), 0);
    bool any = false;
    const std::vector<HalfEdge> half = sorted_half_edges(trial);
    for_each_edge(half, [&](std::size_t i, std::size_t j) {
      if (j - i != 2) bad[at(half[i].low)] = bad[at(half[i].high)] = 1, any = true;
    });
    if (!any) {
      if (removed > 0) mesh = std::move(trial);
      return removed;
    }
    std::vector<std::int32_t> dropped;
    for (std::int32_t t = 0; t < trial.triangle_count(); ++t) {
      const Triangle& c = trial.triangles[at(t)];
      if (bad[at(c[0])] || bad[at(c[1])] || bad[at(c[2])]) dropped.push_back(t);
    }
    removed += static_cast<std::int32_t>(dropped.size());
    if (static_cast<double>(removed) > kMaxRemoved * static_cast<double>(mesh.triangles.size())) return 0;
    drop_triangles(trial, dropped);
    OpenHoles ignored;  // the trial counts only when it is closed
    fill_holes(trial, most_area, filled, ignored);
    drop_unreferenced(trial);
  }
  return 0;
}

/// Removes crossing triangles of one component with their neighbours and fills the holes; returns pairs left.
std::size_t resolve_crossings(TriangleMesh& mesh, double most_area, std::int32_t& removed) {
  std::size_t left = find_crossing_pairs(mesh).size();
  for (int round = 0; round < kCrossingRounds && left > 0; ++round) {
    TriangleMesh trial = mesh;
    std::vector<char> drop(trial.triangles.size(), 0);
    for (const CrossingPair& pair : find_crossing_pairs(trial)) drop[at(pair.first)] = drop[at(pair.second)] = 1;
    for (int ring = 0; ring <= round; ++ring) {  // all triangles at the vertices of those
      std::vector<char> at_vertex(trial.vertices.size(), 0);
      for (std::size_t t = 0; t < drop.size(); ++t) {
        for (std::int32_t v : trial.triangles[t]) at_vertex[at(v)] = static_cast<char>(at_vertex[at(v)] | drop[t]);
      }
      for (std::size_t t = 0; t < drop.size(); ++t) {
        for (std::int32_t v : trial.triangles[t]) drop[t] = static_cast<char>(drop[t] | at_vertex[at(v)]);
      }
    }
    std::vector<std::int32_t> dropped;
    for (std::size_t t = 0; t < drop.size(); ++t) {
      if (drop[t]) dropped.push_back(static_cast<std::int32_t>(t));
    }
    if (static_cast<double>(dropped.size()) > kMaxRemoved * static_cast<double>(trial.triangles.size()) + 64) break;
    drop_triangles(trial, dropped);
    double filled = 0;
    OpenHoles ignored;  // the trial counts only when it is closed
    fill_holes(trial, most_area, filled, ignored);
    drop_unreferenced(trial);
    const MeshCheck check = check_mesh(trial);
    if (!check.is_watertight() || check.degenerate_triangles > 0) continue;
    const auto now = static_cast<std::size_t>(check.crossing_pairs);
    if (now >= left) continue;
    removed += static_cast<std::int32_t>(dropped.size());
    mesh = std::move(trial);
    left = now;
  }
  return left;
}

}  // namespace

std::vector<TriangleMesh> components_of(const TriangleMesh& mesh) {
  std::int32_t count = 0;
  const std::vector<std::int32_t> component = find_components(mesh, count);
  std::vector<TriangleMesh> parts(at(count), TriangleMesh{mesh.vertices, {}});
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    parts[at(component[t])].triangles.push_back(mesh.triangles[t]);
  }
  for (TriangleMesh& part : parts) drop_unreferenced(part);
  return parts;
}

double heal_mesh(TriangleMesh& mesh, const HealOptions& options, std::vector<std::string>& steps) {
  const double extent = longest_extent(mesh);
  const auto clean_after = [&] {
    for (const std::string& sentence : clean_mesh(mesh, false).sentences()) steps.push_back(sentence);
  };

  // weld
  if (options.weld > 0) {
    const std::int32_t welded = weld_near(mesh, options.weld * extent, std::vector<char>(mesh.vertices.size(), 1));
    if (welded > 0) steps.push_back(counted(welded, "vertex welded to one near it", "vertices welded to ones near them"));
  }
  const std::int32_t welded = weld_near(mesh, kBorderWeld * extent, border_vertices(mesh));
  if (welded > 0) {
    steps.push_back(
        counted(welded, "vertex of an open edge welded to one within rounding", "vertices of open edges welded to others within rounding"));
  }
  clean_after();

  // T-junctions, fins, inner walls, shared edges
  if (const std::int32_t splits = split_at_t_junctions(mesh); splits > 0) {
    steps.push_back(counted(splits, "open edge split at a vertex that lies on it (T-junction)",
                            "open edges split at vertices that lie on them (T-junctions)"));
    clean_after();
  }
  if (count_edges_above_two(mesh) > 0) {
    if (const std::int32_t fins = drop_fins(mesh); fins > 0)
      steps.push_back(counted(fins, "triangle of fins dropped", "triangles of fins dropped"));
    if (const std::int32_t walls = drop_inner_walls(mesh); walls > 0)
      steps.push_back(counted(walls, "triangle of walls inside the solid dropped", "triangles of walls inside the solid dropped"));
    turn_outward(mesh);
    if (const std::int32_t parted = part_edges(mesh); parted > 0) {
      steps.push_back(counted(parted, "edge of more than two triangles separated", "edges of more than two triangles separated"));
    }
    drop_unreferenced(mesh);
  }

  // holes: neighbours must agree on the direction before loops can be followed
  std::int32_t turned = std::max(0, turn_outward(mesh));
  const double area = surface_area(mesh), most = options.largest_fill * area;
  double filled = 0;
  OpenHoles left;
  const std::int32_t holes = area > 0 ? fill_holes(mesh, most, filled, left) : 0;
  const double needed = left.too_large > 0 ? (filled + left.area) / area : 0;
  if (holes > 0) {
    steps.push_back(fmt::format("{} closed, {:.3g} % of the area", counted(holes, "hole", "holes"), 100 * filled / area));
    turned += std::max(0, turn_outward(mesh));
    clean_after();
  }
  if (left.too_large > 0) {
    steps.push_back(fmt::format("{} left open: all fillings together would make up {:.3g} % of the area, above the limit of {:.3g} %",
                                counted(left.too_large, "hole", "holes"), 100 * needed, 100 * options.largest_fill));
  }
  if (left.impossible > 0) {
    steps.push_back(fmt::format("{} left open: every filling would use an edge that the surface has already",
                                counted(left.impossible, "hole", "holes")));
  }
  if (const std::int32_t removed = recut(mesh, most, filled); removed > 0) {
    steps.push_back(fmt::format("{} at edges that could neither be separated nor closed removed, and the holes filled",
                                counted(removed, "triangle", "triangles")));
    turned += std::max(0, turn_outward(mesh));
  }
  if (turned > 0) steps.push_back(counted(turned, "triangle turned outward", "triangles turned outward"));

  // self-intersections
  const MeshCheck check = check_mesh(mesh);
  if (check.crossing_pairs > 0 && check.is_watertight() && check.crossing_components == 0 && check.touching_components == 0) {
    std::int32_t removed = 0;
    const std::size_t pairs_left = resolve_crossings(mesh, most, removed);
    if (removed > 0) {
      steps.push_back(fmt::format("{} crossing pairs of triangles became {} by removing {} triangles and filling again",
                                  check.crossing_pairs, pairs_left, removed));
    }
  }
  return needed;
}

}  // namespace scree
