#include "mesher/edit/mesh_simplify.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <queue>
#include <vector>

#include "core/base/index.hpp"
#include "core/base/long_work.hpp"
#include "core/geometry/half_edges.hpp"
#include "mesher/repair/mesh_repair.hpp"

namespace scree {

namespace {

/// Weight of the distance from the edge's middle against that from the planes: decides only where planes do not, as
/// within flat regions, and keeps the system solvable there.
constexpr double kMiddleWeight = 1e-9;
/// Weight of an edge's length in what its collapse costs: short edges go first where the planes do not mind.
constexpr double kLengthWeight = 1e-9;
/// Weight of the planes that stand on open edges, in areas of the triangles there: borders hold their shape.
constexpr double kBorderWeight = 10;
/// An end of the edge is moved to keep the volume when its error becomes at most this many times as large. A place whose
/// error is larger than that of the best one by more than this waits until no edge costs less.
constexpr double kVolumePrice = 4;
/// Errors of at most this part of the trace of the quadric (in extents squared) are rounding.
constexpr double kRounding = 1e-14;
/// A triangle may turn by less than acos of this in one collapse, and keeps at least this quality: 1 for equal sides.
constexpr double kMinCosine = 0.1;
constexpr double kMinQuality = 0.02;
/// A handle or a neck is cut when the three edges around it are shorter than this part of those of a triangle of the
/// result: it could not be shown with so few triangles. A piece that falls off is dropped when it has at most so many.
constexpr double kShortLoop = 1.0;
constexpr std::size_t kCrumb = 48;
/// ... and is no larger than this part of such a loop; else it is a limb, and its neck stays.
constexpr double kCrumbSize = 0.25;
/// The volume-keeping vertex may lie this many edge lengths from the middle; further off the planes are nearly parallel.
constexpr double kReach = 2;

/// Sum of area-weighted squared distances from planes: x A x + 2 b x + c.
struct Quadric {
  double xx = 0, xy = 0, xz = 0, yy = 0, yz = 0, zz = 0;
  Vec3 b;
  double c = 0;
  void add_plane(const Vec3& unit, double offset, double weight) {
    xx += weight * unit.x * unit.x, xy += weight * unit.x * unit.y, xz += weight * unit.x * unit.z;
    yy += weight * unit.y * unit.y, yz += weight * unit.y * unit.z, zz += weight * unit.z * unit.z;
    b += weight * offset * unit;
    c += weight * offset * offset;
  }
  void add_point(const Vec3& p, double weight) {
    xx += weight, yy += weight, zz += weight;
    b -= weight * p;
    c += weight * squared_length(p);
  }
  Quadric& operator+=(const Quadric& o) {
    xx += o.xx, xy += o.xy, xz += o.xz, yy += o.yy, yz += o.yz, zz += o.zz;
    b += o.b;
    c += o.c;
    return *this;
  }
  Vec3 times(const Vec3& v) const {
    return {xx * v.x + xy * v.y + xz * v.z, xy * v.x + yy * v.y + yz * v.z, xz * v.x + yz * v.y + zz * v.z};
  }
  double error(const Vec3& x) const { return std::max(dot(x, times(x)) + 2 * dot(b, x) + c, 0.0); }
  double trace() const { return xx + yy + zz; }
  /// A^-1 v by the factors L D L^T, which lose few digits also where A is nearly singular; add_point keeps it definite.
  Vec3 solve(const Vec3& v) const {
    const double l10 = xy / xx, l20 = xz / xx;
    const double d1 = yy - l10 * xy, l21 = (yz - l20 * xy) / d1;
    const double d2 = zz - l20 * xz - l21 * l21 * d1;
    const double y1 = v.y - l10 * v.x, y2 = v.z - l20 * v.x - l21 * y1;
    const double z = y2 / d2, y = y1 / d1 - l21 * z;
    return {v.x / xx - l10 * y - l20 * z, y, z};
  }
};

struct Candidate {
  double cost;
  std::int32_t a, b;
  std::uint32_t stamp_a, stamp_b;
  bool operator<(const Candidate& o) const {  // the cheapest on top; ties by index, so that runs repeat
    if (cost != o.cost) return cost > o.cost;
    return a != o.a ? a > o.a : b > o.b;
  }
};

/// Where the joint vertex of an edge goes.
struct Place {
  Vec3 x;
  double error = 0;           ///< of x
  double cost = 0;            ///< of the collapse to x
  bool is_near_best = false;  ///< the error is about as small as any place's, folded triangles or not
};

/// An edge that could not collapse as things were, at one of its ends.
struct Sleeper {
  std::int32_t partner;
  std::uint32_t stamp, stamp_partner;
  bool operator==(const Sleeper&) const = default;
};

/// Works about the centre of the mesh and in units of its extent, so that no weight depends on scale or place.
class Simplifier {
 public:
  Simplifier(TriangleMesh& mesh, std::int32_t target, bool may_cut)
      : mesh_(mesh), may_cut_(may_cut), faces_(mesh.vertices.size()), quadric_(mesh.vertices.size()) {
    // perimeter of an equilateral triangle of the result
    shortest_loop_ = 3 * std::sqrt(surface_area(mesh) / target / 0.4330127018922193);
    const Box3 box = bounding_box(mesh);
    origin_ = box.centre();
    const Vec3 e = box.extent();
    unit_ = std::max({e.x, e.y, e.z});
    for (Vec3& p : mesh.vertices) p = (1 / unit_) * (p - origin_);
    shortest_loop_ *= kShortLoop / unit_;
    stamp_.assign(mesh.vertices.size(), 0);
    locked_.assign(mesh.vertices.size(), 0);
    border_.assign(mesh.vertices.size(), 0);
    asleep_.resize(mesh.vertices.size());
    live_ = mesh.triangle_count();
    for (std::int32_t t = 0; t < mesh.triangle_count(); ++t) {
      const Vec3 area2 = normal_of(t);
      const double twice = length(area2);
      for (std::int32_t v : mesh.triangles[at(t)]) faces_[at(v)].push_back(t);
      if (!(twice > 0)) continue;
      const Vec3 n = (1 / twice) * area2;
      for (std::int32_t v : mesh.triangles[at(t)]) quadric_[at(v)].add_plane(n, -dot(n, mesh.corner(t, 0)), twice);
    }
    const std::vector<HalfEdge> half = sorted_half_edges(mesh);
    for_each_edge(half, [&](std::size_t i, std::size_t j) {
      const std::int32_t a = half[i].low, b = half[i].high;
      if (j - i > 2) locked_[at(a)] = locked_[at(b)] = 1;
      if (j - i != 1) return;
      border_[at(a)] = border_[at(b)] = 1;
      const Vec3 along = mesh_.vertices[at(b)] - mesh_.vertices[at(a)];
      const Vec3 area2 = normal_of(half[i].triangle), across = cross(along, area2);
      if (!(length(across) > 0)) return;
      const Vec3 n = normalised(across);
      for (std::int32_t v : {a, b}) quadric_[at(v)].add_plane(n, -dot(n, mesh_.vertices[at(a)]), kBorderWeight * length(area2));
    });
    std::vector<Candidate> first;
    for_each_edge(half, [&](std::size_t i, std::size_t) {
      Candidate candidate{};
      if (weigh(half[i].low, half[i].high, candidate)) first.push_back(candidate);
    });
    heap_ = std::priority_queue<Candidate>({}, std::move(first));
  }

