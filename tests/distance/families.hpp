// The families of triangle pairs that a distance kernel can get wrong, each a generator of members.
//
// Members are built on small dyadic numbers, then moved by integer rotations (3-4-5 and 1-2-2, which keep parallel
// things exactly parallel), integer translations, powers of two, a permutation of the vertices and a swap. The
// truth of each comes from exact_oracle.hpp on the coordinates as they are, so no member needs a known answer.
#pragma once

#include <string>

#include "tests/distance/triangle_pairs.hpp"

namespace scree {

inline constexpr int kFamilyCount = 17;

/// "T5 parallel faces", for messages; family from 1 to kFamilyCount.
std::string family_name(int family);

/// A random member.
Pair18 family_member(int family, Random& random);

}  // namespace scree
