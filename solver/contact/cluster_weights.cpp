#include "solver/contact/cluster_weights.hpp"

#include <algorithm>
#include <cmath>

namespace scree {

namespace {

double power8(double x) {
  const double x2 = x * x, x4 = x2 * x2;
  return x4 * x4;
}

/// How deep a feature is, and what cluster it lies in.
struct InPush {
  double depth(const ContactFeature& f, std::size_t) const { return f.overlap; }
  double cluster(const ContactFeature& f, std::size_t) const { return f.cluster; }
};
struct InPushIfTouching {
  double depth(const ContactFeature& f, std::size_t) const { return std::max(0.0, f.overlap); }
  double cluster(const ContactFeature& f, std::size_t) const { return f.cluster; }
};
struct InPull {
  double range;
  const std::vector<double>& clusters;
  double depth(const ContactFeature& f, std::size_t) const { return f.overlap + range; }
  double cluster(const ContactFeature&, std::size_t j) const { return clusters[j]; }
};

/// sum a_j(x) r_j^8 with r_j = d_j / largest, x = D / largest, and how much of its logarithm a change of that of x takes away.
struct CrowdSum {
  double sum = 0, fall = 0;
  template <class Place>
  CrowdSum(const std::vector<ContactFeature>& features, const Place& place, double largest, double eps, double x) {
    for (std::size_t j = 0; j < features.size(); ++j) {
      const ContactFeature& f = features[j];
      const double clustered = place.cluster(f, j) * (largest / eps) * x,
                   term = f.weight * power8(place.depth(f, j) / largest) / (1 + clustered);
      sum += term;
      fall += term * (clustered / (1 + clustered));
    }
    fall /= sum;
  }
};

/// D as clusters follow it, and the share of its derivatives.
struct Settled {
  double D, share;
};

template <class Place>
Settled settle(const std::vector<ContactFeature>& features, const Place& place, double largest, double eps) {
  // Newton's method for ln D, whose slope is 8 to 9: an error of e becomes e^2 / 20. The start is right to a tenth, since D is an eighth
  // root.
  constexpr int kIterations = 4;
  double x = 1;
  for (int n = 0; n < kIterations; ++n) {
    const CrowdSum at(features, place, largest, eps, x);
    const double root = std::sqrt(std::sqrt(std::sqrt(at.sum)));
    x *= 1 + (root / x - 1) * (kNorm / (kNorm + at.fall));
  }
  const CrowdSum at(features, place, largest, eps, x);
  return {largest * x, 1 / (1 + at.fall / kNorm)};
}

void weigh(ContactFeature& f, double share) {
  f.weight *= share;
  f.weight_gradient.force *= share;
  f.weight_gradient.couple *= share;
}

/// Of a feature in an attraction, from its key.
double cluster_in_pull(const PullView& pull, const ContactFeature& f) {
  const auto [kind, first, second] = indices_of_key(f.key);
  if (kind == kCornerOfA) return pull.a.cluster(first);
  if (kind == kCornerOfB) return pull.b.cluster(first);
  return 4 / (pull.a.weight_of_ends(first) + pull.b.weight_of_ends(second)) - 1;
}

}  // namespace

void solve_weights(double eps, bool follow, PairFeatures& features) {
  double largest = 0, most = 0;
  for (const ContactFeature& f : features.list) {
    largest = std::max(largest, f.overlap);
    most = std::max(most, f.cluster);
  }
  if (!(most > 0)) return;
  double D = eps;
  if (follow) {
    const Settled settled = settle(features.list, InPush{}, largest, eps);
    D = settled.D;
    features.cluster_share = settled.share;
  }
  for (ContactFeature& f : features.list) weigh(f, 1 / (1 + f.cluster * (D / eps)));
}

void solve_weights_separately(double eps, bool follow, const PullView& pull, PairFeatures& features) {
  features.pull_weight.clear();
  bool clustered = pull.a.weights != nullptr || pull.b.weights != nullptr;
  for (const ContactFeature& f : features.list) clustered = clustered || f.cluster > 0;
  if (!clustered || features.list.empty()) return;
  double largest = -pull.range;
  for (const ContactFeature& f : features.list) largest = std::max(largest, f.overlap);
  features.pull_weight.resize(features.list.size());
  for (std::size_t j = 0; j < features.list.size(); ++j) features.pull_weight[j] = cluster_in_pull(pull, features.list[j]);
  const Settled pulled = settle(features.list, InPull{pull.range, features.pull_weight}, largest + pull.range, pull.at);
  features.pull_share = pulled.share;
  Settled push{follow ? 0 : eps, 1};  // where nothing touches, weights of the push stand for nothing
  if (follow && largest > 0) push = settle(features.list, InPushIfTouching{}, largest, eps);
  features.cluster_share = push.share;
  for (std::size_t j = 0; j < features.list.size(); ++j) {
    ContactFeature& f = features.list[j];
    const double share = 1 / (1 + f.cluster * (push.D / eps));
    features.pull_weight[j] = 1 / (1 + features.pull_weight[j] * (pulled.D / pull.at)) / share;
    weigh(f, share);
  }
}

}  // namespace scree
