#include "mesher/fracture/cut_mesh.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "core/base/error.hpp"
#include "core/base/index.hpp"
#include "core/base/long_work.hpp"
#include "core/geometry/plane_faces.hpp"
#include "mesher/fracture/cut_faces.hpp"

namespace scree {

namespace {

using Line = std::array<std::int32_t, 3>;    ///< three cells that meet along it, ascending
using Corner = std::array<std::int32_t, 4>;  ///< four cells (or sides of the box) that meet in it, ascending

/// In a triangle's polygon, edge k of the triangle (from its vertex k to k + 1) has the label -1 - k, the plane of a neighbour its number.
std::int32_t own_edge(std::int32_t label) { return -1 - label; }

class MeshCutter {
 public:
  MeshCutter(const TriangleMesh& mesh, double size, const Generators& generators)
      : mesh_(mesh), size_(size), generators_(generators), cells_(voronoi_cells(generators)) {
    for (const Vec3& p : mesh.vertices) unit_.push_back((1 / size) * p);
    result_.vertices = mesh.vertices;
    result_.skin.resize(cells_.size());
  }

  CutMesh run() {
    LongWork work("fracture", mesh_.triangle_count());
    for (std::int32_t t = 0; t < mesh_.triangle_count(); ++t) {
      work.advance();
      cut_triangle(t);
    }
    cut_lines();
    make_faces(rims_, generators_, result_);
    return std::move(result_);
  }

 private:
  using Corners = std::array<Vec3, 3>;

  Corners corners_of(std::int32_t t) const {
    const Triangle& v = mesh_.triangles[at(t)];
    return {unit_[at(v[0])], unit_[at(v[1])], unit_[at(v[2])]};
  }

  /// The vertex of this name, made on first use.
  template <class Make>
  std::int32_t vertex(const std::array<std::int32_t, 6>& name, Make&& make) {
    const auto [it, is_new] = named_.try_emplace(name, static_cast<std::int32_t>(result_.vertices.size()));
    if (is_new) result_.vertices.push_back(size_ * make());
    return it->second;
  }

  /// The cell that holds a vertex of the mesh, found by walking from the last one that was asked for.
  std::int32_t cell_of_vertex(std::int32_t v) {
    if (cell_of_.empty()) cell_of_.assign(unit_.size(), -1);
    if (cell_of_[at(v)] >= 0) return cell_of_[at(v)];
    std::int32_t i = last_cell_;
    for (bool moved = true; moved;) {
      moved = false;
      for (const auto& [j, loop] : cells_[at(i)]) {
        if (j < 0 || sign_at(generators_.plane(i, j), unit_[at(v)]) > 0) continue;
        i = j;
        moved = true;
        break;
      }
    }
    return cell_of_[at(v)] = last_cell_ = i;
  }

  /// Sign of the plane between cells i and m at the vertex between edges a and b of a polygon of triangle t.
  bool is_inside(std::int32_t i, std::int32_t m, const Corners& c, std::int32_t a, std::int32_t b) const {
    const CutPlane plane = generators_.plane(i, m);
    if (a < 0 && b < 0) return sign_at(plane, c[at(own_edge(b))]) > 0;
    if (a >= 0 && b >= 0) {
      const auto [low, high] = std::minmax(a, b);
      return sign_at_triangle(plane, c, generators_.plane(i, low), generators_.plane(i, high)) > 0;
    }
    const std::int32_t e = own_edge(std::min(a, b));
    return sign_at_edge(plane, c[at(e)], c[at((e + 1) % 3)], generators_.plane(i, std::max(a, b))) > 0;
  }

  std::int32_t polygon_vertex(std::int32_t i, std::int32_t t, std::int32_t a, std::int32_t b) {
    const Triangle& v = mesh_.triangles[at(t)];
    if (a < 0 && b < 0) return v[at(own_edge(b))];
    if (a >= 0 && b >= 0) {
      Line line{i, a, b};
      std::sort(line.begin(), line.end());
      if (i == line[0]) crossings_[line].push_back(t);
      return vertex({2, t, line[0], line[1], line[2], 0}, [&] {
        return triangle_point(corners_of(t), generators_.plane(line[0], line[1]), generators_.plane(line[0], line[2]));
      });
    }
    const std::size_t e = at(own_edge(std::min(a, b)));
    const auto [low, high] = std::minmax(v[e], v[(e + 1) % 3]);
    const auto [first, second] = std::minmax(i, std::max(a, b));
    return vertex({1, low, high, first, second, 0}, [&, low = low, high = high, first = first, second = second] {
      return edge_point(unit_[at(low)], unit_[at(high)], generators_.plane(first, second));
    });
  }

  void cut_triangle(std::int32_t t) {
    const Corners corners = corners_of(t);
    std::set<std::int32_t> seen{cell_of_vertex(mesh_.triangles[at(t)][0])};
    std::vector<std::int32_t> open(seen.begin(), seen.end());
    while (!open.empty()) {
      const std::int32_t i = open.back();
      open.pop_back();
      std::vector<std::int32_t> edges{-1, -2, -3};
      for (const auto& [j, loop] : cells_[at(i)]) {
        if (j < 0) continue;
        edges = cut_polygon(edges, j, [&, j = j](std::int32_t a, std::int32_t b) { return is_inside(i, j, corners, a, b); });
        if (edges.empty()) break;
      }
      for (std::int32_t j : edges) {
        if (j >= 0 && seen.insert(j).second) open.push_back(j);
      }
      if (!edges.empty()) add_polygon(i, t, edges);
    }
  }

