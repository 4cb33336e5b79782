// How friction springs are taken along as bodies and normals turn. Source: docs/reference/contact-law.md section 3.4.
#pragma once

#include <cmath>
#include <vector>

#include "solver/contact/pair_force.hpp"

namespace scree {

/// Takes springs, kept in the frame of A, along with both bodies: by half of what B has turned against A since they were set. Seen from B
/// it is the same rotation, so that which of the two is A changes nothing but rounding.
class MeanTurn {
 public:
  /// in   springs   of the last step, with their kTurnKey     in  turn  B to A, now; of a wall's surface, what of it has moved on to here
  MeanTurn(const std::vector<FrictionSpring>& springs, const Quat& turn, double friction_dt) {
    if (springs.empty() || springs.back().key != kTurnKey || !(friction_dt > 0)) return;
    const FrictionSpring& kept = springs.back();
    const Quat before{kept.stiffness, kept.force.x, kept.force.y, kept.force.z};
    if (before == turn) return;  // at rest, to the last bit
    Quat by = turn * conjugate(before);
    if (by.w < 0) by = {-by.w, -by.x, -by.y, -by.z};
    w_ = std::sqrt(0.5 * (1 + by.w));
    u_ = (0.5 / w_) * Vec3{by.x, by.y, by.z};
  }
  [[gnu::always_inline]] Vec3 operator()(const Vec3& s) const {
    const Vec3 t = cross(2 * u_, s);
    return s + w_ * t + cross(u_, t);
  }
  static FrictionSpring entry(const Quat& turn) { return {kTurnKey, {turn.x, turn.y, turn.z}, turn.w}; }

 private:
  Vec3 u_;
  double w_ = 1;
};

/// A normal that has come to the opposite of what it was, but for this, leaves its spring no direction: the spring goes. Far above
/// rounding, far below what a contact turns by in a step.
inline constexpr double kOppositeNormal = 1e-9;

/// Takes a spring along from a contact's normal n to its present one m, by the shortest rotation: its length stays, whatever the angle.
/// Of a spring that keeps no normal the part along m goes.
inline Vec3 transported(const Vec3& spring, const Vec3& n, const Vec3& m) {
  const double c = 1 + dot(n, m);
  return c > kOppositeNormal ? spring - (dot(spring, m) / c) * (n + m) : Vec3{};
}

}  // namespace scree
