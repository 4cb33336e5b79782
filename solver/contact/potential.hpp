// The contact law of one body pair: one smooth p-norm potential over its unique features, with the exact force,
// damping from restitution, and Coulomb friction with history per feature. Source: docs/reference/contact-law.md sections 3.2 to 3.4.
// The normal energy, the damping and the rolling resistance are those of laws/laws.hpp.
#pragma once

#include <cmath>
#include <cstdint>
#include <vector>

#include "solver/contact/area_pressure.hpp"
#include "solver/contact/pair_state.hpp"
#include "solver/contact/wall_cells.hpp"

namespace scree {

/// Velocities and inverse masses of both sides, A frame (its principal axes, origin at its centre).
struct PairMotion {
  Vec3 v_a, w_a, v_b, w_b;
  Vec3 centre_b;            ///< of B [m]
  Vec3 pivot_b, pivot_v_b;  ///< a point of B and its velocity [m, m/s]: its centre; of a wall that turns, on the axis
  double inverse_mass_a, inverse_mass_b;
  Vec3 inverse_inertia_a;  ///< principal
  Vec3 inverse_inertia_b;  ///< principal of B
  Mat3 b_to_a;
  Quat turn;                          ///< the same rotation, B to A
  bool independent = false;           ///< gather = "pairs": `cells` holds one for every feature
  const AreaContact* area = nullptr;  ///< gather = "area": the layer between two meshes, patches as the features
  const std::vector<CellShare>* cells =
      nullptr;             ///< A or B has cells (SolverShape::cell_size, of a wall or a free body): one potential for each
  double cell_energy = 1;  ///< part of the energy that each cell has (energy_share)
  double radius = 0;       ///< R* [m]; filled only when the law asks for it (LawChoice::needs_radius)
};

/// What a pair does to its bodies, A frame; torque about A's centre.
struct PairForce {
  Vec3 force, torque;                          ///< on A, everything
  Vec3 dissipative_force, dissipative_torque;  ///< on A, from damping and friction alone
  double elastic = 0;                          ///< U [J]
  double tangential_elastic = 0;               ///< stored in friction springs [J]
  double barrier = 0;                          ///< part of U in barriers [J]
  double largest_overlap = 0;                  ///< largest overlap [m]
  double damping = 0;                          ///< chi: the damping force of a feature is its normal force times chi times its speed [s/m]
};

/// One contact as it is written to frames. All contacts of a pair add up to its force.
struct ContactOutput {
  Vec3 normal;            ///< unit: n of the feature; where its weight changes with the pose, of the force without friction
  double normal_force;    ///< on A along `normal` [N], damping included
  Vec3 tangential_force;  ///< on A, A frame [N]
};

/// Norm of the potential: larger values make stiffness depend less on the number of features, but sharpen forces.
inline constexpr int kNorm = 8;

/// Key of the spring of rolling resistance, after those of all features; its force is a moment [N m] over [N m/rad].
inline constexpr std::int64_t kRollingKey = std::int64_t{3} << 60;
/// Key of the last entry: no spring, but how B was turned against A when the springs were set, x y z and w of a quaternion.
inline constexpr std::int64_t kTurnKey = std::int64_t{7} << 60;

/// Factor on chi in the damping of sliding: against the tangent stiffness of the normal force, as in the normal direction.
inline double tangential_damping_share(const PairLaw& law, double exponent) {
  return law.tangential_damping * std::sqrt(law.tangential_ratio / exponent);
}

/// in   features   ascending keys, overlap > 0
/// in   dt         step of the run [s], for damping (laws/damping.hpp); 0: no correction for the step
/// in   friction_dt  step of the friction update [s]: dt, or 0 to leave the springs as they are
/// inout springs   sorted by key; replaced by those of the present features (left empty without friction and rolling)
/// out  outputs    one per feature when not null
using PairForceFunction = PairForce (*)(const std::vector<ContactFeature>& features, const PairLaw& law, const PairMotion& motion,
                                        double dt, double friction_dt, std::vector<FrictionSpring>& springs,
                                        std::vector<ContactOutput>* outputs);

/// The function for a scene's law, with what the scene does not need left out of it.
PairForceFunction pair_force_function(const LawChoice& choice);

}  // namespace scree
