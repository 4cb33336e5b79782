// gather = "potential": one smooth p-norm potential over the unique features of a pair, U(D), D = (sum a_j d_j^8)^(1/8); where one of
// the bodies has cells, one for each of them; and the barrier of each feature that is near enough.
// Source: docs/reference/contact-law.md section 3.2.
#pragma once

#include <algorithm>
#include <cmath>
#include <span>
#include <vector>

#include "solver/contact/cluster_weights.hpp"
#include "solver/contact/contact_model.hpp"

namespace scree {

inline double power7(double x) {
  const double x2 = x * x, x4 = x2 * x2;
  return x4 * x2 * x;
}

/// The push and the pull of a law at an effective overlap.
struct PushAndPull {
  double push = 0, push_energy = 0;  ///< [N, J]
  double pull = 0, pull_energy = 0;
  double overlap = 0;               ///< that the push is of [m]
  double load = 1, least_push = 0;  ///< of a law with necks (NeckLaw::State)
  double dent = 0, yielded = 0;     ///< of a law that yields (PlasticLaw::State)
  template <class Law>
  static PushAndPull of(const Law& law, double D) {
    if constexpr (NeckedLaw<Law>) {
      const auto at = law.at(D);
      const bool presses = at.push_overlap > 0;
      return {presses ? law.force(at.push_overlap) : 0,
              presses ? law.energy(at.push_overlap) : 0,
              at.pull,
              at.pull_energy,
              at.push_overlap,
              at.load,
              at.least_push};
    } else if constexpr (YieldingLaw<Law>) {
      const auto at = law.at(D);
      return {at.push, at.push_energy, at.pull, at.pull_energy, D, 1, 0, at.dent, at.yielded};
    } else if constexpr (PullingLaw<Law>) {
      const bool touches = D > 0;
      return {touches ? law.force(D) : 0, touches ? law.energy(D) : 0, law.pull(D), law.pull_energy(D), D};
    } else {
      return {law.force(D), law.energy(D), 0, 0, D};
    }
  }
};

/// How far a feature is within what the law reaches: what features share an effective overlap by. Above 0 [m], but where attraction finds
/// features beyond touch, which have no part in the law.
template <class Law>
double depth_in_reach(const PairLaw& pair_law, const ContactFeature& f) {
  if constexpr (PullingLaw<Law>) {
    return f.overlap + pair_law.reach;
  } else if constexpr (AttractingLaw<Law>) {
    return std::max(0.0, f.overlap);
  } else {
    return f.overlap;
  }
}

/// The effective overlap that goes with an effective depth.
template <class Law>
double overlap_at(const PairLaw& pair_law, double depth) {
  if constexpr (PullingLaw<Law>) {
    return depth - pair_law.reach;
  } else {
    return depth;
  }
}

/// The law of a pair as it is at an effective overlap. Beyond its limit features share the overlap as they do at the limit.
/// in   shared   effective overlap over that of the deepest feature
template <class Law>
Law law_beyond(const Law& law, double limit, double shared) {
  Law beyond = law;
  if constexpr (LimitedLaw<Law>) beyond.limit = limit * shared;
  return beyond;
}

struct PotentialModel {
  static constexpr Gathering kGathering = Gathering::potential;
  static constexpr bool kDampsEachFeature = false;
  static constexpr bool kHasEdgeLanes = true;  ///< its features of two meshes are those of mesh_pair_features()
  template <class Law>
  using NormalLaw = Law;

  static bool list(const PairView& view, double skin, MeshDistanceScratch& scratch, CandidateLists& lists) {
    if (view.geometry != PairGeometry::two_meshes) return list_closed_form(view, skin, scratch, lists);
    return list_mesh_pair(view.a, view.b, view.reach, sharing_of_vertices(view), skin, view.radius_a, view.radius_b, scratch, lists);
  }

  static void find_features(const PairView& view, double moved, CandidateLists& lists, PairFeatures& features) {
    if (built_with::kMeshes && view.geometry == PairGeometry::two_meshes)
      mesh_pair_features(view.a, view.b, view.pose, view.reach, sharing_of_vertices(view), std::min(view.radius_a, view.radius_b), lists,
                         features.list);
    else
      find_closed_form(view, moved, lists, features.list);
    share_among_cells(view, features);
  }

