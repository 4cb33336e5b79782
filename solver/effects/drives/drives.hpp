// Walls that answer to force: servos, free parts and motors (core/storage/wall_motion.hpp). Each has one way to go, and all ranks move it
// alike: the forces of its contacts are summed exactly, so that neither ranks nor threads change a bit.
//
// A part with an inertia is integrated as bodies are (kick, drift, kick), damping by its mean over the step:
//
//   rate' = rate (1 - z) + dt/2 a,  way += dt rate',  rate = (rate' + dt/2 a) / (1 + z),  z = damping dt / (2 inertia)
//
// A servo has none. Its rate makes up for a share of what is missing of its force F within the time of a contact, by the impedance Z of its
// contacts:
//
//   rate' = v + share (F - F_contacts) / Z, at most the speed that it is given; that speed while nothing touches it
//
// Z is the sum of pi sqrt(k m) over the contacts: of k, the stiffest that is expected of the pair (law.step_stiffness), over the time of a
// contact of the body's mass m, pi sqrt(m/k), each along the way of the wall. v is the rate at which what touches the wall gives way, so
// that the force does not lag behind where bodies flow: the mean by stiffness of the velocities of the surfaces in contact. With both, the
// force of a contact comes to F as exp(-share t / T), however its body moves. In a step in place of T it would swing: contacts damp with 2
// zeta sqrt(k m), which at a rate of dF / (k dt) is many times dF where dt is a small part of T; with Z it is at most share 2 zeta / pi of
// dF. Softer contacts than expected (Hertz under a light load), and bodies behind those that touch, come nearer more slowly.
//
// Source: the controllers of Yade (TriaxialStressController) and LIGGGHTS (mesh/surface/stress/servo), with the contacts' own impedance.
#pragma once

#include "solver/state/effect.hpp"

namespace scree {

/// The states of the walls are RunState::drives: the places of walls follow from them.
EffectKind drives_effect();

}  // namespace scree
