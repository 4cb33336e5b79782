// Bonds as the critical step takes them.
#pragma once

#include "solver/neighbours/bond_list.hpp"
#include "solver/step_size/critical_step.hpp"

namespace scree {

/// A bond, linearised.
PairStiffness linearise(const BondList& bonds, const ListedBond& bond, const ParticleSet& p);

/// Longest stable step of the bonds of a scene as it starts, all holding [s], and whose it is; infinite without bonds.
CriticalStep critical_step_of_bonds(const SolverScene& scene);

}  // namespace scree
