// Pairs of triangles for the tests: random ones, and the solving of many at a time.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

#include "core/distance/triangle_distance.hpp"

namespace scree {

/// 18 coordinates: A0 A1 A2 B0 B1 B2.
using Pair18 = std::array<double, 18>;

/// A small generator with the same numbers everywhere (SplitMix64).
class Random {
 public:
  explicit Random(std::uint64_t seed) : state_(seed) {}
  std::uint64_t bits() {
    std::uint64_t z = (state_ += 0x9E3779B97F4A7C15ull);
    z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9ull;
    z = (z ^ (z >> 27)) * 0x94D049BB133111EBull;
    return z ^ (z >> 31);
  }
  double uniform(double low, double high) { return low + (high - low) * static_cast<double>(bits() >> 11) * 0x1p-53; }
  int integer(int low, int high) {  ///< low..high, both included
    return low + static_cast<int>(bits() % static_cast<std::uint64_t>(high - low + 1));
  }
  double normal() { return std::sqrt(-2 * std::log(uniform(1e-300, 1))) * std::cos(6.283185307179586 * uniform(0, 1)); }
  Vec3 direction() { return normalised(Vec3{normal(), normal(), normal()}); }
  Quat rotation() { return normalised(Quat{normal(), normal(), normal(), normal()}); }

 private:
  std::uint64_t state_;
};

inline std::vector<double> structure_of_arrays(const std::vector<Pair18>& pairs, std::int64_t& stride) {
  const auto count = static_cast<std::int64_t>(pairs.size());
  stride = (count + kBatchPadding - 1) / kBatchPadding * kBatchPadding;
  if (stride % 512 == 0) stride += kBatchPadding;  // see PairBatch
  std::vector<double> values(static_cast<std::size_t>(18 * stride), std::nan(""));
  for (std::int64_t i = 0; i < count; ++i)
    for (std::int64_t c = 0; c < 18; ++c)
      values[static_cast<std::size_t>(c * stride + i)] = pairs[static_cast<std::size_t>(i)][static_cast<std::size_t>(c)];
  return values;
}

inline std::vector<TriangleDistance> solve(const std::vector<Pair18>& pairs) {
  std::int64_t stride = 0;
  const std::vector<double> values = structure_of_arrays(pairs, stride);
  std::vector<TriangleDistance> answers(pairs.size());
  triangle_distances(PairBatch<double>{values.data(), stride, static_cast<std::int64_t>(pairs.size())}, answers.data());
  return answers;
}

inline std::vector<double> solve_distances(const std::vector<Pair18>& pairs) {
  std::int64_t stride = 0;
  const std::vector<double> values = structure_of_arrays(pairs, stride);
  std::vector<double> distance(pairs.size());
  triangle_distances(PairBatch<double>{values.data(), stride, static_cast<std::int64_t>(pairs.size())}, distance.data());
  return distance;
}

inline std::vector<float> solve_single(const std::vector<Pair18>& pairs) {
  std::int64_t stride = 0;
  const std::vector<double> values = structure_of_arrays(pairs, stride);
  const std::vector<float> rounded(values.begin(), values.end());
  std::vector<float> distance(pairs.size());
  triangle_distances(PairBatch<float>{rounded.data(), stride, static_cast<std::int64_t>(pairs.size())}, distance.data());
  return distance;
}

inline Vec3 corner(const Pair18& p, int k) {
  const auto i = static_cast<std::size_t>(3 * k);
  return {p[i], p[i + 1], p[i + 2]};
}

/// The longest edge of the two triangles.
inline double longest_edge(const Pair18& p) {
  double longest = 0;
  for (int side = 0; side < 6; side += 3)
    for (int k = 0; k < 3; ++k) longest = std::max(longest, length(corner(p, side + (k + 1) % 3) - corner(p, side + k)));
  return longest;
}

/// Largest ratio of longest edge to height over the two triangles; 1e300 for a degenerate one.
inline double aspect(const Pair18& p) {
  double largest = 0;
  for (int side = 0; side < 6; side += 3) {
    double edge = 0;
    for (int k = 0; k < 3; ++k) edge = std::max(edge, length(corner(p, side + (k + 1) % 3) - corner(p, side + k)));
    const double area2 = length(cross(corner(p, side + 1) - corner(p, side), corner(p, side + 2) - corner(p, side)));
    largest = std::max(largest, area2 > 0 ? edge * edge / area2 : 1e300);
  }
  return largest;
}

inline Pair18 scaled(const Pair18& p, double s) {
  Pair18 q;
  for (std::size_t i = 0; i < 18; ++i) q[i] = s * p[i];
  return q;
}
inline Pair18 swapped(const Pair18& p) {
  Pair18 q;
  for (std::size_t i = 0; i < 18; ++i) q[i] = p[(i + 9) % 18];
  return q;
}
/// One of the 36 orders of the vertices of both triangles.
inline Pair18 permuted(const Pair18& p, int order) {
  static constexpr std::size_t kOrders[6][3] = {{0, 1, 2}, {1, 2, 0}, {2, 0, 1}, {0, 2, 1}, {2, 1, 0}, {1, 0, 2}};
  Pair18 q;
  for (std::size_t k = 0; k < 3; ++k)
    for (std::size_t c = 0; c < 3; ++c) {
      q[3 * k + c] = p[3 * kOrders[order % 6][k] + c];
      q[9 + 3 * k + c] = p[9 + 3 * kOrders[order / 6 % 6][k] + c];
    }
  return q;
}
inline Pair18 random_integer_pair(Random& random, int low, int high) {
  Pair18 p;
  for (double& x : p) x = random.integer(low, high);
  return p;
}

}  // namespace scree