  static void weigh(const PairView& view, const PullView& pull, double /*moved*/, const CandidateLists& /*lists*/, PairFeatures& features) {
    features.cluster_share = 1;
    if (pull.range > 0)
      solve_weights_separately(view.cluster_depth, view.weights_follow_overlap, pull, features);
    else if (view.a.weights != nullptr || view.b.weights != nullptr)
      solve_weights(view.cluster_depth, view.weights_follow_overlap, features);
  }

  template <class Law>
  static PushSum potential(const PairFeatures& features, const PairLaw& pair_law, const Law& law, FeatureForces& forces,
                           PairForce& result) {
    PushSum sum;
    if constexpr (PowerLaw<Law> && !PullingLaw<Law>) {
      sum =
          features.has_cells ? add_cell_potentials(features, law, forces, result) : add_potential(features, pair_law, law, forces, result);
    } else {  // a scene with cells is refused
      sum = add_potential(features, pair_law, law, forces, result);
    }
    if (pair_law.barrier > 0) add_barrier(features.list, pair_law, forces, sum, result);
    if constexpr (AttractingLaw<Law>) add_attraction(features, law.attraction, forces, result);
    return sum;
  }

  template <class Law>
  static void linearise(const LinearContact& contact, const Law& law);

  /// Of a pair that remembers whether it has touched: whether it touches, or has not yet parted.
  /// in   linked   it has touched
  template <class Law>
  static bool holds(const PairFeatures& features, const PairLaw& pair_law, const Law& law, bool linked);

  /// Energy that goes as its neck or bridge forms [J]: what it has where the deepest feature touches. Features that share a potential are
  /// deeper together than one of them.
  template <class Law>
  static double released(const PairFeatures& features, const PairLaw& pair_law, const Law& law);

