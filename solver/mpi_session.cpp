#include "solver/mpi_session.hpp"

#include <algorithm>
#include <climits>
#include <memory>

namespace scree::mpi {

Session::Session(int& argc, char**& argv) {
  int provided = 0;
  MPI_Init_thread(&argc, &argv, MPI_THREAD_FUNNELED, &provided);
  if (provided < MPI_THREAD_FUNNELED) throw SystemError("this MPI library does not allow threads (MPI_THREAD_FUNNELED)");
}

Session::~Session() {
  int finalized = 0;
  MPI_Finalized(&finalized);
  if (!finalized) MPI_Finalize();
}

Communicator::Communicator() {
  MPI_Comm_dup(MPI_COMM_WORLD, &handle_);
  MPI_Comm_rank(handle_, &rank_);
  MPI_Comm_size(handle_, &size_);
}

Communicator::~Communicator() {
  if (handle_ != MPI_COMM_NULL) MPI_Comm_free(&handle_);
}

double Communicator::sum(double value) const {
  double result = 0;
  MPI_Allreduce(&value, &result, 1, MPI_DOUBLE, MPI_SUM, handle_);
  return result;
}

double Communicator::max(double value) const {
  double result = 0;
  MPI_Allreduce(&value, &result, 1, MPI_DOUBLE, MPI_MAX, handle_);
  return result;
}

std::int64_t Communicator::sum(std::int64_t value) const {
  std::int64_t result = 0;
  MPI_Allreduce(&value, &result, 1, MPI_INT64_T, MPI_SUM, handle_);
  return result;
}

std::vector<std::vector<char>> Communicator::exchange_bytes(const std::vector<std::vector<char>>& outgoing) const {
  const auto ranks = static_cast<std::size_t>(size_);
  SCREE_ASSERT(outgoing.size() == ranks, "{} blocks for {} ranks", outgoing.size(), ranks);
  std::vector<std::int64_t> send_sizes(ranks), receive_sizes(ranks);
  for (std::size_t r = 0; r < ranks; ++r) send_sizes[r] = static_cast<std::int64_t>(outgoing[r].size());
  MPI_Alltoall(send_sizes.data(), 1, MPI_INT64_T, receive_sizes.data(), 1, MPI_INT64_T, handle_);
  std::vector<std::vector<char>> incoming(ranks);
  std::vector<MPI_Request> requests;
  constexpr int kTag = 17;
  for (std::size_t r = 0; r < ranks; ++r) {
    if (receive_sizes[r] == 0) continue;
    if (receive_sizes[r] > INT_MAX) throw SystemError("rank {}: a message of {} bytes; use more ranks", rank_, receive_sizes[r]);
    incoming[r].resize(static_cast<std::size_t>(receive_sizes[r]));
    MPI_Irecv(incoming[r].data(), static_cast<int>(receive_sizes[r]), MPI_BYTE, static_cast<int>(r), kTag, handle_, &requests.emplace_back());
  }
  for (std::size_t r = 0; r < ranks; ++r) {
    if (outgoing[r].empty()) continue;
    MPI_Isend(outgoing[r].data(), static_cast<int>(outgoing[r].size()), MPI_BYTE, static_cast<int>(r), kTag, handle_, &requests.emplace_back());
  }
  MPI_Waitall(static_cast<int>(requests.size()), requests.data(), MPI_STATUSES_IGNORE);
  return incoming;
}

void agree(const Communicator& comm, const Error* mine) {
  // Code of the lowest failing rank, found with one reduction: rank * 1000 + code, smallest wins.
  const int none = INT_MAX;
  int key = mine == nullptr ? none : comm.rank() * 1000 + static_cast<int>(mine->code());
  int lowest = none;
  MPI_Allreduce(&key, &lowest, 1, MPI_INT, MPI_MIN, comm.get());
  if (lowest == none) return;
  const int teller = lowest / 1000;
  const bool tells = mine != nullptr && teller == comm.rank();
  std::string message = tells ? mine->what() : "";
  int size = static_cast<int>(message.size());
  MPI_Bcast(&size, 1, MPI_INT, teller, comm.get());
  message.resize(static_cast<std::size_t>(size));
  MPI_Bcast(message.data(), size, MPI_CHAR, teller, comm.get());
  if (tells) throw Error(*mine);
  throw SilentError(static_cast<ExitCode>(lowest % 1000), message);
}

void on_root(const Communicator& comm, const std::function<void()>& action) {
  std::unique_ptr<Error> error;
  if (comm.rank() == 0) {
    try {
      action();
    } catch (const Error& e) {
      error = std::make_unique<Error>(e);
    }
  }
  agree(comm, error.get());
}

}  // namespace scree::mpi
