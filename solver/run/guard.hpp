// Stops a run whose numbers cannot be trusted: energy that came from nowhere.
#pragma once

#include "solver/run/checkpoint.hpp"

namespace scree {

/// The contact that limits the step, for the user: walls by their names.
std::string name_of(const CriticalStep& critical, const SolverScene& scene);

/// Follows the rows of the log and keeps what a run records of them: worst values, last values, sums.
class Guard {
 public:
  /// in   before   the record of the parts of this run before this one; empty for a run from the scene
  Guard(const mpi::Communicator& comm, const SolverScene& scene, const RunRecord& before);

  /// Takes the energies that the run begins with. Collective.
  /// in   is_fresh   the run begins at the scene: they are what the balance is measured from
  void begin(const Simulation& simulation, bool is_fresh);

  /// Takes in a row: its energies, the largest overlap over margin and the imbalance of its steps, the critical step of its contacts.
  /// Returns the error of the energy balance [J].
  double add_row(const Energies& energies, double overlap_ratio, double imbalance, const CriticalStep& critical);
  /// The largest overlap over margin of steps after the last row.
  void add_overlap(double ratio);

  /// Throws RunInvalid on every rank when energy grew without a cause, or when damping and friction gave some back. Collective.
  /// in   energy_error   of the last row [J]
  void check(const Simulation& simulation, double energy_error) const;

  /// Rows so far; what is not of the rows is that of the parts before this one.
  const RunRecord& record() const { return record_; }

 private:
  double energy_scale() const;  // all that was in motion or stored [J]

  const mpi::Communicator& comm_;
  const SolverScene& scene_;
  RunRecord record_;
  double bond_rounding_ = 0;  // that rounded places leave in bonds [J]
};

}  // namespace scree
