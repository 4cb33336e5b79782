#include "solver/run/watchdog.hpp"

#include <fcntl.h>
#include <signal.h>
#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cstring>
#include <new>

namespace scree {

namespace {

constexpr int kLooksPerLimit = 20;    // a stall is found at most 5 % late
constexpr double kLongestTick = 1;    // [s] also how long the end of a run may wait for the thread at most
constexpr int kLooksUntilSilent = 5;  // a process whose thread has not run for so many looks does not run

}  // namespace

Watchdog::Watchdog(const mpi::Communicator& comm, double limit, std::function<void(const std::string&)> stalled)
    : limit_(limit), stalled_(std::move(stalled)), rank_(comm.rank()), ranks_(comm.size()) {
  if (!(limit_ > 0)) return;
  mpi::on_all(comm, [&] { share_beats(comm); });
  beats_[local_rank_].rank = rank_;
  beats_[local_rank_].process = static_cast<std::int32_t>(getpid());
  // signals are the business of the rank itself
  sigset_t all, before;
  sigfillset(&all);
  pthread_sigmask(SIG_SETMASK, &all, &before);
  thread_ = std::thread([this] { watch(); });
  pthread_sigmask(SIG_SETMASK, &before, nullptr);
}

Watchdog::~Watchdog() {
  if (thread_.joinable()) {
    {
      const std::lock_guard lock(mutex_);
      stop_ = true;
    }
    wake_.notify_one();
    thread_.join();
  }
  if (beats_ != nullptr) munmap(beats_, sizeof(Beat) * static_cast<std::size_t>(local_ranks_));
}

/// Not an MPI window: freeing one is collective, and a rank that fails must be able to leave alone.
void Watchdog::share_beats(const mpi::Communicator& comm) {
  MPI_Comm machine = MPI_COMM_NULL;
  MPI_Comm_split_type(comm.get(), MPI_COMM_TYPE_SHARED, comm.rank(), MPI_INFO_NULL, &machine);
  MPI_Comm_rank(machine, &local_rank_);
  MPI_Comm_size(machine, &local_ranks_);
  char name[64] = {};
  const std::size_t bytes = sizeof(Beat) * static_cast<std::size_t>(local_ranks_);
  int file = -1;
  if (local_rank_ == 0) {
    std::snprintf(name, sizeof name, "/scree-watchdog-%d-%d", static_cast<int>(getuid()), static_cast<int>(getpid()));
    file = shm_open(name, O_CREAT | O_RDWR | O_TRUNC, 0600);
    if (file >= 0 && ftruncate(file, static_cast<off_t>(bytes)) != 0) {
      close(file);
      file = -1;
    }
  }
  MPI_Bcast(name, sizeof name, MPI_CHAR, 0, machine);
  if (local_rank_ != 0) file = shm_open(name, O_RDWR, 0600);
  void* memory = file < 0 ? MAP_FAILED : mmap(nullptr, bytes, PROT_READ | PROT_WRITE, MAP_SHARED, file, 0);
  const int reason = errno;
  if (file >= 0) close(file);
  MPI_Barrier(machine);
  if (local_rank_ == 0) shm_unlink(name);
  MPI_Comm_free(&machine);
  if (memory == MAP_FAILED) {
    throw SystemError("no shared memory for the watch on stalled ranks: {}; run with --stall-limit 0", std::strerror(reason));
  }
  beats_ = static_cast<Beat*>(memory);  // zeros, as the system gives them: valid atomics
}

void Watchdog::watch() {
  const double tick = std::min(limit_ / kLooksPerLimit, kLongestTick);
  // rank 0 speaks first, so that mostly one message is seen
  const double patience = limit_ + std::min(rank_, 2) * 1.0;
  std::int64_t seen = -1;
  double waited = 0;
  const auto count = static_cast<std::size_t>(local_ranks_);
  std::vector<std::int64_t> looks(count, -1);
  std::vector<int> silent(count, 0);
  std::unique_lock lock(mutex_);
  while (!wake_.wait_for(lock, std::chrono::duration<double>(tick), [this] { return stop_; })) {
    beats_[local_rank_].looks.fetch_add(1, std::memory_order_relaxed);
    for (std::size_t r = 0; r < count; ++r) {
      const std::int64_t now = beats_[r].looks.load(std::memory_order_relaxed);
      silent[r] = now == looks[r] ? silent[r] + 1 : 0;
      looks[r] = now;
    }
    const std::int64_t now = progress_.load(std::memory_order_relaxed);
    waited = now == seen ? waited + tick : 0;
    seen = now;
    if (waited < patience) continue;
    std::vector<std::int32_t> stopped;
    for (std::size_t r = 0; r < count; ++r) {
      if (silent[r] >= kLooksUntilSilent) stopped.push_back(static_cast<std::int32_t>(r));
    }
    stalled_(message(stopped));
    return;
  }
}

std::string Watchdog::message(const std::vector<std::int32_t>& silent) const {
  std::string text = fmt::format("rank {}: nothing has moved for {:g} s after step {}; ", rank_, limit_, step_.load());
  if (silent.empty()) {
    text += ranks_ > local_ranks_ ? "all ranks of this machine run: one of them, another machine or the disk is stuck"
                                  : "all ranks run: one of them or the disk is stuck";
  }
  for (const std::int32_t r : silent) {
    const Beat& beat = beats_[r];
    text += fmt::format("{}rank {} (process {}) does not run", r == silent.front() ? "" : ", ", beat.rank.load(), beat.process.load());
  }
  return text + "; continue with --restart latest, and with a larger --stall-limit if steps or outputs can take that long";
}

}  // namespace scree
