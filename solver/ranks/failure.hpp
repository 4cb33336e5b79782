// The first error of a rank, kept until all ranks stop together: one that stopped by itself would leave the others waiting.
#pragma once

#include <cstdint>
#include <memory>

#include "solver/ranks/mpi_session.hpp"

namespace scree {

/// After a failure the state of a rank means nothing; its messages go on for a step or two, until all ranks know.
class FirstFailure {
 public:
  /// Keeps the error, unless there is one already.
  void keep(const Error& error, std::int64_t step);
  /// Runs `action` and keeps what it throws.
  template <class Action>
  void watch(std::int64_t step, Action&& action) {
    try {
      action();
    } catch (const Error& error) {
      keep(error, step);
    }
  }
  bool exists() const { return error_ != nullptr; }

  /// Throws on every rank when one of them holds an error: that of the earliest step. Collective.
  void agree(const mpi::Communicator& comm) const;

 private:
  std::unique_ptr<Error> error_;
  std::int64_t step_ = 0;
};

}  // namespace scree
