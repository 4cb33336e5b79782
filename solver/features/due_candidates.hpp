// Which candidates of a pair are to be looked at: most are not, so that running over them is what a pair of fine meshes costs. Their slacks
// lie apart from all else in one array, and are compared sixteen at a time.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

namespace scree {

/// Slacks are held in blocks of so many; the last is filled up with candidates that are never due.
inline constexpr std::size_t kSlackBlock = 16;
inline void fill_up(std::vector<float>& slacks) {
  slacks.resize((slacks.size() + kSlackBlock - 1) / kSlackBlock * kSlackBlock, std::numeric_limits<float>::infinity());
}

/// Indices of the slacks that are used up on the way of a pair, ascending; one that is not used up may be among them when it is by
/// rounding.
void find_due(const std::vector<float>& slacks, double way, std::vector<std::int32_t>& due);

/// The least of them; infinity where there are none.
float least_of(const std::vector<float>& slacks);

}  // namespace scree
