#include "solver/ranks/failure.hpp"

namespace scree {

void FirstFailure::keep(const Error& error, std::int64_t step) {
  if (error_) return;
  error_ = std::make_unique<Error>(error);
  step_ = step;
}

void FirstFailure::agree(const mpi::Communicator& comm) const {
  // A failed rank goes on with a state that means nothing, which others may stumble over: the first failure counts.
  constexpr double kNone = 1e300;
  const auto step = static_cast<double>(step_);
  const double first = -comm.max(error_ ? -step : -kNone);
  mpi::agree(comm, error_ && step <= first ? error_.get() : nullptr);
}

}  // namespace scree
