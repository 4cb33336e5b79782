#include "post/statistics/block_average.hpp"

#include <algorithm>
#include <boost/math/distributions/students_t.hpp>
#include <cmath>
#include <limits>

#include "core/base/error.hpp"

namespace scree {

namespace {
constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
}

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
      smallest_(quantities, std::numeric_limits<double>::infinity()),
      largest_(quantities, -std::numeric_limits<double>::infinity()),
      count_(quantities * blocks_) {}

void BlockAverage::add(const std::vector<double>& values) {
  SCREE_ASSERT(values.size() == quantities_, "{} values for {} quantities", values.size(), quantities_);
  const std::size_t block = std::min(blocks_ - 1, added_ * blocks_ / frames_);
  ++added_;
  for (std::size_t q = 0; q < quantities_; ++q) {
    if (!std::isfinite(values[q])) continue;
    sum_[q * blocks_ + block] += values[q];
    ++count_[q * blocks_ + block];
    smallest_[q] = std::min(smallest_[q], values[q]);
    largest_[q] = std::max(largest_[q], values[q]);
  }
}

Average BlockAverage::of(std::size_t quantity) const {
  Average a;
  std::vector<double> means;
  double total = 0;
  for (std::size_t b = 0; b < blocks_; ++b) {
    const std::size_t n = count_[quantity * blocks_ + b];
    if (n == 0) continue;
    means.push_back(sum_[quantity * blocks_ + b] / static_cast<double>(n));
    total += sum_[quantity * blocks_ + b];
    a.count += n;
  }
  if (a.count == 0) return {kNaN, kNaN, kNaN, kNaN, 0};
  a.mean = total / static_cast<double>(a.count);
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
