#include "solver/contact/crowds.hpp"

#include <algorithm>
#include <cmath>

namespace scree {

namespace {

double power8(double x) {
  const double x2 = x * x, x4 = x2 * x2;
  return x4 * x4;
}

/// sum a_j(x) r_j^8 with r_j = d_j / largest, x = D / largest, and how much of its logarithm a change of that of x takes away.
struct CrowdSum {
  double sum = 0, fall = 0;
  CrowdSum(const std::vector<ContactFeature>& features, double largest, double eps, double x) {
    for (const ContactFeature& f : features) {
      const double crowded = f.crowd * (largest / eps) * x, term = f.weight * power8(f.overlap / largest) / (1 + crowded);
      sum += term;
      fall += term * (crowded / (1 + crowded));
    }
    fall /= sum;
  }
};

}  // namespace

void settle_crowds(double eps, bool follow, PairFeatures& features) {
  double largest = 0, most = 0;
  for (const ContactFeature& f : features.list) {
    largest = std::max(largest, f.overlap);
    most = std::max(most, f.crowd);
  }
  if (!(most > 0)) return;
  double D = eps;
  if (follow) {
    // Newton's method for ln D, whose slope is 8 to 9: an error of e becomes e^2 / 20. The start is right to a tenth, since D is an eighth
    // root.
    constexpr int kIterations = 4;
    double x = 1;
    for (int n = 0; n < kIterations; ++n) {
      const CrowdSum at(features.list, largest, eps, x);
      const double root = std::sqrt(std::sqrt(std::sqrt(at.sum)));
      x *= 1 + (root / x - 1) * (kNorm / (kNorm + at.fall));
    }
    const CrowdSum at(features.list, largest, eps, x);
    features.crowd_share = 1 / (1 + at.fall / kNorm);
    D = largest * x;
  }
  for (ContactFeature& f : features.list) {
    const double share = 1 / (1 + f.crowd * (D / eps));
    f.weight *= share;
    f.weight_gradient.force *= share;
    f.weight_gradient.couple *= share;
  }
}

}  // namespace scree
