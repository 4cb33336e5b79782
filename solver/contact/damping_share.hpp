// What damping of a contact on a fragment needs where several of its pieces press on the same partner (step/shared_damping.hpp).
#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include "solver/contact/pair_state.hpp"

namespace scree {

/// Key of an entry of a pair's springs that is no spring, after kLinkKey and before kTurnKey: x of its force is the product of energy and
/// mobility of all contacts that press together, over that of this one.
inline constexpr std::int64_t kShareKey = std::int64_t{6} << 60;

/// 1 where a contact presses alone.
inline double damping_share(const std::vector<FrictionSpring>& springs) {
  for (auto s = springs.rbegin(); s != springs.rend() && s->key >= kShareKey; ++s) {
    if (s->key == kShareKey) return s->force.x;
  }
  return 1;
}

/// Notes it in the order of keys; 1 takes the entry away.
inline void set_damping_share(std::vector<FrictionSpring>& springs, double share) {
  const auto at = std::find_if(springs.begin(), springs.end(), [](const FrictionSpring& s) { return s.key >= kShareKey; });
  const bool is_there = at != springs.end() && at->key == kShareKey;
  if (share == 1) {
    if (is_there) springs.erase(at);
  } else if (is_there) {
    at->force.x = share;
  } else {
    springs.insert(at, {kShareKey, {share, 0, 0}, 0});
  }
}

}  // namespace scree
