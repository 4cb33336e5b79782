// Many terms of an exact sum at once.
#pragma once

#include <array>
#include <cstddef>

namespace scree {

inline constexpr std::size_t kManyTerms = 64;
struct alignas(64) ManyTerms : std::array<double, kManyTerms> {};

/// Numbers with the same sum as `terms`, without any rounding: few where the exponents of the terms are near each other.
///
/// How: from each term what is a multiple of u is taken by rounding, exactly, u being 2^-40 of the largest; these parts add up without
/// rounding, and what they leave is treated alike until nothing is left.
/// Source: J. Demmel, H. D. Nguyen, Fast reproducible floating-point summation, IEEE ARITH 21 (2013).
///
/// in, out   terms   count of them; used up     out   parts
/// Returns the number of parts; 0 where a term is so large or small that the steps above would overflow: `terms` are as they were then.
/// Cost: some ns for each vector of terms and part, two or three parts.
std::size_t find_exact_parts(ManyTerms& terms, std::size_t count, ManyTerms& parts);

}  // namespace scree
