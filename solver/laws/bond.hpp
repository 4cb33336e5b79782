// The law of a bond: a potential of where two faces are with respect to each other, its exact derivatives, and when it breaks.
//
//   U = A/2 (k_n D_x^2 + k_t (D_y^2 + D_z^2)) + 1/2 (k_t J t_x^2 + k_n I_1 t_y^2 + k_n I_2 t_z^2)
//
//   D    from the centroid of the face on A to that on B, in the mean frame of both faces: half way between their orientations [m]
//   t    rotation vector of the face on B with respect to that on A [rad]; its components in either face's frame and in the mean one are
//   equal A    area; I_1, I_2 second moments about y and z; J = I_1 + I_2; x normal from A to B
//
// With v = sin(|t|/2) t/|t| and w = cos(|t|/2), the vector and scalar part of the relative rotation, and spins in the mean frame:
//
//   dt/dtime   = S (w_B - w_A),                   S = n n^T + s (1 - n n^T), s = (|t|/2) / sin(|t|/2)
//   mean spin  = (w_A + w_B)/2 - 1/2 r x (w_B - w_A),  r = tan(|t|/4) n = v / (1 + w)
//
// U depends on the configuration alone: nothing is summed over steps, a rigid motion of both bodies changes nothing, and the torques of the
// mean frame's turn make forces and torques those of U to rounding, so that momentum and angular momentum are kept. Damping takes the same
// way with the rates of D and t in place of D and t: it does nothing to a rigid motion of both.
// Source: the potential is that of rigid bodies and springs (T. Kawai, New discrete models and their application to seismic response
// analysis of structures, Nucl. Eng. Des. 48 (1978) 207) with the height between generators (J. Bolander, S. Saito, Eng. Fract. Mech. 61
// (1998) 569); mean frame and derivatives are derived here. Limits: |t| < pi.
#pragma once

#include <algorithm>
#include <cmath>

#include "core/geometry/vec3.hpp"
#include "core/storage/bond.hpp"

