// What all ranks must know of each other at a step, agreed without making anybody wait.
//
// Everything travels in one reduction, which is started in one step and finished in the next: the forces of a whole step hide
// it, and a rank that is late once holds up no other rank. What is learned is therefore one step old; whoever gives the report
// looks one step ahead (see NeighbourLists::look).
#pragma once

#include <cstdint>
#include <memory>
#include <optional>

#include "solver/ranks/mpi_session.hpp"

namespace scree {

/// Of one rank before, of all ranks after the reduction.
struct StepReport {
  // the largest of all ranks
  std::int64_t rebuild = 0;       ///< body lists must be rebuilt
  std::int64_t signal = 0;        ///< number of a signal that asks to stop
  std::int64_t failed = 0;        ///< a rank holds an error
  std::int64_t checkpoint = 0;    ///< number of the checkpoint that rank 0 asks for, see Requests
  std::int64_t largest_work = 0;  ///< computing time since the last cut [ns]
  std::int64_t cut_cost = 0;      ///< of the last cut and what it moved [ns]
  double fastest = 0;             ///< speed of the fastest body [m/s]
  // the sum over the ranks
  std::int64_t work = 0;  ///< computing time since the last cut [ns]
};

class Agreement {
 public:
  explicit Agreement(const mpi::Communicator& comm);
  ~Agreement();
  Agreement(const Agreement&) = delete;
  Agreement& operator=(const Agreement&) = delete;

  /// Gives this rank's report. Every rank calls it once a step; no rank waits.
  void start(const StepReport& mine);
  /// What start() of all ranks gave.
  StepReport finish();
  /// Finishes what is under way; take() has it later.
  void finish_early();
  /// Whether there is a report that was started before and not finished then.
  bool has_report() const { return early_ || is_under_way(); }
  /// That report.
  StepReport take();
  bool is_under_way() const { return request_ != MPI_REQUEST_NULL; }

 private:
  const mpi::Communicator& comm_;
  MPI_Datatype type_ = MPI_DATATYPE_NULL;
  MPI_Op op_ = MPI_OP_NULL;
  MPI_Request request_ = MPI_REQUEST_NULL;
  std::optional<StepReport> early_;
  struct Buffers {
    StepReport mine, all;
  };
  std::unique_ptr<Buffers> buffers_;
};

}  // namespace scree
