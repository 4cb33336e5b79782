#include "core/geometry/plane_faces.hpp"

#include <algorithm>
#include <limits>
#include <map>

#include "core/base/index.hpp"
#include "core/geometry/polygon_moments.hpp"
#include "core/geometry/polygons.hpp"

namespace scree {

namespace {

using Ring = std::vector<std::int32_t>;

struct PlanePoint {
  double x = 0, y = 0;
};

/// Twice the area of the triangle, positive to the left.
double turn_of(const PlanePoint& a, const PlanePoint& b, const PlanePoint& c) {
  return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
}

/// Every vertex of a rim has one edge that comes and one that goes, unless a plane passes through a vertex.
std::optional<std::vector<Ring>> join_loops(const std::vector<std::pair<std::int32_t, std::int32_t>>& edges) {
  std::map<std::int32_t, std::int32_t> next;
  for (const auto& [from, to] : edges) {
    if (!next.emplace(from, to).second) return std::nullopt;
  }
  std::vector<Ring> loops;
  while (!next.empty()) {
    Ring loop;
    std::int32_t v = next.begin()->first;
    do {
      const auto step = next.find(v);
      if (step == next.end()) return std::nullopt;
      loop.push_back(v);
      v = step->second;
      next.erase(step);
    } while (v != loop.front());
    loops.push_back(std::move(loop));
  }
  return loops;
}

/// Loops of one face plane, in its axes.
class PlaneLoops {
 public:
  PlaneLoops(const std::vector<Vec3>& vertices, const Vec3& normal, const Vec3& origin) : vertices_(vertices), axes_(normal, origin) {}

  PlanePoint place(std::int32_t v) const {
    const Vec3 from = vertices_[at(v)] - axes_.origin;
    return {dot(axes_.u, from), dot(axes_.v, from)};
  }

  double area(const Ring& loop) const {
    double twice = 0;
    const PlanePoint o = place(loop[0]);
    for (std::size_t k = 1; k + 1 < loop.size(); ++k) twice += turn_of(o, place(loop[k]), place(loop[k + 1]));
    return 0.5 * twice;
  }

  bool holds(const Ring& loop, std::int32_t v) const {
    const PlanePoint p = place(v);
    bool inside = false;
    for (std::size_t k = 0; k < loop.size(); ++k) {
      const PlanePoint a = place(loop[k]), b = place(loop[(k + 1) % loop.size()]);
      if ((a.y > p.y) == (b.y > p.y)) continue;
      if ((turn_of(a, b, p) > 0) == (b.y > a.y)) inside = !inside;
    }
    return inside;
  }

  /// One ring along the rim and, by a cut to each, around the holes. The shortest cut that crosses nothing is taken first.
  std::optional<Ring> with_holes(Ring ring, std::vector<Ring> holes) const {
    while (!holes.empty()) {
      double shortest = std::numeric_limits<double>::infinity();
      std::size_t from = 0, hole = 0, to = 0;
      for (std::size_t h = 0; h < holes.size(); ++h) {
        for (std::size_t j = 0; j < holes[h].size(); ++j) {
          for (std::size_t i = 0; i < ring.size(); ++i) {
            const PlanePoint a = place(ring[i]), b = place(holes[h][j]);
            const double d2 = (b.x - a.x) * (b.x - a.x) + (b.y - a.y) * (b.y - a.y);
            if (d2 < shortest && opens_to(ring, i, b) && is_free(ring, holes, ring[i], holes[h][j]))
              shortest = d2, from = i, hole = h, to = j;
          }
        }
      }
      if (!(shortest < std::numeric_limits<double>::infinity())) return std::nullopt;
      Ring way{ring[from]};  // from the rim to the hole, around it, and back
      for (std::size_t j = 0; j <= holes[hole].size(); ++j) way.push_back(holes[hole][(to + j) % holes[hole].size()]);
      ring.insert(ring.begin() + static_cast<std::ptrdiff_t>(from), way.begin(), way.end());
      holes.erase(holes.begin() + static_cast<std::ptrdiff_t>(hole));
    }
    return ring;
  }