namespace scree {

/// A bond as the step reads it; arms and frames in the principal axes of its bodies.
struct BondLaw {
  Vec3 arm_a, arm_b;      ///< to the centroid of the face [m]
  Quat frame_a, frame_b;  ///< axes of the bond to principal axes
  Vec3 push, turn;        ///< stiffness of each component of D [N/m] and of t [N m]
  Vec3 push_damping;      ///< [N s/m]
  Vec3 turn_damping;      ///< [N m s]
};

/// Both bodies as they are now.
struct BondMotion {
  Vec3 branch;    ///< from the centre of A to that of B, of the nearest image [m]
  Quat q_a, q_b;  ///< principal axes to world
  Vec3 v_a, v_b, w_a, w_b;
};

/// World axes; torques about the centre of each body.
struct BondForce {
  Vec3 force_a, torque_a, torque_b;  ///< damping included; the force on B is -force_a
  Vec3 dissipative_force_a, dissipative_torque_a, dissipative_torque_b;
  Vec3 displacement, rotation;  ///< D [m] and t [rad]
  double energy = 0;            ///< U [J]
};

namespace bond_detail {

inline Vec3 times(const Vec3& a, const Vec3& b) { return {a.x * b.x, a.y * b.y, a.z * b.z}; }

/// The forces and torques that a force f and a moment m, conjugate to D and t, make on the bodies.
struct Spread {
  Vec3 force_a, torque_a, torque_b;
};

}  // namespace bond_detail

/// Forces of a bond.   Cost: about 400 flops.
inline BondForce bond_force(const BondLaw& law, const BondMotion& m) {
  using bond_detail::times;
  const Quat face_a = m.q_a * law.frame_a, face_b = m.q_b * law.frame_b;
  Quat relative = conjugate(face_a) * face_b;
  if (relative.w < 0) relative = {-relative.w, -relative.x, -relative.y, -relative.z};
  const Vec3 v{relative.x, relative.y, relative.z};
  const double sine = length(v), w = relative.w;
  // (|t|/2) / sin(|t|/2); below 1e-4 the next term of the series is beneath rounding
  const double s = sine < 1e-4 ? 1 + sine * sine / 6 : std::atan2(sine, w) / sine;
  const Vec3 n = sine > 0 ? (1 / sine) * v : Vec3{}, r = (1 / (1 + w)) * v;
  // half the relative rotation, from face A on
  const Quat half = normalised(Quat{1 + w, v.x, v.y, v.z});
  const Mat3 mean = matrix_of(face_a * half);  // mean frame to world

  const Vec3 arm_a = rotate(m.q_a, law.arm_a), arm_b = rotate(m.q_b, law.arm_b);
  const Vec3 gap = m.branch + arm_b - arm_a;

  BondForce out;
  out.displacement = transpose_times(mean, gap);
  out.rotation = (2 * s) * v;
  const Vec3 &d = out.displacement, &t = out.rotation;
  const auto along_s = [&](const Vec3& x) { return s * x + ((1 - s) * dot(n, x)) * n; };
  const auto spread = [&](const Vec3& f, const Vec3& moment) {
    const Vec3 twist = cross(d, f), skew = 0.5 * cross(twist, r), straight = along_s(moment);
    const Vec3 force = mean * f;
    return bond_detail::Spread{force, cross(arm_a, force) + mean * (0.5 * twist + skew + straight),
                               mean * (0.5 * twist - skew - straight) - cross(arm_b, force)};
  };
  const Vec3 f = times(law.push, d), moment = times(law.turn, t);
  out.energy = 0.5 * (dot(f, d) + dot(moment, t));
  const bond_detail::Spread elastic = spread(f, moment);
  out.force_a = elastic.force_a;
  out.torque_a = elastic.torque_a;
  out.torque_b = elastic.torque_b;
  if (law.push_damping.x == 0) return out;
  const Vec3 w_a = transpose_times(mean, m.w_a), w_b = transpose_times(mean, m.w_b), spin = w_b - w_a;
  const Vec3 mean_spin = 0.5 * (w_a + w_b) - 0.5 * cross(r, spin);
  const Vec3 velocity = (m.v_b + cross(m.w_b, arm_b)) - (m.v_a + cross(m.w_a, arm_a));
  const Vec3 d_rate = transpose_times(mean, velocity) - cross(mean_spin, d);
  const bond_detail::Spread lost = spread(times(law.push_damping, d_rate), times(law.turn_damping, along_s(spin)));
  out.dissipative_force_a = lost.force_a;
  out.dissipative_torque_a = lost.torque_a;
  out.dissipative_torque_b = lost.torque_b;
  out.force_a += lost.force_a;
  out.torque_a += lost.torque_a;
  out.torque_b += lost.torque_b;
  return out;
}

/// Stresses of a bond [Pa].
struct BondStress {
  double mean = 0;   ///< along the normal, over the face; tension > 0
  double rim = 0;    ///< the same with what bending adds at the farthest point of the rim
  double shear = 0;  ///< with what torsion adds there
};

inline BondStress bond_stress(const Bond& bond, const Vec3& displacement, const Vec3& rotation) {
  BondStress stress;
  stress.mean = bond.normal_stiffness * displacement.x;
  stress.rim = stress.mean + bond.normal_stiffness * bond.rim_radius * std::hypot(rotation.y, rotation.z);
  stress.shear = bond.tangential_stiffness * (std::hypot(displacement.y, displacement.z) + std::abs(rotation.x) * bond.rim_radius);
  return stress;
}

/// The part of U that opens a bond or lets it slide [J]; what presses its faces together opens no crack. Under pressure bending counts by
/// the part of the face that it opens: of a strip from -r to r that turns by t, pressed by p, the points beyond p / t open, with the share
/// (1 - p / (t r))^3 of the energy that they have without pressure.
inline double opening_energy(const Bond& bond, const BondForce& force) {
  const double pressed = -force.displacement.x;
  if (!(pressed > 0)) return force.energy;
  const Vec3& t = force.rotation;
  const double rim = bond.rim_radius * std::hypot(t.y, t.z);
  const double closed = rim > pressed ? pressed / rim : 1, open = 1 - closed;
  const double normal = bond.area * pressed * pressed, bending = bond.moment_1 * t.y * t.y + bond.moment_2 * t.z * t.z;
  return force.energy - 0.5 * bond.normal_stiffness * (normal + bending * (1 - open * open * open));
}

/// Share of what the bond holds that it is loaded to: it breaks from 1 on. Tension at the rim; shear against cohesion and friction of the
/// mean pressure (Mohr and Coulomb); energy of opening and sliding of each area.
inline double bond_load(const Bond& bond, const BondForce& force) {
  const BondStress stress = bond_stress(bond, force.displacement, force.rotation);
  const double shear_strength = bond.cohesion - bond.friction * stress.mean;
  // where tension has used up cohesion, no shear at all is held
  const double shear = shear_strength > 0 ? stress.shear / shear_strength : kNeverBreaks;
  return std::max({stress.rim / bond.tension, shear, opening_energy(bond, force) / (bond.fracture_energy * bond.area)});
}

}  // namespace scree
