// A network with latency, for tests: preloaded into the solver (LD_PRELOAD), it lets every ghost message arrive
// SCREE_MESSAGE_DELAY_US microseconds after it was sent, whatever both ranks do meanwhile. The product knows nothing of it.
//
// Each message of the ghost refresh takes along a second one with the time at which it was sent. Whoever waits for the message
// waits until that time plus the delay has passed; who comes later waits for nothing, as with a network that works by itself.
// Each rank tells at its end how long it waited for the delay alone. Ranks must share a clock: one machine.
#include <mpi.h>
#include <sched.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <vector>

namespace {

constexpr int kGhostTag = 23, kTimeTag = 1023;  // the first is that of Halo::start_refresh

struct Awaited {
  int source;
  MPI_Comm comm;
};
std::vector<Awaited> g_awaited;
std::array<double, 4096> g_times;  // far more than messages of one step: a slot is free again when it is used again
std::size_t g_next = 0;
double g_waited = 0;  // for the delay alone: what a late rank adds is not in it

double now() { return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count(); }

double delay() {
  static const double seconds = [] {
    const char* text = std::getenv("SCREE_MESSAGE_DELAY_US");
    return text != nullptr ? 1e-6 * std::atof(text) : 0.0;
  }();
  return seconds;
}

}  // namespace

extern "C" {

int MPI_Isend(const void* data, int count, MPI_Datatype type, int to, int tag, MPI_Comm comm, MPI_Request* request) {
  if (tag == kGhostTag) {
    double& slot = g_times[g_next++ % g_times.size()];
    slot = now();
    MPI_Request sent = MPI_REQUEST_NULL;
    PMPI_Isend(&slot, 1, MPI_DOUBLE, to, kTimeTag, comm, &sent);
    PMPI_Request_free(&sent);
  }
  return PMPI_Isend(data, count, type, to, tag, comm, request);
}

int MPI_Irecv(void* data, int count, MPI_Datatype type, int from, int tag, MPI_Comm comm, MPI_Request* request) {
  if (tag == kGhostTag) g_awaited.push_back({from, comm});
  return PMPI_Irecv(data, count, type, from, tag, comm, request);
}

int MPI_Waitall(int count, MPI_Request* requests, MPI_Status* statuses) {
  const int code = PMPI_Waitall(count, requests, statuses);
  double arrival = 0;
  for (const Awaited& a : g_awaited) {
    double sent = 0;
    PMPI_Recv(&sent, 1, MPI_DOUBLE, a.source, kTimeTag, a.comm, MPI_STATUS_IGNORE);
    arrival = std::max(arrival, sent + delay());
  }
  g_awaited.clear();
  const double start = now();
  while (now() < arrival) sched_yield();
  g_waited += std::max(0.0, arrival - start);
  return code;
}

int MPI_Finalize() {
  std::fprintf(stderr, "delayed messages: waited %.9f s\n", g_waited);
  return PMPI_Finalize();
}

}  // extern "C"
