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

/// A block with a groove along y in its top, whose walls go down by 22 degrees to a bottom at z = 0 that is `bottom` wide.
TriangleMesh grooved_block(double bottom) {
  const double h = .5 * bottom;
  const std::vector<std::array<double, 2>> outline{{-.5, -.5}, {.5, -.5}, {.5, .16},      {h + .4, .16},
                                                   {h, 0},     {-h, 0},   {-h - .4, .16}, {-.5, .16}};
  const auto n = static_cast<std::int32_t>(outline.size());
  TriangleMesh mesh;
  for (const double y : {-.4, .4}) {
    for (const auto& p : outline) mesh.vertices.push_back({p[0], y, p[1]});
    mesh.vertices.push_back({0, y, -.25});  // sees the whole outline
  }
  for (std::int32_t i = 0; i < n; ++i) {
    const std::int32_t j = (i + 1) % n, far = n + 1;
    mesh.triangles.push_back({i, far + j, far + i});
    mesh.triangles.push_back({i, j, far + j});
    mesh.triangles.push_back({n, j, i});
    mesh.triangles.push_back({far + n, far + i, far + j});
  }
  for (Triangle& t : mesh.triangles) std::swap(t[1], t[2]);
  return mesh;
}

/// A pair in contact, and a path on which A moves by `shift` and turns by `turn` (a rotation vector) about its middle.
class TurningPath {
 public:
  TurningPath(TwoBodies& pair, const Vec3& shift, const Vec3& turn)
      : pair_(pair), x_(pair.body[0].x), q_(pair.body[0].q), shift_(shift), turn_(turn) {}
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

Vec3 random_direction(std::mt19937& g) {
  std::normal_distribution<double> n;
  const double x = n(g), y = n(g), z = n(g);
  return normalised(Vec3{x, y, z});
}

// Vertices in dents, edges across each other, several at once.
TEST(ConcaveBodies, energy_has_no_jump_on_turning_paths) {
  struct {
    const char* name;
    TriangleMesh a, b;
  } const pairs[] = {
      {"dented", test::scaled(test::rock(1, 2, .4), .5), test::scaled(test::rock(2, 2, .4), .5)},
      {"finely dented", test::scaled(test::rock(3, 3, .4), .5), test::scaled(test::rock(1, 3, .4), .5)},
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
      const Vec3 apart = normalised(pair.body[1].x - pair.body[0].x);
      pair.body[0].x += (.4 * test::kMargin) * apart;
      pair.forget_lists();
      const Vec3 aside = normalised(cross(apart, random_direction(g)));
      const TurningPath path(pair, (2 * test::kMargin) * aside, (2 * test::kMargin / pair.radius(0)) * random_direction(g));
      if (const TurningPath::Place place = path.at(0); !(place.energy > 0) || place.deepest > .9) continue;
      for (const ContactFeature& f : pair.features) shared += f.faded ? 1 : 0;
      worst = std::max(worst, largest_jump(path, 200));
      ++paths;
    }
    EXPECT_GE(paths, 40) << named.name;
    EXPECT_GE(shared, 1) << named.name << ": some contacts must share";
    EXPECT_LE(worst, 1e-6) << named.name;
    std::printf("%-16s %d paths, %d faded contacts at their starts, largest jump %.1e k eps^2\n", named.name, paths, shared, worst);
  }
}

// The bottom ends before the wall does: its foot is a minimum here and none there. Minima alone as screens jump by 1e-3.
TEST(ConcaveBodies, energy_has_no_jump_as_a_tip_turns_in_a_groove_with_a_narrow_bottom) {
  std::mt19937 g(29);
  std::uniform_real_distribution<double> u(0, 1);
  constexpr double kSide = .2, kHalf = .5 * kSide;
  double worst = 0;
  int paths = 0;
  for (int k = 0; k < 200; ++k) {
    const double bottom = (.1 + .8 * u(g)) * test::kMargin;
    TwoBodies pair(test::grid_box(1, {kSide, kSide, kSide}), grooved_block(bottom), test::kStiffness, test::kMargin, 1, 0);
    pair.place(1, {});
    // a corner of the cube down, about so, over the bottom
    const Quat down = quaternion_of(normalised(Vec3{1, -1, 0}), std::acos(1 / std::sqrt(3.)));
    const Quat turn = quaternion_of(random_direction(g), .2) * quaternion_of({0, 0, 1}, 6 * u(g)) * down;
    const double x = (u(g) - .5) * test::kMargin, z = (.5 + .6 * u(g)) * test::kMargin;
    const auto tip_from = [&](const Vec3& middle) {  // the lowest corner
      Vec3 lowest{0, 0, 1};
      for (int c = 0; c < 8; ++c) {
        const Vec3 corner = middle + rotate(turn, {c & 1 ? kHalf : -kHalf, c & 2 ? kHalf : -kHalf, c & 4 ? kHalf : -kHalf});
        if (corner.z < lowest.z) lowest = corner;
      }
      return lowest;
    };
    const Vec3 tip{x, 0, z};
    pair.place(0, tip - tip_from({}), turn);
    pair.forget_lists();
    const Vec3 way = test::kMargin * Vec3{u(g) - .5, u(g) - .5, .4 * (u(g) - .5)};
    const TurningPath path(pair, way, (test::kMargin / kSide) * random_direction(g));
    if (const TurningPath::Place place = path.at(0); !(place.energy > 0) || place.deepest > .9) continue;
    worst = std::max(worst, largest_jump(path, 200));
    ++paths;
  }
  EXPECT_GE(paths, 60);
  EXPECT_LE(worst, 1e-6);
  std::printf("%d paths, largest jump %.1e k eps^2\n", paths, worst);
}

}  // namespace
}  // namespace scree
