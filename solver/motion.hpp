// Motion: kick, drift, kick with world angular momentum, and a symmetric splitting of the free rotor.
//
// The rotor of a body without torque is split into five rotations about its principal axes (z/2 y/2 x y/2 z/2);
// each is exact, so the scheme is time-reversible and symplectic: no energy drift, angular momentum kept to
// rounding. Source: Dullweber, Leimkuhler & McLachlan, J. Chem. Phys. 107 (1997) 5840.
#pragma once

#include "solver/particle_set.hpp"

namespace scree {

/// v += force h / m, L += torque h for the owned, moving bodies.   Threads: parallel inside.
void kick(ParticleSet& p, double h);

/// x and q over a step h with v and L constant; refreshes w. Fixed bodies stay; locked ones only translate.
void drift(ParticleSet& p, double h);

/// One body's free rotation: q and w after h.
void rotate_freely(const Vec3& inverse_inertia, bool isotropic, double h, const Vec3& L, Quat& q, Vec3& w);

/// Kinetic energies [J] of one body.
double translational_energy(const ParticleSet& p, std::size_t i);
double rotational_energy(const ParticleSet& p, std::size_t i);

}  // namespace scree