  SimplifyCounts run(std::int32_t target) {
    SimplifyCounts counts;
    const std::int32_t from = live_;
    LongWork work("simplify", from - target);
    while (live_ > target && !heap_.empty()) {
      Candidate top = heap_.top();
      heap_.pop();
      if (top.stamp_a != stamp_[at(top.a)] || top.stamp_b != stamp_[at(top.b)]) continue;
      Place place;
      if (!keeps_topology(top.a, top.b) || !find_place(top.a, top.b, place)) {
        if (may_cut_ && cut_handle(top.a, top.b))
          ++counts.handles_cut;
        else
          put_to_sleep(top);
      } else if (!place.is_near_best && place.cost > top.cost) {
        // where it would be cheap it folds a triangle: it takes its turn at what it costs, unless its surroundings change
        put_to_sleep(top);
        top.cost = place.cost;
        heap_.push(top);
      } else {
        collapse(top.a, top.b, place.x);
        ++counts.collapses;
        constexpr std::int32_t kCollapsesPerLook = 64;  // a look at the clock costs as much as a small part of a collapse
        if (counts.collapses % kCollapsesPerLook == 0) work.update(from - live_, fmt::format("{} triangles", live_));
      }
    }
    counts.reached_target = live_ <= target;
    for (Vec3& p : mesh_.vertices) p = unit_ * p + origin_;
    std::erase_if(mesh_.triangles, [](const Triangle& t) { return t[0] < 0; });
    drop_unreferenced(mesh_);
    return counts;
  }

