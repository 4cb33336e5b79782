// Squared distance of two triangles in exact integer arithmetic: every feature pair, one by one.
//
// Nothing is shared with the kernels under test: the distances of vertices, edges and faces are rational numbers,
// kept as fractions of integers; an intersection is decided by the signs of determinants. Integer is Int128
// for coordinates below about 100, mpz_class for anything (doubles are integers after scaling by a power of two).
#pragma once

#include <gmpxx.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

namespace scree::oracle {

__extension__ typedef __int128 Int128;

template <class Integer>
using Point = std::array<Integer, 3>;

template <class Integer>
struct Fraction {
  Integer numerator, denominator;  ///< denominator > 0
};

template <class Integer>
Point<Integer> operator-(const Point<Integer>& a, const Point<Integer>& b) {
  return {Integer(a[0] - b[0]), Integer(a[1] - b[1]), Integer(a[2] - b[2])};
}
template <class Integer>
Integer dot(const Point<Integer>& a, const Point<Integer>& b) {
  return Integer(a[0] * b[0] + a[1] * b[1] + a[2] * b[2]);
}
template <class Integer>
Point<Integer> cross(const Point<Integer>& a, const Point<Integer>& b) {
  return {Integer(a[1] * b[2] - a[2] * b[1]), Integer(a[2] * b[0] - a[0] * b[2]), Integer(a[0] * b[1] - a[1] * b[0])};
}

template <class Integer>
class SquaredDistance {
 public:
  static Fraction<Integer> of(const Point<Integer> a[3], const Point<Integer> b[3]) {
    SquaredDistance d;
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) {
        d.vertices(a[i], b[j]);
        d.vertex_edge(a[i], b[j], b[(j + 1) % 3]);
        d.vertex_edge(b[j], a[i], a[(i + 1) % 3]);
        d.edges(a[i], a[(i + 1) % 3], b[j], b[(j + 1) % 3]);
      }
    d.vertices_and_edges_against_face(a, b);
    d.vertices_and_edges_against_face(b, a);
    return d.best_;
  }

 private:
  using P = Point<Integer>;
  void offer(const Integer& numerator, const Integer& denominator) {
    if (!found_ || Integer(numerator * best_.denominator) < Integer(best_.numerator * denominator)) best_ = {numerator, denominator};
    found_ = true;
  }
  void vertices(const P& p, const P& q) {
    const P r = p - q;
    offer(dot(r, r), 1);
  }
  void vertex_edge(const P& p, const P& q0, const P& q1) {
    const P e = q1 - q0, r = p - q0;
    const Integer ee = dot(e, e), re = dot(r, e);
    if (ee == 0 || re < 0 || re > ee) return;
    offer(Integer(dot(r, r) * ee - re * re), ee);
  }
  void edges(const P& p0, const P& p1, const P& q0, const P& q1) {
    const P a = p1 - p0, b = q1 - q0, r = p0 - q0, n = cross(a, b);
    const Integer nn = dot(n, n);
    if (nn == 0) return;  // parallel: some vertex-edge distance is as small
    const Integer s = dot(cross(b, r), n), t = dot(cross(a, r), n);
    if (s < 0 || s > nn || t < 0 || t > nn) return;
    const Integer h = dot(n, r);
    offer(Integer(h * h), nn);
  }
  void vertices_and_edges_against_face(const P p[3], const P f[3]) {
    const P e1 = f[1] - f[0], e2 = f[2] - f[0], n = cross(e1, e2);
    const Integer nn = dot(n, n);
    if (nn == 0) return;
    std::array<Integer, 3> u, v, h;
    for (std::size_t i = 0; i < 3; ++i) {
      const P r = p[i] - f[0];
      u[i] = dot(cross(r, e2), n);
      v[i] = dot(cross(e1, r), n);
      h[i] = dot(n, r);
      if (u[i] >= 0 && v[i] >= 0 && Integer(u[i] + v[i]) <= nn) offer(Integer(h[i] * h[i]), nn);
    }
    for (std::size_t i = 0; i < 3; ++i) {
      const std::size_t k = (i + 1) % 3;
      Integer rise = Integer(h[i] - h[k]);
      if (rise == 0 || (h[i] > 0 && h[k] > 0) || (h[i] < 0 && h[k] < 0)) continue;
      // crossing coordinates times rise times nn
      Integer uu = Integer(u[k] * h[i] - u[i] * h[k]), vv = Integer(v[k] * h[i] - v[i] * h[k]);
      if (rise < 0) {
        rise = Integer(-rise);
        uu = Integer(-uu);
        vv = Integer(-vv);
      }
      if (uu >= 0 && vv >= 0 && Integer(uu + vv) <= Integer(nn * rise)) offer(0, 1);
    }
  }

  Fraction<Integer> best_;
  bool found_ = false;
};

inline long double root(const Fraction<Int128>& f) {
  return std::sqrt(static_cast<long double>(f.numerator) / static_cast<long double>(f.denominator));
}
inline long double root(const Fraction<mpz_class>& f) {
  const mpf_class value = sqrt(mpf_class(f.numerator, 512) / mpf_class(f.denominator, 512));
  const double high = value.get_d();
  const mpf_class low = value - mpf_class(high, 512);
  return static_cast<long double>(high) + static_cast<long double>(low.get_d());
}

/// Squared distance of triangles with any finite double coordinates (18: A then B), in units of 2^(2 unit).
inline Fraction<mpz_class> squared_distance(const double c[18], int& unit) {
  int lowest = 4000;
  for (int i = 0; i < 18; ++i) {
    if (c[i] == 0) continue;
    int e = 0;
    std::frexp(c[i], &e);
    lowest = std::min(lowest, e - 53);
  }
  unit = lowest;
  if (lowest == 4000) return {0, 1};
  Point<mpz_class> a[3], b[3];
  for (int i = 0; i < 18; ++i) {
    int e = 0;
    const double m = std::frexp(c[i], &e);
    mpz_class z(std::ldexp(m, 53));
    if (c[i] != 0) z <<= static_cast<unsigned long>(e - 53 - lowest);
    // a pointer, not the arrays themselves: GCC 12 with -fsanitize=undefined writes into a copy of (i < 9 ? a : b)
    Point<mpz_class>* side = i < 9 ? a : b;
    side[(i % 9) / 3][static_cast<std::size_t>(i % 3)] = z;
  }
  return SquaredDistance<mpz_class>::of(a, b);
}

/// Exact distance, to long double. The coordinates within some 2^900 of each other.
inline long double distance(const double c[18]) {
  int unit = 0;
  const Fraction<mpz_class> squared = squared_distance(c, unit);
  return squared.numerator == 0 ? 0 : std::ldexp(root(squared), unit);
}

/// Whether the triangles have a common point.
inline bool intersect(const double c[18]) {
  int unit = 0;
  return squared_distance(c, unit).numerator == 0;
}

}  // namespace scree::oracle
