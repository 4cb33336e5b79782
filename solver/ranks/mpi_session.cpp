#include "solver/ranks/mpi_session.hpp"

#include <algorithm>
#include <climits>
#include <memory>

namespace scree::mpi {

namespace {

std::vector<char> receive_matched(MPI_Message message, MPI_Status& status) {
  int bytes = 0;
  MPI_Get_count(&status, MPI_BYTE, &bytes);
  std::vector<char> block(static_cast<std::size_t>(bytes));
  MPI_Mrecv(block.data(), bytes, MPI_BYTE, &message, MPI_STATUS_IGNORE);
  return block;
}

}  // namespace

Communicator::Communicator() : Communicator(MPI_COMM_WORLD) {}

Communicator::Communicator(MPI_Comm other) {
  MPI_Comm_dup(other, &handle_);
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

void Communicator::sum(std::vector<double>& values) const {
  // added on one rank, since the order of an MPI_Allreduce may differ from rank to rank
  std::vector<double> total(values.size());
  MPI_Reduce(values.data(), total.data(), static_cast<int>(values.size()), MPI_DOUBLE, MPI_SUM, 0, handle_);
  MPI_Bcast(total.data(), static_cast<int>(total.size()), MPI_DOUBLE, 0, handle_);
  values = std::move(total);
}

// Nobody knows how much it will receive, and from whom. A synchronous send completes when it is received; a rank whose sends
// are complete enters a barrier that does not wait, and goes on receiving until all ranks have entered it: then nothing is
// left on its way. Sizes come with the messages. Cost: O(partners) messages and O(log ranks) for the barrier.
// Source: Hoefler, Siebert, Lumsdaine, Scalable communication protocols for dynamic sparse data exchange, PPoPP 2010 (NBX).
std::vector<std::vector<char>> Communicator::exchange_bytes(const std::vector<std::vector<char>>& outgoing) const {
  const auto ranks = static_cast<std::size_t>(size_);
  SCREE_ASSERT(outgoing.size() == ranks, "{} blocks for {} ranks", outgoing.size(), ranks);
  // A rank may still look for messages when its neighbour is one exchange ahead, never two: two tags keep them apart.
  constexpr int kTags[2] = {17, 18};
  const int tag = kTags[exchanges_++ % 2];
  std::vector<std::vector<char>> incoming(ranks);
  std::vector<MPI_Request> sends;
  for (std::size_t r = 0; r < ranks; ++r) {
    if (outgoing[r].empty()) continue;
    if (static_cast<int>(r) == rank_) {
      incoming[r] = outgoing[r];
      continue;
    }
    MPI_Issend(outgoing[r].data(), message_size(outgoing[r].size()), MPI_BYTE, static_cast<int>(r), tag, handle_, &sends.emplace_back());
  }
  MPI_Request barrier = MPI_REQUEST_NULL;
  for (int done = 0; done == 0;) {
    int found = 0;
    MPI_Message message = MPI_MESSAGE_NULL;
    MPI_Status status;
    MPI_Improbe(MPI_ANY_SOURCE, tag, handle_, &found, &message, &status);
    if (found != 0) incoming[static_cast<std::size_t>(status.MPI_SOURCE)] = receive_matched(message, status);
    if (barrier == MPI_REQUEST_NULL) {
      int sent = 0;
      MPI_Testall(static_cast<int>(sends.size()), sends.data(), &sent, MPI_STATUSES_IGNORE);
      if (sent != 0) MPI_Ibarrier(handle_, &barrier);
    } else {
      MPI_Test(&barrier, &done, MPI_STATUS_IGNORE);
    }
  }
  return incoming;
}

std::vector<std::vector<char>> Communicator::exchange_with(std::span<const int> partners,
                                                           const std::vector<std::vector<char>>& outgoing) const {
  SCREE_ASSERT(outgoing.size() == partners.size(), "{} blocks for {} partners", outgoing.size(), partners.size());
  constexpr int kTag = 19;
  std::vector<MPI_Request> sends(partners.size());
  for (std::size_t n = 0; n < partners.size(); ++n) {
    MPI_Isend(outgoing[n].data(), message_size(outgoing[n].size()), MPI_BYTE, partners[n], kTag, handle_, &sends[n]);
  }
  std::vector<std::vector<char>> incoming;
  for (const int partner : partners) {
    MPI_Message message = MPI_MESSAGE_NULL;
    MPI_Status status;
    MPI_Mprobe(partner, kTag, handle_, &message, &status);
    incoming.push_back(receive_matched(message, status));
  }
  MPI_Waitall(static_cast<int>(sends.size()), sends.data(), MPI_STATUSES_IGNORE);
  return incoming;
}

int Communicator::message_size(std::size_t bytes) const {
  if (bytes > static_cast<std::size_t>(INT_MAX)) throw SystemError("rank {}: a message of {} bytes; use more ranks", rank_, bytes);
  return static_cast<int>(bytes);
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
  if (tells) throw AgreedError(*mine);
  throw SilentError(static_cast<ExitCode>(lowest % 1000), message);
}

void on_all(const Communicator& comm, const std::function<void()>& action) {
  std::unique_ptr<Error> error;
  try {
    action();
  } catch (const Error& e) {
    error = std::make_unique<Error>(e);
  }
  agree(comm, error.get());
}

void on_root(const Communicator& comm, const std::function<void()>& action) {
  on_all(comm, [&] {
    if (comm.rank() == 0) action();
  });
}

}  // namespace scree::mpi
