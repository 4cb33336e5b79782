// docs/reference/contact-law.md section 5, test 7: an edge past the end of another, through parallel with it, and a wedge through coplanar.
// Section 3.7: dented bodies, cups and scans that turn against each other.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "tests/solver/contact_cases.hpp"

namespace scree {
namespace {

using test::TwoBodies;

/// A bar of square section with an edge up or down; the other lies across it.
struct CrossedBars {
  TwoBodies pair{test::grid_box(1, {1, .2, .2}), test::grid_box(1, {2, .2, .2}), 1e4, .02, 1, 0};
  static constexpr double kEdge = .14142135623730951;  // half of the section's diagonal
  CrossedBars() { pair.place(1, {}, quaternion_of({1, 0, 0}, std::numbers::pi / 4)); }
  /// A with its middle at `at`, turned about its own length by `roll` from standing on its edge, then about z by `yaw`.
  double energy(const Vec3& at, double roll, double yaw) {
    pair.place(0, at, quaternion_of({0, 0, 1}, yaw) * quaternion_of({1, 0, 0}, std::numbers::pi / 4 + roll));
    return pair.force(0).elastic;
  }
};

/// Follows U(t) for t in [0, 1]: with steps 8 times as short the largest change must be 8 times as small, which no jump
/// allows, and the slope stays what it was.
void expect_smooth(const std::function<double(double)>& energy, const char* what) {
  constexpr int kCoarse = 2000, kFine = 8 * kCoarse;
  const auto largest_change = [&](int steps) {
    double worst = 0, before = energy(0);
    for (int i = 1; i <= steps; ++i) {
      const double now = energy(static_cast<double>(i) / steps);
      worst = std::max(worst, std::abs(now - before));
      before = now;
    }
    return worst;
  };
  const double coarse = largest_change(kCoarse), fine = largest_change(kFine);
  double top = 0;
  for (int i = 0; i <= 100; ++i) top = std::max(top, energy(.01 * i));
  EXPECT_GT(top, 0) << what;
  EXPECT_GT(coarse, 0) << what;
  EXPECT_LE(fine, 1.3 * coarse / 8) << what;
  std::printf("%-28s U max %.2e J, largest slope %.1f U max\n", what, top, fine * kFine / top);
}

constexpr double kDeep = .012;  // overlap of the crossing edges, of a margin sum of 0.02
constexpr double kHeight = 2 * CrossedBars::kEdge + .02 - kDeep;

TEST(EdgeSweep, energy_is_continuous_as_an_edge_slides_past_the_end_of_another) {
  CrossedBars bars;
  expect_smooth([&](double t) { return bars.energy({0.03, -.7 + 1.4 * t, kHeight}, 0, std::numbers::pi / 2); }, "along its own length");
  expect_smooth([&](double t) { return bars.energy({.7 + .6 * t, .02, kHeight}, 0, std::numbers::pi / 2); }, "past the end of the other");
  expect_smooth([&](double t) { return bars.energy({.02, -.7 + 1.4 * t, kHeight}, 0, 1.1); }, "aslant");
}

TEST(EdgeSweep, energy_is_continuous_as_an_edge_turns_through_parallel) {
  CrossedBars bars;
  expect_smooth([&](double t) { return bars.energy({0, 0, kHeight}, 0, -.4 + .8 * t); }, "turning about its middle");
  expect_smooth([&](double t) { return bars.energy({.3, .001, kHeight}, 0, -.4 + .8 * t); }, "turning beside it");
  expect_smooth([&](double t) { return bars.energy({0, -.02 + .04 * t, kHeight}, 0, .02); }, "passing nearly parallel");
}

TEST(EdgeSweep, energy_is_continuous_as_a_wedge_tilts_through_coplanar) {
  CrossedBars bars;
  // height of the lowest point of a square section rolled by a: the overlap stays what it was
  const auto height = [](double roll) {
    return .1 * (std::abs(std::sin(std::numbers::pi / 4 + roll)) + std::abs(std::cos(std::numbers::pi / 4 + roll)));
  };
  expect_smooth(
      [&](double t) {
        const double roll = -.9 + 1.8 * t;
        return bars.energy({0, .03, CrossedBars::kEdge + height(roll) + .02 - kDeep}, roll, std::numbers::pi / 2);
      },
      "rolling over, crossed");
  expect_smooth(
      [&](double t) {
        const double roll = -.9 + 1.8 * t;
        return bars.energy({.1, .002, CrossedBars::kEdge + height(roll) + .02 - kDeep}, roll, .05);
      },
      "rolling over, nearly parallel");
}

/// A pair in contact, and a path on which A moves and turns by about the margin.
class TurningPath {
 public:
  TurningPath(TwoBodies& pair, std::mt19937& g) : pair_(pair), x_(pair.body[0].x), q_(pair.body[0].q) {
    std::normal_distribution<double> n;
    const double x = n(g), y = n(g), z = n(g), a = n(g), b = n(g), c = n(g);
    shift_ = (.7 * test::kMargin) * normalised(Vec3{x, y, z});
    turn_ = (.7 * test::kMargin / pair.radius(0)) * normalised(Vec3{a, b, c});
  }
  struct Place {
    double t, energy, slope;  // slope: -(power of the force on the way), dU/dt
    double deepest;           // of the margin
  };
  Place at(double t) const {
    pair_.body[0].x = x_ + t * shift_;
    pair_.body[0].q = normalised(quaternion_of(normalised(turn_), t * length(turn_)) * q_);
    const PairForce f = pair_.force(0);
    const Quat& q = pair_.body[0].q;
    return {t, f.elastic, -dot(rotate(q, f.force), shift_) - dot(rotate(q, f.torque), turn_), f.largest_overlap / test::kMargin};
  }

