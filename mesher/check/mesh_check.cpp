#include "mesher/check/mesh_check.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>

#include "core/base/counted.hpp"
#include "core/base/index.hpp"
#include "core/base/units.hpp"
#include "core/geometry/half_edges.hpp"
#include "core/surface/self_intersections.hpp"

namespace scree {

namespace {

std::string text_of(const Vec3& p) { return fmt::format("({:.6g}, {:.6g}, {:.6g})", p.x, p.y, p.z); }

void list_place(std::vector<Vec3>& places, const Vec3& place) {
  if (places.size() < kListedPlaces) places.push_back(place);
}

Vec3 middle_of(const TriangleMesh& mesh, std::int32_t t) { return (1.0 / 3) * (mesh.corner(t, 0) + mesh.corner(t, 1) + mesh.corner(t, 2)); }

void count_triangles(const TriangleMesh& mesh, MeshCheck& check) {
  for (std::int32_t t : duplicate_triangles(mesh)) {
    ++check.duplicate_triangles;
    list_place(check.places.duplicate_triangles, middle_of(mesh, t));
  }
  for (std::int32_t t = 0; t < mesh.triangle_count(); ++t) {
    if (!is_degenerate(mesh.corner(t, 0), mesh.corner(t, 1), mesh.corner(t, 2))) continue;
    ++check.degenerate_triangles;
    list_place(check.places.degenerate_triangles, middle_of(mesh, t));
  }
  std::vector<char> used(mesh.vertices.size(), 0);
  for (const Triangle& t : mesh.triangles) {
    for (std::int32_t v : t) used[at(v)] = 1;
  }
  check.unreferenced_vertices = static_cast<std::int32_t>(std::count(used.begin(), used.end(), 0));
}

/// Boundary vertices strictly inside a boundary edge: what is left where a neighbour was split and this side
/// was not.
std::set<std::int32_t> find_t_junctions(const TriangleMesh& mesh, const std::vector<HalfEdge>& boundary) {
  std::vector<std::int32_t> vertices;
  for (const HalfEdge& edge : boundary) {
    vertices.push_back(edge.low);
    vertices.push_back(edge.high);
  }
  std::sort(vertices.begin(), vertices.end());
  vertices.erase(std::unique(vertices.begin(), vertices.end()), vertices.end());
  const auto by_x = [&](std::int32_t a, std::int32_t b) { return mesh.vertices[at(a)].x < mesh.vertices[at(b)].x; };
  std::stable_sort(vertices.begin(), vertices.end(), by_x);
  std::set<std::int32_t> found;
  for (const HalfEdge& edge : boundary) {
    const Vec3 &a = mesh.vertices[at(edge.low)], &b = mesh.vertices[at(edge.high)];
    const Vec3 u = b - a;
    const double l2 = squared_length(u), reach = kTJunctionDistance * std::sqrt(l2);
    const double from = std::min(a.x, b.x) - reach, to = std::max(a.x, b.x) + reach;
    auto it =
        std::lower_bound(vertices.begin(), vertices.end(), from, [&](std::int32_t v, double x) { return mesh.vertices[at(v)].x < x; });
    for (; it != vertices.end() && mesh.vertices[at(*it)].x <= to; ++it) {
      if (*it == edge.low || *it == edge.high) continue;
      const Vec3 d = mesh.vertices[at(*it)] - a;
      const double s = dot(d, u) / l2;
      if (s <= kTJunctionDistance || s >= 1 - kTJunctionDistance) continue;
      if (length(d - s * u) <= reach) found.insert(*it);
    }
  }
  return found;
}

/// Component of each triangle from the sets that share edges, numbered by first triangle.
std::vector<std::int32_t> numbered(DisjointSets& pieces, std::size_t triangle_count, std::int32_t& component_count) {
  std::vector<std::int32_t> component(triangle_count, -1), number(triangle_count, -1);
  component_count = 0;
  for (std::size_t t = 0; t < triangle_count; ++t) {
    const auto root = at(pieces.find(static_cast<std::int32_t>(t)));
    if (number[root] < 0) number[root] = component_count++;
    component[t] = number[root];
  }
  return component;
}

/// Fills everything that follows from which triangles share which edges; returns the component of each triangle.
std::vector<std::int32_t> read_topology(const TriangleMesh& mesh, MeshCheck& check) {
  const std::vector<HalfEdge> half = sorted_half_edges(mesh);
  DisjointSets pieces(mesh.triangles.size()), fans(3 * mesh.triangles.size()), holes(mesh.vertices.size());
  const auto corner_at = [&](const HalfEdge& h, std::int32_t vertex) {
    const Triangle& t = mesh.triangles[at(h.triangle)];
    const std::int32_t k = t[at(h.k)] == vertex ? h.k : (h.k + 1) % 3;
    return 3 * h.triangle + k;
  };
  const auto middle_of_edge = [&](const HalfEdge& h) { return 0.5 * (mesh.vertices[at(h.low)] + mesh.vertices[at(h.high)]); };

  std::vector<HalfEdge> boundary;
  std::vector<std::int32_t> open_triangles, turned_triangles;
  std::int32_t edge_count = 0;
  for_each_edge(half, [&](std::size_t i, std::size_t j) {
    ++edge_count;
    for (std::size_t h = i + 1; h < j; ++h) {
      pieces.join(half[i].triangle, half[h].triangle);
      fans.join(corner_at(half[i], half[i].low), corner_at(half[h], half[i].low));
      fans.join(corner_at(half[i], half[i].high), corner_at(half[h], half[i].high));
    }
    if (j - i == 1) {
      ++check.boundary_edges;
      list_place(check.places.boundary_edges, middle_of_edge(half[i]));
      boundary.push_back(half[i]);
      holes.join(half[i].low, half[i].high);
      open_triangles.push_back(half[i].triangle);
    } else if (j - i > 2) {
      ++check.non_manifold_edges;
      list_place(check.places.non_manifold_edges, middle_of_edge(half[i]));
      open_triangles.push_back(half[i].triangle);
    } else if (half[i].is_forward == half[i + 1].is_forward) {
      ++check.inconsistent_edges;
      list_place(check.places.inconsistent_edges, middle_of_edge(half[i]));
      turned_triangles.push_back(half[i].triangle);
    }
  });

  std::set<std::int32_t> loops;
  for (const HalfEdge& edge : boundary) loops.insert(holes.find(edge.low));
  check.boundary_loops = static_cast<std::int32_t>(loops.size());
  for (std::int32_t v : find_t_junctions(mesh, boundary)) {
    ++check.t_junctions;
    list_place(check.places.t_junctions, mesh.vertices[at(v)]);
  }
  check.euler_characteristic = mesh.vertex_count() - check.unreferenced_vertices - edge_count + mesh.triangle_count();

  // a vertex whose triangles form more than one fan
  std::vector<std::int32_t> fan_of(mesh.vertices.size(), -1);
  std::vector<char> counted_vertex(mesh.vertices.size(), 0);
  for (std::int32_t c = 0; c < 3 * mesh.triangle_count(); ++c) {
    const std::int32_t v = mesh.triangles[at(c / 3)][at(c % 3)], fan = fans.find(c);
    if (fan_of[at(v)] < 0) fan_of[at(v)] = fan;
    if (fan_of[at(v)] != fan && !counted_vertex[at(v)]) {
      counted_vertex[at(v)] = 1;
      ++check.non_manifold_vertices;
      list_place(check.places.non_manifold_vertices, mesh.vertices[at(v)]);
    }
  }

  // components: closedness, orientation, signed volume about the centre of the bounding box
  std::int32_t count = 0;
  std::vector<std::int32_t> component = numbered(pieces, mesh.triangles.size(), count);
  check.components.resize(at(count));
  for (std::int32_t t : open_triangles) check.components[at(component[at(t)])].is_closed = false;
  for (std::int32_t t : turned_triangles) check.components[at(component[at(t)])].is_oriented = false;
  const Vec3 origin = check.bounds.centre();
  for (std::int32_t t = 0; t < mesh.triangle_count(); ++t) {
    MeshComponent& c = check.components[at(component[at(t)])];
    ++c.triangle_count;
    c.volume += dot(mesh.corner(t, 0) - origin, cross(mesh.corner(t, 1) - origin, mesh.corner(t, 2) - origin)) / 6;
  }

  // Nesting: how many other closed components wind around this one. All of it: of two parts that overlap, one vertex may lie within the
  // other. So its box is within that of the other, and vertices all over it are looked at.
  if (static_cast<double>(count) * mesh.triangle_count() > kNestingWork) check.nesting_was_checked = false;
  std::vector<std::vector<std::int32_t>> members(check.components.size());
  for (std::int32_t t = 0; t < mesh.triangle_count(); ++t) members[at(component[at(t)])].push_back(t);
  std::vector<Box3> boxes(members.size());
  for (std::int32_t t = 0; t < mesh.triangle_count(); ++t) {
    for (int k = 0; k < 3; ++k) boxes[at(component[at(t)])].add(mesh.corner(t, k));
  }
  constexpr std::size_t kLooks = 100;
  const auto lies_within = [&](std::size_t c, std::size_t other) {
    for (int k = 0; k < 3; ++k) {
      if (boxes[c].lower[k] < boxes[other].lower[k] || boxes[c].upper[k] > boxes[other].upper[k]) return false;
    }
    const std::size_t corners = 3 * members[c].size(), every = corners / kLooks + 1;
    for (std::size_t i = 0; i < corners; i += every) {
      if (!(std::abs(winding_number(mesh, members[other], mesh.corner(members[c][i / 3], static_cast<int>(i % 3)))) > 0.5)) return false;
    }
    return true;
  };
  for (std::size_t c = 0; c < members.size() && members.size() > 1 && check.nesting_was_checked; ++c) {
    for (std::size_t other = 0; other < members.size(); ++other) {
      if (other != c && check.components[other].is_closed && lies_within(c, other)) ++check.components[c].depth;
    }
  }
  for (const MeshComponent& c : check.components) {
    if (!c.is_closed || !c.is_oriented) continue;
    const bool should_be_inward = c.depth % 2 == 1;
    if (should_be_inward && c.volume > 0) ++check.overlapping_components;
    if (!should_be_inward && c.volume < 0) ++check.inverted_components;
  }
  return component;
}

/// Whether an edge of triangle t clearly passes through the inside of triangle u: beyond rounding on both sides of it.
bool pierces(const TriangleMesh& mesh, std::int32_t t, std::int32_t u) {
  constexpr double kClearly = 1e-9;  // of the volume of a box of the longest edges: far above the rounding of a determinant
  const Vec3 a = mesh.corner(u, 0), b = mesh.corner(u, 1), c = mesh.corner(u, 2);
  const double size = std::max({length(b - a), length(c - b), length(a - c)});
  const auto side = [&](const Vec3& p, const Vec3& q, const Vec3& r, const Vec3& s) {
    const double volume = dot(q - p, cross(r - p, s - p)), reach = std::max(size, length(s - p));
    return std::abs(volume) > kClearly * size * size * reach ? (volume > 0 ? 1 : -1) : 0;
  };
  for (int k = 0; k < 3; ++k) {
    const Vec3 p = mesh.corner(t, k), q = mesh.corner(t, (k + 1) % 3);
    if (side(a, b, c, p) * side(a, b, c, q) >= 0) continue;
    const int ab = side(a, b, p, q), bc = side(b, c, p, q), ca = side(c, a, p, q);
    if (ab != 0 && ab == bc && bc == ca) return true;
  }
  return false;
}

/// Whether the solid just below triangle t lies within the component whose triangles are `other`.
bool is_within(const TriangleMesh& mesh, std::int32_t t, const std::vector<std::int32_t>& other) {
  constexpr double kBelow = 1e-6, kNearCorner = 0.9;  // of the longest edge; weight of a corner
  const Vec3 a = mesh.corner(t, 0), b = mesh.corner(t, 1), c = mesh.corner(t, 2), middle = (1.0 / 3) * (a + b + c);
  const Vec3 below = (-kBelow * std::max({length(b - a), length(c - b), length(a - c)})) * normalised(cross(b - a, c - a));
  const auto holds = [&](const Vec3& p) { return std::abs(winding_number(mesh, other, p + below)) > 0.5; };
  return holds(middle) || holds(kNearCorner * a + (1 - kNearCorner) * middle) || holds(kNearCorner * b + (1 - kNearCorner) * middle) ||
         holds(kNearCorner * c + (1 - kNearCorner) * middle);
}

/// Components that have a common volume: edges of one pass through triangles of the other, or where the surfaces touch the solid of one
/// lies within the other. Those that only touch, along an edge or with a face on a face, have none.
std::set<std::pair<std::int32_t, std::int32_t>> find_common_volumes(const TriangleMesh& mesh, const std::vector<std::int32_t>& component,
                                                                    std::size_t count, const std::vector<CrossingPair>& pairs) {
  std::set<std::pair<std::int32_t, std::int32_t>> common;
  std::vector<CrossingPair> undecided;
  for (const CrossingPair& pair : pairs) {
    const std::int32_t a = component[at(pair.first)], b = component[at(pair.second)];
    if (a == b || common.contains(std::minmax(a, b))) continue;
    if (pierces(mesh, pair.first, pair.second) || pierces(mesh, pair.second, pair.first))
      common.insert(std::minmax(a, b));
    else
      undecided.push_back(pair);
  }
  std::vector<std::vector<std::int32_t>> members(count);
  if (!undecided.empty())
    for (std::int32_t t = 0; t < mesh.triangle_count(); ++t) members[at(component[at(t)])].push_back(t);
  std::set<std::pair<std::int32_t, std::int32_t>> seen;  // triangle, component
  double work = 0;
  for (const CrossingPair& pair : undecided) {
    const std::int32_t a = component[at(pair.first)], b = component[at(pair.second)];
    if (common.contains(std::minmax(a, b))) continue;
    work += static_cast<double>(members[at(a)].size() + members[at(b)].size());
    if (work > kNestingWork)  // too many to tell: they count as before, as passing through each other
      common.insert(std::minmax(a, b));
    else if ((seen.emplace(pair.first, b).second && is_within(mesh, pair.first, members[at(b)])) ||
             (seen.emplace(pair.second, a).second && is_within(mesh, pair.second, members[at(a)])))
      common.insert(std::minmax(a, b));
  }
  return common;
}

void find_self_intersections(const TriangleMesh& mesh, const std::vector<std::int32_t>& component, MeshCheck& check) {
  const std::vector<CrossingPair> pairs = find_crossing_pairs(mesh);
  check.crossing_pairs = static_cast<std::int32_t>(pairs.size());
  if (pairs.empty()) return;
  std::set<std::pair<std::int32_t, std::int32_t>> meeting;
  for (const CrossingPair& pair : pairs) {
    const std::int32_t a = component[at(pair.first)], b = component[at(pair.second)];
    if (a != b) meeting.insert(std::minmax(a, b));
  }
  check.crossing_components = static_cast<std::int32_t>(find_common_volumes(mesh, component, check.components.size(), pairs).size());
  check.touching_components = static_cast<std::int32_t>(meeting.size()) - check.crossing_components;
  for (const CrossingPair& pair : pairs) list_place(check.places.self_intersections, middle_of(mesh, pair.first));
}

void judge(MeshCheck& check) {
  auto& problems = check.problems;
  auto& advice = check.advice;
  if (check.triangle_count == 0) {
    problems.push_back("there are no triangles");
    advice.push_back("export the model again as a triangle mesh");
    return;
  }
  if (check.boundary_edges > 0) {
    problems.push_back(fmt::format(
        "the mesh is open: {} in {}, first near {}{}", counted(check.boundary_edges, "boundary edge", "boundary edges"),
        counted(check.boundary_loops, "loop", "loops"), text_of(check.places.boundary_edges.front()),
        check.t_junctions > 0
            ? fmt::format("; {} (a vertex inside another triangle's edge)", counted(check.t_junctions, "T-junction", "T-junctions"))
            : ""));
    advice.push_back(check.t_junctions > 0 ? "split the edges at the T-junctions with 'scree-mesher repair'"
                                           : "close the holes with 'scree-mesher repair'");
    advice.push_back("or import it as a wall with --surface");
  }
  if (check.non_manifold_edges > 0) {
    problems.push_back(fmt::format("{} with more than two triangles, first near {}",
                                   counted(check.non_manifold_edges, "non-manifold edge", "non-manifold edges"),
                                   text_of(check.places.non_manifold_edges.front())));
    advice.push_back("'scree-mesher repair' drops fins and inner walls and parts bodies that share an edge");
  }
  if (check.inconsistent_edges > 0) {
    problems.push_back(fmt::format("the orientation is not consistent: {} between triangles that face opposite ways, first near {}",
                                   counted(check.inconsistent_edges, "edge", "edges"), text_of(check.places.inconsistent_edges.front())));
    advice.push_back("import with --flip, which turns all triangles outward");
  }
  if (check.degenerate_triangles > 0) {
    problems.push_back(fmt::format("{} of zero area", counted(check.degenerate_triangles, "triangle", "triangles")));
    advice.push_back("remove the slivers in a mesh editor");
  }
  if (check.duplicate_triangles > 0) {
    problems.push_back(counted(check.duplicate_triangles, "duplicate triangle", "duplicate triangles"));
    advice.push_back("remove the duplicates in a mesh editor");
  }
  if (!problems.empty()) return;  // the volume has a meaning only below
  if (check.inverted_components > 0) {
    problems.push_back(fmt::format("the mesh is inverted: {} of {} face inward, signed volume {:.6g} m^3", check.inverted_components,
                                   counted(static_cast<std::int32_t>(check.components.size()), "component", "components"),
                                   check.mass.volume));
    advice.push_back("import with --flip, which turns all triangles outward");
  }
  if (check.overlapping_components > 0) {
    problems.push_back(fmt::format("{} inside another one and face outward: their volume would count twice",
                                   counted(check.overlapping_components, "component lies", "components lie")));
    advice.push_back("unite the parts with 'scree-mesher remesh'; a cavity is turned inward by --flip");
  }
  if (check.crossing_components > 0) {
    problems.push_back(fmt::format("{} through each other, first near {}: their common volume would count twice",
                                   counted(check.crossing_components, "pair of components passes", "pairs of components pass"),
                                   text_of(check.places.self_intersections.front())));
    advice.push_back("unite the parts with 'scree-mesher remesh'");
  }
  const Vec3 extent = check.bounds.extent();
  const double size = std::max({extent.x, extent.y, extent.z});
  // a body's principal moments are above 0, and the largest is at most the sum of the others
  const Vec3& moments = check.mass.principal_moments;
  if (problems.empty() && check.mass.volume > 0 && !(moments.x > 0 && moments.z <= (moments.x + moments.y) * (1 + kMomentRounding))) {
    problems.push_back(
        fmt::format("the surface passes through itself so that no body has its inertia: principal moments {:.3g}, {:.3g}, {:.3g} m^5",
                    moments.x, moments.y, moments.z));
    advice.push_back("repair it with 'scree-mesher repair' or 'scree-mesher remesh'");
  }
  if (problems.empty() && !(check.mass.volume > kFlatVolume * check.area * size)) {
    problems.push_back(fmt::format("the mesh is flat: volume {:.3g} m^3 for an area of {:.3g} m^2", check.mass.volume, check.area));
    advice.push_back("give it a thickness, or import it as a wall with --surface");
  }
}

void remark(MeshCheck& check) {
  if (check.unreferenced_vertices > 0) {
    check.remarks.push_back(fmt::format("{} by no triangle", counted(check.unreferenced_vertices, "vertex is used", "vertices are used")));
  }
  if (check.non_manifold_vertices > 0) {
    check.remarks.push_back(fmt::format("the surface touches itself at {}", counted(check.non_manifold_vertices, "vertex", "vertices")));
  }
  if (check.crossing_pairs > 0) {
    check.remarks.push_back(
        fmt::format("{} through or touch each other, first near {}; where the surface is folded over, volume "
                    "counts twice",
                    counted(check.crossing_pairs, "pair of triangles passes", "pairs of triangles pass"),
                    text_of(check.places.self_intersections.front())));
  }
  if (check.touching_components > 0) {
    check.remarks.push_back(fmt::format("{} without a common volume",
                                        counted(check.touching_components, "pair of components touches", "pairs of components touch")));
  }
  const auto bodies = std::count_if(check.components.begin(), check.components.end(), [](const auto& c) { return c.depth % 2 == 0; });
  if (bodies > 1) check.remarks.push_back(fmt::format("{} separate pieces: they would move as one rigid body", bodies));
  if (!check.nesting_was_checked) {
    check.remarks.push_back(fmt::format("{} components: too many to test which lie inside others", check.components.size()));
  }
}

}  // namespace

double MeshCheck::equivalent_diameter() const { return mass.volume > 0 ? std::cbrt(6 * mass.volume / std::numbers::pi) : 0.0; }

bool is_degenerate(const Vec3& a, const Vec3& b, const Vec3& c) {
  const Vec3 u = b - a, v = c - a;
  const double longest2 = std::max({squared_length(u), squared_length(v), squared_length(c - b)});
  return !(length(cross(u, v)) > kDegenerateHeight * longest2);
}

double winding_number(const TriangleMesh& mesh, const std::vector<std::int32_t>& triangles, const Vec3& point) {
  double angle = 0;
  for (std::int32_t t : triangles) {
    const Vec3 a = mesh.corner(t, 0) - point, b = mesh.corner(t, 1) - point, c = mesh.corner(t, 2) - point;
    const double la = length(a), lb = length(b), lc = length(c);
    angle += 2 * std::atan2(dot(a, cross(b, c)), la * lb * lc + dot(a, b) * lc + dot(b, c) * la + dot(c, a) * lb);
  }
  return angle / (4 * std::numbers::pi);
}

std::vector<std::int32_t> find_components(const TriangleMesh& mesh, std::int32_t& component_count) {
  const std::vector<HalfEdge> half = sorted_half_edges(mesh);
  DisjointSets pieces(mesh.triangles.size());
  for_each_edge(half, [&](std::size_t i, std::size_t j) {
    for (std::size_t h = i + 1; h < j; ++h) pieces.join(half[i].triangle, half[h].triangle);
  });
  return numbered(pieces, mesh.triangles.size(), component_count);
}

MeshCheck check_mesh(const TriangleMesh& mesh) {
  MeshCheck check;
  check.vertex_count = mesh.vertex_count();
  check.triangle_count = mesh.triangle_count();
  for (std::int32_t v = 0; v < mesh.vertex_count(); ++v) {
    if (is_finite(mesh.vertices[at(v)])) continue;
    if (check.nonfinite_vertices++ == 0) check.first_nonfinite_vertex = v;
  }
  if (check.nonfinite_vertices > 0) {
    check.problems.push_back(fmt::format("{} with a coordinate that is not a finite number (NaN or infinite), first vertex {} at {}",
                                         counted(check.nonfinite_vertices, "vertex", "vertices"), check.first_nonfinite_vertex,
                                         text_of(mesh.vertices[at(check.first_nonfinite_vertex)])));
    check.advice.push_back("export the model again, or remove these vertices");
    return check;
  }
  if (mesh.vertex_count() > 0) check.bounds = bounding_box(mesh);
  check.area = surface_area(mesh);
  count_triangles(mesh, check);
  const std::vector<std::int32_t> component = read_topology(mesh, check);
  if (check.degenerate_triangles == 0) find_self_intersections(mesh, component, check);
  check.mass = mass_properties(mesh);
  judge(check);
  remark(check);
  return check;
}

std::string table_of(const MeshCheck& check) {
  std::string text;
  const auto row = [&](const char* title, const std::string& value) { text += fmt::format("  {:<24} {}\n", title, value); };
  row("vertices", fmt::format("{}", check.vertex_count));
  row("triangles", fmt::format("{}", check.triangle_count));
  if (check.nonfinite_vertices > 0) {
    row("NaN vertices", fmt::format("{}", check.nonfinite_vertices));
    return text;
  }
  const auto finding = [&](const char* title, const std::string& count, const std::vector<Vec3>& places) {
    row(title, places.empty() ? count : fmt::format("{}, first near {}", count, text_of(places.front())));
  };
  row("watertight", check.is_watertight() ? "yes" : "no");
  finding("boundary edges", fmt::format("{} in {} loops", check.boundary_edges, check.boundary_loops), check.places.boundary_edges);
  finding("T-junctions", fmt::format("{}", check.t_junctions), check.places.t_junctions);
  finding("non-manifold edges", fmt::format("{}", check.non_manifold_edges), check.places.non_manifold_edges);
  finding("non-manifold vertices", fmt::format("{}", check.non_manifold_vertices), check.places.non_manifold_vertices);
  row("orientation", check.inconsistent_edges > 0 ? fmt::format("inconsistent at {} edges", check.inconsistent_edges)
                     : !check.is_watertight()     ? "consistent"
                     : check.inverted_components > 0 || check.overlapping_components > 0 ? "inward"
                                                                                         : "outward");
  finding("self-intersections", fmt::format("{}", check.crossing_pairs), check.places.self_intersections);
  finding("zero-area triangles", fmt::format("{}", check.degenerate_triangles), check.places.degenerate_triangles);
  finding("duplicate triangles", fmt::format("{}", check.duplicate_triangles), check.places.duplicate_triangles);
  row("unreferenced vertices", fmt::format("{}", check.unreferenced_vertices));
  row("components", fmt::format("{}", check.components.size()));
  constexpr std::size_t kListed = 8;
  for (std::size_t c = 0; c < check.components.size() && check.components.size() > 1 && c < kListed; ++c) {
    const MeshComponent& part = check.components[c];
    row("", fmt::format("{}: {} triangles, {}, signed volume {:.6g} m^3{}", c + 1, part.triangle_count,
                        part.is_closed ? (part.is_oriented ? "closed" : "closed, mixed orientation") : "open", part.volume,
                        part.depth > 0 ? fmt::format(", inside {} other", part.depth) : ""));
  }
  if (check.components.size() > kListed) row("", fmt::format("and {} more", check.components.size() - kListed));
  row("Euler characteristic", fmt::format("{}", check.euler_characteristic));
  if (check.vertex_count > 0) {
    row("bounding box", fmt::format("{} to {} m", text_of(check.bounds.lower), text_of(check.bounds.upper)));
  }
  row("area", fmt::format("{:.9g} m^2", check.area));
  if (!check.is_watertight() || check.inconsistent_edges > 0) {
    row("volume", "not defined");
    return text;
  }
  row("volume", fmt::format("{:.9g} m^3", check.mass.volume));
  row("equivalent diameter", format_quantity(check.equivalent_diameter(), Dimension::length));
  row("centre of mass", text_of(check.mass.centre) + " m");
  for (int i = 0; i < 3; ++i) {
    const Vec3& r = check.mass.inertia[i];
    row(i == 0 ? "inertia at density 1" : "", fmt::format("{:13.6g} {:13.6g} {:13.6g}{}", r.x, r.y, r.z, i == 0 ? " m^5" : ""));
  }
  const Vec3& p = check.mass.principal_moments;
  row("principal moments", fmt::format("{:13.6g} {:13.6g} {:13.6g}", p.x, p.y, p.z));
  return text;
}

nlohmann::json json_of(const MeshCheck& check) {
  const auto array = [](const Vec3& v) { return nlohmann::json::array({v.x, v.y, v.z}); };
  nlohmann::json json = {
      {"vertices", check.vertex_count}, {"triangles", check.triangle_count}, {"nonfinite_vertices", check.nonfinite_vertices},
      {"solid", check.is_solid()},      {"problems", check.problems},        {"advice", check.advice},
      {"remarks", check.remarks}};
  if (check.nonfinite_vertices > 0) return json;
  json["watertight"] = check.is_watertight();
  json["boundary_edges"] = check.boundary_edges;
  json["boundary_loops"] = check.boundary_loops;
  json["t_junctions"] = check.t_junctions;
  json["non_manifold_edges"] = check.non_manifold_edges;
  json["non_manifold_vertices"] = check.non_manifold_vertices;
  json["inconsistent_edges"] = check.inconsistent_edges;
  json["degenerate_triangles"] = check.degenerate_triangles;
  json["duplicate_triangles"] = check.duplicate_triangles;
  json["unreferenced_vertices"] = check.unreferenced_vertices;
  json["self_intersections"] = check.crossing_pairs;
  json["crossing_components"] = check.crossing_components;
  json["touching_components"] = check.touching_components;
  json["inverted_components"] = check.inverted_components;
  json["overlapping_components"] = check.overlapping_components;
  json["euler_characteristic"] = check.euler_characteristic;
  const MeshPlaces& p = check.places;
  for (const auto& [kind, places] :
       {std::pair("boundary_edges", &p.boundary_edges), std::pair("non_manifold_edges", &p.non_manifold_edges),
        std::pair("inconsistent_edges", &p.inconsistent_edges), std::pair("non_manifold_vertices", &p.non_manifold_vertices),
        std::pair("t_junctions", &p.t_junctions), std::pair("degenerate_triangles", &p.degenerate_triangles),
        std::pair("duplicate_triangles", &p.duplicate_triangles), std::pair("self_intersections", &p.self_intersections)}) {
    for (const Vec3& place : *places) json["places"][kind].push_back(array(place));
  }
  json["components"] = nlohmann::json::array();
  for (const MeshComponent& c : check.components) {
    json["components"].push_back(
        {{"triangles", c.triangle_count}, {"closed", c.is_closed}, {"oriented", c.is_oriented}, {"volume", c.volume}, {"depth", c.depth}});
  }
  if (check.vertex_count > 0) json["bounds"] = {array(check.bounds.lower), array(check.bounds.upper)};
  json["area"] = check.area;
  if (check.is_watertight() && check.inconsistent_edges == 0) {
    json["volume"] = check.mass.volume;
    json["equivalent_diameter"] = check.equivalent_diameter();
    json["centre_of_mass"] = array(check.mass.centre);
    json["inertia"] = {array(check.mass.inertia[0]), array(check.mass.inertia[1]), array(check.mass.inertia[2])};
    json["principal_moments"] = array(check.mass.principal_moments);
  }
  return json;
}

}  // namespace scree
