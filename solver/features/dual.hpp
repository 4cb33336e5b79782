// Numbers that carry their six derivatives by a virtual motion of body A: translation, then rotation about its centre.
#pragma once

#include <array>
#include <cmath>

#include "core/geometry/vec3.hpp"

namespace scree {

struct Dual {
  double v = 0;
  std::array<double, 6> d{};
  Dual() = default;
  Dual(double value) : v(value) {}
};

/// a(x) and b(x) combined with the slopes of the result in both.
inline Dual chain(double value, double slope_a, const Dual& a, double slope_b, const Dual& b) {
  Dual r(value);
  for (std::size_t i = 0; i < 6; ++i) r.d[i] = slope_a * a.d[i] + slope_b * b.d[i];
  return r;
}
inline Dual chain(double value, double slope, const Dual& a) {
  Dual r(value);
  for (std::size_t i = 0; i < 6; ++i) r.d[i] = slope * a.d[i];
  return r;
}
inline Dual operator+(const Dual& a, const Dual& b) { return chain(a.v + b.v, 1, a, 1, b); }
inline Dual operator-(const Dual& a, const Dual& b) { return chain(a.v - b.v, 1, a, -1, b); }
inline Dual operator*(const Dual& a, const Dual& b) { return chain(a.v * b.v, b.v, a, a.v, b); }
inline Dual operator/(const Dual& a, const Dual& b) { return chain(a.v / b.v, 1 / b.v, a, -a.v / (b.v * b.v), b); }
inline Dual sqrt(const Dual& a) { return chain(std::sqrt(a.v), 0.5 / std::sqrt(a.v), a); }

struct DualVec {
  Dual x, y, z;
  DualVec() = default;
  DualVec(const Dual& x_, const Dual& y_, const Dual& z_) : x(x_), y(y_), z(z_) {}
  DualVec(const Vec3& p) : x(p.x), y(p.y), z(p.z) {}
  Vec3 value() const { return {x.v, y.v, z.v}; }
};
inline DualVec operator+(const DualVec& a, const DualVec& b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
inline DualVec operator-(const DualVec& a, const DualVec& b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
inline DualVec operator*(const Dual& s, const DualVec& a) { return {s * a.x, s * a.y, s * a.z}; }
inline Dual dot(const DualVec& a, const DualVec& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
inline DualVec cross(const DualVec& a, const DualVec& b) { return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x}; }
inline DualVec normalised(const DualVec& a) { return (Dual(1) / sqrt(dot(a, a))) * a; }

/// A point fixed in A, in A's frame; and a direction fixed in A.
inline DualVec moving_direction(const Vec3& n) {
  DualVec r(n);
  // phi x n
  r.x.d = {0, 0, 0, 0, n.z, -n.y};
  r.y.d = {0, 0, 0, -n.z, 0, n.x};
  r.z.d = {0, 0, 0, n.y, -n.x, 0};
  return r;
}
inline DualVec moving_point(const Vec3& p) {
  DualVec r = moving_direction(p);
  r.x.d[0] = r.y.d[1] = r.z.d[2] = 1;
  return r;
}

}  // namespace scree
