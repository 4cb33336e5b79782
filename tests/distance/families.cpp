#include "tests/distance/families.hpp"

#include <fmt/format.h>

#include <cmath>

namespace scree {
namespace {

/// A multiple of 1/8 in low..high.
double eighths(Random& r, int low, int high) { return r.integer(8 * low, 8 * high) / 8.0; }

Pair18 pair_of(const Vec3& a0, const Vec3& a1, const Vec3& a2, const Vec3& b0, const Vec3& b1, const Vec3& b2) {
  return {a0.x, a0.y, a0.z, a1.x, a1.y, a1.z, a2.x, a2.y, a2.z, b0.x, b0.y, b0.z, b1.x, b1.y, b1.z, b2.x, b2.y, b2.z};
}

Vec3 transform(const Vec3& v, int kind) {
  switch (kind) {
    case 0:
      return v;
    case 1:
      return {3 * v.x - 4 * v.y, 4 * v.x + 3 * v.y, 5 * v.z};
    case 2:
      return {5 * v.x, 3 * v.y - 4 * v.z, 4 * v.y + 3 * v.z};
    case 3:
      return {v.x + 2 * v.y + 2 * v.z, 2 * v.x + v.y - 2 * v.z, 2 * v.x - 2 * v.y + v.z};
    default:
      return {v.y, v.z, v.x};
  }
}

Pair18 moved(const Pair18& p, Random& r, double offset) {
  const int kind = r.integer(0, 4), then = r.integer(0, 4);
  const Vec3 shift{offset * r.integer(-4, 4), offset * r.integer(-4, 4), offset * r.integer(-4, 4)};
  Pair18 q;
  for (int k = 0; k < 6; ++k) {
    const Vec3 v = transform(transform(corner(p, k), kind), then) + shift;
    for (int c = 0; c < 3; ++c) q[static_cast<std::size_t>(3 * k + c)] = v[c];
  }
  q = permuted(q, r.integer(0, 35));
  if (r.integer(0, 1) == 1) q = swapped(q);
  return q;
}

Vec3 random_point(Random& r, int low, int high) { return {eighths(r, low, high), eighths(r, low, high), eighths(r, low, high)}; }

/// A triangle in z = 0 that holds the origin well inside.
void face_around_origin(Random& r, Vec3 f[3]) {
  f[0] = {eighths(r, 1, 4), eighths(r, -2, 2), 0};
  f[1] = {-eighths(r, 1, 4), eighths(r, 2, 4), 0};
  f[2] = {-eighths(r, 1, 4), -eighths(r, 2, 4), 0};
}

Pair18 base_member(int family, Random& r) {
  Vec3 f[3];
  face_around_origin(r, f);
  const double h = 0.125 * r.integer(1, 16);
  const auto above = [&](double z) { return Vec3{eighths(r, -3, 3), eighths(r, -3, 3), z + eighths(r, 1, 3)}; };
  switch (family) {
    case 1:  // a vertex over the inside of a face
      return pair_of(f[0], f[1], f[2], {0.125 * r.integer(-1, 1), 0.125 * r.integer(-1, 1), h}, above(h), above(h));
    case 2: {  // the foot exactly on an edge or a vertex of the face
      const Vec3 foot = r.integer(0, 1) == 1 ? f[r.integer(0, 2)] : 0.5 * (f[0] + f[1]);
      return pair_of(f[0], f[1], f[2], {foot.x, foot.y, h}, above(h), above(h));
    }
    case 3: {  // a vertex beyond an edge or a vertex
      const Vec3 out = r.integer(0, 1) == 1 ? 2.0 * f[r.integer(0, 2)] : f[0] + f[1];
      const Vec3 p{out.x, out.y, h * r.integer(0, 1)};
      return pair_of(f[0], f[1], f[2], p, 3.0 * p + random_point(r, 0, 1), 3.0 * p - random_point(r, 0, 1));
    }
    case 4: {  // edge over edge, perpendicular or oblique
      const Vec3 e{eighths(r, -1, 1), 1.0 + eighths(r, 0, 2), 0};
      return pair_of({-2, 0, 0}, {2, 0, 0}, {eighths(r, -1, 1), eighths(r, -3, 3), -eighths(r, 1, 3)}, Vec3{0, 0, h} - e,
                     Vec3{0, 0, h} + 2.0 * e, {eighths(r, -2, 2), eighths(r, -2, 2), h + eighths(r, 1, 3)});
    }
    case 5: {  // parallel faces, overlapping in projection or not
      Vec3 g[3];
      face_around_origin(r, g);
      const Vec3 shift{eighths(r, -5, 5), eighths(r, -5, 5), h};
      return pair_of(f[0], f[1], f[2], g[0] + shift, g[1] + shift, g[2] + shift);
    }
    case 6: {  // in one plane, apart
      const double x = 4 + h;
      return pair_of(f[0], f[1], f[2], {x, eighths(r, -3, 3), 0}, {x + eighths(r, 0, 3), eighths(r, -3, 3), 0},
                     {x + eighths(r, 0, 3), eighths(r, -3, 3), 0});
    }
    case 7: {  // edges on one line, apart or overlapping
      const double start = eighths(r, -2, 4);
      return pair_of({0, 0, 0}, {2, 0, 0}, {eighths(r, 0, 2), -eighths(r, 1, 3), eighths(r, -1, 1)}, {start, 0, 0},
                     {start + eighths(r, 1, 3), 0, 0}, {eighths(r, 0, 2), eighths(r, 1, 3), eighths(r, -1, 1)});
    }
    case 8: {  // intersecting in all ways
      switch (r.integer(0, 5)) {
        case 0:
          return pair_of(f[0], f[1], f[2], {0, 0, h}, {0.125, 0.125, -h}, above(0));
        case 1:
          return pair_of(f[0], f[1], f[2], 0.5 * f[0], 2.0 * f[1], {eighths(r, -2, 2), eighths(r, -2, 2), 0});
        case 2:
          return pair_of(f[0], f[1], f[2], 0.25 * f[0], 0.25 * f[1], 0.25 * f[2]);
        case 3:
          return pair_of(f[0], f[1], f[2], f[0], above(0), above(0));
        case 4:
          return pair_of(f[0], f[1], f[2], f[1], f[0], above(0));
        default:
          return pair_of(f[0], f[1], f[2], f[0], f[1], f[2]);
      }
    }
    case 9: {  // segments, points, two corners the same
      Pair18 p = pair_of(random_point(r, -2, 2), random_point(r, -2, 2), random_point(r, -2, 2), random_point(r, -2, 2),
                         random_point(r, -2, 2), random_point(r, -2, 2));
      const int which = r.integer(1, 3);
      for (std::size_t side = 0; side < 2; ++side) {
        if ((which >> side & 1) == 0) continue;
        double* t = p.data() + 9 * side;
        const int kind = r.integer(0, 3);
        for (int c = 0; c < 3; ++c) {
          if (kind == 0) t[6 + c] = t[3 + c];
          if (kind == 1) t[6 + c] = t[3 + c] = t[c];
          if (kind == 2) t[6 + c] = 2 * t[3 + c] - t[c];
          if (kind == 3) t[6 + c] = 0.5 * (t[3 + c] + t[c]);
        }
      }
      return p;
    }
    case 10: {  // slivers
      const double width = std::ldexp(1.0, -r.integer(30, 40));
      const Vec3 thin = r.integer(0, 1) == 1 ? Vec3{0, width, 0} : Vec3{eighths(r, -2, 2), width, 0};
      return pair_of({-2, 0, 0}, {2, 0, 0}, thin, {eighths(r, -3, 3), eighths(r, -1, 1), h}, above(h), above(h));
    }
    case 11: {  // nearly parallel edges that cross
      const double angle = std::ldexp(1.0, -r.integer(20, 26));
      return pair_of({-2, 0, 0}, {2, 0, 0}, {eighths(r, -1, 1), eighths(r, -1, 1), -eighths(r, 1, 3)}, {-2, -2 * angle, h}, {1, angle, h},
                     {eighths(r, -1, 1), eighths(r, -1, 1), h + eighths(r, 1, 3)});
    }
    case 12: {  // nearly parallel faces
      Vec3 g[3];
      face_around_origin(r, g);
      const double tilt = std::ldexp(1.0, -r.integer(20, 40));
      for (Vec3& v : g) v = v + Vec3{eighths(r, -1, 1), 0, h + tilt * r.integer(-3, 3)};
      return pair_of(f[0], f[1], f[2], g[0], g[1], g[2]);
    }
    case 13: {  // nearly touching: vertex over face, edge over edge
      const double gap = std::ldexp(1.0, r.integer(0, 1) == 1 ? -30 : -40);
      if (r.integer(0, 1) == 1)
        return pair_of(f[0], f[1], f[2], {0.125 * r.integer(-1, 1), 0.125 * r.integer(-1, 1), gap}, above(h), above(h));
      return pair_of({-2, 0, 0}, {2, 0, 0}, {eighths(r, -1, 1), eighths(r, -1, 1), -eighths(r, 1, 3)}, {eighths(r, -1, 1), -1, gap},
                     {eighths(r, -1, 1), 2, gap}, above(h));
    }
    case 14: {  // very different sizes
      const double small = std::ldexp(1.0, -r.integer(20, 40));
      const Vec3 where{0.125 * r.integer(-1, 1), 0.125 * r.integer(-1, 1), r.integer(0, 1) == 1 ? h : small * r.integer(3, 9)};
      return pair_of(f[0], f[1], f[2], where + small * random_point(r, -1, 1), where + small * random_point(r, -1, 1),
                     where + small * random_point(r, -1, 1));
    }
    case 15:
      return base_member(r.integer(1, 8), r);
    case 16: {  // closest to the long edge of an obtuse triangle from beside its blunt corner
      return pair_of({0, 0, 0}, {4, 0, 0}, {-eighths(r, 1, 3), eighths(r, 1, 2), 0}, {-eighths(r, 0, 3), -eighths(r, 0, 2), h},
                     {-4, -3, h + 1}, {-3, -4, h + 2});
    }
    default: {  // ties: mirrored about a plane, several features equally near
      const Vec3 m{1, 1, -1};
      const auto mirrored = [&](const Vec3& v) { return Vec3{m.x * v.x, m.y * v.y, m.z * v.z - h}; };
      const double z = eighths(r, 0, 2);
      const Vec3 a{eighths(r, -2, 2), eighths(r, -2, 2), 0}, b{eighths(r, -2, 2), eighths(r, -2, 2), 0}, c{eighths(r, -2, 2), 1, z};
      return pair_of(a, b, c, mirrored(a), mirrored(b), mirrored(c));
    }
  }
}

}  // namespace

std::string family_name(int family) {
  static const char* const names[kFamilyCount] = {"vertex over face",
                                                  "foot on edge or vertex",
                                                  "vertex-edge, vertex-vertex",
                                                  "edge-edge",
                                                  "parallel faces",
                                                  "coplanar, apart",
                                                  "edges on one line",
                                                  "intersecting",
                                                  "degenerate",
                                                  "slivers",
                                                  "near-parallel edges",
                                                  "near-parallel faces",
                                                  "near touching",
                                                  "size ratio",
                                                  "far from the origin",
                                                  "obtuse corner",
                                                  "ties"};
  return fmt::format("T{} {}", family, names[family - 1]);
}

Pair18 family_member(int family, Random& r) {
  double offset = r.integer(0, 1);
  if (family == 15) offset = std::ldexp(1.0, 10 * r.integer(2, 4));
  const Pair18 p = moved(base_member(family, r), r, offset);
  int exponent = 0;
  if (family == 14) exponent = 60 * r.integer(-1, 1);
  if (family < 10) exponent = r.integer(-3, 3);
  return scaled(p, std::ldexp(1.0, exponent));
}

}  // namespace scree