 private:
  TwoBodies& pair_;
  Vec3 x_;
  Quat q_;
  Vec3 shift_, turn_;
};

/// The largest jump of the energy on a path, by halving where its change is not that of its slope [k eps^2].
double largest_jump(const TurningPath& path, int pieces) {
  using Place = TurningPath::Place;
  constexpr double kUnit = test::kStiffness * test::kMargin * test::kMargin;
  const auto surprise = [](const Place& a, const Place& b) {
    return std::abs(b.energy - a.energy - .5 * (a.slope + b.slope) * (b.t - a.t)) / kUnit;
  };
  double jump = 0;
  Place from = path.at(0);
  for (int i = 1; i <= pieces; ++i) {
    const Place to = path.at(static_cast<double>(i) / pieces);
    if (to.deepest > .9) break;
    if (surprise(from, to) > 1e-7) {
      Place a = from, b = to;
      for (int n = 0; n < 40; ++n) {
        const Place middle = path.at(.5 * (a.t + b.t));
        (surprise(a, middle) > surprise(middle, b) ? b : a) = middle;
      }
      jump = std::max(jump, std::abs(b.energy - a.energy) / kUnit);
    }
    from = to;
  }
  return jump;
}

// Vertices in dents, edges across each other, several at once. What rounding leaves: places to 1e-16 of the radius are 5e-14 of the margin.
TEST(ConcaveBodies, energy_has_no_jump_on_turning_paths) {
  struct {
    const char* name;
    TriangleMesh a, b;
  } const pairs[] = {
      {"dented", test::scaled(test::rock(1, 2, .4), .5), test::scaled(test::rock(2, 2, .4), .5)},
      {"finely dented", test::scaled(test::rock(3, 3, .3), .5), test::scaled(test::rock(4, 2, .4), .5)},
      {"dented in a cup", test::scaled(test::rock(5, 2, .4), .2), test::bowl(.5, .4, 16, 6)},
  };
  std::mt19937 g(23);
  for (const auto& named : pairs) {
    double worst = 0;
    int shared = 0, paths = 0;
    for (int k = 0; k < 60; ++k) {
      TwoBodies pair(named.a, named.b, test::kStiffness, test::kMargin, 1, 0);
      place_at_random(pair, g);
      if (!pair.approach(1.8)) continue;
      pair.body[0].x += (.4 * test::kMargin) * normalised(pair.body[1].x - pair.body[0].x);
      pair.forget_lists();
      const TurningPath path(pair, g);
      if (const TurningPath::Place place = path.at(0); !(place.energy > 0) || place.deepest > .9) continue;
      for (const ContactFeature& f : pair.features) shared += f.faded ? 1 : 0;
      worst = std::max(worst, largest_jump(path, 100));
      ++paths;
    }
    EXPECT_GE(paths, 40) << named.name;
    EXPECT_GE(shared, 1) << named.name << ": some contacts must share";
    EXPECT_LE(worst, 1e-6) << named.name;
    std::printf("%-16s %d paths, %d faded contacts at their starts, largest jump %.1e k eps^2\n", named.name, paths, shared, worst);
  }
}

}  // namespace
}  // namespace scree
