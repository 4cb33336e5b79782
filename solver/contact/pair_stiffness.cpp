#include "solver/contact/pair_stiffness.hpp"

#include <cmath>

namespace scree {

std::array<double, 12> mode_of(const PairMotion& m, const Vec3& x, const Vec3& f) {
  const auto root = [](double v) { return std::sqrt(v); };
  const Vec3 torque_a = cross(x, f);
  const Vec3 force_b = transpose_times(m.b_to_a, -f), torque_b = transpose_times(m.b_to_a, cross(x - m.centre_b, -f));
  const double ma = root(m.inverse_mass_a), mb = root(m.inverse_mass_b);
  return {ma * f.x,
          ma * f.y,
          ma * f.z,
          root(m.inverse_inertia_a.x) * torque_a.x,
          root(m.inverse_inertia_a.y) * torque_a.y,
          root(m.inverse_inertia_a.z) * torque_a.z,
          mb * force_b.x,
          mb * force_b.y,
          mb * force_b.z,
          root(m.inverse_inertia_b.x) * torque_b.x,
          root(m.inverse_inertia_b.y) * torque_b.y,
          root(m.inverse_inertia_b.z) * torque_b.z};
}

void PairStiffness::add_mode(double s, double c, const std::array<double, 12>& mode) {
  for (std::size_t i = 0; i < 12; ++i) {
    for (std::size_t j = 0; j < 12; ++j) {
      const double product = mode[i] * mode[j];
      stiffness[12 * i + j] += s * product;
      damping[12 * i + j] += c * product;
    }
  }
}

void LinearContact::add_point(const Vec3& x, const Vec3& n, double stiffness, double push, double chi, double overlap,
                              double exponent) const {
  result.add_mode(stiffness, chi * push, mode_of(motion, x, n));
  if (!(law.friction > 0)) return;
  // any two directions across the normal
  const Vec3 other = std::abs(n.x) < 0.6 ? Vec3{1, 0, 0} : Vec3{0, 1, 0};
  const Vec3 u = normalised(cross(n, other)), v = cross(n, u);
  const double kappa = law.tangential_ratio * push / overlap, c = tangential_damping_share(law, exponent) * chi * push;
  result.add_mode(kappa, c, mode_of(motion, x, u));
  result.add_mode(kappa, c, mode_of(motion, x, v));
}

}  // namespace scree
