// MPI handles that own what they hold, and the few collective helpers the solver needs.
#pragma once

#include <mpi.h>

#include <algorithm>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "core/base/error.hpp"
#include "core/base/mpi_session.hpp"

namespace scree::mpi {

/// An own duplicate of a communicator, by default of the world; errors of MPI stop the job with exit code 4.
class Communicator {
 public:
  Communicator();
  /// A duplicate of another one, whose ranks all call it.
  explicit Communicator(MPI_Comm other);
  ~Communicator();
  Communicator(const Communicator&) = delete;
  Communicator& operator=(const Communicator&) = delete;
  MPI_Comm get() const { return handle_; }
  int rank() const { return rank_; }
  int size() const { return size_; }

  double sum(double value) const;
  double max(double value) const;
  std::int64_t sum(std::int64_t value) const;
  /// Sums entry by entry, the same bits on every rank.
  void sum(std::vector<double>& values) const;

  /// Sends element block r of `outgoing` to rank r; returns what came, by sender. T is plain data. Collective, but ranks that
  /// have nothing for each other exchange nothing.
  template <class T>
  std::vector<std::vector<T>> exchange(const std::vector<std::vector<T>>& outgoing) const {
    return typed_blocks<T>(exchange_bytes(byte_blocks(outgoing)));
  }

  /// What all ranks give, rank after rank, on every rank. T is plain data. Collective.   Cost: as exchange(), each block to every rank.
  template <class T>
  std::vector<T> of_all(const std::vector<T>& mine) const {
    if (size_ == 1) return mine;
    std::vector<T> all;
    for (const std::vector<T>& block : exchange(std::vector<std::vector<T>>(static_cast<std::size_t>(size_), mine)))
      all.insert(all.end(), block.begin(), block.end());
    return all;
  }

  /// Sends block n to rank partners[n] and returns its answer. The partners must name this rank likewise; no other rank takes part.
  template <class T>
  std::vector<std::vector<T>> exchange(std::span<const int> partners, const std::vector<std::vector<T>>& outgoing) const {
    return typed_blocks<T>(exchange_with(partners, byte_blocks(outgoing)));
  }

 private:
  template <class T>
  static std::vector<std::vector<char>> byte_blocks(const std::vector<std::vector<T>>& blocks) {
    std::vector<std::vector<char>> raw(blocks.size());
    for (std::size_t r = 0; r < blocks.size(); ++r) {
      const char* first = reinterpret_cast<const char*>(blocks[r].data());
      raw[r].assign(first, first + blocks[r].size() * sizeof(T));
    }
    return raw;
  }
  template <class T>
  static std::vector<std::vector<T>> typed_blocks(const std::vector<std::vector<char>>& raw) {
    std::vector<std::vector<T>> blocks(raw.size());
    for (std::size_t r = 0; r < raw.size(); ++r) {
      blocks[r].resize(raw[r].size() / sizeof(T));
      std::copy(raw[r].begin(), raw[r].end(), reinterpret_cast<char*>(blocks[r].data()));
    }
    return blocks;
  }
  std::vector<std::vector<char>> exchange_bytes(const std::vector<std::vector<char>>& outgoing) const;
  std::vector<std::vector<char>> exchange_with(std::span<const int> partners, const std::vector<std::vector<char>>& outgoing) const;
  int message_size(std::size_t bytes) const;

  MPI_Comm handle_ = MPI_COMM_NULL;
  int rank_ = 0, size_ = 1;
  mutable unsigned exchanges_ = 0;  // so far, the same on every rank
};

/// Runs `action` on rank 0 alone; when it throws, every rank throws the same error (only rank 0's is printed).
void on_root(const Communicator& comm, const std::function<void()>& action);

/// Runs `action` on every rank; when it throws on any of them, every rank throws and one of them tells. An action that is
/// itself collective has to fail on all ranks together.
void on_all(const Communicator& comm, const std::function<void()>& action);

/// Known to all ranks: each throws it at the same place. Any other error leaves the other ranks waiting, unless the job is stopped.
class AgreedError : public Error {
 public:
  explicit AgreedError(const Error& error) : Error(error) {}
};

/// Thrown on the other ranks, with the same text and exit code, so that one failure is printed once.
class SilentError : public AgreedError {
 public:
  SilentError(ExitCode code, const std::string& message) : AgreedError(Error(code, message)) {}
};

/// Throws on every rank when one of them holds an error: the lowest such rank's message is the one that is told, by AgreedError.
void agree(const Communicator& comm, const Error* mine);

}  // namespace scree::mpi