  void add_polygon(std::int32_t i, std::int32_t t, const std::vector<std::int32_t>& edges) {
    const std::size_t n = edges.size();
    std::vector<std::int32_t> ring;
    for (std::size_t k = 0; k < n; ++k) ring.push_back(polygon_vertex(i, t, edges[(k + n - 1) % n], edges[k]));
    for (std::size_t k = 0; k < n; ++k) {
      if (edges[k] > i) rims_[{i, edges[k]}].emplace_back(ring[(k + 1) % n], ring[k]);  // the face runs the other way
    }
    // convex: where rounding makes a sliver cross itself, a fan covers it all the same
    fill_ring(ring, result_.vertices, result_.skin[at(i)]);
  }

  /// What of each Voronoi edge lies in the body, from the outside inwards.
  void cut_lines() {
    std::map<Line, std::array<Corner, 2>> lines;
    std::map<Corner, std::vector<Line>> at_corner;
    for (std::int32_t i = 0; i < generators_.count(); ++i) {
      for (const auto& [j, loop] : cells_[at(i)]) {
        for (std::size_t a = 0; j > i && a < loop.size(); ++a) {
          const std::int32_t k = loop[a];
          if (k < j) continue;
          Corner first{i, j, k, loop[(a + loop.size() - 1) % loop.size()]}, second{i, j, k, loop[(a + 1) % loop.size()]};
          const Line line{i, j, k};
          // along (normal of i,j) x (normal of i,k), the fourth cell of the first corner is left behind
          const CutPlane p = generators_.plane(i, j), q = generators_.plane(i, k);
          if (sign_of_turn(p, q, generators_.plane(i, first[3])) < 0) std::swap(first, second);
          std::sort(first.begin(), first.end());
          std::sort(second.begin(), second.end());
          lines[line] = {first, second};
          at_corner[first].push_back(line);
          at_corner[second].push_back(line);
        }
      }
    }
    std::map<Corner, int> winding;
    std::vector<Corner> open;
    for (const auto& [corner, ends] : at_corner) {
      if (corner[0] < 0) open.push_back(corner), winding[corner] = 0;
    }
    std::set<Line> done;
    while (!open.empty()) {
      const Corner corner = open.back();
      open.pop_back();
      for (const Line& line : at_corner[corner]) {
        if (!done.insert(line).second) continue;
        const std::array<Corner, 2>& ends = lines.at(line);
        const bool from_start = ends[0] == corner;
        const int other = winding[corner] + cut_line(line, ends, winding[corner], from_start);
        const auto [it, is_new] = winding.try_emplace(ends[from_start ? 1 : 0], other);
        if (!is_new && it->second != other) refuse();
        if (is_new) open.push_back(it->first);
      }
    }
  }

  [[noreturn]] void refuse() const {
    throw InputError("the surface passes through itself, or a part of it through another: inside and outside have no meaning there");
  }

  /// Adds the pieces of a line inside the body to the rims; returns by how much the winding number grows to the other end.
  int cut_line(const Line& line, const std::array<Corner, 2>& ends, int winding, bool from_start) {
    const CutPlane p = generators_.plane(line[0], line[1]), q = generators_.plane(line[0], line[2]);
    std::vector<std::int32_t> through;
    if (const auto found = crossings_.find(line); found != crossings_.end()) through = found->second;
    std::sort(through.begin(), through.end(),
              [&](std::int32_t s, std::int32_t t) { return s != t && meets_before(corners_of(s), corners_of(t), p, q); });
    std::vector<int> change;  // 1 where the line enters the body
    int total = 0;
    for (std::int32_t t : through) change.push_back(-sign_of_crossing(corners_of(t), p, q)), total += change.back();
    int now = from_start ? winding : winding - total;
    std::int32_t from = now == 1 ? corner_vertex(ends[0]) : -1;
    for (std::size_t k = 0; k < through.size(); ++k) {
      now += change[k];
      const std::int32_t here = named_.at({2, through[k], line[0], line[1], line[2], 0});
      if (now == 0 && from >= 0) add_rim(line, from, here);
      if (now < 0 || now > 1) refuse();
      from = now == 1 ? here : -1;
    }
    if (now == 1) add_rim(line, from, corner_vertex(ends[1]));
    return from_start ? total : -total;
  }

  std::int32_t corner_vertex(const Corner& c) {
    return vertex({3, c[0], c[1], c[2], c[3], 0}, [&] {
      return planes_point(generators_.plane(c[0], c[1]), generators_.plane(c[0], c[2]), generators_.plane(c[0], c[3]));
    });
  }

  /// Along (normal of i,j) x (normal of i,k) with i < j < k, the faces i-j and j-k, seen from the higher cell, lie to the left and i-k to
  /// the right.
  void add_rim(const Line& line, std::int32_t from, std::int32_t to) {
    rims_[{line[0], line[1]}].emplace_back(from, to);
    rims_[{line[0], line[2]}].emplace_back(to, from);
    rims_[{line[1], line[2]}].emplace_back(from, to);
  }

  const TriangleMesh& mesh_;
  double size_;
  const Generators& generators_;
  std::vector<VoronoiCell> cells_;
  std::vector<Vec3> unit_;  // vertices over size_: exact, since that is a power of two
  std::vector<std::int32_t> cell_of_;
  std::int32_t last_cell_ = 0;
  std::map<std::array<std::int32_t, 6>, std::int32_t> named_;  // kind, then what meets
  std::map<Line, std::vector<std::int32_t>> crossings_;        // triangles that a Voronoi edge passes through
  FaceRims rims_;
  CutMesh result_;
};

}  // namespace

CutMesh cut_mesh(const TriangleMesh& mesh, double size, const Generators& generators) { return MeshCutter(mesh, size, generators).run(); }

}  // namespace scree
