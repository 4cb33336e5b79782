#include "solver/contact/overlap_limit.hpp"

namespace scree {

PairView shifted_view(const PairView& view, const Vec3& shift) {
  PairView shifted = view;
  shifted.b.x -= rotate(view.a.q, shift);
  shifted.pose.centre -= shift;
  shifted.reach += length(shift);
  return shifted;
}

void take_shift_back(const Vec3& shift, std::vector<ContactFeature>& features) {
  const double further = length(shift);
  for (ContactFeature& f : features) {
    f.overlap += dot(shift, f.n) - further;
    f.x += 0.5 * shift;  // the middle of the gap: a point of A stays, one of B comes along
  }
  std::erase_if(features, [](const ContactFeature& f) { return !(f.overlap > 0); });
}

Vec3 next_shift(const PairView& view, const PairMotion& motion, const std::vector<ContactFeature>& features, const Vec3& shift, double dt) {
  // the deepest of the shifted pose, after one more step
  const ContactFeature* deepest = nullptr;
  double overlap = 0;
  for (const ContactFeature& f : features) {
    const Vec3 velocity = motion.v_a + cross(motion.w_a, f.x) - motion.pivot_v_b - cross(motion.w_b, f.x - motion.pivot_b);
    const double next = f.overlap - dot(shift, f.n) + std::max(0.0, -dot(velocity, f.n)) * dt;
    if (deepest != nullptr && !(next > overlap)) continue;
    deepest = &f;
    overlap = next;
  }
  const double too_deep = overlap - kShiftTo * view.max_overlap;
  if (overlap > kShiftFrom * view.max_overlap) return shift + too_deep * deepest->n;
  const double size = length(shift);
  if (!(size > 0) || overlap > kShiftBack * view.max_overlap) return shift;
  const double cosine = dot(shift, deepest->n) / size;
  if (cosine < kMinCosine) return shift;
  const double left = size + too_deep / cosine;
  return left > 0 ? (left / size) * shift : Vec3{};
}

}  // namespace scree
