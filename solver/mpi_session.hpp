// MPI handles that own what they hold, and the few collective helpers the solver needs.
#pragma once

#include <mpi.h>

#include <functional>
#include <vector>

#include "core/base/error.hpp"

namespace scree::mpi {

/// MPI_Init and MPI_Finalize. The first local of main().
class Session {
 public:
  Session(int& argc, char**& argv);
  ~Session();
  Session(const Session&) = delete;
  Session& operator=(const Session&) = delete;
};

/// An own duplicate of the world communicator; errors of MPI stop the job with exit code 4.
class Communicator {
 public:
  Communicator();
  ~Communicator();
  Communicator(const Communicator&) = delete;
  Communicator& operator=(const Communicator&) = delete;
  MPI_Comm get() const { return handle_; }
  int rank() const { return rank_; }
  int size() const { return size_; }

  double sum(double value) const;
  double max(double value) const;
  std::int64_t sum(std::int64_t value) const;

  /// Sends element block r of `outgoing` to rank r; returns what came, by sender. T is plain data.
  template <class T>
  std::vector<std::vector<T>> exchange(const std::vector<std::vector<T>>& outgoing) const {
    std::vector<std::vector<char>> raw(outgoing.size());
    for (std::size_t r = 0; r < outgoing.size(); ++r) {
      const char* first = reinterpret_cast<const char*>(outgoing[r].data());
      raw[r].assign(first, first + outgoing[r].size() * sizeof(T));
    }
    const std::vector<std::vector<char>> received = exchange_bytes(raw);
    std::vector<std::vector<T>> result(received.size());
    for (std::size_t r = 0; r < received.size(); ++r) {
      result[r].resize(received[r].size() / sizeof(T));
      std::copy(received[r].begin(), received[r].end(), reinterpret_cast<char*>(result[r].data()));
    }
    return result;
  }

 private:
  std::vector<std::vector<char>> exchange_bytes(const std::vector<std::vector<char>>& outgoing) const;

  MPI_Comm handle_ = MPI_COMM_NULL;
  int rank_ = 0, size_ = 1;
};

/// Runs `action` on rank 0 alone; when it throws, every rank throws the same error (only rank 0's is printed).
void on_root(const Communicator& comm, const std::function<void()>& action);

/// Thrown on the other ranks, with the same text and exit code, so that one failure is printed once.
class SilentError : public Error {
 public:
  SilentError(ExitCode code, const std::string& message) : Error(code, message) {}
};

/// Throws on every rank when one of them holds an error: the lowest such rank's message is the one that is told.
void agree(const Communicator& comm, const Error* mine);

}  // namespace scree::mpi
