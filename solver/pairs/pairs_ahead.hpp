// What a loop over pairs is about to read is asked for before it is needed.
#pragma once

#include <algorithm>
#include <cstdint>
#include <span>

#include "solver/neighbours/pair_list.hpp"
#include "solver/neighbours/prefetch.hpp"

namespace scree {

/// What a pair keeps lies in several places: asked for together and before they are needed.
[[gnu::always_inline]] inline void prefetch_pair(const BodyPair& pair, const PairResult& result) {
  prefetch<sizeof(CandidateLists)>(pair.lists.get());
  prefetch<4 * sizeof(FrictionSpring)>(pair.state.springs.data());
  prefetch<sizeof(PairResult)>(&result);
}

/// The same of what its lists hold.
[[gnu::always_inline]] inline void prefetch_candidates(const CandidateLists& lists) {
  prefetch<1>(lists.corners_a.data());  // the rest of a list follows by itself
  prefetch<1>(lists.corners_b.data());
  prefetch<1>(lists.edges.data());
  prefetch<512>(lists.slacks.data());  // all are read at once
}

/// Walks ahead of a loop over pairs and asks for what those hold that are not idle. A bed of 600 rocks of 320 triangles is more than the
/// inner caches hold.
class PairsAhead {
 public:
  /// in   which   of one thread: what others work on is not looked at
  PairsAhead(PairList& list, std::span<const std::int32_t> which) : list_(list), which_(which) {}
  /// Before each pair is evaluated.   in   n   its place in `which`
  void advance(std::size_t n) {
    next_ = std::max(next_, n + 1);
    if (list_.idle()[static_cast<std::size_t>(which_[n])].way >= 0) return;
    if (coming_ != nullptr && coming_->lists != nullptr) prefetch_candidates(*coming_->lists);
    coming_ = nullptr;
    for (; next_ < which_.size() && coming_ == nullptr; ++next_) {
      const auto k = static_cast<std::size_t>(which_[next_]);
      if (list_.idle()[k].way >= 0) continue;
      coming_ = &list_.stored_pairs()[k];
      prefetch_pair(*coming_, list_.stored_results()[k]);
    }
  }

 private:
  PairList& list_;
  std::span<const std::int32_t> which_;
  std::size_t next_ = 0;
  const BodyPair* coming_ = nullptr;  ///< the next pair that is not idle
};

}  // namespace scree
