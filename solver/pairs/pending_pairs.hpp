// Pairs of meshes whose candidates wait to be looked at together with those of other pairs (features/corner_lanes.hpp, edge_lanes.hpp).
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "solver/features/corner_lanes.hpp"
#include "solver/features/mesh_features.hpp"
#include "solver/features/pair_view.hpp"
#include "solver/lanes/edge_lanes.hpp"
#include "solver/neighbours/pair_list.hpp"

namespace scree {

struct PendingPair {
  std::int32_t k = 0;  ///< in the list of pairs
  double moved = 0;    ///< see motion_since_listed() [m]
  PairView view;
  DueCandidates due;
  std::vector<ContactFeature> features;
};

/// One thread's. Kept from pass to pass, so that nothing is allocated for each pair.
class PendingPairs {
 public:
  static PendingPairs& of_thread();

  /// Whether the candidates of a pair may wait here.
  static bool may_take(const PairView& view) {
    return view.geometry == PairGeometry::two_meshes && view.cells == CellSide::none && !view.a.shape->edge_rows.empty() &&
           !view.b.shape->edge_rows.empty();
  }
  /// Beside those that wait, and when none does.
  bool has_room(const DueCandidates& due) const {
    return count_ < kPosesAtOnce && corners_.count + due.edges <= kCornersAtOnce && edges_.count + due.edge_count() <= kEdgesAtOnce;
  }
  static bool could_have_room(const DueCandidates& due) { return due.edges <= kCornersAtOnce && due.edge_count() <= kEdgesAtOnce; }

  /// A view that add() need not copy.
  PairView& next_view() { return pairs_[count_].view; }
  /// in   due   there is room for them; becomes those of a pair that is done
  void add(std::int32_t k, double moved, const PairView& view, const CandidateLists& lists, DueCandidates& due);

  /// Finds out what all candidates are, and calls work(pair) for each pair, with all of its features; begins again.
  template <class Work>
  void finish(std::vector<BodyPair>& pairs, Work&& work) {
    if (count_ == 0) return;
    examine_vertices_at_once(corners_, found_corners_);
    examine_edges_at_once(edges_, found_edges_);
    Places first{0, 0};
    for (std::size_t n = 0; n < count_; ++n) {
      PendingPair& pending = pairs_[n];
      complete(pending, first, *pairs[static_cast<std::size_t>(pending.k)].lists);
      work(pending);
    }
    clear();
  }
  void clear() {
    count_ = corners_.count = edges_.count = 0;
    edges_.has_walls = false;
  }

 private:
  /// In both queues.
  struct Places {
    std::size_t corner, edge;
  };
  /// The features of a pair, and new slacks.   in, out   first   of its candidates, and of the next pair's
  void complete(PendingPair& pending, Places& first, CandidateLists& lists) const;

  std::size_t count_ = 0;
  std::array<PendingPair, kPosesAtOnce + 1> pairs_;  // of the last, the view alone
  CornerQueue corners_;
  CornerAnswers found_corners_;
  EdgeQueue edges_;
  EdgeAnswers found_edges_;
};

}  // namespace scree
