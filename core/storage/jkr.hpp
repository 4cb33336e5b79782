// Two elastic spheres that stick, with the neck that holds them until it tears.
// Source: Johnson, Kendall, Roberts, Proc. R. Soc. A 324 (1971) 301. With the radius a of the contact,
//     F = 4 E* a^3 / (3 R*) - sqrt(8 pi w E* a^3),   overlap = a^2 / R* - sqrt(2 pi w a / E*),
// on the branch that ends where the overlap is least, -tear_off. With a = y^2 a_tear all of it is algebra in y >= 1:
//     F = F_c (y^6 - 6 y^3) / 9,   overlap = tear_off (y^4 - 4 y) / 3,   F_c = 3/2 pi w R*
#pragma once

#include <algorithm>
#include <cmath>
#include <numbers>

namespace scree {

struct Jkr {
  double pull_off;  ///< F_c [N]
  double tear_off;  ///< gap at which the neck tears [m]: (3/4) (pi^2 w^2 R* / E*^2)^(1/3)

  /// in   adhesion   w [J/m^2]     in  modulus   E* [Pa]     in  radius   R* [m]; all above 0
  Jkr(double adhesion, double modulus, double radius)
      : pull_off(1.5 * std::numbers::pi * adhesion * radius), tear_off(0.75 * unit_of(adhesion, modulus, radius)) {}

  /// y of an overlap >= -tear_off: the largest root of y^4 - 4 y = 3 q, q = overlap / tear_off, by Ferrari's method.
  double root(double overlap) const {
    const double q = std::max(-1.0, overlap / tear_off);
    // m^3 + 3 q m = 2, without the difference of two near numbers that Cardano's formula has for large q
    const double t = std::cbrt(1 + std::sqrt(1 + q * q * q)), u = q / t, m = 2 / (t * t + q + u * u);
    return 0.5 * (std::sqrt(2 * m) + std::sqrt(std::max(0.0, 4 * std::sqrt(2 / m) - 2 * m)));
  }
  double overlap(double y) const { return tear_off * (y * y * y - 4) * y / 3; }
  double force(double y) const { return pull_off * y * y * y * (y * y * y - 6) / 9; }
  /// F's first part, which Hertz gives for the same radius of contact, and its overlap a^2 / R*.
  double push(double y) const { return pull_off * y * y * y * (y * y * y) / 9; }
  double push_overlap(double y) const { return tear_off / 3 * y * y * y * y; }
  /// Energy, 0 where the neck tears [J].
  double energy(double y) const {
    const double y3 = y * y * y, y4 = y3 * y;
    return pull_off * tear_off * (4.0 / 3) * (y4 * (y3 * y3 - 10 * y3 + 15) - 6) / 90;
  }
  /// What is released as a contact forms at touch [J]: 7.09 (w^5 R*^4 / E*^2)^(1/3) (Thornton and Ning, Powder Technol. 99 (1998) 154).
  double released_at_touch() const { return -energy(std::cbrt(4.0)); }

 private:
  static double unit_of(double adhesion, double modulus, double radius) {
    const double s = std::numbers::pi * adhesion / modulus;
    return std::cbrt(s * s * radius);
  }
};

}  // namespace scree