 private:
  Vec3 normal_of(std::int32_t t) const {
    const Vec3& a = mesh_.corner(t, 0);
    return cross(mesh_.corner(t, 1) - a, mesh_.corner(t, 2) - a);
  }

  /// The sum of both quadrics, the same with the pull to the middle, and that middle.
  struct Joint {
    Quadric planes, pulled;
    Vec3 middle;
    double length_cost = 0;
  };
  Joint joint_of(std::int32_t a, std::int32_t b) const {
    Joint j{quadric_[at(a)], {}, 0.5 * (mesh_.vertices[at(a)] + mesh_.vertices[at(b)]), 0};
    j.planes += quadric_[at(b)];
    if (border_[at(a)] != border_[at(b)]) j.middle = mesh_.vertices[at(border_[at(a)] ? a : b)];
    j.pulled = j.planes;
    // the second part keeps the system solvable for triangles too small to weigh anything
    j.pulled.add_point(j.middle, kMiddleWeight * j.planes.trace() + 1e-30);
    j.length_cost = kLengthWeight * j.planes.trace() * squared_length(mesh_.vertices[at(a)] - mesh_.vertices[at(b)]);
    return j;
  }

  bool weigh(std::int32_t a, std::int32_t b, Candidate& candidate) const {
    if (locked_[at(a)] || locked_[at(b)]) return false;
    const Joint j = joint_of(a, b);
    const Vec3 x = j.pulled.solve(-j.pulled.b);
    const double cost = j.planes.error(is_finite(x) ? x : j.middle) + j.length_cost;
    if (!std::isfinite(cost)) return false;
    candidate = {cost, a, b, stamp_[at(a)], stamp_[at(b)]};
    return true;
  }

  /// Where the joint vertex goes: the place of least error among those that keep the volume; where that folds a
  /// triangle, another that keeps the volume, near an end or the middle; at last an end, whatever its error.
  bool find_place(std::int32_t a, std::int32_t b, Place& place) const {
    const Joint joint = joint_of(a, b);
    const Quadric &q = joint.planes, &pulled = joint.pulled;
    const Vec3 middle = joint.middle;
    const Vec3 first = mesh_.vertices[at(a)], second = mesh_.vertices[at(b)];
    const double reach = kReach * length(first - second);
    // sum of n (x - p) over the triangles around the edge is six times the volume gained
    Vec3 gradient{};
    double gained = 0;
    const auto add = [&](std::int32_t t) {
      const Vec3 n = normal_of(t);
      gradient += n;
      gained += dot(n, mesh_.corner(t, 0) - middle);
    };
    for (std::int32_t t : faces_[at(a)]) add(t);
    for (std::int32_t t : faces_[at(b)]) {
      if (!has(t, a)) add(t);
    }
    const double rounding = kRounding * q.trace();
    Vec3 best = pulled.solve(-pulled.b);
    best += pulled.solve(-(q.times(best) + q.b));  // takes back what the pull did where the planes decide
    if (!is_finite(best) || length(best - middle) > reach) best = middle;
    const double limit = kVolumePrice * q.error(best) + rounding;
    const auto try_place = [&](const Vec3& x) {
      if (!is_finite(x) || length(x - middle) > reach || !keeps_triangles(a, b, x) || !keeps_triangles(b, a, x)) return false;
      const double error = q.error(x);
      place = {x, error, error + joint.length_cost, error <= limit};
      return true;
    };
    const auto keeping_volume = [&](const Vec3& start, const Vec3& direction) {
      return start - ((dot(gradient, start - middle) - gained) / dot(gradient, direction)) * direction;
    };
    if (try_place(keeping_volume(best, pulled.solve(gradient)))) return true;
    const bool a_first = q.error(first) <= q.error(second);
    const Vec3 &near = a_first ? first : second, &far = a_first ? second : first;
    const double allowed = kVolumePrice * q.error(near) + rounding;
    for (const Vec3& start : {best, near, middle, far}) {
      const Vec3 x = keeping_volume(start, gradient);
      if (q.error(x) <= allowed && try_place(x)) return true;
    }
    return try_place(best) || try_place(near) || try_place(far);
  }

