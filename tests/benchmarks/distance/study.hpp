// Error and time of one method on one set of pairs.
#pragma once

#include <string>
#include <vector>

#include "tests/distance/triangle_pairs.hpp"

namespace scree {

/// brute-force, brute-force-distance (no points), penalty, hybrid, the published pen4, pen7, pen4-hybrid, pen7-hybrid, and
/// brute-force-indexed: brute-force from indices into two shapes, B turned and shifted, in single precision only. The
/// rounding of its placed corners counts as error.
const std::vector<std::string>& study_methods();
bool has_precision(const std::string& method, bool single);

struct StudyRow {
  double nanoseconds = 0;                                 ///< per pair, best of the repetitions
  double error_median = 0, error_p99 = 0, error_max = 0;  ///< |d - d*| / max(L, d*)
  double wrong_flags = 0;                                 ///< share of pairs whose intersecting flag is wrong (d = 0 or not)
  double uncertified = 0, fell_back = 0;                  ///< shares
  std::int64_t not_a_number = 0;
};

/// Floating-point operations of one pair by brute-force, closest points included, as compiled (disassembly of the
/// AVX-512 loop by GCC 12; a multiply-add counts two, minima, comparisons and blends none). 0 for the other methods.
double operations_of(const std::string& method, bool single);

/// One answer as the file of answers holds it: 64 bytes.
struct AnswerRecord {
  double distance;
  double point_a[3], point_b[3];
  std::uint32_t feature;  ///< bits 0-3 on A, 4-7 on B: 0 face, 1-3 edge, 4-6 vertex
  std::uint32_t flags;    ///< bit 0 intersecting, 1 uncertified, 2 fell back
};
static_assert(sizeof(AnswerRecord) == 64);

/// A set of pairs with the exact distances of their coordinates as the kernel sees them.
struct StudyCase {
  std::string name;
  bool single = false;
  std::vector<Pair18> pairs;  ///< in the frame of the first vertex of A when single, rounded
  std::vector<Vec3> origins;  ///< what was subtracted
  std::vector<double> truth;
};

/// Prepares a case: exact distances of up to `checked` pairs (0: none) by rational arithmetic, 30 microseconds each.
StudyCase make_study_case(const std::string& name, const std::vector<Pair18>& pairs, bool single, std::size_t checked);

/// Times the method for about `seconds` and compares with the truth. Fills `answers` when not null.
StudyRow run_study(const StudyCase& study, const std::string& method, double seconds, std::vector<AnswerRecord>* answers);

}  // namespace scree
