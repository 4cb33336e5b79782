#include "post/statistics/block_average.hpp"

#include <algorithm>
#include <boost/math/distributions/students_t.hpp>
#include <cmath>
#include <limits>

#include "core/base/error.hpp"
#include "core/base/numbers.hpp"

namespace scree {

double student_95(std::size_t degrees_of_freedom) {
  if (degrees_of_freedom == 0) return kNaN;
  constexpr double kUpperTail = 0.025;
  return boost::math::quantile(boost::math::complement(boost::math::students_t(static_cast<double>(degrees_of_freedom)), kUpperTail));
}

BlockAverage::BlockAverage(std::size_t quantities, std::size_t frames, std::size_t blocks)
    : quantities_(quantities),
      frames_(std::max<std::size_t>(frames, 1)),
      blocks_(std::clamp<std::size_t>(frames / 2, 1, std::max<std::size_t>(blocks, 1))),
      sum_(quantities * blocks_),
      weight_(quantities * blocks_),
      smallest_(quantities, std::numeric_limits<double>::infinity()),
      largest_(quantities, -std::numeric_limits<double>::infinity()),
      count_(quantities * blocks_) {}

std::vector<double> frame_weights(const std::vector<double>& times) {
  const std::size_t n = times.size();
  const double span = n > 1 ? times.back() - times.front() : 0;
  std::vector<double> weights(n, n > 0 ? 1 / static_cast<double>(n) : 0);
  if (!(span > 0)) return weights;
  double sum = 0;
  for (std::size_t i = 0; i < n; ++i) {
    const double before = i > 0 ? times[i] - times[i - 1] : times[1] - times[0];
    const double after = i + 1 < n ? times[i + 1] - times[i] : before;
    weights[i] = 0.5 * (before + after);
    sum += weights[i];
  }
  for (double& w : weights) w /= sum;
  return weights;
}

void BlockAverage::add(const std::vector<double>& values, double weight) { add(values, weight, quantities_, 0); }

void BlockAverage::add(const std::vector<double>& values, double weight, std::size_t other, double weight_of_other) {
  SCREE_ASSERT(values.size() == quantities_, "{} values for {} quantities", values.size(), quantities_);
  constexpr double kRounding = 1e-9;  // of all: sums of weights, such that a block does not end a frame late
  const auto block = std::min(blocks_ - 1, static_cast<std::size_t>((weight_added_ + kRounding) * static_cast<double>(blocks_)));
  ++added_;
  weight_added_ += weight;
  for (std::size_t q = 0; q < quantities_; ++q) {
    if (!std::isfinite(values[q])) continue;
    const double share = q == other ? weight_of_other : weight;
    sum_[q * blocks_ + block] += share * values[q];
    weight_[q * blocks_ + block] += share;
    ++count_[q * blocks_ + block];
    smallest_[q] = std::min(smallest_[q], values[q]);
    largest_[q] = std::max(largest_[q], values[q]);
  }
}

Average BlockAverage::of(std::size_t quantity) const {
  Average a;
  std::vector<double> means;
  double total = 0, weight = 0;
  for (std::size_t b = 0; b < blocks_; ++b) {
    const std::size_t n = count_[quantity * blocks_ + b];
    a.count += n;
    const double w = weight_[quantity * blocks_ + b];
    if (!(w > 0)) continue;
    means.push_back(sum_[quantity * blocks_ + b] / w);
    total += sum_[quantity * blocks_ + b];
    weight += w;
  }
  if (a.count == 0 || !(weight > 0)) return {kNaN, kNaN, kNaN, kNaN, 0};
  a.mean = total / weight;
  a.smallest = smallest_[quantity];
  a.largest = largest_[quantity];
  a.ci95 = kNaN;
  if (const std::size_t n = means.size(); n >= 2) {
    double middle = 0, squares = 0;
    for (const double m : means) middle += m / static_cast<double>(n);
    for (const double m : means) squares += (m - middle) * (m - middle);
    a.ci95 = student_95(n - 1) * std::sqrt(squares / static_cast<double>(n - 1) / static_cast<double>(n));
  }
  return a;
}

}  // namespace scree
