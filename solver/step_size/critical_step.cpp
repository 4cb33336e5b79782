#include "solver/step_size/critical_step.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

namespace scree {

namespace {

using Mat6 = Eigen::Matrix<double, 6, 6>;
using Mat12 = Eigen::Matrix<double, 12, 12, Eigen::RowMajor>;

template <class Matrix>
double largest_eigenvalue(const Matrix& m) {
  return std::max(0.0, Eigen::SelfAdjointEigenSolver<Matrix>(m, Eigen::EigenvaluesOnly).eigenvalues()(m.rows() - 1));
}

Eigen::Map<const Mat12> matrix(const std::array<double, 144>& values) { return Eigen::Map<const Mat12>(values.data()); }

}  // namespace

PairStiffness linearise(const PairContact& look, LineariseFunction function) {
  PairStiffness result;
  result.key = look.pair.key;
  result.a = look.pair.a;
  result.b = look.pair.b;
  function({look.features, look.force, look.motion, look.law, result});
  return result;
}

StabilityBound::StabilityBound(std::size_t rows) : rows_(rows) {}

void StabilityBound::add(const PairStiffness& pair, double of_wall) {
  bool is_alone = pair.b >= 0;
  for (int side = 0; side < 2; ++side) {
    const std::int32_t row = side == 0 ? pair.a : pair.b;
    if (row < 0) continue;
    Row& r = rows_[static_cast<std::size_t>(row)];
    const std::size_t corner = side == 0 ? 0 : 6 * 12 + 6;
    for (std::size_t i = 0; i < 6; ++i) {
      for (std::size_t j = 0; j < 6; ++j) {
        r.stiffness[6 * i + j] += pair.stiffness[corner + 12 * i + j];
        r.damping[6 * i + j] += pair.damping[corner + 12 * i + j];
      }
    }
    is_alone = is_alone && r.bound.pairs == 0;
    ++r.bound.pairs;
  }
  links_.push_back({pair.key, pair.a, pair.b, is_alone ? static_cast<std::int32_t>(alone_.size()) : -1, of_wall});
  if (is_alone) alone_.push_back(pair);
}

const BodyBound& StabilityBound::bound_of(std::size_t row) {
  Row& r = rows_[row];
  if (!r.is_exact) {
    r.bound.lambda = largest_eigenvalue(Mat6(Eigen::Map<const Mat6>(r.stiffness.data())));
    r.bound.gamma = largest_eigenvalue(Mat6(Eigen::Map<const Mat6>(r.damping.data())));
    r.is_exact = true;
  }
  return r.bound;
}

void StabilityBound::set_bound(std::size_t row, const BodyBound& bound) {
  rows_[row].bound = bound;
  rows_[row].is_exact = true;
}

namespace {

constexpr double kAboveRounding = 1 + 1e-12;  // a norm found in rounded arithmetic stays above the eigenvalue

/// Fourth root of |M^4|: at most 6^(1/8) = 1.25 times the largest eigenvalue.
double norm_above(const std::array<double, 36>& values) {
  const Eigen::Map<const Mat6> m(values.data());
  const double scale = m.norm();
  if (!(scale > 0)) return 0.0;
  const Mat6 one = m / scale, two = one * one, four = two * two;
  return kAboveRounding * scale * std::sqrt(std::sqrt(four.norm()));
}

}  // namespace

std::vector<double> StabilityBound::steps_below(bool corrected) const {
  std::vector<std::array<double, 2>> above(rows_.size(), {0, 0});  // at least lambda and gamma of each row
  for (std::size_t i = 0; i < rows_.size(); ++i) {
    const Row& r = rows_[i];
    if (r.is_exact)
      above[i] = {r.bound.lambda, r.bound.gamma};
    else if (r.bound.pairs > 0)
      above[i] = {norm_above(r.stiffness), norm_above(r.damping)};
  }
  std::vector<double> below;
  for (const Link& link : links_) {
    auto [lambda, gamma] = above[static_cast<std::size_t>(link.a)];
    if (link.b >= 0) {
      lambda += above[static_cast<std::size_t>(link.b)][0];
      gamma += above[static_cast<std::size_t>(link.b)][1];
    }
    lambda += link.of_wall;
    below.push_back(largest_stable_step(lambda, gamma, corrected) / kAboveRounding);
  }
  return below;
}

double StabilityBound::step_of(const Link& link, bool corrected) {
  const BodyBound& a = bound_of(static_cast<std::size_t>(link.a));
  double lambda = a.lambda, gamma = a.gamma;
  if (link.b >= 0) {
    const BodyBound& b = bound_of(static_cast<std::size_t>(link.b));
    if (a.pairs == 1 && b.pairs == 1) {
      const PairStiffness& pair = alone_[static_cast<std::size_t>(link.alone)];
      lambda = largest_eigenvalue(Mat12(matrix(pair.stiffness)));
      gamma = largest_eigenvalue(Mat12(matrix(pair.damping)));
    } else {
      lambda += b.lambda;
      gamma += b.gamma;
    }
  }
  lambda += link.of_wall;
  return largest_stable_step(lambda, gamma, corrected);
}

CriticalStep StabilityBound::critical_step(bool corrected) {
  CriticalStep result;
  if (links_.empty()) return result;
  const std::vector<double> below = steps_below(corrected);
  const auto first = static_cast<std::size_t>(std::min_element(below.begin(), below.end()) - below.begin());
  const double enough = step_of(links_[first], corrected);
  for (std::size_t k = 0; k < links_.size(); ++k) {
    if (below[k] > std::min(enough, result.step)) continue;
    const double step = step_of(links_[k], corrected);
    if (step < result.step) result = {step, links_[k].key};
  }
  return result;
}

double largest_stable_step(double lambda, double gamma, bool corrected) {
  if (!(lambda > 0) && !(gamma > 0)) return std::numeric_limits<double>::infinity();
  if (!corrected) return 4 / (gamma + std::sqrt(gamma * gamma + 4 * lambda));
  if (!(lambda > 0)) return 4 / gamma;  // 2 s / (1 + s / 4) = 4 at s = 4
  // In units of 2 / sqrt(lambda): z x^3 + x^2 + z x - 1 = 0 with z = gamma / (2 sqrt(lambda)); rising and convex, so Newton's steps
  // come down to the root from 1 without passing it. A large z begins at 1 / z, which is above the root too.
  const double root = std::sqrt(lambda), z = gamma / (2 * root);
  double x = z > 1 ? 1 / z : 1;
  for (int i = 0; i < 100; ++i) {
    const double value = ((z * x + 1) * x + z) * x - 1, slope = (3 * z * x + 2) * x + z, next = x - value / slope;
    if (!(next < x)) break;
    x = next;
  }
  return 2 * x / root;
}

}  // namespace scree