  bool has(std::int32_t t, std::int32_t v) const {
    const Triangle& c = mesh_.triangles[at(t)];
    return c[0] == v || c[1] == v || c[2] == v;
  }

  void neighbours(std::int32_t v, std::vector<std::int32_t>& found) const {
    found.clear();
    for (std::int32_t t : faces_[at(v)]) {
      for (std::int32_t u : mesh_.triangles[at(t)]) {
        if (u != v) found.push_back(u);
      }
    }
    std::sort(found.begin(), found.end());
    found.erase(std::unique(found.begin(), found.end()), found.end());
  }

  /// The link condition: the two vertices have no common neighbour but those opposite in the triangles they share.
  bool keeps_topology(std::int32_t a, std::int32_t b) {
    std::size_t shared = 0;
    for (std::int32_t t : faces_[at(a)]) {
      if (!has(t, b)) continue;
      ++shared;
      for (std::int32_t v : mesh_.triangles[at(t)]) {
        // the opposite vertex loses one triangle and must keep a fan: three, or one on a border
        if (v != a && v != b && faces_[at(v)].size() <= (border_[at(v)] ? 1U : 3U)) return false;
      }
    }
    if (shared == 0 || shared > 2) return false;
    if (border_[at(a)] && border_[at(b)] && shared == 2) return false;  // would pinch the surface
    neighbours(a, around_a_);
    neighbours(b, around_b_);
    std::size_t common = 0;
    for (auto i = around_a_.begin(), j = around_b_.begin(); i != around_a_.end() && j != around_b_.end();) {
      if (*i == *j)
        ++common, ++i, ++j;
      else if (*i < *j)
        ++i;
      else
        ++j;
    }
    return common == shared;
  }

  /// Whether the triangles of v that do not hold `other` stay upright and well shaped when v moves to x.
  bool keeps_triangles(std::int32_t v, std::int32_t other, const Vec3& x) const {
    for (std::int32_t t : faces_[at(v)]) {
      if (has(t, other)) continue;
      Vec3 p[3];
      for (int k = 0; k < 3; ++k) p[k] = mesh_.triangles[at(t)][at(k)] == v ? x : mesh_.corner(t, k);
      const Vec3 before = normal_of(t), after = cross(p[1] - p[0], p[2] - p[0]);
      const double area2 = length(after);
      if (!(dot(before, after) > kMinCosine * length(before) * area2)) return false;
      const auto quality = [](double twice, const Vec3& a, const Vec3& b, const Vec3& c) {
        return 3.4641016151377544 * twice / (squared_length(b - a) + squared_length(c - b) + squared_length(a - c));
      };
      // a needle may stay a needle, but none is made
      const double q = quality(area2, p[0], p[1], p[2]);
      if (q < kMinQuality && q < quality(length(before), mesh_.corner(t, 0), mesh_.corner(t, 1), mesh_.corner(t, 2))) return false;
    }
    return true;
  }

  /// Joins b with a at x.
  void collapse(std::int32_t a, std::int32_t b, const Vec3& x) {
    mesh_.vertices[at(a)] = x;
    quadric_[at(a)] += quadric_[at(b)];
    border_[at(a)] = border_[at(a)] | border_[at(b)];
    for (std::int32_t t : faces_[at(b)]) {
      Triangle& corners = mesh_.triangles[at(t)];
      if (has(t, a)) {
        for (std::int32_t v : corners) {
          if (v != b) std::erase(faces_[at(v)], t);
        }
        corners = {-1, -1, -1};
        --live_;
      } else {
        std::replace(corners.begin(), corners.end(), b, a);
        faces_[at(a)].push_back(t);
      }
    }
    faces_[at(b)] = {};
    ++stamp_[at(b)];
    renew(a);
  }

