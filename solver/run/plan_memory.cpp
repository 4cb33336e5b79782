#include "solver/run/plan_memory.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <fstream>

namespace scree {

namespace {

/// Resident memory of this process [bytes].
double resident() {
  std::ifstream file("/proc/self/statm");
  double all = 0, pages = 0;
  file >> all >> pages;
  return pages * static_cast<double>(sysconf(_SC_PAGESIZE));
}

// Bytes. Pairs in a bed: runs of 10^5 and 10^6 bodies (docs/results/performance.md). Ghosts: docs/results/scaling.md.
constexpr double kPairsOfBall = 2.2e3, kPairsOfMesh = 4.2e3, kGhostWithPairs = 2.7e3;
/// While files are written: what HDF5 and MPI hold on each rank, 5 to 8 MB in the ready cases; the rows of a checkpoint, for each body.
constexpr double kRankWhileFiles = 6e6, kBodyWhileFiles = 1e3;
constexpr double kRankWithoutBodies = 30e6;

}  // namespace

std::string bytes_text(double bytes) {
  if (bytes < 1e6) return fmt::format("{:.0f} kB", bytes / 1e3);
  return bytes < 1e9 ? fmt::format("{:.1f} MB", bytes / 1e6) : fmt::format("{:.1f} GB", bytes / 1e9);
}

double memory_of_pairs(const RunState& s) {
  double bytes = 0;
  for (const BodyPair& pair : s.pairs.pairs()) bytes += static_cast<double>(memory_of(pair));
  return bytes;
}

double usual_memory_of_pairs(bool meshes) { return meshes ? kPairsOfMesh : kPairsOfBall; }

MemoryNow memory_now(const mpi::Communicator& comm, const RunState& s) { return {comm.sum(resident()), comm.sum(memory_of_pairs(s))}; }

double most_memory(const MemoryNow& now, int ranks, double bodies, double arriving, double in_bed) {
  return now.all + kRankWhileFiles * ranks + kBodyWhileFiles * bodies + kMemoryOfBody * arriving +
         std::max(0.0, in_bed * bodies - now.of_pairs);
}

double memory_of_rank(double most, const StepOnRanks& step) {
  const double share = step.bodies_max / std::max(1.0, step.bodies_mean * step.ranks);
  return kRankWithoutBodies + std::max(0.0, most - kRankWithoutBodies) * share + kGhostWithPairs * step.ghosts_max;
}

}  // namespace scree
