// Where the present state of a run differs from one that was recorded.
#pragma once

#include <climits>
#include <cstdint>
#include <string>

#include "solver/run/checkpoint.hpp"

namespace scree {

/// The first body of this rank's share that differs, and how many do.
struct Differences {
  std::int64_t count = 0, id = INT64_MAX;
  std::string text;
  void add(std::int64_t body, const std::string& what) {
    ++count;
    if (body < id) {
      id = body;
      text = what;
    }
  }
};

/// The bodies of a frame with those of the present state. Collective: the frame is read by every rank as a whole.
/// in   origin   of the scene as it is computed [m]: frames are written in the world; moved as the writer moves it, bits agree
Differences compare_with_frame(const mpi::Communicator& comm, const SolverScene& scene, const Checkpoint& now, const Vec3& origin,
                               const std::string& path);

/// Bodies and the state of pairs, column by column.
Differences compare_with_checkpoint(const Checkpoint& now, const Checkpoint& recorded);

/// The whole picture on every rank: "17 differences, first body 3, position: ...", or "". Collective.
std::string sum_up(const mpi::Communicator& comm, const Differences& mine);

}  // namespace scree
