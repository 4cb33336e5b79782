// Motion: how a step moves the bodies, and five ways to turn a body without torque.
//
//   kdk-dlm    kick, drift, kick with world angular momentum; free rotor by five exact rotations about the principal
//              axes (z/2 y/2 x y/2 z/2): reversible and symplectic, no energy drift, momentum kept to rounding.
//              Source: Dullweber, Leimkuhler & McLachlan, J. Chem. Phys. 107 (1997) 5840. The default.
//   midpoint   the same kicks; free rotor by one rotation h I^-1 l, l the body momentum at the middle of that rotation
//              (implicit, fixed point). Source: the class of Simo & Wong, Int. J. Numer. Meth. Eng. 31 (1991) 19.
//   rig        the same kicks; explicit body angular velocity. Source: Koziara & Bicanic, Int. J. Numer. Meth. Eng. 81
//              (2010) 1073, as in the seed's code. Gains energy and momentum slowly.
//   spiral     the same kicks; SSPRK3 of Euler's equations, one rotation by the half-step angular velocity. Source: del
//              Valle et al., SPIRAL (2023). Loses energy slowly.
//   euler      the seed's explicit Euler: position and orientation by the old velocities, velocities by the old forces.
//              Gains energy at every contact; for comparison only.
//
// Departure of rig, midpoint and spiral from their sources: torque acts in the kicks, so that all schemes but euler share
// one loop, one force evaluation a step and the same translation, and differ in the free rotation alone. All of them
// turn isotropic bodies and bodies without rotation alike, by one exact rotation or none.
#pragma once

#include "core/storage/scene_words.hpp"
#include "solver/bodies/particle_set.hpp"

namespace scree {

class FluidForces;

/// The part of a step before the forces are evaluated: x and q reach the full step; v and L the half step (euler: the
/// full step). Fixed bodies stay; locked ones only translate. A fluid, where there is one, takes part in the kicks.
/// Threads: parallel inside.
void begin_step(Integrator integrator, ParticleSet& p, double h, const FluidForces* fluid = nullptr);

/// The part after: v and L reach the full step; w follows.
void end_step(Integrator integrator, ParticleSet& p, double h, const FluidForces* fluid = nullptr);

/// One body's free rotation: q with its remainder, L and w after h. L changes (in rounding at least) with rig and spiral only.
void rotate_freely(Integrator integrator, const Vec3& inertia, const Vec3& inverse_inertia, bool isotropic, double h, Vec3& L, Quat& q,
                   Quat& remainder, Vec3& w);

/// Rotation by the vector theta [rad]: the exponential map, a unit quaternion for every finite theta, 0 and denormals too.
Quat rotation_by(const Vec3& theta);

/// Kinetic energies [J] of one body.
double translational_energy(const ParticleSet& p, std::size_t i);
double rotational_energy(const ParticleSet& p, std::size_t i);

}  // namespace scree
