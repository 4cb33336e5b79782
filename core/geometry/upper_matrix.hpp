// Upper triangular matrices of 3 x 3: the edges of a periodic cell, and how it deforms.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>

#include "core/geometry/vec3.hpp"

namespace scree {

/// A component by its number: 0, 1, 2 are xx, yy, zz; 3, 4, 5 are yz, xz, xy. Unit: that of the use.
struct UpperMatrix {
  Vec3 diagonal;  ///< xx, yy, zz
  Vec3 above;     ///< yz, xz, xy

  double operator[](int component) const { return component < 3 ? diagonal[component] : above[component - 3]; }
  double& operator[](int component) { return component < 3 ? diagonal[component] : above[component - 3]; }

  Vec3 times(const Vec3& v) const {
    return {diagonal.x * v.x + above.z * v.y + above.y * v.z, diagonal.y * v.y + above.x * v.z, diagonal.z * v.z};
  }
  /// The most by which it lengthens a vector, or more: the largest of the diagonal, and what is above it by its squares.
  double largest_stretch() const { return std::max({std::abs(diagonal.x), std::abs(diagonal.y), std::abs(diagonal.z)}) + length(above); }
};

/// The components as cases, logs and pages name them, by their numbers.
inline constexpr std::array<const char*, 6> kUpperNames = {"x", "y", "z", "yz", "xz", "xy"};

inline UpperMatrix operator*(double s, const UpperMatrix& m) { return {s * m.diagonal, s * m.above}; }
inline UpperMatrix operator*(const UpperMatrix& a, const UpperMatrix& b) {
  const Vec3 &d = a.diagonal, &e = b.diagonal;
  return {
      {d.x * e.x, d.y * e.y, d.z * e.z},
      {d.y * b.above.x + a.above.x * e.z, d.x * b.above.y + a.above.z * b.above.x + a.above.y * e.z, d.x * b.above.z + a.above.z * e.y}};
}
/// of a diagonal without zeros
inline UpperMatrix inverse(const UpperMatrix& m) {
  const Vec3 &d = m.diagonal, &a = m.above;
  return {{1 / d.x, 1 / d.y, 1 / d.z}, {-a.x / (d.y * d.z), (a.z * a.x - a.y * d.y) / (d.x * d.y * d.z), -a.z / (d.x * d.y)}};
}
/// All that two symmetric products or rates add up to: sum over the components that are not 0.
inline double dot(const UpperMatrix& a, const UpperMatrix& b) { return dot(a.diagonal, b.diagonal) + dot(a.above, b.above); }

}  // namespace scree
