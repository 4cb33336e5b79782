// Exact distance between triangles, many pairs at a time.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "core/geometry/vec3.hpp"

namespace scree {

/// Which part of a triangle is closest: 0 face, 1-3 edge k (from vertex k-1 to k), 4-6 vertex k-4.
enum class Feature : std::uint8_t { face = 0, edge0 = 1, edge1 = 2, edge2 = 3, vertex0 = 4, vertex1 = 5, vertex2 = 6 };

/// One answer. Closest points lie on their triangles; distance = |point_a - point_b|.
struct TriangleDistance {
  double distance = 0;    ///< [m]; 0 when intersecting
  Vec3 point_a, point_b;  ///< closest points; for an intersecting pair a point of the intersection
  Vec3 normal;            ///< unit, from b to a; from the feature when close; zero when intersecting
  Feature feature_a = Feature::face, feature_b = Feature::face;
  /// The closed triangles have a common point, touching included: exactly when the exact distance is 0. Decided in
  /// exact arithmetic where rounding cannot tell, so it is never set for a pair that is apart, however near. It may be
  /// missing for a pierced sliver, whose distance is then at most 4 roundoffs * aspect * longest edge.
  bool intersecting = false;
};

/// Batches are padded to a multiple of this many pairs: the widest SIMD vector.
inline constexpr std::int64_t kBatchPadding = 16;

/// Pairs as a structure of arrays: coordinate c (0..17) of pair i is at values[c * stride + i].
/// Coordinates 0..8 are triangle A (p0 p1 p2), 9..17 triangle B. A stride that is a multiple of 4096 bytes puts the
/// eighteen rows into the same cache sets and costs a third of the speed: add kBatchPadding.
template <class Real>
struct PairBatch {
  const Real* values = nullptr;
  std::int64_t stride = 0;  ///< >= count rounded up to a multiple of kBatchPadding; what lies past count is read, never used
  std::int64_t count = 0;
};

/// Distances only, the fast filter: distance[i] for each pair, 0 when intersecting.
/// Exact up to rounding: error <= 5 eps max(L, d), L the longest edge of the two.
void triangle_distances(const PairBatch<double>& pairs, double* distance);
void triangle_distances(const PairBatch<float>& pairs, float* distance);

/// Distances with closest points, features and normals.
void triangle_distances(const PairBatch<double>& pairs, TriangleDistance* answers);

/// One pair; the same arithmetic as the batch.
TriangleDistance triangle_distance(const Vec3 a[3], const Vec3 b[3]);

/// Features from the code that the kernel leaves in a lane (brute_force-inl.hpp). For the methods' own use.
std::pair<Feature, Feature> decode_features(int code);

/// Name of the SIMD target in use ("AVX3", "AVX2", "SSE4", ...), and a limit for --simd: "avx512", "avx2",
/// "sse4", "scalar" (lowest compiled target) or "best". Throws UsageError for another name or a target that
/// this processor does not have. Call before threads start.
std::string simd_target();
void limit_simd(const std::string& name);

}  // namespace scree
