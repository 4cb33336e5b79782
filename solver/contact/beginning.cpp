#include "solver/contact/beginning.hpp"

namespace scree {

Beginning beginning_of(const PairFeatures& features, const PairMotion& m, double friction_dt) {
  Beginning begins;
  if (!(friction_dt > 0)) return begins;
  for (const ContactFeature& f : features.list) {
    if (!(f.overlap > 0)) continue;
    const Vec3 velocity = m.v_a + cross(m.w_a, f.x) - m.pivot_v_b - cross(m.w_b, f.x - m.pivot_b);
    const double vn = dot(velocity, f.n);
    // bodies drift by these velocities: one step before, the overlap was this much less
    if (f.overlap + vn * friction_dt > 0) return {};
    begins.overlaps += f.overlap;
    begins.speed += f.overlap * vn;
    begins.force += f.overlap * f.n;
    begins.torque += cross(f.x, f.overlap * f.n);
    Vec3 sliding = velocity;
    if (m.surface != nullptr) sliding -= m.surface->at(f.x);
    begins.slip += f.overlap * (sliding - dot(sliding, f.n) * f.n);
    begins.place += f.overlap * f.x;
  }
  const double mobility = wrench_mobility(m, begins.force, begins.torque);
  if (mobility > 0) begins.energy[kNormalImpact] = 0.5 * begins.speed * begins.speed / mobility;
  const double slides = squared_length(begins.slip);
  if (slides > 0) {
    // the mean slip, at the mean place: (s . s / o)^2 / (2 Q M^-1 Q) for the wrench Q of the force s at the place
    const double along = wrench_mobility(m, begins.slip, cross((1 / begins.overlaps) * begins.place, begins.slip));
    const double power = slides / begins.overlaps;
    if (along > 0) begins.energy[kShearImpact] = 0.5 * power * power / along;
  }
  return begins;
}

}  // namespace scree
