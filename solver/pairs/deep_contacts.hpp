// What a run counts of contacts deeper than their maximum overlap (contact/overlap_limit.hpp); part of a checkpoint.
#pragma once

#include <mpi.h>

#include <cstdint>
#include <string>

#include "core/geometry/vec3.hpp"
#include "solver/contact/pair_state.hpp"

namespace scree {

class SolverScene;

/// One such contact, in one evaluation.
struct DeepContact {
  PairKey key;
  double overlap, excess;  ///< of the deepest feature, and what of it is beyond the limit [m]
  Vec3 place;              ///< of body A, about the origin of the computation [m]
  bool begins;             ///< it has passed the limit since the last step
};

/// Of one rank, or of all.
struct DeepTotals {
  std::int64_t contacts = 0;                     ///< that passed the limit
  std::int64_t contact_steps = 0;                ///< steps of all of them beyond it
  std::int64_t first_step = -1, last_step = -1;  ///< at which there was one
  // the deepest of all
  double overlap = 0, excess = 0;  ///< [m]
  PairKey key{-1, -1, -1};
  std::int64_t step = -1;
  Vec3 place;  ///< of body A, about the origin of the computation [m]

  void add(const DeepContact& contact, std::int64_t at_step);
  void add(const DeepTotals& other);

 private:
  bool is_less_deep_than(const DeepTotals& other) const;
};

/// Of all ranks, on every rank. Collective.
DeepTotals over_ranks(MPI_Comm comm, const DeepTotals& totals);

/// "body 3 and wall 'press'", for messages.
std::string name_of_pair(const SolverScene& scene, const PairKey& key);

/// What a user is told of them: how many, when, how deep, where; in one line.
std::string text_of(const SolverScene& scene, const DeepTotals& totals, double step_size);

}  // namespace scree
