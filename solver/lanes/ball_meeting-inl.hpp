// Where two balls, or a ball and a plane or cylinder, are against each other, a pair in each lane, and what of a pair does not change from
// step to step. Included by ball_forces.cpp once for every instruction set.
#if defined(SCREE_SOLVER_LANES_BALL_MEETING_INL_HPP_) == defined(HWY_TARGET_TOGGLE)
#ifdef SCREE_SOLVER_LANES_BALL_MEETING_INL_HPP_
#undef SCREE_SOLVER_LANES_BALL_MEETING_INL_HPP_
#else
#define SCREE_SOLVER_LANES_BALL_MEETING_INL_HPP_
#endif

#include <hwy/highway.h>

#include "solver/lanes/ball_lanes-inl.hpp"
#include "solver/lanes/lane_contact-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace scree::HWY_NAMESPACE {

/// What of two balls is found in each step where it is not kept.
struct OfPair {
  Lane radius_a, radius_b, radius, stiffness, mobility, mass, inverse_limit;
};

template <Of kOf>
HWY_INLINE Lane3 load_vector(const BallScene& scene, std::size_t first, const std::int32_t* a, const std::int32_t* b) {
  Lane column[4];
  load_quarters<kOf>(scene.rows, a, b, first, column);
  return {column[0], column[1], column[2]};
}

/// Two balls: sphere_pair_features.   in   pair   its radii
template <bool kRows, bool kRolls>
HWY_INLINE BallsApart apart(const BallScene& scene, const BallPairs& pairs, std::size_t k, const OfPair& pair) {
  const std::int32_t *const a = &pairs.a(k), *const b = &pairs.b(k);
  const auto image = [&](const Lane3& xa, const Lane3& xb) { return xa - image_of(scene.periodicity, xa, xb); };
  const auto with_cell = [&](const Lane3& vb, const Lane3& between) {
    const Lane zero(0.0);
    return vb + velocity_along(scene.p.cell, Lane3{zero, zero, zero} - between);
  };
  if (kRows || scene.rows != nullptr) {
    BallsApart balls;
    if (scene.periodicity.any())
      balls.between = image(load_vector<Of::one>(scene, 0, a, a), load_vector<Of::one>(scene, 0, b, b));
    else
      balls.between = load_vector<Of::difference>(scene, 0, a, b);
    if (scene.p.cell.deforms())
      balls.velocity = load_vector<Of::one>(scene, 4, a, a) - with_cell(load_vector<Of::one>(scene, 4, b, b), balls.between);
    else
      balls.velocity = load_vector<Of::difference>(scene, 4, a, b);
    const Lane3 wa = load_vector<Of::one>(scene, 8, a, a), wb = load_vector<Of::one>(scene, 8, b, b);
    balls.spins = wa + wb;
    balls.surface_spins = pair.radius_a * wa + pair.radius_b * wb;
    if constexpr (kRolls) balls.relative_spin = wa - wb;
    return balls;
  } else {
    const ParticleSet& p = scene.p;
    const Rows row_a(a), row_b(b);
    const Lane3 xa = row_a.of(p.x), xb = row_b.of(p.x), wa = row_a.of(p.w), wb = row_b.of(p.w);
    const Lane3 between = image(xa, xb), vb = row_b.of(p.v);
    return {between, row_a.of(p.v) - (p.cell.deforms() ? with_cell(vb, between) : vb), wa + wb, pair.radius_a * wa + pair.radius_b * wb,
            wa - wb};
  }
}

/// A ball at a wall: zone_pair_features, where the ball's only corner is its centre.
struct AtWall {
  WallBeside wall;
  Lane3 branch;
  Lane gap;
};
template <class Walls>
HWY_INLINE AtWall at_wall(const BallScene& scene, const Lane3& x, Lane radius, const Walls& b) {
  const Lane zero(0.0), one(1.0);
  const Lane3 origin{zero, zero, zero};
  const LaneMatrix rotation(b.of(&BallWall::q));
  const Lane3 direction = b.of(&BallWall::direction), branch = b.of(&BallWall::x) - x;
  const Lane3 r = rotation.transpose_times(origin - branch) - b.of(&BallWall::point);
  const Lane along = dot(r, direction);
  Lane3 normal = direction;
  Lane height = along, cylinder = zero;
  if (scene.laws.has_cylinders) {
    cylinder = b.of(&BallWall::radius);
    const auto is_round = cylinder > zero;
    const Lane3 radial = r - along * direction;
    const Lane rho = length(radial);
    normal = select(is_round, select(rho > zero, ((-one) / rho) * radial, origin), normal);
    height = select(is_round, cylinder - rho, height);
  }
  const Lane3 axis = rotation.times(direction);
  return {
      {rotation.times(normal), axis, cylinder, x - b.of(&BallWall::pivot), b.of(&BallWall::pivot_v), b.of(&BallWall::w), length(branch)},
      branch,
      height - radius};
}

/// Push over overlap, or over overlap^(3/2).
template <LaneLawKind kKind>
HWY_INLINE Lane stiffness_of(const LawRows<LaneLaw>& law, Lane radius) {
  if constexpr (kKind == LaneLawKind::hertz_viscous) return law.at(&LaneLaw::stiffness) * sqrt(radius);
  return law.at(&LaneLaw::stiffness) + law.at(&LaneLaw::size_stiffness) * radius;
}

/// in   kWall   of a ball and a wall
template <LaneLawKind kKind, bool kWall>
HWY_INLINE OfPair find_pair(const BallScene& scene, const LawRows<LaneLaw>& law, const BallPairs& pairs, std::size_t k) {
  const ParticleSet& p = scene.p;
  const LaneLaws& laws = scene.laws;
  const Rows a(&pairs.a(k)), b(&pairs.b(k));  // of a wall, b is not looked at
  const Lane zero(0.0), one(1.0);
  const Lane equivalent_a = a.of(p.equivalent_radius);
  OfPair pair;
  pair.radius_a = a.of(p.ball_radius);
  pair.mobility = a.of(p.inverse_mass);
  Lane smaller = equivalent_a, both = equivalent_a;
  if constexpr (!kWall) {
    const Lane equivalent_b = b.of(p.equivalent_radius);
    pair.radius_b = b.of(p.ball_radius);
    pair.mobility = pair.mobility + b.of(p.inverse_mass);
    smaller = select(equivalent_b < equivalent_a, equivalent_b, equivalent_a);
    both = equivalent_a * equivalent_b / (equivalent_a + equivalent_b);
  } else {
    pair.radius_b = zero;
  }
  pair.radius = zero;
  if (laws.needs_radius) {
    const Lane given = law.at(&LaneLaw::radius);
    pair.radius = select(given > zero, given, both);
  }
  pair.stiffness = stiffness_of<kKind>(law, pair.radius);
  pair.mass = one / pair.mobility;
  pair.inverse_limit = laws.max_overlap_by_size ? one / smaller : laws.margin > 0 ? one / Lane(laws.margin) : zero;
  return pair;
}

// NOLINTNEXTLINE(google-readability-namespace-comments)
}  // namespace scree::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