 private:
  /// Whether the way from vertex i of the ring to the point starts into the polygon.
  bool opens_to(const Ring& ring, std::size_t i, const PlanePoint& to) const {
    const PlanePoint before = place(ring[(i + ring.size() - 1) % ring.size()]), here = place(ring[i]),
                     after = place(ring[(i + 1) % ring.size()]);
    const bool left_of_after = turn_of(here, after, to) > 0, right_of_before = turn_of(before, here, to) > 0;
    return turn_of(before, here, after) > 0 ? left_of_after && right_of_before : left_of_after || right_of_before;
  }

  bool is_free(const Ring& ring, const std::vector<Ring>& holes, std::int32_t from, std::int32_t to) const {
    const PlanePoint a = place(from), b = place(to);
    const auto crosses = [&](const Ring& loop) {
      for (std::size_t k = 0; k < loop.size(); ++k) {
        const std::int32_t first = loop[k], second = loop[(k + 1) % loop.size()];
        if (first == from || second == from || first == to || second == to) continue;
        const PlanePoint c = place(first), d = place(second);
        if (turn_of(a, b, c) * turn_of(a, b, d) <= 0 && turn_of(c, d, a) * turn_of(c, d, b) <= 0) return true;
      }
      return false;
    };
    return !crosses(ring) && std::none_of(holes.begin(), holes.end(), crosses);
  }

  const std::vector<Vec3>& vertices_;
  PlaneAxes axes_;
};

}  // namespace

bool fill_ring(const Ring& ring, const std::vector<Vec3>& vertices, std::vector<Triangle>& triangles) {
  if (ring.size() == 3) {
    triangles.push_back({ring[0], ring[1], ring[2]});
    return true;
  }
  PolygonMesh polygon;
  for (std::size_t k = 0; k < ring.size(); ++k) {
    polygon.vertices.push_back(vertices[at(ring[k])]);
    polygon.corners.push_back(static_cast<std::int32_t>(k));
  }
  polygon.close_facet();
  PolygonCounts counts;
  const TriangleMesh mesh = triangulated(std::move(polygon), counts);
  for (const Triangle& t : mesh.triangles) triangles.push_back({ring[at(t[0])], ring[at(t[1])], ring[at(t[2])]});
  return counts.crossing == 0;
}

std::optional<std::vector<PlaneFace>> plane_faces(const std::vector<std::pair<std::int32_t, std::int32_t>>& edges,
                                                  const std::vector<Vec3>& vertices, const Vec3& normal) {
  std::vector<PlaneFace> faces;
  if (edges.empty()) return faces;
  const PlaneLoops plane(vertices, normal, vertices[at(edges.front().first)]);
  std::optional<std::vector<Ring>> loops = join_loops(edges);
  if (!loops) return std::nullopt;
  std::vector<std::pair<double, Ring>> rings;
  std::vector<Ring> holes;
  for (Ring& loop : *loops) {
    const double area = plane.area(loop);
    if (area > 0) {
      rings.emplace_back(area, std::move(loop));
    } else {
      holes.push_back(std::move(loop));
    }
  }
  std::vector<std::vector<Ring>> within(rings.size());
  for (Ring& hole : holes) {
    std::size_t best = rings.size();
    for (std::size_t r = 0; r < rings.size(); ++r) {
      if (plane.holds(rings[r].second, hole[0]) && (best == rings.size() || rings[r].first < rings[best].first)) best = r;
    }
    if (best == rings.size()) return std::nullopt;
    within[best].push_back(std::move(hole));
  }
  for (std::size_t r = 0; r < rings.size(); ++r) {
    PlaneFace face;
    const std::optional<Ring> ring = plane.with_holes(rings[r].second, within[r]);
    if (!ring || (!fill_ring(*ring, vertices, face.triangles) && !within[r].empty())) return std::nullopt;
    face.loops.push_back(std::move(rings[r].second));
    for (Ring& hole : within[r]) face.loops.push_back(std::move(hole));
    faces.push_back(std::move(face));
  }
  return faces;
}

}  // namespace scree
