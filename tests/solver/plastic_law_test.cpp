// Contacts that yield (solver/laws/plastic.hpp): what force does along a path is what is stored and what yielding takes, at any step.
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "solver/laws/plastic.hpp"

namespace scree {
namespace {

constexpr double kRadius = 0.5;

template <class Base>
PairLaw pair_law(double plasticity, double adhesive_ratio) {
  PairLaw law;
  law.stiffness = law.step_stiffness = 1e4;
  prepare_yielding(plasticity, adhesive_ratio, Base::kExponent, law);
  return law;
}

/// Force and energies as the overlap is changed, in a number of steps.
template <class Base>
class Path {
 public:
  Path(double plasticity, double adhesive_ratio) : law_(pair_law<Base>(plasticity, adhesive_ratio), kRadius) {}
  void go_to(double overlap, int steps) {
    for (int n = 1; n <= steps; ++n) {
      const auto before = law_.at(at_);
      const double next = from_ + (overlap - from_) * n / steps, middle = 0.5 * (at_ + next);
      // Simpson's rule for the force between the two: exact for linear pieces, and within rounding where steps are small
      const auto half = law_.at(middle), after = law_.at(next);
      const auto force = [](const auto& state) { return state.push - state.pull; };
      work_ += (next - at_) * (force(before) + 4 * force(half) + force(after)) / 6;
      law_.dent = after.dent;
      taken_ += after.yielded;
      at_ = next;
    }
    from_ = overlap;
  }
  double work() const { return work_; }
  double taken() const { return taken_; }
  double stored() const {
    const auto now = law_.at(at_);
    return now.push_energy - now.pull_energy;
  }
  double force() const {
    const auto now = law_.at(at_);
    return now.push - now.pull;
  }
  const PlasticLaw<Base>& law() const { return law_; }

 private:
  PlasticLaw<Base> law_;
  double at_ = 0, from_ = 0, work_ = 0, taken_ = 0;
};

template <class Base>
void expect_balance() {
  std::mt19937 generator(3);
  std::uniform_real_distribution<double> overlap(0, 1e-2);
  for (const double plasticity : {0.2, 0.6, 0.95}) {
    for (const double adhesive : {0.0, 0.05, 0.7}) {
      Path<Base> path(plasticity, adhesive);
      const double unit = Base(pair_law<Base>(0.0, 0), kRadius).energy(1e-2);
      for (int turn = 0; turn < 12; ++turn) {
        path.go_to(overlap(generator), 4000);
        EXPECT_NEAR(path.work(), path.stored() + path.taken(), 2e-6 * unit) << plasticity << " " << adhesive << " turn " << turn;
        EXPECT_GE(path.stored(), 0);
      }
      const double taken = path.taken();
      EXPECT_GT(taken, 0);
      path.go_to(1e-9, 4000);
      EXPECT_LT(path.stored(), 1e-6 * unit);
    }
  }
}

TEST(PlasticLaw, work_is_what_is_stored_and_what_yielding_takes) {
  expect_balance<LinearLaw>();
  expect_balance<HertzLaw>();
}

TEST(PlasticLaw, pressed_in_one_step_or_in_many_it_takes_the_same) {
  for (const double adhesive : {0.0, 0.3}) {
    Path<HertzLaw> one(0.7, adhesive), many(0.7, adhesive);
    one.go_to(1e-2, 1);
    many.go_to(1e-2, 1000);
    EXPECT_NEAR(one.taken(), many.taken(), 1e-12 * many.taken());
    EXPECT_EQ(one.law().dent, many.law().dent);
    // the energy of the law, c D^2.5 / 2.5
    EXPECT_NEAR(one.taken() + one.stored(), HertzLaw(pair_law<HertzLaw>(0, 0), kRadius).energy(1e-2), 1e-12 * one.taken());
    one.go_to(0.8e-2, 1);  // back to the adhesive branch and further
    many.go_to(0.8e-2, 1);
    one.go_to(1e-3, 1);
    many.go_to(1e-3, 3000);
    EXPECT_NEAR(one.taken(), many.taken(), 1e-12 * many.taken());
  }
}

TEST(PlasticLaw, limits_are_those_that_are_published) {
  const double k1 = 1e4, plasticity = 0.8, adhesive = 0.25, k2 = k1 / (1 - plasticity), deepest = 1e-2;
  Path<LinearLaw> path(plasticity, adhesive);
  path.go_to(deepest, 10);
  EXPECT_NEAR(path.force(), k1 * deepest, 1e-12 * k1 * deepest);
  EXPECT_NEAR(path.law().dent, (1 - k1 / k2) * deepest, 1e-12 * deepest);
  // Luding 2008: the largest pull is where -k_adh d and k2 (d - d_0) meet
  const double meets = k2 * path.law().dent / (k2 + adhesive * k1);
  path.go_to(meets, 10);
  EXPECT_NEAR(path.force(), -adhesive * k1 * meets, 1e-10 * k1 * meets);
  path.go_to(0.5 * meets, 10);
  EXPECT_NEAR(path.force(), -adhesive * k1 * 0.5 * meets, 1e-12 * k1 * meets);
  // pressed again it goes along k2, from the dent that is left
  path.go_to(0.55 * meets, 1);
  EXPECT_NEAR(path.force(), -adhesive * k1 * 0.5 * meets + k2 * 0.05 * meets, 1e-10 * k1 * meets);
}

/// Where the load has nearly gone, differences of energies are rounding: damping divides by what is stored, and must not find 0.
template <class Base>
void expect_energy_beside_the_dent() {
  const PairLaw law = pair_law<Base>(0.8, 0);
  PlasticLaw<Base> plastic(law, kRadius);
  std::mt19937 generator(5);
  std::uniform_real_distribution<double> decades(-16, -3), digits(1, 10);
  int loaded = 0;
  for (int n = 0; n < 100000; ++n) {
    plastic.dent = 1e-3 * digits(generator);
    const double overlap = plastic.dent * (1 + std::pow(10, decades(generator)));
    const auto at = plastic.at(overlap);
    if (!(at.push > 0)) continue;
    ++loaded;
    const double slope = 5 * Base(law, kRadius).stiffness(overlap);
    ASSERT_GE(at.push_energy, (1 - 1e-14) * at.push * at.push / (2 * slope));
    ASSERT_LE(at.push_energy, 1.2 * at.push * at.push / (2 * slope) + 1e-15 * 5 * Base(law, kRadius).energy(overlap));
  }
  EXPECT_GT(loaded, 90000);
}

TEST(PlasticLaw, a_contact_that_bears_a_load_stores_energy) {
  expect_energy_beside_the_dent<LinearLaw>();
  expect_energy_beside_the_dent<HertzLaw>();
}

TEST(PlasticLaw, without_plasticity_it_is_the_law_itself) {
  const PairLaw law = pair_law<HertzLaw>(0, 0);
  const HertzLaw hertz(law, kRadius);
  const PlasticLaw<HertzLaw> plastic(law, kRadius);
  for (const double d : {1e-6, 1e-3, 7e-3}) {
    const auto at = plastic.at(d);
    EXPECT_EQ(at.push, hertz.force(d));
    EXPECT_EQ(at.push_energy, hertz.energy(d));
    EXPECT_EQ(at.pull, 0);
    EXPECT_EQ(at.dent, 0);
    EXPECT_EQ(at.yielded, 0);
  }
}

}  // namespace
}  // namespace scree
