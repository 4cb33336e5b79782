// Pairs of meshes whose corners have been looked at, and whose edges wait to be looked at together with those of other pairs
// (contact/edge_lanes.hpp).
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "solver/contact/edge_lanes.hpp"
#include "solver/contact/pair_view.hpp"
#include "solver/neighbours/pair_list.hpp"

namespace scree {

struct BegunPair {
  std::int32_t k = 0;  ///< in the list of pairs
  double moved = 0;    ///< see motion_since_listed() [m]
  PairView view;
  std::vector<ContactFeature> features;  ///< of corners
  std::vector<std::int32_t> edges;       ///< of its lists, that are due
};

/// One thread's. Kept from pass to pass, so that nothing is allocated for each pair.
class BegunPairs {
 public:
  static BegunPairs& of_thread();

  /// Whether the edges of a pair may wait here.
  static bool may_take(const PairView& view) {
    return view.geometry == PairGeometry::two_meshes && view.cells == CellSide::none && !view.a.shape->edge_rows.empty() &&
           !view.b.shape->edge_rows.empty();
  }
  /// Another pair has no room, or its edges are likely to have none.
  bool is_full() const { return count_ == kPosesAtOnce || queue_.count + kLikelyEdges > kEdgesAtOnce; }
  bool has_room(std::size_t edges) const { return queue_.count + edges <= kEdgesAtOnce; }
  /// The place of the next pair; add() makes it one.
  BegunPair& next() { return pairs_[count_]; }
  void add(const CandidateLists& lists);

  /// Finds out what all edges are, and calls work(pair) for each pair, with all of its features; begins anew.
  template <class Work>
  void finish(std::vector<BodyPair>& pairs, Work&& work) {
    if (count_ == 0) return;
    look_at_edges_at_once(queue_, answers_);
    std::size_t first = 0;
    for (std::size_t n = 0; n < count_; ++n) {
      BegunPair& begun = pairs_[n];
      complete(begun, first, *pairs[static_cast<std::size_t>(begun.k)].lists);
      first += begun.edges.size();
      work(begun);
    }
    clear();
  }
  void clear() { count_ = queue_.count = 0; }

 private:
  void complete(BegunPair& begun, std::size_t first, CandidateLists& lists) const;

  static constexpr std::size_t kLikelyEdges = 16;
  std::size_t count_ = 0;
  std::array<BegunPair, kPosesAtOnce> pairs_;
  EdgeQueue queue_;
  EdgeAnswers answers_;
};

}  // namespace scree
