// Three ways to the distance of two triangles behind one batch interface, so that they can be compared.
//
//   brute-force  every edge pair and two vertex-face pairs with shared subexpressions. Exact. The default elsewhere.
//   penalty      Newton on penalised barycentric coordinates, active set solved exactly, honest certificate. A
//                pair whose certificate fails says so; it may then be far off.
//   hybrid       penalty with a strict certificate; pairs without it go to brute-force, compacted. Exact.
//
// The error-against-time study (tests/benchmarks/distance) puts brute-force on the front: with wide vectors it
// needs no more instructions than four Newton steps, and no fallback.
#pragma once

#include <cstdint>
#include <string>
#include <utility>

#include "core/distance/triangle_distance.hpp"

namespace scree {

enum class DistanceMethod { brute_force, penalty, hybrid };

/// "brute-force", "penalty" or "hybrid". Throws UsageError with the nearest known name for anything else.
DistanceMethod distance_method_of(const std::string& name);

/// Answers as a structure of arrays. Room for the count rounded up to a multiple of kBatchPadding in every row.
template <class Real>
struct AnswerBatch {
  Real* distance = nullptr;  ///< 0 when intersecting (never from penalty alone)
  Real* points = nullptr;    ///< rows 0-2 closest point on A, 3-5 on B
  Real* code = nullptr;      ///< features and flags: features_of, is_uncertified, fell_back
  std::int64_t stride = 0;   ///< between the rows of points
};

/// Closest features of A and of B from a code.
std::pair<Feature, Feature> features_of(double code);
/// The certificate did not hold: the distance is an upper bound only.
bool is_uncertified(double code);
/// The answer came from brute force after the certificate of the penalty method failed.
bool fell_back(double code);

/// Relative error up to which an answer of `penalty` without the uncertified flag is right: |d - d*| <= this times
/// the longest edge.
inline constexpr double kPenaltyToleranceDouble = 2e-9, kPenaltyToleranceSingle = 2e-4;

/// Distances with closest points by the chosen method; nothing is allocated.
/// Error of brute-force and hybrid: 5 roundoffs of max(L, d), L the longest edge of the pair.
void triangle_distances(DistanceMethod method, const PairBatch<double>& pairs, const AnswerBatch<double>& answers);
void triangle_distances(DistanceMethod method, const PairBatch<float>& pairs, const AnswerBatch<float>& answers);

}  // namespace scree