  /// The triangle of v that has the directed edge v -> to, or -1.
  std::int32_t face_with(std::int32_t v, std::int32_t to) const {
    for (std::int32_t t : faces_[at(v)]) {
      const Triangle& c = mesh_.triangles[at(t)];
      for (std::size_t k = 0; k < 3; ++k) {
        if (c[k] == v && c[(k + 1) % 3] == to) return t;
      }
    }
    return -1;
  }

  /// Triangles around v on the left of the way from -> v -> to, counter-clockwise from the edge v -> to; empty when the
  /// fan has a gap.
  std::vector<std::int32_t> left_arc(std::int32_t v, std::int32_t to, std::int32_t from) const {
    std::vector<std::int32_t> arc;
    std::int32_t spoke = to;
    while (spoke != from) {
      const std::int32_t t = face_with(v, spoke);
      if (t < 0 || arc.size() > faces_[at(v)].size()) return {};
      arc.push_back(t);
      for (std::int32_t u : mesh_.triangles[at(t)]) {
        if (u != v && u != spoke) {
          spoke = u;
          break;
        }
      }
    }
    return arc;
  }

  /// Cuts the surface along three edges a-b, b-c, c-a that bound no triangle, and caps both sides: a short handle is
  /// opened, a thin neck severed, and the volume does not change.
  bool cut_handle(std::int32_t a, std::int32_t b) {
    if (border_[at(a)] || border_[at(b)]) return false;
    neighbours(a, around_a_);
    neighbours(b, around_b_);
    std::vector<std::int32_t> common;
    std::set_intersection(around_a_.begin(), around_a_.end(), around_b_.begin(), around_b_.end(), std::back_inserter(common));
    const auto bounds_a_triangle = [&](std::int32_t c) {
      return std::any_of(faces_[at(c)].begin(), faces_[at(c)].end(), [&](std::int32_t t) { return has(t, a) && has(t, b); });
    };
    const auto edge = [&](std::int32_t u, std::int32_t v) { return length(mesh_.vertices[at(u)] - mesh_.vertices[at(v)]); };
    std::int32_t c = -1;
    double shortest = shortest_loop_;
    for (std::int32_t v : common) {
      const double loop = edge(a, b) + edge(b, v) + edge(v, a);
      if (loop < shortest && !border_[at(v)] && !locked_[at(v)] && !bounds_a_triangle(v)) shortest = loop, c = v;
    }
    if (c < 0) return false;
    const std::array<std::int32_t, 3> loop{a, b, c};
    std::array<std::vector<std::int32_t>, 3> arcs;
    for (std::size_t k = 0; k < 3; ++k) {
      arcs[k] = left_arc(loop[k], loop[(k + 1) % 3], loop[(k + 2) % 3]);
      if (arcs[k].empty() || arcs[k].size() >= faces_[at(loop[k])].size()) return false;
    }
    if (severs_a_limb(loop)) return false;
    std::array<std::int32_t, 3> copy{};
    for (std::size_t k = 0; k < 3; ++k) {
      copy[k] = mesh_.vertex_count();
      mesh_.vertices.push_back(Vec3(mesh_.vertices[at(loop[k])]));
      faces_.push_back(arcs[k]);
      quadric_.push_back(Quadric(quadric_[at(loop[k])]));
      stamp_.push_back(0);
      locked_.push_back(0);
      border_.push_back(0);
      asleep_.emplace_back();
      for (std::int32_t t : arcs[k]) {
        std::erase(faces_[at(loop[k])], t);
        for (std::int32_t& v : mesh_.triangles[at(t)]) {
          if (v == loop[k]) v = copy[k];
        }
      }
    }
    add_face({copy[0], copy[2], copy[1]});
    add_face({loop[0], loop[1], loop[2]});
    for (const auto& ring : {loop, copy}) {
      if (drop_crumb(ring[0])) continue;
      for (std::int32_t v : ring) renew(v);
    }
    return true;
  }

