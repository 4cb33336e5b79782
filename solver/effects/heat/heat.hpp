// Heat: each body has one temperature, contacts and gas in gaps conduct (conductance.hpp, gas_gaps.hpp), walls and sources give or take,
// and what contacts dissipate may heat the bodies (contact_losses.hpp).
//
// Scheme: after the second kick of a step, with the conductances of its forces held for the step, Heun's method: two Euler steps, averaged.
// It is of second order, and as an average of what two Euler steps can reach it keeps temperatures between those of bodies and walls
// (maximum principle) up to the critical step of Euler's: the smallest m c / H over bodies, H the sum over the contacts of the body. A step
// beyond that ends the run. Conductances vary over the steps of a contact; taken at the end of each, their sum over a contact that begins
// and ends is that of the trapezoidal rule. What flows through a pair is computed by both owners from the same bits; each adds it to its
// own body, in the order of pairs: contacts first, then gaps. Sums over the scene are exact: the same bits on any number of ranks and
// threads. Temperatures keep what rounding takes from them (temperature_remainder): what flows in a step may be far below one unit in their
// last place.
//
// Tables over time: walls have the temperature of the beginning of the step in the first of both steps, and that of its end in the second;
// sources and fluxes give the integral of the table over the step, so that their sum is that of the table.
//
// Bodies asleep go on conducting: neither side moves, and the conductance is that of the contact where it is (visit_pairs).
//
// In a scene whose bodies stay as they are (heat.frozen), conductances are computed once, at the start and again at a restart, and bound()
// sets the step.
//
// Friction heat is counted as dissipation is: the forces of a step act over a whole step around it, so that half of the last one lies ahead
// when totals are read. What friction springs store is no heat until it is given up.
//
// A program that steps the run can give each body a source and a medium (outer_heat.hpp).
//
// Source: HEUN, K., Z. Math. Phys. 45 (1900) 23; conduction as in conductance.hpp.   Limits: no radiation; one temperature a body, which
// holds for Biot numbers below 0.1 (the log has the largest).
#pragma once

#include "solver/state/effect.hpp"

namespace scree {

EffectKind heat_effect();

}  // namespace scree
