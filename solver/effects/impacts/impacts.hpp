// Impacts and what contacts dissipate, by pair of materials: sums since the start of the run, which no order of contacts, ranks or threads
// changes, so that frames and checkpoints have the same bits on any of them. Kept where the case asks for it (output.impacts).
//
//   impact        of a pair that begins to touch: no feature of it was within the margins one step before (beginning_of). Its energy is
//   that of
//                 the motion that the contact takes up, along the normals and along the surfaces: m v^2 / 2 with the reduced mass of two
//                 balls that meet head on. Each goes to the bin of its size.
//   dissipation   by cause: damping along the normal, friction (its damping included), rolling and torsional resistance. What springs of
//                 friction store is taken off when the sums are read: it is not lost.
//
// Each rank adds what its own bodies do, as for all that is dissipated (add_dissipation): ghosts have no velocities at the end of a step.
// The sums of all pairs are the dissipation of contacts in log.csv. Cost: per contact and step about a microsecond; kImpactBins x 176 bytes
// for each pair of materials and rank.
#pragma once

#include "solver/state/effect.hpp"

namespace scree {

EffectKind impacts_effect();

}  // namespace scree
