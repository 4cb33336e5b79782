// How friction springs are taken along as bodies and normals turn. Source: docs/reference/contact-law.md section 3.4.
#pragma once

#include <vector>

#include "solver/contact/pair_force.hpp"
#include "solver/laws/friction.hpp"

namespace scree {

/// Takes springs, kept in the frame of A, along with both bodies: by half of what B has turned against A since they were set. Seen from B
/// it is the same rotation, so that which of the two is A changes nothing but rounding.
class MeanTurn {
 public:
  /// in   springs   of the last step, with their Turn     in  turn  B to A, now; of a wall's surface, what of it has moved on to here
  MeanTurn(const std::vector<FrictionSpring>& springs, const Quat& turn, double friction_dt) {
    if (springs.empty() || springs.back().key != Turn::kKey || !(friction_dt > 0)) return;
    const Quat before = Turn::of(springs.back()).quaternion();
    if (before == turn) return;  // at rest, to the last bit
    half_ = half_turn(before, turn);
  }
  [[gnu::always_inline]] Vec3 operator()(const Vec3& s) const { return turned_by(half_, s); }

 private:
  HalfTurn half_{{}, 1};
};

}  // namespace scree
