#include "solver/contact/due_candidates.hpp"

#include <hwy/highway.h>

#include <bit>

namespace scree {

namespace hn = hwy::HWY_NAMESPACE;

void find_due(const std::vector<float>& slacks, double way, std::vector<std::int32_t>& due) {
  due.clear();
  const hn::CappedTag<float, 4> four;
  constexpr double kRoundedUp = 1 + 0x1p-22;
  const auto used = hn::Set(four, static_cast<float>(kRoundedUp * way));
  constexpr std::size_t kStep = hn::MaxLanes(four);
  static_assert(kSlackBlock % kStep == 0 && kStep <= 8);
  for (std::size_t begin = 0; begin < slacks.size(); begin += kSlackBlock) {
    std::uint32_t bits = 0;
    for (std::size_t k = 0; k < kSlackBlock; k += kStep) {
      std::uint8_t some[8] = {};
      hn::StoreMaskBits(four, hn::Le(hn::LoadU(four, slacks.data() + begin + k), used), some);
      bits |= static_cast<std::uint32_t>(some[0]) << k;
    }
    for (; bits != 0; bits &= bits - 1) due.push_back(static_cast<std::int32_t>(begin) + std::countr_zero(bits));
  }
}

float least_of(const std::vector<float>& slacks) {
  const hn::CappedTag<float, 4> four;
  constexpr std::size_t kStep = hn::MaxLanes(four);
  auto least = hn::Set(four, std::numeric_limits<float>::infinity());
  for (std::size_t begin = 0; begin < slacks.size(); begin += kStep) least = hn::Min(least, hn::LoadU(four, slacks.data() + begin));
  return hn::GetLane(hn::MinOfLanes(four, least));
}

}  // namespace scree
