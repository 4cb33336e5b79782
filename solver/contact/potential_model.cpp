#include "solver/contact/potential_model.hpp"

#include "solver/laws/barrier.hpp"

namespace scree {

namespace {

/// Of a feature in an attraction over that in the push.
double share_of(std::span<const double> weights, std::size_t j) { return weights.empty() ? 1.0 : weights[j]; }

}  // namespace

/// The pull of an effective depth, shared as the push is.
/// in   weights   of the features over those in the push; empty: 1
void PotentialModel::add_pull(const std::vector<ContactFeature>& features, std::span<const double> weights, double reach, double depth,
                              double pull, FeatureForces& forces) {
  forces.pull.assign(features.size(), 0);
  forces.pull_force = forces.pull_torque = {};
  for (std::size_t j = 0; j < features.size(); ++j) {
    const ContactFeature& f = features[j];
    const double r = (f.overlap + reach) / depth, r7 = share_of(weights, j) * power7(r);
    forces.pull[j] = pull * f.weight * r7;
    forces.pull_force -= forces.pull[j] * f.n;
    forces.pull_torque -= cross(f.x, forces.pull[j] * f.n);
    if (f.faded) {
      const double c = pull * depth / kNorm * r7 * r;
      forces.pull_force += c * f.weight_gradient.force;
      forces.pull_torque += c * f.weight_gradient.couple;
      if (forces.wants_from_weight) forces.from_weight[j] += c * f.weight_gradient.force;
    }
  }
}

/// The eighth norm of how far features are within a reach beyond the margins, with their weights in an attraction.
double PotentialModel::depth_of_all(const PairFeatures& features, double reach) {
  double largest = 0, sum = 0;
  for (const ContactFeature& f : features.list) largest = std::max(largest, f.overlap + reach);
  for (std::size_t j = 0; j < features.list.size(); ++j) {
    const ContactFeature& f = features.list[j];
    const double r = (f.overlap + reach) / largest;
    sum += share_of(features.pull_weight, j) * f.weight * power7(r) * r;
  }
  return largest * std::sqrt(std::sqrt(std::sqrt(sum)));
}

void PotentialModel::add_attraction(const PairFeatures& features, const Attraction& attraction, FeatureForces& forces, PairForce& result) {
  if (!attraction.acts()) {
    forces.pull.assign(features.list.size(), 0);
    forces.pull_force = forces.pull_torque = {};
    return;
  }
  const double depth = depth_of_all(features, attraction.range);
  result.elastic -= attraction.energy(depth);
  const double share = features.pull_weight.empty() ? 1 : features.pull_share;
  add_pull(features.list, features.pull_weight, attraction.range, depth, share * attraction.pull(depth), forces);
}

/// The barrier of each feature that is near enough, on top of the potential.
void PotentialModel::add_barrier(const std::vector<ContactFeature>& features, const PairLaw& law, FeatureForces& forces, PushSum& sum,
                                 PairForce& result) {
  const Barrier barrier(law);
  PushSum added;
  for (std::size_t j = 0; j < features.size(); ++j) {
    const ContactFeature& f = features[j];
    const double gap = law.margin - f.overlap;
    if (!barrier.acts(gap)) continue;
    const double force = f.weight * barrier.force(gap), energy = barrier.energy(gap);
    forces.push[j] += force;
    forces.push_per_overlap[j] += force / f.overlap;
    added.force += force;
    added.energy += f.weight * energy;
    result.force += force * f.n;
    result.torque += cross(f.x, force * f.n);
    if (f.faded) {
      result.force -= energy * f.weight_gradient.force;
      result.torque -= energy * f.weight_gradient.couple;
      if (forces.wants_from_weight) forces.from_weight[j] -= energy * f.weight_gradient.force;
    }
  }
  result.elastic += added.energy;
  sum.force += added.force;
  sum.energy += added.energy;
}

void PotentialModel::linearise_barrier(const LinearContact& contact, double exponent) {
  const Barrier barrier(contact.law);
  for (const ContactFeature& f : contact.features.list) {
    const double gap = contact.law.margin - f.overlap;
    if (!barrier.acts(gap)) continue;
    contact.add_point(f.x, f.n, f.weight * barrier.curvature(gap), f.weight * barrier.force(gap), contact.force.damping, f.overlap,
                      exponent);
  }
}

/// As springs of the largest slope of the pull, where the push is softer than that: the pair may be beyond touch before the next look.
void PotentialModel::linearise_attraction(const LinearContact& contact, const Attraction& attraction, double tangent) {
  if (!attraction.acts() || !(attraction.stiffness() > tangent)) return;
  const double depth = depth_of_all(contact.features, attraction.range), stiffness = attraction.stiffness() - tangent;
  std::array<double, 12> common{};
  for (std::size_t j = 0; j < contact.features.list.size(); ++j) {
    const ContactFeature& f = contact.features.list[j];
    const double r = (f.overlap + attraction.range) / depth,
                 part = share_of(contact.features.pull_weight, j) * f.weight * std::pow(r, kNorm - 2);
    const auto along = mode_of(contact.motion, f.x, f.n);
    for (std::size_t i = 0; i < 12; ++i) common[i] += part * r * along[i];
    contact.result.add_mode((kNorm - 1) * stiffness * part, 0, along);
  }
  contact.result.add_mode(-(kNorm - 2) * stiffness, 0, common);
}

}  // namespace scree
