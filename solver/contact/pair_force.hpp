// The force of one body pair: the potential of its unique features by the scene's contact model, damping from restitution, Coulomb
// friction with history per feature, rolling resistance. Source: docs/reference/contact-law.md sections 3.2 to 3.4.
// The laws are those of laws/laws.hpp.
#pragma once

#include <cmath>
#include <cstdint>
#include <vector>

#include "solver/contact/pair_memory.hpp"
#include "solver/features/area_pressure.hpp"
#include "solver/features/pair_view.hpp"

namespace scree {

/// The features of one pair, and what of them shares an energy. Each thread has one and fills it again for every pair.
struct PairFeatures {
  std::vector<ContactFeature> list;  ///< ascending keys
  double cluster_share = 1;          ///< what is left of dD/dd_j where weights fall as D grows (contact/cluster_weights.hpp)
  bool has_cells = false;            ///< one potential for each of `cells`, with this part of the energy
  double cell_energy = 1;
  std::vector<CellShare> cells;
  bool hands_over = true;  ///< keys name what a contact lies between, so that springs can be handed over (contact/hand_over.hpp)
  bool has_layer = false;  ///< gather = "area": patches of `layer` as the features
  AreaContact layer;
  AreaContact pull_layer;  ///< the same with the range of an attraction beside the margins; its patches go with `list` too
  // of an attraction: the weight of each of `list` over that in the push, 1 where empty, and what cluster_share is of the push
  std::vector<double> pull_weight;
  double pull_share = 1;
};

/// What a pair does to its bodies, A frame; torque about A's centre.
struct PairForce {
  Vec3 force, torque;                          ///< on A, everything
  Vec3 dissipative_force, dissipative_torque;  ///< on A, from damping and friction alone
  Vec3 push;                                   ///< on A: what is neither of these nor attraction
  double elastic = 0;                          ///< U [J]; below 0 where a law pulls
  double tangential_elastic = 0;               ///< stored in friction springs, that of rolling included [J]
  double rolling_elastic = 0;                  ///< of that, in the spring of rolling [J]
  Vec3 rolling_moment;                         ///< on A, of rolling and torsional resistance; part of `torque`
  double largest_overlap = 0;                  ///< largest overlap [m]
  double surface_power = 0;                    ///< of friction on A where the wall's surface moves: its work on both [W]
  double yielded = 0;                          ///< what the pair's dent has taken since the last step [J]
  double damping = 0;                          ///< chi: the damping force of a feature is its push times chi times its speed [s/m]
};

/// One contact as it is written to frames. All contacts of a pair add up to its force.
struct ContactOutput {
  Vec3 normal;            ///< unit: n of the feature; where its weight changes with the pose, along the force without friction
  double normal_force;    ///< on A along `normal` [N], damping included; below 0 where a law pulls
  Vec3 tangential_force;  ///< on A, A frame [N]
  double damping = 0;     ///< what damping adds to the force of the feature along its n [N]
  double slid = 0;        ///< what friction took in the step from what slides: not what its spring stores, and so never below 0 [J]
};

/// What each feature of a pair presses and pulls with: filled by the potential of a contact model.
struct FeatureForces {
  std::vector<double> push;              ///< f_j >= 0 [N]: what damping and friction are in proportion to
  std::vector<double> push_per_overlap;  ///< over the effective overlap [N/m]: the tangential stiffness goes with it
  bool wants_from_weight = false;
  std::vector<Vec3> from_weight;  ///< where wanted, the force from a weight that changes with the pose [N]
  // of a law that pulls
  std::vector<double> pull;      ///< >= 0 [N]
  Vec3 pull_force, pull_torque;  ///< on A, of all of them
  // of a law with necks
  double push_overlap = 0;  ///< that the push is of [m]
  double load = 1;          ///< what friction and rolling are limited by, over the push
  double least_push = 0;    ///< share of the push that damping leaves
  double dent = 0;          ///< of a law that yields [m]
};

/// Of the push of all features of a pair.
struct PushSum {
  double force = 0;   ///< [N]
  double energy = 0;  ///< [J]
};

/// Norm of the potential: larger values make stiffness depend less on the number of features, but sharpen forces.
inline constexpr int kNorm = 8;

/// Factor on chi in the damping of sliding: against the tangent stiffness of the normal force, as in the normal direction.
/// in   exponent   tangent stiffness of the push over its secant
inline double tangential_damping_share(const PairLaw& law, double exponent) {
  return law.tangential_damping * std::sqrt(law.tangential_ratio / exponent);
}

/// Effective inverse mass of a wrench Q (force F on A at A's centre with torque T, the opposite on B): Q M^-1 Q.
inline double wrench_mobility(const PairMotion& m, const Vec3& force, const Vec3& torque) {
  double sum = (m.inverse_mass_a + m.inverse_mass_b) * squared_length(force);
  sum += torque.x * torque.x * m.inverse_inertia_a.x + torque.y * torque.y * m.inverse_inertia_a.y +
         torque.z * torque.z * m.inverse_inertia_a.z;
  // T_B = -T_A - (x_A - x_B) x F, with x_A = 0
  const Vec3 on_b = transpose_times(m.b_to_a, cross(m.centre_b, force) - torque);
  sum += on_b.x * on_b.x * m.inverse_inertia_b.x + on_b.y * on_b.y * m.inverse_inertia_b.y + on_b.z * on_b.z * m.inverse_inertia_b.z;
  return sum;
}

/// The same of two fragments, or of a fragment and a body: a wrench on a body is one on what bonds hold to it.
inline double wrench_mobility_of_bonded(const PairMotion& m, const Vec3& force, const Vec3& torque) {
  const auto bonded = [](const BondedMass& body, const Vec3& f, const Vec3& t) {
    const Vec3 about_centre = t - cross(body.centre, f);
    return body.inverse_mass * squared_length(f) + dot(about_centre, body.inverse_inertia * about_centre);
  };
  const auto alone = [](double inverse_mass, const Vec3& w, const Vec3& f, const Vec3& t) {
    return inverse_mass * squared_length(f) + t.x * t.x * w.x + t.y * t.y * w.y + t.z * t.z * w.z;
  };
  const Vec3 force_b = transpose_times(m.b_to_a, -force), torque_b = transpose_times(m.b_to_a, cross(m.centre_b, force) - torque);
  const double of_a =
      m.bonded_a != nullptr ? bonded(*m.bonded_a, force, torque) : alone(m.inverse_mass_a, m.inverse_inertia_a, force, torque);
  return of_a +
         (m.bonded_b != nullptr ? bonded(*m.bonded_b, force_b, torque_b) : alone(m.inverse_mass_b, m.inverse_inertia_b, force_b, torque_b));
}

/// in   features     overlap > -PairLaw::reach
/// in   dt           step of the run [s], for damping (laws/damping.hpp); 0: no correction for the step
/// in   friction_dt  step of the friction update [s]: dt, or 0 to leave the springs as they are
/// inout springs     sorted by key; replaced by those of the present features (left empty without friction and rolling)
/// out  outputs      one per feature when not null
using PairForceFunction = PairForce (*)(const PairFeatures& features, const PairLaw& law, const PairMotion& motion, double dt,
                                        double friction_dt, std::vector<FrictionSpring>& springs, std::vector<ContactOutput>* outputs);

/// Whether two bodies whose features lie within the reach of their law act on each other, where that depends on whether they have touched.
/// in   radius     R* [m]
/// out  released   energy that goes as a neck or bridge forms now [J]; 0 where none does
using PairHoldsFunction = bool (*)(const PairFeatures& features, const PairLaw& law, double radius,
                                   const std::vector<FrictionSpring>& springs, double& released);

}  // namespace scree
