// Pairs of balls that do not touch, over steps in which no body is asked how far it has gone: of the fastest body alone is known how far it
// went in each step. Each pair waits until all bodies together may have gone its gap. Pairs wait in groups, so that a step looks at one
// number of each group.
//
// Source: the bound of Verlet, Phys. Rev. 159 (1967) 98, for each pair.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

#include "solver/neighbours/pair_list.hpp"

namespace scree {

class WaitingBalls {
 public:
  /// Takes all pairs of a class that wait for their place in blocks.   in   list   blocks are filled
  void begin(const PairList& list, PairClass which);
  /// The pairs that may touch once any two bodies may have come nearer by `bound` since begin() [m]; they are asked, whatever their idle
  /// time says.
  const std::vector<std::int32_t>& due(double bound, PairList& list);
  /// Those that the last call of due() gave, ascending.
  const std::vector<std::int32_t>& last_due() const { return due_; }
  /// After those pairs were looked at: for how long they wait again.
  void note(double bound, const PairList& list);
  /// The pairs with walls, which move: they are looked at in every step again.
  void end_of_walls(PairList& list) const;

 private:
  static constexpr std::size_t kTogether = 16;
  struct Group {
    std::array<std::int32_t, kTogether> pair;  ///< -1: none
    std::array<double, kTogether> limit;       ///< bound from which on the pair is due [m]
  };
  static constexpr double kNever = std::numeric_limits<double>::infinity();

  std::vector<Group> groups_;
  std::vector<double> first_;             // limit of each group
  std::vector<std::int32_t> due_;         // pairs
  std::vector<std::int32_t> due_places_;  // of them, in groups
};

}  // namespace scree
