#include "solver/features/surface_minima.hpp"

#include <algorithm>
#include <cmath>

namespace scree {

namespace {

/// A foot is no minimum if a triangle that contains it is nearer by this share of the squared distance: rounding of a squared distance is
/// a few 1e-16 of it.
constexpr double kNearer = 1e-14;
/// Feet nearer to each other than this share of their distance from the point are one. It must be well above the root of kNearer: two
/// triangles at an edge give feet that are apart by that root, since the distance is flat about a minimum; 1e-9 gave double minima on
/// convex edges and jumps of the potential.
constexpr double kSameFoot = 1e-6;
/// Of t_it: below, its eighth power is lost beside 1, and quotients of such powers would overflow.
constexpr double kNoScreen = 1e-20;

enum class FootKind { face, edge, vertex };

struct Foot {
  std::size_t near = 0;
  Vec3 q, n;
  double squared = 0, g = 0;
  FootKind kind = FootKind::face;
  Vec3 u;  ///< unit, along the edge
  std::int32_t region = 0;
  std::int64_t place = 0;
};

/// What the foot of a near triangle is to the point.
struct FootRole {
  bool is_minimum = false, is_screen = false;
};

struct MinimaWorkspace {
  std::vector<FootRole> roles;  // of the near triangles
  std::vector<Foot> minima, screens;
  std::vector<double> visible;  // v_i
  std::vector<Vec3> visible_gradient;
};

double smooth_step(double y, double& slope) {
  slope = 0;
  if (y <= 0) return 0;
  if (y >= 1) return 1;
  slope = 6 * y * (1 - y);
  return y * y * (3 - 2 * y);
}

double eighth_root(double x) { return std::sqrt(std::sqrt(std::sqrt(x))); }

/// The vertices of a triangle that its foot lies on: two for an edge, one for a vertex, none inside.
struct HeldVertices {
  std::int32_t vertices[2];
  int count = 0;
  HeldVertices(const Triangle& t, int place) {
    if (place < 0) return;
    const auto k = static_cast<std::size_t>(place);
    if (place < 3) {
      vertices[0] = t[k];
      vertices[1] = t[(k + 1) % 3];
      count = 2;
    } else {
      vertices[0] = t[k - 3];
      count = 1;
    }
  }
  bool are_in(const Triangle& t) const {
    for (int i = 0; i < count; ++i) {
      if (vertices[i] != t[0] && vertices[i] != t[1] && vertices[i] != t[2]) return false;
    }
    return true;
  }
};

/// A vertex that is no corner of the shape lies on a straight sharp edge or inside a flat region. Returns the triangle and edge of one of
/// the near triangles by which the sharp edge is found; -1: none.
struct SharpEdge {
  std::int32_t triangle = -1;
  std::size_t k = 0;
};
SharpEdge sharp_edge_at(const SolverShape& shape, const std::vector<NearTriangle>& near, std::int32_t vertex) {
  for (const NearTriangle& other : near) {
    const Triangle& t = shape.mesh.triangles[static_cast<std::size_t>(other.triangle)];
    for (std::size_t k = 0; k < 3; ++k) {
      if (t[k] != vertex) continue;
      for (const std::size_t edge : {k, (k + 2) % 3}) {
        if (shape.features.edge_kind(static_cast<std::size_t>(other.triangle), edge) != EdgeKind::flat) return {other.triangle, edge};
      }
    }
  }
  return {};
}

void set_edge(const SolverShape& shape, std::int32_t triangle, std::size_t k, Foot& foot) {
  const auto t = static_cast<std::size_t>(triangle);
  foot.kind = FootKind::edge;
  const Vec3 along = shape.mesh.corner(triangle, static_cast<int>((k + 1) % 3)) - shape.mesh.corner(triangle, static_cast<int>(k));
  const double l = length(along);
  foot.u = l > 0 ? (1 / l) * along : Vec3{};
  const std::int32_t edge = shape.features.edge_of[t][k];
  foot.place = edge >= 0 ? make_place(kPlaceOnEdge, edge) : make_place(kPlaceInTriangle, triangle);
}

/// What of the surface holds a foot: how its direction turns, and its name.
void set_kind(const SolverShape& shape, const std::vector<NearTriangle>& near, Foot& foot) {
  const auto& [triangle, place, q, squared] = near[foot.near];
  const auto t = static_cast<std::size_t>(triangle);
  foot.region = shape.features.region[t];
  foot.kind = FootKind::face;
  foot.place = make_place(kPlaceInRegion, foot.region);
  if (place < 0) return;
  if (place < 3) {
    const auto k = static_cast<std::size_t>(place);
    if (shape.features.edge_kind(t, k) != EdgeKind::flat) set_edge(shape, triangle, k, foot);
    return;
  }
  const std::int32_t vertex = shape.mesh.triangles[t][static_cast<std::size_t>(place - 3)];
  const std::int32_t corner = shape.features.corner_of[static_cast<std::size_t>(vertex)];
  if (corner >= 0) {
    foot.kind = FootKind::vertex;
    foot.place = make_place(kPlaceAtVertex, corner);
    return;
  }
  const SharpEdge edge = sharp_edge_at(shape, near, vertex);
  if (edge.triangle >= 0) set_edge(shape, edge.triangle, edge.k, foot);
}

bool same_place(const Foot& a, const Foot& b) { return squared_length(a.q - b.q) < kSameFoot * kSameFoot * b.squared; }

FootRole role_of(const SolverShape& shape, const std::vector<NearTriangle>& near, std::size_t i) {
  const NearTriangle& at = near[i];
  FootRole role{true, true};
  if (at.place < 0) return role;
  const auto triangle = static_cast<std::size_t>(at.triangle);
  const HeldVertices held(shape.mesh.triangles[triangle], at.place);
  const double limit = at.squared * (1 - kNearer);
  for (const NearTriangle& other : near) {
    if (!(other.squared < limit) || !held.are_in(shape.mesh.triangles[static_cast<std::size_t>(other.triangle)])) continue;
    role.is_minimum = false;
    if (shape.features.region[static_cast<std::size_t>(other.triangle)] == shape.features.region[triangle]) role.is_screen = false;
  }
  return role;
}

/// Minima and screens among the feet of the near triangles.   in   work.roles
void find_feet(const SolverShape& shape, const Vec3& p, const std::vector<NearTriangle>& near, MinimaWorkspace& work) {
  work.minima.clear();
  work.screens.clear();
  for (std::size_t i = 0; i < near.size(); ++i) {
    const auto [is_minimum, is_screen] = work.roles[i];
    if (!is_minimum && !is_screen) continue;
    const NearTriangle& at = near[i];
    Foot foot;
    foot.near = i;
    foot.q = at.foot;
    foot.squared = at.squared;
    foot.g = std::sqrt(at.squared);
    foot.n = (1 / foot.g) * (p - at.foot);
    set_kind(shape, near, foot);
    if (is_minimum) {
      const auto known = std::find_if(work.minima.begin(), work.minima.end(), [&](const Foot& m) { return same_place(m, foot); });
      if (known == work.minima.end())
        work.minima.push_back(foot);
      else if (foot.squared < known->squared)
        *known = foot;
    }
    const auto is_known = [&](const Foot& s) { return s.region == foot.region && same_place(s, foot); };
    if (is_screen && std::none_of(work.screens.begin(), work.screens.end(), is_known)) work.screens.push_back(foot);
  }
}

/// g times the change of a foot's direction with a move w of the point.
Vec3 turning(const Foot& f, const Vec3& w) {
  if (f.kind == FootKind::face) return {};
  Vec3 r = w - dot(w, f.n) * f.n;
  if (f.kind == FootKind::edge) r -= dot(r, f.u) * f.u;
  return r;
}

/// Gradient of the cosine between two directions by the point.
Vec3 cosine_gradient(const Foot& a, const Foot& b) { return (1 / a.g) * turning(a, b.n) + (1 / b.g) * turning(b, a.n); }

/// v of a minimum, and its gradient.
double visibility(const Foot& f, const std::vector<Foot>& screens, Vec3& gradient) {
  gradient = {};
  double sum = 0;
  Vec3 sum_gradient;
  for (const Foot& s : screens) {
    const double deeper = f.g - s.g;
    if (!(deeper > kNearer * f.g)) continue;
    const double apart = squared_length(f.n - s.n), together = squared_length(f.n + s.n), gaps = f.g + s.g;
    if (deeper * together >= gaps * apart) return 0;
    const double xi = apart / together, t = deeper / (gaps * xi);
    if (!(t > kNoScreen)) continue;  // directions that are opposite, or gaps that are equal
    const double cosine = dot(f.n, s.n), t2 = t * t, t7 = t2 * t2 * t2 * t;
    sum += t7 * t;
    const Vec3 xi_gradient = (-2 / ((1 + cosine) * (1 + cosine))) * cosine_gradient(f, s);
    sum_gradient += t7 * ((1 / (gaps * gaps * xi)) * (2 * s.g * f.n - 2 * f.g * s.n) - (t / xi) * xi_gradient);
  }
  if (!(sum > 0)) return 1;
  const double norm = eighth_root(sum);
  double slope = 0;
  const double v = smooth_step(1 - norm, slope);
  gradient = (-slope * norm / sum) * sum_gradient;
  return v;
}

/// Weights of the minima. Those that have none are left out.
void weigh_minima(MinimaWorkspace& work, double reach, double sharing, std::vector<SurfaceMinimum>& minima) {
  const std::vector<Foot>& feet = work.minima;
  const std::size_t count = feet.size();
  work.visible.resize(count);
  work.visible_gradient.resize(count);
  for (std::size_t i = 0; i < count; ++i) work.visible[i] = visibility(feet[i], work.screens, work.visible_gradient[i]);
  for (std::size_t i = 0; i < count; ++i) {
    const double v = work.visible[i];
    if (!(v > 0) || !(feet[i].g < reach)) continue;
    double cluster = 0;
    Vec3 cluster_gradient;
    for (std::size_t j = 0; j < count; ++j) {
      if (j == i || !(work.visible[j] > 0)) continue;
      const double apart = squared_length(feet[i].n - feet[j].n), together = squared_length(feet[i].n + feet[j].n);
      const double gaps = feet[i].g + feet[j].g;
      if (!(gaps * apart < sharing * together)) continue;
      const double xi = apart / together, y = gaps * xi / sharing, K = (1 - y * y) * (1 - y * y);
      const double cosine = dot(feet[i].n, feet[j].n);
      const Vec3 xi_gradient = (-2 / ((1 + cosine) * (1 + cosine))) * cosine_gradient(feet[i], feet[j]);
      const Vec3 y_gradient = (1 / sharing) * (xi * (feet[i].n + feet[j].n) + gaps * xi_gradient);
      cluster += K * work.visible[j];
      cluster_gradient += K * work.visible_gradient[j] + (work.visible[j] * (-4 * y * (1 - y * y))) * y_gradient;
    }
    const double kappa = cluster < 1 ? cluster * (2 - cluster) : 1, kappa_slope = cluster < 1 ? 2 - 2 * cluster : 0;
    const double whole = 1 + cluster - (1 - v) * kappa;
    const Vec3 whole_gradient = (1 - (1 - v) * kappa_slope) * cluster_gradient + kappa * work.visible_gradient[i];
    const Vec3 gradient = (1 / whole) * work.visible_gradient[i] - (v / (whole * whole)) * whole_gradient;
    minima.push_back({feet[i].near, feet[i].q, feet[i].squared, feet[i].place, v / whole, gradient, squared_length(gradient) > 0});
  }
}

/// Two minima may lie in one region that is not convex, or on one edge: the later ones are named by their triangles.
void name_apart(const std::vector<NearTriangle>& near, std::vector<SurfaceMinimum>& minima) {
  const auto by_place = [](const SurfaceMinimum& l, const SurfaceMinimum& r) {
    return l.place != r.place ? l.place < r.place : l.near < r.near;
  };
  if (minima.empty()) return;
  std::sort(minima.begin(), minima.end(), by_place);
  bool renamed = false;
  std::int64_t last = minima.front().place;
  for (std::size_t i = 1; i < minima.size(); ++i) {
    const bool again = minima[i].place == last;
    last = minima[i].place;
    if (again) {
      minima[i].place = make_place(kPlaceInTriangle, near[minima[i].near].triangle);
      renamed = true;
    }
  }
  if (renamed) std::sort(minima.begin(), minima.end(), by_place);
}

}  // namespace

void find_minima(const SolverShape& shape, const Vec3& p, const std::vector<NearTriangle>& near, double reach, double sharing,
                 std::vector<SurfaceMinimum>& minima) {
  minima.clear();
  if (near.empty()) return;
  std::size_t nearest = 0;
  for (std::size_t n = 1; n < near.size(); ++n)
    if (near[n].squared < near[nearest].squared) nearest = n;
  const double squared = near[nearest].squared, within = reach + sharing;
  if (!(squared < reach * reach) || !(squared > 0)) return;
  thread_local MinimaWorkspace work;
  const bool one_place =
      shape.is_convex || std::all_of(near.begin(), near.end(), [&](const NearTriangle& other) {
        return !(other.squared < within * within) || squared_length(other.foot - near[nearest].foot) < kSameFoot * kSameFoot * squared;
      });
  const auto add_alone = [&] {
    Foot foot;
    foot.near = nearest;
    set_kind(shape, near, foot);
    minima.push_back({nearest, near[nearest].foot, squared, foot.place, 1, {}, false});
  };
  if (one_place) return add_alone();
  std::size_t count = 0;
  work.roles.assign(near.size(), {});
  for (std::size_t i = 0; i < near.size(); ++i) {
    if (!(near[i].squared < within * within) || !(near[i].squared > 0)) continue;
    work.roles[i] = role_of(shape, near, i);
    if (work.roles[i].is_minimum) ++count;
  }
  if (count == 1) {  // the nearest: no screen is nearer, so that its weight is 1
    if (std::sqrt(squared) < reach) add_alone();
    return;
  }
  find_feet(shape, p, near, work);
  weigh_minima(work, reach, sharing, minima);
  name_apart(near, minima);
}

}  // namespace scree
