// Compiled once for every instruction set (Highway's foreach_target), for the baseline, never with -march=native.
#include "solver/ranks/exact_parts.hpp"

#include <algorithm>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "solver/ranks/exact_parts.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace scree::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

HWY_NOINLINE std::size_t exact_parts(double* terms, std::size_t count, double* parts) {
  constexpr double kLeast = 0x1p-900, kMost = 0x1p900;
  const hn::ScalableTag<double> d;
  const hn::RebindToSigned<decltype(d)> bits;
  const std::size_t lanes = hn::Lanes(d), end = (count + lanes - 1) / lanes * lanes;
  std::fill(terms + count, terms + end, 0.0);
  auto most = hn::Zero(d);
  auto odd = hn::Lt(most, most);  // none
  for (std::size_t i = 0; i < end; i += lanes) {
    const auto size = hn::Abs(hn::Load(d, terms + i));
    most = hn::Max(most, size);
    const auto fits = hn::And(hn::Ge(size, hn::Set(d, kLeast)), hn::Lt(size, hn::Set(d, kMost)));
    odd = hn::Or(odd, hn::Not(hn::Or(fits, hn::Eq(size, hn::Zero(d)))));
  }
  if (!hn::AllFalse(d, odd)) return 0;
  std::size_t found = 0;
  do {
    // the power of two that the largest begins with, times 1.5 x 2^13: 1.5 x 2^52 u
    const auto largest = hn::MaxOfLanes(d, most);
    const auto power = hn::BitCast(d, hn::And(hn::BitCast(bits, largest), hn::Set(bits, 0x7FF0000000000000)));
    const auto round = hn::Mul(hn::Set(d, 0x1.8p13), power);
    auto sum = hn::Zero(d);
    most = hn::Zero(d);
    for (std::size_t i = 0; i < end; i += lanes) {
      const auto term = hn::Load(d, terms + i), part = hn::Sub(hn::Add(term, round), round), left = hn::Sub(term, part);
      sum = hn::Add(sum, part);
      most = hn::Max(most, hn::Abs(left));
      hn::Store(left, d, terms + i);
    }
    parts[found++] = hn::GetLane(hn::SumOfLanes(d, sum));
  } while (!hn::AllTrue(d, hn::Eq(most, hn::Zero(d))));
  return found;
}

}  // namespace scree::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace scree {
namespace {
HWY_EXPORT(exact_parts);
}

std::size_t find_exact_parts(ManyTerms& terms, std::size_t count, ManyTerms& parts) {
  return HWY_DYNAMIC_DISPATCH(exact_parts)(terms.data(), count, parts.data());
}

}  // namespace scree
#endif
