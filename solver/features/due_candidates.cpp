// Compiled once for every instruction set (Highway's foreach_target): comparisons are exact on all of them.
#include "solver/features/due_candidates.hpp"

#include <bit>
#include <cstring>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "solver/features/due_candidates.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace scree::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;
using Slacks = hn::CappedTag<float, kSlackBlock>;
constexpr std::size_t kStep = hn::MaxLanes(Slacks());
static_assert(kSlackBlock % kStep == 0);

HWY_NOINLINE void find_used_up(const float* slacks, std::size_t count, float used, std::vector<std::int32_t>& due) {
  const Slacks some;
  const auto limit = hn::Set(some, used);
  for (std::size_t begin = 0; begin < count; begin += kSlackBlock) {
    std::uint32_t bits = 0;
    for (std::size_t k = 0; k < kSlackBlock; k += kStep) {
      const auto is_due = hn::Le(hn::LoadU(some, slacks + begin + k), limit);
      if (hn::AllFalse(some, is_due)) continue;  // as most are
      std::uint8_t bytes[8] = {};
      hn::StoreMaskBits(some, is_due, bytes);
      std::uint32_t of_step = 0;
      std::memcpy(&of_step, bytes, sizeof(of_step));
      bits |= of_step << k;
    }
    for (; bits != 0; bits &= bits - 1) due.push_back(static_cast<std::int32_t>(begin) + std::countr_zero(bits));
  }
}

HWY_NOINLINE float least_of_all(const float* slacks, std::size_t count) {
  const Slacks some;
  auto least = hn::Set(some, std::numeric_limits<float>::infinity());
  for (std::size_t begin = 0; begin < count; begin += kStep) least = hn::Min(least, hn::LoadU(some, slacks + begin));
  return hn::GetLane(hn::MinOfLanes(some, least));
}

}  // namespace scree::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace scree {
namespace {

HWY_EXPORT(find_used_up);
HWY_EXPORT(least_of_all);

}  // namespace

void find_due(const std::vector<float>& slacks, double way, std::vector<std::int32_t>& due) {
  due.clear();
  constexpr double kRoundedUp = 1 + 0x1p-22;
  HWY_DYNAMIC_DISPATCH(find_used_up)(slacks.data(), slacks.size(), static_cast<float>(kRoundedUp * way), due);
}

float least_of(const std::vector<float>& slacks) { return HWY_DYNAMIC_DISPATCH(least_of_all)(slacks.data(), slacks.size()); }

}  // namespace scree
#endif
