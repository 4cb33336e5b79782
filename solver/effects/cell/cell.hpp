// A periodic cell under stress and strain ([cell] of a case).
//
// Each axis keeps its length h, or changes it at a given rate, or moves so that its stress tends to a target. The last has an equation of
// motion of its own, with L = (dh/dt) / h, the stress sigma that is measured (cell_sums.hpp) and the target p, compression positive:
//
//   W dL/dt = V (sigma - p) - W gamma (L - r),   W = M h^2 / pi^2,   gamma = sqrt(2) pi^2 a / (h t_c)
//   dr/dt = (L - r) V min(s, p) / (0.01 W gamma),   ds/dt = (sigma - s) V p / (0.01 W gamma),   r = 0, s = sigma at the start
//
// with the mass M and number N of all bodies, their spacing a = (V / N)^(1/3), and the time t_c of the contact that limits the step. W is
// the inertia of a specimen of that mass with free faces: its slowest wave along the axis has omega^2 = pi^2 C / (rho h^2), which is V C /
// W for any stiffness C. gamma damps critically what has the wave speed of a chain of equal balls with such contacts, a omega / sqrt(2),
// omega = pi / t_c. So neither has to be asked for. In a gas without contacts the cell shrinks at the inertial number
// L d sqrt(rho / p) ~ (d / h) sqrt(p / C), far below 1.
//
// r is the rate that the cell has for long, and the damping leaves it alone: else a bed that is sheared would hold its lateral stress off
// the target for good, by V^-1 W gamma L (84 % in validation case Z5). It follows in the time in which the stress would move the damped
// cell by a strain of 0.01, which is longer than what oscillates. s, a mean of the stress over the shortest such time, keeps r at rest in
// a gas. With sigma itself in its place r would follow L most where sigma is above p, and the mean stress would lie below the target, by
// the mean of min(sigma - p, 0)^2 over p^2.
//
// Energy: the cell does the work -V sigma_ij L_ij on its bodies, contacts and motion together. What its own inertia and damping have lies
// between target and stress, and is no part of the balance. Of friction and damping, the part by L times the branch is counted here, that
// by the velocities of bodies with the bodies.
#pragma once

#include "solver/state/effect.hpp"

namespace scree {

EffectKind cell_effect();

}  // namespace scree
