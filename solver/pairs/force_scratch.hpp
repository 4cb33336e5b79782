// Scratch memory of the loop over pairs.
#pragma once

#include "core/storage/contact_limits.hpp"
#include "core/storage/frame_file.hpp"
#include "solver/neighbours/pair_list.hpp"
#include "solver/pairs/deep_contacts.hpp"
#include "solver/pairs/pair_observer.hpp"
#include "solver/ranks/exact_sum.hpp"

namespace scree {

/// Scratch memory of each thread, and of a step whose pairs are timed.
struct ForceScratch {
  std::vector<MeshDistanceScratchPtr> distance;  ///< one per thread
  std::vector<float> pair_seconds;               ///< when not empty, one per pair: evaluate_pairs fills in what each took
  /// One per thread where necks or bridges may form or contacts yield: evaluate_pairs adds the energy that goes as they do, of the pairs
  /// counted here [J].
  std::vector<ExactSum> released;
  /// One per thread where contacts go on beyond their maximum overlap: evaluate_pairs appends those that do, of the pairs counted here.
  std::vector<std::vector<DeepContact>> deep;
  std::vector<std::int32_t> left;  ///< of a pass without columns: pairs that wait for these
  std::vector<BallRow> ball_rows;  ///< of a pass over blocks of balls: what pairs read of their bodies
  ForceScratch();
};

}  // namespace scree
