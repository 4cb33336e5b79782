// The step size, derived from the stiffest contact that can occur.
#pragma once

#include <string>

#include "solver/mpi_session.hpp"
#include "solver/particle_set.hpp"

namespace scree {

struct StepSize {
  double step = 0;             ///< [s]
  double contact_time = 0;     ///< half period of the limiting contact [s]
  std::string limited_by;      ///< "boulder 17 (fels) on steel", for the user
  bool given = false;          ///< taken from the case
};

/// dt = pi / sqrt(k n^(2/q) W) / steps_per_contact, W = sum over both bodies of the largest inverse mass of a contact
/// anywhere on the surface, 1/m + max_r |[r]x^T I^-1 [r]x|, n = 4 features (a face on a face).
/// Source: CONTACT.md section 3.5, with the exact maximum in place of its bound R^2 / I_min, which slender bodies never
/// reach (a factor 2.6 for an elongated asteroid). Collective.
/// Throws UsageError when a given step is too large to be stable (less than 4 steps per contact).
StepSize derive_step_size(const mpi::Communicator& comm, const SolverScene& scene, const ParticleSet& p);

}  // namespace scree
