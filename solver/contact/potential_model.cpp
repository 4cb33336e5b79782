#include "solver/contact/potential_model.hpp"

#include "solver/laws/barrier.hpp"

namespace scree {

/// The pull of an effective depth, shared as the push is.
void PotentialModel::add_pull(const std::vector<ContactFeature>& features, double reach, double depth, double pull, FeatureForces& forces) {
  forces.pull.assign(features.size(), 0);
  forces.pull_force = forces.pull_torque = {};
  for (std::size_t j = 0; j < features.size(); ++j) {
    const ContactFeature& f = features[j];
    const double r = (f.overlap + reach) / depth, r7 = power7(r);
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

}  // namespace scree
