#include "solver/ranks/balance.hpp"

#include <algorithm>
#include <cmath>

namespace scree {

namespace {

// A pair that was interrupted while it was timed must not weigh as much as thousands: on a busy machine one such pair spoilt a
// cut. The rebuild of a pair's lists is honest work, but rare, and takes up to some hundred times a common pair.
constexpr double kLongestPair = 50;  // of the median pair of the sample
// A first look at the pairs says too little to cut by.
constexpr std::int64_t kMinSamples = 4;
// Where a cut leaves more than this, since single bodies weigh too much, the next one must be worth twice as much, and so on.
constexpr double kPoorCut = 1.1, kMaxPatience = 64;
// Below this imbalance a cut could not gain what measuring noise hides.
constexpr double kSmallestImbalance = 1.03;

}  // namespace

void Balance::add_sample(std::span<const float> pair_seconds, const std::vector<BodyPair>& pairs, ParticleSet& p) {
  double sum = 0, longest = 0;
  if (!pair_seconds.empty()) {
    std::vector<float> sorted(pair_seconds.begin(), pair_seconds.end());
    const auto middle = sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() / 2);
    std::nth_element(sorted.begin(), middle, sorted.end());
    longest = kLongestPair * *middle;
  }
  for (std::size_t k = 0; k < pair_seconds.size(); ++k) {
    const double half = 0.5 * std::min<double>(pair_seconds[k], longest);
    sum += 2 * half;
    for (const std::int32_t row : {pairs[k].a, pairs[k].b}) {
      if (row >= 0 && static_cast<std::size_t>(row) < p.owned) p.work[static_cast<std::size_t>(row)] += half;
    }
  }
  pair_seconds_ += sum;
  ++samples_;
}

std::vector<double> Balance::work_of_bodies(const ParticleSet& p) const {
  std::vector<double> work(p.owned, 1.0);
  if (samples_ == 0 || p.owned == 0) return work;
  // what is not spent on pairs is shared out evenly; a body without contacts costs something, however the measurement falls out
  constexpr double kMinShare = 0.02;  // of the rank's time
  const double steps = static_cast<double>(samples_ * kSampleEvery), all = (computing_ - computing_at_cut_) / steps;
  const double each = std::max(all - pair_seconds_ / static_cast<double>(samples_), kMinShare * all) / static_cast<double>(p.owned);
  for (std::size_t i = 0; i < p.owned; ++i) work[i] = each + p.work[i] / static_cast<double>(samples_);
  return work;
}

void Balance::tell(StepReport& report) const {
  report.work = report.largest_work = std::llround(1e9 * (computing_ - computing_at_cut_));
  report.cut_cost = std::llround(1e9 * cut_cost_);
}

bool Balance::is_cut_due(const StepReport& all) const {
  if (ranks_ == 1 || samples_ < kMinSamples) return false;
  const double mean = static_cast<double>(all.work) / ranks_, largest = static_cast<double>(all.largest_work);
  return largest > kSmallestImbalance * mean && largest - mean > patience_ * static_cast<double>(all.cut_cost);
}

void Balance::note_cut(double seconds, double expected, ParticleSet& p) {
  cut_cost_ = seconds;
  patience_ = expected > kPoorCut ? std::min(2 * patience_, kMaxPatience) : 1;
  computing_at_cut_ = computing_;
  pair_seconds_ = 0;
  samples_ = 0;
  std::fill(p.work.begin(), p.work.end(), 0.0);
}

}  // namespace scree
