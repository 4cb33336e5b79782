// The small fixed-size algebra of the kernels: 3-vectors, unit quaternions and 3 x 3 matrices.
//
// Plain structs with inline functions, so that arrays of them are arrays of doubles and the order of every
// operation is written down: the same input gives the same bits on every rank, thread and build. Eigen is
// used at set-up only (eigenvalues, least squares).
#pragma once

#include <array>
#include <cmath>

namespace scree {

struct Vec3 {
  double x = 0, y = 0, z = 0;
  double& operator[](int i) { return i == 0 ? x : (i == 1 ? y : z); }
  double operator[](int i) const { return i == 0 ? x : (i == 1 ? y : z); }
  Vec3& operator+=(const Vec3& b) {
    x += b.x;
    y += b.y;
    z += b.z;
    return *this;
  }
  Vec3& operator-=(const Vec3& b) {
    x -= b.x;
    y -= b.y;
    z -= b.z;
    return *this;
  }
  Vec3& operator*=(double s) {
    x *= s;
    y *= s;
    z *= s;
    return *this;
  }
  bool operator==(const Vec3&) const = default;
};

inline Vec3 operator+(const Vec3& a, const Vec3& b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
inline Vec3 operator-(const Vec3& a, const Vec3& b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
inline Vec3 operator-(const Vec3& a) { return {-a.x, -a.y, -a.z}; }
inline Vec3 operator*(double s, const Vec3& a) { return {s * a.x, s * a.y, s * a.z}; }
inline Vec3 operator*(const Vec3& a, double s) { return {s * a.x, s * a.y, s * a.z}; }
inline double dot(const Vec3& a, const Vec3& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
inline Vec3 cross(const Vec3& a, const Vec3& b) { return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x}; }
inline double squared_length(const Vec3& a) { return dot(a, a); }
inline double length(const Vec3& a) { return std::sqrt(dot(a, a)); }
inline Vec3 normalised(const Vec3& a) { return (1.0 / length(a)) * a; }
inline Vec3 component_min(const Vec3& a, const Vec3& b) { return {a.x < b.x ? a.x : b.x, a.y < b.y ? a.y : b.y, a.z < b.z ? a.z : b.z}; }
inline Vec3 component_max(const Vec3& a, const Vec3& b) { return {a.x > b.x ? a.x : b.x, a.y > b.y ? a.y : b.y, a.z > b.z ? a.z : b.z}; }
inline bool is_finite(const Vec3& a) { return std::isfinite(a.x) && std::isfinite(a.y) && std::isfinite(a.z); }

/// Row-major 3 x 3 matrix.
struct Mat3 {
  std::array<Vec3, 3> rows{};
  Vec3& operator[](int i) { return rows[static_cast<std::size_t>(i)]; }
  const Vec3& operator[](int i) const { return rows[static_cast<std::size_t>(i)]; }
  bool operator==(const Mat3&) const = default;
};

inline Vec3 operator*(const Mat3& m, const Vec3& v) { return {dot(m[0], v), dot(m[1], v), dot(m[2], v)}; }
/// Transpose of m times v.
inline Vec3 transpose_times(const Mat3& m, const Vec3& v) { return v.x * m[0] + v.y * m[1] + v.z * m[2]; }
inline Mat3 transpose(const Mat3& m) {
  return {{Vec3{m[0].x, m[1].x, m[2].x}, Vec3{m[0].y, m[1].y, m[2].y}, Vec3{m[0].z, m[1].z, m[2].z}}};
}
inline Mat3 operator*(const Mat3& a, const Mat3& b) {
  const Mat3 t = transpose(b);
  Mat3 c;
  for (int i = 0; i < 3; ++i) c[i] = {dot(a[i], t[0]), dot(a[i], t[1]), dot(a[i], t[2])};
  return c;
}
inline Mat3 identity3() { return {{Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, 0, 1}}}; }

/// Unit quaternion, scalar first. As an orientation it maps body axes to world axes.
struct Quat {
  double w = 1, x = 0, y = 0, z = 0;
  bool operator==(const Quat&) const = default;
};

inline Quat operator*(const Quat& a, const Quat& b) {
  return {a.w * b.w - a.x * b.x - a.y * b.y - a.z * b.z, a.w * b.x + a.x * b.w + a.y * b.z - a.z * b.y,
          a.w * b.y - a.x * b.z + a.y * b.w + a.z * b.x, a.w * b.z + a.x * b.y - a.y * b.x + a.z * b.w};
}
inline Quat conjugate(const Quat& q) { return {q.w, -q.x, -q.y, -q.z}; }
inline double norm(const Quat& q) { return std::sqrt(q.w * q.w + q.x * q.x + q.y * q.y + q.z * q.z); }
inline Quat normalised(const Quat& q) {
  const double s = 1.0 / norm(q);
  return {s * q.w, s * q.x, s * q.y, s * q.z};
}
/// Rotates v by q: world vector of a body vector.
inline Vec3 rotate(const Quat& q, const Vec3& v) {
  const Vec3 u{q.x, q.y, q.z};
  const Vec3 t = 2.0 * cross(u, v);
  return v + q.w * t + cross(u, t);
}
/// Rotates v by the inverse of q: body vector of a world vector.
inline Vec3 rotate_inverse(const Quat& q, const Vec3& v) { return rotate(conjugate(q), v); }
/// Rotation matrix of q (rows are the world axes seen in body coordinates).
inline Mat3 matrix_of(const Quat& q) {
  const double xx = q.x * q.x, yy = q.y * q.y, zz = q.z * q.z, xy = q.x * q.y, xz = q.x * q.z, yz = q.y * q.z, wx = q.w * q.x,
               wy = q.w * q.y, wz = q.w * q.z;
  return {{Vec3{1 - 2 * (yy + zz), 2 * (xy - wz), 2 * (xz + wy)}, Vec3{2 * (xy + wz), 1 - 2 * (xx + zz), 2 * (yz - wx)},
           Vec3{2 * (xz - wy), 2 * (yz + wx), 1 - 2 * (xx + yy)}}};
}
/// Quaternion of the rotation by `angle` [rad] about the unit vector `axis`.
inline Quat quaternion_of(const Vec3& axis, double angle) {
  const double s = std::sin(0.5 * angle);
  return {std::cos(0.5 * angle), s * axis.x, s * axis.y, s * axis.z};
}
/// Quaternion of a proper rotation matrix.
Quat quaternion_of(const Mat3& rotation);

}  // namespace scree