 private:
  template <class Law>
  static PushSum add_potential(const PairFeatures& pair, const PairLaw& pair_law, const Law& law, FeatureForces& forces, PairForce& result);
  static void add_pull(const std::vector<ContactFeature>& features, std::span<const double> weights, double reach, double depth,
                       double pull, FeatureForces& forces);
  static double depth_of_all(const PairFeatures& features, double reach);
  static void add_attraction(const PairFeatures& features, const Attraction& attraction, FeatureForces& forces, PairForce& result);
  template <class Law>
  static PushSum add_cell_potentials(const PairFeatures& features, const Law& law, FeatureForces& forces, PairForce& result);
  static void add_barrier(const std::vector<ContactFeature>& features, const PairLaw& law, FeatureForces& forces, PushSum& sum,
                          PairForce& result);
  static void linearise_barrier(const LinearContact& contact, double exponent);
  static void linearise_attraction(const LinearContact& contact, const Attraction& attraction, double tangent);
};

/// One potential of all features.
template <class Law>
PushSum PotentialModel::add_potential(const PairFeatures& pair, const PairLaw& pair_law, const Law& law, FeatureForces& forces,
                                      PairForce& result) {
  const std::vector<ContactFeature>& features = pair.list;
  // scaled by the largest depth so that nothing under- or overflows
  double largest = 0;
  for (const ContactFeature& f : features) largest = std::max(largest, depth_in_reach<Law>(pair_law, f));
  result.largest_overlap = std::max(0.0, overlap_at<Law>(pair_law, largest));
  if constexpr (AttractingLaw<Law>) {
    if (!(largest > 0)) return {};  // within the range of the attraction alone
  }
  double sum = 0;
  for (const ContactFeature& f : features) {
    const double r = depth_in_reach<Law>(pair_law, f) / largest;
    sum += f.weight * power7(r) * r;
  }
  const double depth = largest * std::sqrt(std::sqrt(std::sqrt(sum))), D = overlap_at<Law>(pair_law, depth);
  const PushAndPull at = pair_law.limit > 0 && result.largest_overlap > pair_law.limit
                             ? PushAndPull::of(law_beyond(law, pair_law.limit, depth / largest), D)
                             : PushAndPull::of(law, D);
  result.elastic = at.push_energy;
  const double slope = pair.cluster_share * at.push;
  double push = 0;
  for (std::size_t j = 0; j < features.size(); ++j) {
    const ContactFeature& f = features[j];
    const double r = depth_in_reach<Law>(pair_law, f) / depth, r7 = power7(r);
    forces.push[j] = slope * f.weight * r7;
    forces.push_per_overlap[j] = forces.push[j] / at.overlap;
    push += forces.push[j];
    const Vec3 force = forces.push[j] * f.n;
    result.force += force;
    result.torque += cross(f.x, force);
    if (f.faded) {
      const double c = slope * depth / kNorm * r7 * r;  // dU/da_j
      result.force -= c * f.weight_gradient.force;
      result.torque -= c * f.weight_gradient.couple;
      if (forces.wants_from_weight) forces.from_weight[j] -= c * f.weight_gradient.force;
    }
  }
  if constexpr (PullingLaw<Law>) {
    result.elastic -= at.pull_energy;
    if (!(at.overlap > 0)) std::fill(forces.push_per_overlap.begin(), forces.push_per_overlap.end(), 0.0);
    add_pull(features, {}, pair_law.reach, depth, pair.cluster_share * at.pull, forces);
  }
  if constexpr (YieldingLaw<Law>) {
    forces.dent = at.dent;
    result.yielded = at.yielded;
  }
  if constexpr (NeckedLaw<Law>) {
    forces.push_overlap = at.overlap;
    forces.load = at.load;
    forces.least_push = at.least_push;
  }
  return {push, at.push_energy};
}

/// The same with one potential per cell (wall_cells.hpp), each with a part of the energy.
template <class Law>
PushSum PotentialModel::add_cell_potentials(const PairFeatures& features, const Law& law, FeatureForces& forces, PairForce& result) {
  constexpr double kPower = kNorm / (1 + Law::kExponent);  // a single feature's energies then sum to U(d)
  const std::vector<CellShare>& shares = features.cells;
  const double part = features.cell_energy;
  for (const ContactFeature& f : features.list) result.largest_overlap = std::max(result.largest_overlap, f.overlap);
  double push = 0;
  for (std::size_t begin = 0, end = 0; begin < shares.size(); begin = end) {
    double sum = 0;
    for (end = begin; end < shares.size() && shares[end].cell == shares[begin].cell; ++end) {
      const ContactFeature& f = features.list[static_cast<std::size_t>(shares[end].feature)];
      const double r = f.overlap / result.largest_overlap;
      sum += f.weight * std::pow(shares[end].weight, kPower) * power7(r) * r;
    }
    const double D = result.largest_overlap * std::sqrt(std::sqrt(std::sqrt(sum)));
    if (!(D > 0)) continue;
    result.elastic += part * law.energy(D);
    const double dU = part * law.force(D);
    for (std::size_t s = begin; s < end; ++s) {
      const CellShare& share = shares[s];
      const auto j = static_cast<std::size_t>(share.feature);
      const ContactFeature& f = features.list[j];
      const double ratio = f.overlap / D, slope = kPower * std::pow(share.weight, kPower - 1), weight = std::pow(share.weight, kPower);
      const double r7 = power7(ratio), force = dU * f.weight * weight * r7;
      forces.push[j] += force;
      // per overlap that the cell's would be with the whole weight of the feature: a place that two cells share is not stiffer for it
      forces.push_per_overlap[j] += force / D * std::pow(share.weight, kPower / kNorm);
      push += force;
      result.force += force * f.n;
      result.torque += cross(f.x, force * f.n);
      const double c = dU * D / kNorm * r7 * ratio;  // dU / d(a_j w^power)
      if (f.faded) {
        result.force -= (c * weight) * f.weight_gradient.force;
        result.torque -= (c * weight) * f.weight_gradient.couple;
        if (forces.wants_from_weight) forces.from_weight[j] -= (c * weight) * f.weight_gradient.force;
      }
      result.force -= (c * f.weight * slope) * share.gradient.force;
      result.torque -= (c * f.weight * slope) * share.gradient.couple;
      if (forces.wants_from_weight) forces.from_weight[j] -= (c * f.weight * slope) * share.gradient.force;
    }
  }
  return {push, result.elastic};
}

template <class Law>
void PotentialModel::linearise(const LinearContact& contact, const Law& law) {
  const std::vector<ContactFeature>& features = contact.features.list;
  // features that share a potential, each with its weight in it: all of them, or those of a cell
  struct Member {
    std::int64_t cell;
    std::size_t feature;
    double weight;
  };
  std::vector<Member> members;
  double part = 1, largest = 0;
  for (const ContactFeature& f : features) largest = std::max(largest, depth_in_reach<Law>(contact.law, f));
  if constexpr (AttractingLaw<Law>) {
    linearise_attraction(contact, law.attraction, largest > 0 ? law.stiffness(largest) : 0);
    if (!(largest > 0)) return;
  }
  if (contact.features.has_cells) {
    part = contact.features.cell_energy;
    for (const CellShare& s : contact.features.cells) {
      const auto j = static_cast<std::size_t>(s.feature);
      members.push_back({s.cell, j, features[j].weight * std::pow(s.weight, kNorm / (1 + tangent_over_secant(law, largest)))});
    }
  } else {
    for (std::size_t j = 0; j < features.size(); ++j) members.push_back({0, j, features[j].weight});
  }
  for (std::size_t begin = 0, end = 0; begin < members.size(); begin = end) {
    double sum = 0;
    for (end = begin; end < members.size() && members[end].cell == members[begin].cell; ++end) {
      sum += members[end].weight * std::pow(depth_in_reach<Law>(contact.law, features[members[end].feature]) / largest, kNorm);
    }
    const double depth = largest * std::pow(sum, 1.0 / kNorm), D = overlap_at<Law>(contact.law, depth);
    if (!(depth > 0)) continue;
    double push = 0, tangent = 0;  // U', U'' at most: a pull that grows with the overlap softens, one that fades stiffens
    const double of_push = overlap_of_push(law, D);
    if (of_push > 0) {
      const bool is_beyond = contact.law.limit > 0 && largest > contact.law.limit;
      const Law as_it_is = is_beyond ? law_beyond(law, contact.law.limit, depth / largest) : law;
      push = part * as_it_is.force(of_push);
      tangent = part * as_it_is.stiffness(of_push);
    }
    if constexpr (PullingLaw<Law>) tangent += part * law.pull_stiffness(D);
    const double slope = push / depth;
    std::array<double, 12> common{};
    for (std::size_t m = begin; m < end; ++m) {
      const ContactFeature& f = features[members[m].feature];
      if (!(depth_in_reach<Law>(contact.law, f) > 0)) continue;
      const double weight = members[m].weight, r = depth_in_reach<Law>(contact.law, f) / depth, r6 = std::pow(r, kNorm - 2);
      const auto along = mode_of(contact.motion, f.x, f.n);
      for (std::size_t i = 0; i < 12; ++i) common[i] += weight * r6 * r * along[i];
      if (of_push > 0) {
        contact.add_point(f.x, f.n, (kNorm - 1) * slope * weight * r6, push * weight * r6 * r, contact.force.damping, of_push,
                          tangent_over_secant(law, of_push));
      }
    }
    contact.result.add_mode(tangent - (kNorm - 1) * slope, 0, common);
  }
  if (contact.law.barrier > 0) linearise_barrier(contact, tangent_over_secant(law, largest));
}

template <class Law>
bool PotentialModel::holds(const PairFeatures& features, const PairLaw& pair_law, const Law& law, bool linked) {
  for (const ContactFeature& f : features.list) {
    if (f.overlap > 0) return true;
  }
  if constexpr (NeckedLaw<Law>) {
    if (law.neck) return linked && depth_of_all(features, pair_law.reach) - pair_law.reach > -law.neck->tear_off;
  }
  if constexpr (AttractingLaw<Law>) {
    if (pair_law.bridge != nullptr) return linked && law.attraction.holds(depth_of_all(features, pair_law.reach));
  }
  return true;
}

template <class Law>
double PotentialModel::released(const PairFeatures& features, const PairLaw& pair_law, const Law& law) {
  double deepest = 0;  // since touch, within this step
  for (const ContactFeature& f : features.list) deepest = std::max(deepest, f.overlap);
  const double depth = depth_of_all(features, pair_law.reach) - deepest;
  if constexpr (NeckedLaw<Law>)
    return -law.neck->energy(law.neck->root(depth - pair_law.reach));
  else
    return law.attraction.energy(depth);
}

}  // namespace scree
