#include "tests/benchmarks/distance/regimes.hpp"

#include <algorithm>

#include "core/base/error.hpp"

namespace scree {
namespace {

struct Tri {
  Vec3 p[3];
};
Tri operator+(Tri t, const Vec3& shift) {
  for (Vec3& v : t.p) v += shift;
  return t;
}
Tri rotated(Tri t, const Quat& q) {
  for (Vec3& v : t.p) v = rotate(q, v);
  return t;
}
Pair18 pair_of(const Tri& a, const Tri& b) {
  Pair18 pair;
  for (int k = 0; k < 6; ++k)
    for (int c = 0; c < 3; ++c) pair[static_cast<std::size_t>(3 * k + c)] = (k < 3 ? a.p[k] : b.p[k - 3])[c];
  return pair;
}

/// A triangle of decent shape about the origin, longest edge 1.
Tri decent_triangle(Random& r) {
  for (;;) {
    Tri t;
    for (Vec3& v : t.p) v = {r.uniform(-1, 1), r.uniform(-1, 1), r.uniform(-1, 1)};
    const double longest = std::max({length(t.p[1] - t.p[0]), length(t.p[2] - t.p[1]), length(t.p[0] - t.p[2])});
    if (length(cross(t.p[1] - t.p[0], t.p[2] - t.p[0])) < 0.25 * longest * longest) continue;
    const Vec3 centre = (1.0 / 3) * (t.p[0] + t.p[1] + t.p[2]);
    for (Vec3& v : t.p) v = (1 / longest) * (v - centre);
    return t;
  }
}
Tri flat_triangle(Random& r) {
  for (;;) {
    Tri t = decent_triangle(r);
    for (Vec3& v : t.p) v.z = 0;
    if (std::abs(cross(t.p[1] - t.p[0], t.p[2] - t.p[0]).z) > 0.1) return t;
  }
}

/// Moves b along the closest direction until the pair is `gap` apart; false when it intersects.
bool bring_to(const Tri& a, Tri& b, double gap) {
  for (int pass = 0; pass < 4; ++pass) {
    const TriangleDistance d = triangle_distance(a.p, b.p);
    if (d.intersecting) return pass > 0 && gap == 0;
    b = b + (gap - d.distance) * (-d.normal);
  }
  return true;
}

/// A random member of a family that may have to be drawn again.
bool draw(const std::string& name, Random& r, Pair18& pair) {
  Tri a = decent_triangle(r), b = decent_triangle(r);
  const auto near_at = [&](double gap) {
    b = b + r.uniform(0.8, 2) * r.direction();
    if (!bring_to(a, b, gap)) return false;
    pair = pair_of(a, b);
    return true;
  };
  if (name == "separated") {
    pair = pair_of(a, b + r.uniform(1.2, 3) * r.direction());
    return true;
  }
  if (name == "near-1e-3") return near_at(1e-3 * std::pow(10, r.uniform(-0.5, 0.5)));
  if (name == "near-1e-6") return near_at(1e-6 * std::pow(10, r.uniform(-0.5, 0.5)));
  if (name == "touching") return near_at(0);
  if (name == "intersecting") {
    b = b + r.uniform(0, 0.4) * r.direction();
    pair = pair_of(a, b);
    return triangle_distance(a.p, b.p).intersecting;
  }
  if (name == "parallel" || name == "coplanar") {
    const double height = name == "coplanar" ? 0 : std::pow(10, r.uniform(-6, 0));
    const Quat q = r.rotation();
    const bool turn = r.integer(0, 1) == 1;
    a = flat_triangle(r);
    b = flat_triangle(r) + Vec3{r.uniform(-1.5, 1.5), r.uniform(-1.5, 1.5), height};
    pair = turn ? pair_of(rotated(a, q), rotated(b, q)) : pair_of(a, b);
    return true;
  }
  if (name == "shared-edge") {
    const int shared = r.integer(1, 2);
    for (int k = 0; k < shared; ++k) b.p[(2 * k + 1) % 3] = a.p[k];
    pair = pair_of(a, b);
    return true;
  }
  if (name == "slivers-1e6") {
    const int which = r.integer(1, 3);
    for (int side = 0; side < 2; ++side) {
      if ((which >> side & 1) == 0) continue;
      Tri& t = side == 0 ? a : b;
      const double thin = std::pow(10, r.uniform(-6, -5));
      const Vec3 base = r.integer(0, 1) == 1 ? t.p[1] : t.p[0] + r.uniform(0.2, 0.8) * (t.p[1] - t.p[0]);
      t.p[2] = base + thin * (t.p[2] - base);
    }
    return near_at(std::pow(10, r.uniform(-4, -2)));
  }
  if (name == "size-ratio-1e4") {
    double u = r.uniform(0, 1), v = r.uniform(0, 1);
    if (u + v > 1) u = 1 - u, v = 1 - v;
    for (Vec3& p : b.p) p *= 1e-4;
    b = b + a.p[0] + u * (a.p[1] - a.p[0]) + v * (a.p[2] - a.p[0]) + r.uniform(3e-4, 1e-2) * r.direction();
    if (!bring_to(a, b, 1e-4 * std::pow(10, r.uniform(-3, -1)))) return false;
    pair = pair_of(a, b);
    return true;
  }
  if (name == "far-1e6") {
    if (!near_at(1e-3)) return false;
    const Vec3 offset = 1e6 * r.direction();
    pair = pair_of(a + offset, b + offset);
    return true;
  }
  if (name == "degenerate") {
    const int which = r.integer(1, 3);
    for (int side = 0; side < 2; ++side) {
      if ((which >> side & 1) == 0) continue;
      Tri& t = side == 0 ? a : b;
      switch (r.integer(0, 3)) {
        case 0:
          t.p[2] = t.p[1];
          break;
        case 1:
          t.p[2] = t.p[1] = t.p[0];
          break;
        case 2:
          t.p[2] = 2.0 * t.p[1] - t.p[0];
          break;
        default:
          t.p[2] = 0.5 * (t.p[0] + t.p[1]);
      }
    }
    pair = pair_of(a, b + r.uniform(0.5, 2) * r.direction());
    return true;
  }
  throw UsageError(
      "--regime: '{}' is not known; expected one of separated, near-1e-3, near-1e-6, touching, intersecting, "
      "parallel, coplanar, shared-edge, slivers-1e6, size-ratio-1e4, far-1e6, degenerate",
      name);
}

}  // namespace

const std::vector<std::string>& regime_names() {
  static const std::vector<std::string> names = {"separated", "near-1e-3",   "near-1e-6",   "touching",       "intersecting", "parallel",
                                                 "coplanar",  "shared-edge", "slivers-1e6", "size-ratio-1e4", "far-1e6",      "degenerate"};
  return names;
}

std::vector<Pair18> make_regime(const std::string& name, std::size_t count, std::uint64_t seed) {
  Random random(seed);
  std::vector<Pair18> pairs;
  while (pairs.size() < count) {
    Pair18 pair;
    if (draw(name, random, pair)) pairs.push_back(pair);
  }
  return pairs;
}

}  // namespace scree
