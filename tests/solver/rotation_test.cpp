// Free rotation against Jacobi's closed solution. VALIDATION.md section 1.5, R1 and R2.
#include <gtest/gtest.h>

#include "solver/motion.hpp"

namespace scree {
namespace {

// Box of VALIDATION.md G1: I = (1/30, 0.34/3, 0.4/3).
const Vec3 kInertia{1.0 / 30, 0.34 / 3, 0.4 / 3};
const Vec3 kInverse{30, 3 / 0.34, 3 / 0.4};

struct Top {
  Quat q;
  Vec3 L, w;
  explicit Top(const Vec3& spin) : L{kInertia.x * spin.x, kInertia.y * spin.y, kInertia.z * spin.z}, w(spin) {}
  void turn(double h, int steps) {
    for (int i = 0; i < steps; ++i) rotate_freely(kInverse, false, h, L, q, w);
  }
  double energy() const { return 0.5 * dot(w, L); }
};

double angle_between(const Quat& a, const Quat& b) {
  const Quat d = conjugate(a) * b;
  return 2 * std::asin(std::min(1.0, std::sqrt(d.x * d.x + d.y * d.y + d.z * d.z)));
}

TEST(FreeRotation, follows_jacobis_solution_of_a_box_to_second_order) {
  Top top({1, 2, 3});
  top.turn(0.005, 2000);
  const Quat exact{.4228517539, -.3100925385, .0549651270, -.8497163330};
  EXPECT_LE(angle_between(top.q, exact), 2.6e-4);
  Top coarse({1, 2, 3});
  coarse.turn(0.01, 1000);
  const double order = std::log2(angle_between(coarse.q, exact) / angle_between(top.q, exact));
  EXPECT_NEAR(order, 2.0, 0.1);
}

TEST(FreeRotation, flips_like_dzhanibekovs_nut) {
  Top top({.1, 10, 0});
  top.turn(0.005, 200);
  const Quat exact{.1807161123, .0321527822, -.6069381730, .7732618828};
  EXPECT_LE(angle_between(top.q, exact), 2.8e-3);
}

TEST(FreeRotation, does_not_drift_in_energy_over_a_million_steps) {
  Top top({1, 2, 3});
  const double start = top.energy();
  double first = 0, second = 0;
  for (int i = 0; i < 1000; ++i) {
    top.turn(0.005, 1000);
    (i < 500 ? first : second) += (top.energy() / start - 1) / 500;
  }
  EXPECT_LE(std::abs(first), 6e-6);
  EXPECT_LE(std::abs(second - first), 1e-6) << "a slope";
}

TEST(FreeRotation, of_an_isotropic_body_is_one_exact_turn) {
  const Vec3 inverse{2, 2, 2};
  const Vec3 L{0.3, -0.2, 0.5};
  Quat q;
  Vec3 w;
  for (int i = 0; i < 1000; ++i) rotate_freely(inverse, true, 0.01, L, q, w);
  EXPECT_LE(angle_between(q, quaternion_of(normalised(L), 2 * length(L) * 10)), 1e-12);
}

}  // namespace
}  // namespace scree
