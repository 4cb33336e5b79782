#include "solver/balance.hpp"

#include <algorithm>
#include <cmath>

namespace scree {

namespace {

// A pair that was interrupted while it was timed must not weigh as much as thousands. The renewal of a pair's lists is honest
// work and takes up to some hundred times an average pair.
constexpr double kLongestPair = 300;  // of the average pair of the sample
// Below this imbalance a cut could not gain what measuring noise hides.
constexpr double kSmallestImbalance = 1.03;

}  // namespace

void Balance::add_sample(std::span<const float> pair_seconds, const std::vector<BodyPair>& pairs, ParticleSet& p) {
  double all = 0, sum = 0;
  for (const float s : pair_seconds) all += s;
  const double longest = kLongestPair * all / static_cast<double>(std::max<std::size_t>(1, pair_seconds.size()));
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
  constexpr double kLeastShare = 0.02;  // of the rank's time
  const double steps = static_cast<double>(samples_ * kSampleEvery), all = (computing_ - computing_at_cut_) / steps;
  const double each = std::max(all - pair_seconds_ / static_cast<double>(samples_), kLeastShare * all) / static_cast<double>(p.owned);
  for (std::size_t i = 0; i < p.owned; ++i) work[i] = each + p.work[i] / static_cast<double>(samples_);
  return work;
}

void Balance::tell(StepNews& news) const {
  news.work = news.largest_work = std::llround(1e9 * (computing_ - computing_at_cut_));
  news.cut_cost = std::llround(1e9 * cut_cost_);
}

bool Balance::is_cut_due(const StepNews& all) const {
  if (ranks_ == 1 || samples_ == 0) return false;
  const double mean = static_cast<double>(all.work) / ranks_, largest = static_cast<double>(all.largest_work);
  return largest > kSmallestImbalance * mean && largest - expected_ * mean > static_cast<double>(all.cut_cost);
}

void Balance::note_cut(double seconds, double expected, ParticleSet& p) {
  cut_cost_ = seconds;
  expected_ = expected;
  computing_at_cut_ = computing_;
  pair_seconds_ = 0;
  samples_ = 0;
  std::fill(p.work.begin(), p.work.end(), 0.0);
}

}  // namespace scree
