// Ends a run that no longer moves: with a message and an exit code, in place of ranks that wait for each other indefinitely.
#pragma once

#include <atomic>
#include <condition_variable>
#include <functional>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "solver/ranks/mpi_session.hpp"

namespace scree {

/// Calls `stalled` with a message when a rank has made no progress for `limit` seconds.
///
/// How: a thread beside each rank looks at the rank's progress a number of times within the limit, and counts looks, not time:
/// a job that is suspended as a whole and goes on later is not stalled. The thread makes no MPI call. It also shows the other
/// ranks of its machine, in shared memory, that its process runs, so that the message can name the one that does not.
/// Rank 0 speaks first, rank 1 a second later, the others after that: one message in most cases.
/// `stalled` is called from the thread, while the rank may be stuck in MPI: it must end the process without unwinding.
/// Fails: the constructor, which is collective, throws SystemError on every rank when there is no shared memory.
class Watchdog {
 public:
  /// in   limit   [s]; 0: no watch is kept, no thread is made
  Watchdog(const mpi::Communicator& comm, double limit, std::function<void(const std::string&)> stalled);
  Watchdog(const Watchdog&) = delete;
  Watchdog& operator=(const Watchdog&) = delete;
  ~Watchdog();

  /// To be called after every step and every output: a relaxed store.
  void progress(std::int64_t step) {
    step_.store(step, std::memory_order_relaxed);
    progress_.fetch_add(1, std::memory_order_relaxed);
  }

 private:
  /// One rank of this machine, as the others see it.
  struct Beat {
    std::atomic<std::int64_t> looks;
    std::atomic<std::int32_t> rank, process;
  };
  void share_beats(const mpi::Communicator& comm);
  void watch();
  std::string message(const std::vector<std::int32_t>& silent) const;

  double limit_;
  std::function<void(const std::string&)> stalled_;
  int rank_, ranks_, local_rank_ = 0, local_ranks_ = 1;
  Beat* beats_ = nullptr;
  std::atomic<std::int64_t> step_{0}, progress_{0};
  std::mutex mutex_;
  std::condition_variable wake_;
  bool stop_ = false;
  std::thread thread_;
};

}  // namespace scree