  /// Whether a piece of few triangles hangs on the loop that is larger than the loop may be: an ear, not a crumb.
  bool severs_a_limb(const std::array<std::int32_t, 3>& loop) {
    std::vector<std::int32_t> starts;
    neighbours(loop[0], starts);
    for (std::int32_t start : starts) {
      if (std::find(loop.begin(), loop.end(), start) != loop.end()) continue;
      std::vector<std::int32_t> seen{start};
      Box3 box;
      for (std::int32_t v : loop) box.add(mesh_.vertices[at(v)]);
      for (std::size_t i = 0; i < seen.size() && seen.size() <= kCrumb / 2; ++i) {
        box.add(mesh_.vertices[at(seen[i])]);
        neighbours(seen[i], around_b_);
        for (std::int32_t u : around_b_) {
          const bool is_known = std::find(seen.begin(), seen.end(), u) != seen.end();
          if (!is_known && std::find(loop.begin(), loop.end(), u) == loop.end()) seen.push_back(u);
        }
      }
      if (seen.size() <= kCrumb / 2 && length(box.extent()) > kCrumbSize * shortest_loop_) return true;
    }
    return false;
  }

  void add_face(const Triangle& t) {
    for (std::int32_t v : t) faces_[at(v)].push_back(mesh_.triangle_count());
    mesh_.triangles.push_back(t);
    ++live_;
  }

  /// Removes the piece around a vertex when it is a small closed one of its own.
  bool drop_crumb(std::int32_t v) {
    std::vector<std::int32_t> piece, queue{v}, seen{v};
    while (!queue.empty()) {
      const std::int32_t u = queue.back();
      queue.pop_back();
      for (std::int32_t t : faces_[at(u)]) {
        if (std::find(piece.begin(), piece.end(), t) != piece.end()) continue;
        piece.push_back(t);
        if (piece.size() > kCrumb || 2 * piece.size() > static_cast<std::size_t>(live_)) return false;
        for (std::int32_t w : mesh_.triangles[at(t)]) {
          if (std::find(seen.begin(), seen.end(), w) != seen.end()) continue;
          seen.push_back(w);
          queue.push_back(w);
        }
      }
    }
    for (std::int32_t t : piece) mesh_.triangles[at(t)] = {-1, -1, -1};
    for (std::int32_t w : seen) faces_[at(w)].clear(), ++stamp_[at(w)];
    live_ -= static_cast<std::int32_t>(piece.size());
    return true;
  }

  /// Puts all edges of a changed vertex on the heap again, and those around it that waited for a change.
  void renew(std::int32_t v) {
    ++stamp_[at(v)];
    asleep_[at(v)].clear();
    neighbours(v, around_a_);
    for (std::int32_t u : around_a_) {
      Candidate candidate{};
      if (weigh(std::min(u, v), std::max(u, v), candidate)) heap_.push(candidate);
      for (const Sleeper& s : asleep_[at(u)]) {
        if (s.stamp != stamp_[at(u)] || s.stamp_partner != stamp_[at(s.partner)]) continue;
        if (weigh(std::min(u, s.partner), std::max(u, s.partner), candidate)) heap_.push(candidate);
      }
      asleep_[at(u)].clear();
    }
  }

  /// Keeps an edge at both of its ends until a vertex next to one of them changes.
  void put_to_sleep(const Candidate& c) {
    const auto add = [&](std::int32_t v, const Sleeper& s) {
      std::vector<Sleeper>& here = asleep_[at(v)];
      if (std::find(here.begin(), here.end(), s) == here.end()) here.push_back(s);
    };
    add(c.a, {c.b, c.stamp_a, c.stamp_b});
    add(c.b, {c.a, c.stamp_b, c.stamp_a});
  }

  TriangleMesh& mesh_;
  bool may_cut_;
  double shortest_loop_ = 0;
  Vec3 origin_;
  double unit_ = 1;
  std::vector<std::vector<std::int32_t>> faces_;  // of each vertex
  std::vector<Quadric> quadric_;
  std::vector<std::uint32_t> stamp_;  // of each vertex, counts its collapses
  std::vector<char> locked_, border_;
  std::priority_queue<Candidate> heap_;
  std::vector<std::vector<Sleeper>> asleep_;  // at each vertex
  std::vector<std::int32_t> around_a_, around_b_;
  std::int32_t live_ = 0;
};

}  // namespace

SimplifyCounts simplify_mesh(TriangleMesh& mesh, std::int32_t triangle_count, bool may_cut_handles) {
  if (mesh.triangle_count() <= triangle_count) return {0, 0, true};
  return Simplifier(mesh, triangle_count, may_cut_handles).run(triangle_count);
}

}  // namespace scree
