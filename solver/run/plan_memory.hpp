// The memory that a run will take, for --plan.
#pragma once

#include <cstddef>
#include <string>

#include "core/base/mpi_session.hpp"
#include "solver/run/plan_ranks.hpp"
#include "solver/state/run_state.hpp"

namespace scree {

/// "54.8 MB".
std::string bytes_text(double bytes);

/// What a body holds, its pairs apart [bytes].
inline constexpr std::size_t kMemoryOfBody = sizeof(ParticleRecord) + 8 * sizeof(Vec3);
/// What pairs and their candidates hold [bytes].
double memory_of_pairs(const RunState& s);
/// The same for each body in a bed, where no sample of it was settled (bed_sample.hpp).
double usual_memory_of_pairs(bool meshes);

struct MemoryNow {
  double all = 0, of_pairs = 0;  ///< of all ranks [bytes]
};
/// Collective.
MemoryNow memory_now(const mpi::Communicator& comm, const RunState& s);

/// What all ranks hold at most [bytes]: at the end, once all lie in a bed, while files are written.
/// in   bodies     at the end, and `arriving` of them are still to come
/// in   in_bed     of the pairs of a body [bytes]; 0: no bed will form
double most_memory(const MemoryNow& now, int ranks, double bodies, double arriving, double in_bed);

/// What one of so many ranks holds at most [bytes].   in   most   of one rank that has all bodies
double memory_of_rank(double most, const StepOnRanks& step);

}  // namespace scree
