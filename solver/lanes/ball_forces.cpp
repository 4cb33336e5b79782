// The kernels of ball_forces.hpp, compiled once for every instruction set (Highway's foreach_target); the best that the processor has is
// taken when the program runs. Compile for the baseline, never with -march=native.
//
// Letters: a, b the two balls; n from B to A; x the contact point, mid-gap; w angular velocities; all in the frame of A about its centre,
// as in chosen_law.cpp, unless said otherwise. The order of operations is that of the general path, line by line: whoever changes one
// changes both. Tests compare them (tests/solver/ball_forces_test.cpp), and the hashes of all recorded runs of balls do.
//
// What is left out. The mobility of a pair, Q M^-1 Q of its wrench (wrench_mobility), is |F|^2 / m* and what the torques T of the normal
// force about both centres add. Of balls they are zero but for rounding: with u = 2^-53 at most 4 u r_A |F| about A, and 30 u d |F| about
// B, d the distance of the centres (a wall has no inertia that they could turn). Three terms T_i^2 / I with I = 2/5 m r^2 are each below
// 2250 u^2 (d / r)^2 |F|^2 / m, which is less than half a unit in the last place of |F|^2 / m* while d < 1e6 r, and so never changes the
// sum. Pairs beyond kMaxDistance go the general way. Effective overlaps, D = d (1)^(1/8), and weights of 1 are the numbers themselves.
#include "solver/lanes/ball_forces.hpp"

#include <algorithm>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "solver/lanes/ball_forces.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "solver/lanes/ball_lanes-inl.hpp"
#include "solver/lanes/lane_contact-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace scree::HWY_NAMESPACE {

constexpr double kMaxDistance = 1e5;  ///< of centres, over the smaller radius; see above

/// Where A and B are, and where they meet.
struct Meeting {
  LaneQuat qa, turn;                  ///< of A; B to A
  Lane3 n, x, centre_b, pivot_b;      ///< frame of A
  Lane3 branch, v_b, w_b, pivot_v_b;  ///< world
  Lane gap, distance;                 ///< of the surfaces, of the centres
  Lane inverse_mass_b, radius_b;
  Lane equivalent_b;  ///< the radius that R* is made from
};

/// Two balls: sphere_pair_features.
HWY_INLINE Meeting meet_ball(const BallScene& scene, const LaneBody& a, const LaneBody& b) {
  const Lane one(1.0), half(0.5);
  Meeting m;
  m.qa = a.q;
  m.turn = conjugate(m.qa) * b.q;
  const Lane3 xa = a.x, xb = image_of(scene.periodicity, xa, b.x), between = xa - xb;
  m.distance = length(between);
  m.branch = xb - xa;
  m.radius_b = b.radius;
  m.gap = m.distance - a.radius - m.radius_b;
  m.n = rotate_inverse(m.qa, (one / m.distance) * between);
  m.x = (-(a.radius + half * m.gap)) * m.n;
  m.centre_b = m.pivot_b = rotate_inverse(m.qa, m.branch);
  m.v_b = m.pivot_v_b = b.v;
  m.w_b = b.w;
  m.inverse_mass_b = b.inverse_mass;
  m.equivalent_b = b.equivalent_radius;
  return m;
}

/// A ball at a wall: zone_pair_features, where the ball's only corner is its centre.
HWY_INLINE Meeting meet_wall(const BallScene& scene, const LaneBody& a, const WallRows& b) {
  const Lane zero(0.0), one(1.0), half(0.5);
  const Lane3 origin{zero, zero, zero};
  Meeting m;
  m.qa = a.q;
  m.turn = conjugate(m.qa) * b.of(&BallWall::q);
  const LaneMatrix rotation(m.turn);
  const Lane3 xa = a.x, direction = b.of(&BallWall::direction);
  m.branch = b.of(&BallWall::x) - xa;
  m.centre_b = rotate_inverse(m.qa, m.branch);
  const Lane3 r = rotation.transpose_times(origin - m.centre_b) - b.of(&BallWall::point);
  const Lane along = dot(r, direction);
  Lane3 normal = direction;
  Lane height = along;
  if (scene.laws.has_cylinders) {
    const Lane radius = b.of(&BallWall::radius);
    const auto is_round = radius > zero;
    const Lane3 radial = r - along * direction;
    const Lane rho = length(radial);
    normal = select(is_round, select(rho > zero, ((-one) / rho) * radial, origin), normal);
    height = select(is_round, radius - rho, height);
  }
  m.gap = height - a.radius;
  m.n = rotation.times(normal);
  m.x = origin - (a.radius + half * m.gap) * m.n;
  m.pivot_b = rotate_inverse(m.qa, b.of(&BallWall::pivot) - xa);
  m.v_b = b.of(&BallWall::v);
  m.w_b = b.of(&BallWall::w);
  m.pivot_v_b = b.of(&BallWall::pivot_v);
  m.distance = m.inverse_mass_b = m.radius_b = m.equivalent_b = zero;
  return m;
}

template <bool kWall, bool kRows>
HWY_INLINE Meeting meet(const BallScene& scene, const LaneBody& a, const BallPairs& pairs, std::size_t k) {
  if constexpr (kWall)
    return meet_wall(scene, a, WallRows(scene.walls, pairs.b.data() + k));
  else
    return meet_ball(scene, a, load_body<kRows>(scene, pairs.b.data() + k));
}

template <bool kWall>
void gaps_of(const BallScene& scene, const BallPairs& pairs, double* gap) {
  for (std::size_t k = 0; k < pairs.count; k += kLanes)
    meet<kWall, false>(scene, load_body<false>(scene, pairs.a.data() + k), pairs, k).gap.store(gap + k);
}

HWY_NOINLINE void gaps_in_lanes(const BallScene& scene, const BallPairs& pairs, double* gap) {
  pairs.with_walls ? gaps_of<true>(scene, pairs, gap) : gaps_of<false>(scene, pairs, gap);
}

/// What pairs keep no spring for, what they keep one for, and what two.
enum class Rubs { no, slides, slides_and_rolls };

/// What the lanes of one vector say of themselves.
struct LanesFound {
  Mask<double> fits;
  Lane ratio;  ///< overlap over maximum overlap
};

template <LaneLawKind kKind, Rubs kRubs, bool kWall, bool kRows>
HWY_INLINE LanesFound forces_in_lanes(const BallScene& scene, double dt, const BallPairs& pairs, BallSprings& springs, std::size_t k,
                                      BallForces& out) {
  const LaneLaws& laws = scene.laws;
  const LawRows<LaneLaw> law(laws.laws, springs.law.data() + k);
  const Lane zero(0.0), one(1.0), half(0.5), step(dt);
  const LaneBody a = load_body<kRows>(scene, pairs.a.data() + k);
  const Meeting m = meet<kWall, kRows>(scene, a, pairs, k);
  const Lane3 n = m.n, x = m.x;
  const Lane overlap = Lane(laws.margin) - m.gap;

  // the push
  const Lane equivalent_a = a.equivalent_radius;
  Lane radius = zero;
  if (laws.needs_radius) {
    const Lane given = law.at(&LaneLaw::radius);
    radius = kWall ? equivalent_a : equivalent_a * m.equivalent_b / (equivalent_a + m.equivalent_b);
    radius = select(given > zero, given, radius);
  }
  Lane push, energy;
  if constexpr (kKind == LaneLawKind::hertz_viscous) {
    const Lane c = law.at(&LaneLaw::stiffness) * sqrt(radius), root = sqrt(overlap);
    push = c * overlap * root;
    energy = Lane(0.4) * c * overlap * overlap * root;
  } else {
    const Lane stiffness = law.at(&LaneLaw::stiffness) + law.at(&LaneLaw::size_stiffness) * radius;
    push = stiffness * overlap;
    energy = half * stiffness * overlap * overlap;
  }
  const Lane3 force = push * n, torque = cross(x, force);

  // damping
  const Lane own = a.inverse_mass + m.inverse_mass_b, wrench = own * dot(force, force) / (push * push);
  const Lane mobility = select(own < wrench, wrench, own);
  const LaneDamping damping = damping_of<kKind>(law, energy, push, mobility, step);
  auto fits = damping.fits;
  if constexpr (!kWall) {
    const Lane most(kMaxDistance);
    fits = fits & (m.distance > zero) & (m.distance < most * a.radius) & (m.distance < most * m.radius_b);
  }
  const LaneMatrix a_to_world(m.qa);
  const Lane3 w_a = a_to_world.transpose_times(a.w), w_b = a_to_world.transpose_times(m.w_b);
  const Lane3 v_a = a_to_world.transpose_times(a.v), v_b = a_to_world.transpose_times(m.pivot_v_b);
  const Lane3 turning_a = cross(w_a, x), turning_b = cross(w_b, x - m.pivot_b);
  const Lane3 velocity = v_a + turning_a - v_b - turning_b;
  const Lane vn = dot(velocity, n), damped = damped_push<kKind>(damping, push, overlap, vn, step);
  Lane3 dissipative = (damped - push) * n;

  // friction
  Lane stored = zero;
  Lane3 moment{zero, zero, zero};
  if constexpr (kRubs != Rubs::no) {
    const Lane3 slip = velocity - (half * step) * (cross(w_a, turning_a) - cross(w_b, turning_b)), vt = slip - dot(slip, n) * n;
    const Lane kept = Lane::load(springs.kept.data() + k);
    const auto is_kept = kept > zero;
    const auto [spring_force, spring_stiffness] = load_fours(springs.spring, k);
    const Lane3 spring_normal = load_fours(springs.normal, k).first;
    const auto [turn_v, turn_w] = load_fours(springs.turn, k);
    const LaneFriction friction{half_turn(LaneQuat{turn_w, turn_v.x, turn_v.y, turn_v.z}, m.turn),
                                law.at(&LaneLaw::friction),
                                law.at(&LaneLaw::friction_sliding),
                                law.at(&LaneLaw::tangential_ratio),
                                law.at(&LaneLaw::tangential_damping) * damping.chi,
                                Lane(kStiffnessRounding) * length(m.centre_b)};
    LaneSpring spring{spring_force, spring_stiffness, spring_normal};
    dissipative = dissipative + friction.force({n, vt, overlap, vn, push, damped}, overlap, is_kept, step, spring);
    stored = with_energy({spring.force, spring.stiffness}, stored);
    if constexpr (kRubs == Rubs::slides_and_rolls) {
      const LawRows<BallRolling> rolling(laws.rolling, springs.law.data() + k);
      const Lane size = length(force);
      const RollingState state{(one / size) * force,
                               w_a - w_b,
                               push,
                               push / (push / overlap),
                               radius,
                               friction.damping,
                               rolling.at(&BallRolling::friction) * radius * push,
                               rolling.at(&BallRolling::torsional) * radius * push,
                               friction.tangential_ratio};
      const auto [old_roll, old_stiffness] = load_fours(springs.rolling, k);
      const Lane3 none{zero, zero, zero};
      const RollingMoment rolls =
          rolling_spring(state, select(is_kept, turned_by(friction.turned, old_roll), none), select(is_kept, old_stiffness, zero), step);
      moment = rolls.moment;
      stored = with_energy({rolls.spring, rolls.stiffness}, stored);
      fits = fits & (size > zero);
      store_fours(select(fits, rolls.spring, old_roll), select(fits, rolls.stiffness, old_stiffness), k, springs.rolling);
    }
    // those that are left keep what they have
    store_fours(select(fits, spring.force, spring_force), select(fits, spring.stiffness, spring_stiffness), k, springs.spring);
    store_fours(select(fits, spring.normal, spring_normal), zero, k, springs.normal);
    store_fours(select(fits, Lane3{m.turn.x, m.turn.y, m.turn.z}, turn_v), select(fits, m.turn.w, turn_w), k, springs.turn);
    select(fits, one, kept).store(springs.kept.data() + k);
  }

  // onto the bodies
  select(fits, zero, one).store(out.left.data() + k);
  m.gap.store(out.gap.data() + k);
  Lane3 dissipative_torque = cross(x, dissipative);
  if constexpr (kRubs == Rubs::slides_and_rolls) dissipative_torque = dissipative_torque + moment;
  const Lane3 force_a = a_to_world.times(force + dissipative), torque_a = a_to_world.times(torque + dissipative_torque);
  const Lane3 lost_a = a_to_world.times(dissipative), lost_torque_a = a_to_world.times(dissipative_torque);
  const Lane3 torque_b = cross(m.branch, force_a) - torque_a, lost_torque_b = cross(m.branch, lost_a) - lost_torque_a;
  Lane ratio = zero;
  if (laws.max_overlap_by_size)
    ratio = overlap / (kWall ? equivalent_a : select(m.equivalent_b < equivalent_a, m.equivalent_b, equivalent_a));
  else if (laws.margin > 0)
    ratio = overlap / Lane(laws.margin);
  store_fours(force_a, ratio, k, out.fours[0]);
  store_fours(torque_a, energy, k, out.fours[1]);
  store_fours(torque_b, stored, k, out.fours[2]);
  store_fours(lost_a, zero, k, out.fours[3]);
  store_fours(lost_torque_a, zero, k, out.fours[4]);
  store_fours(lost_torque_b, zero, k, out.fours[5]);
  return {fits, ratio};
}

template <LaneLawKind kKind, Rubs kRubs, bool kWall, bool kRows>
HWY_NOINLINE BallSummary forces_of(const BallScene& scene, double dt, const BallPairs& pairs, BallSprings& springs, BallForces& out) {
  const Lane zero(0.0);
  Lane largest = zero;
  BallSummary summary;
  for (std::size_t k = 0; k < pairs.count; k += kLanes) {
    const LanesFound found = forces_in_lanes<kKind, kRubs, kWall, kRows>(scene, dt, pairs, springs, k, out);
    largest = select(found.fits & (largest < found.ratio), found.ratio, largest);
    summary.some_left = summary.some_left || any(!found.fits);
  }
  alignas(64) double of_lanes[kLanes];
  largest.store(of_lanes);
  summary.largest = *std::max_element(of_lanes, of_lanes + kLanes);
  return summary;
}

template <LaneLawKind kKind, Rubs kRubs>
BallSummary forces_with(const BallScene& scene, double dt, const BallPairs& pairs, BallSprings& springs, BallForces& out) {
  if (pairs.with_walls) return forces_of<kKind, kRubs, true, false>(scene, dt, pairs, springs, out);
  return scene.rows != nullptr ? forces_of<kKind, kRubs, false, true>(scene, dt, pairs, springs, out)
                               : forces_of<kKind, kRubs, false, false>(scene, dt, pairs, springs, out);
}

template <LaneLawKind kKind>
BallSummary forces_of_kind(const BallScene& scene, double dt, const BallPairs& pairs, BallSprings& springs, BallForces& out) {
  if (!scene.laws.friction) return forces_with<kKind, Rubs::no>(scene, dt, pairs, springs, out);
  if (scene.laws.rolling.empty()) return forces_with<kKind, Rubs::slides>(scene, dt, pairs, springs, out);
  return forces_with<kKind, Rubs::slides_and_rolls>(scene, dt, pairs, springs, out);
}

HWY_NOINLINE BallSummary forces_of_any(const BallScene& scene, double dt, const BallPairs& pairs, BallSprings& springs, BallForces& out) {
  switch (scene.laws.kind) {
    case LaneLawKind::linear_viscous:
      return forces_of_kind<LaneLawKind::linear_viscous>(scene, dt, pairs, springs, out);
    case LaneLawKind::linear_hunt_crossley:
      return forces_of_kind<LaneLawKind::linear_hunt_crossley>(scene, dt, pairs, springs, out);
    case LaneLawKind::hertz_viscous:
      return forces_of_kind<LaneLawKind::hertz_viscous>(scene, dt, pairs, springs, out);
    case LaneLawKind::none:
      break;
  }
  return {};
}

}  // namespace scree::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace scree {
namespace {

HWY_EXPORT(gaps_in_lanes);
HWY_EXPORT(forces_of_any);

/// Lanes beyond the last pair repeat it.
template <class Column>
void fill_up(std::size_t count, Column& column) {
  constexpr std::size_t kMaxLanes = 8;
  static_assert(kBallPairs % kMaxLanes == 0);
  for (std::size_t k = count; k % kMaxLanes != 0; ++k) column[k] = column[count - 1];
}

}  // namespace

void find_ball_gaps(const BallScene& scene, BallPairs& pairs, double* gap) {
  fill_up(pairs.count, pairs.a);
  fill_up(pairs.count, pairs.b);
  HWY_DYNAMIC_DISPATCH(gaps_in_lanes)(scene, pairs, gap);
}

BallSummary find_ball_forces(const BallScene& scene, double dt, BallPairs& pairs, BallSprings& springs, BallForces& forces) {
  fill_up(pairs.count, pairs.a);
  fill_up(pairs.count, pairs.b);
  fill_up(pairs.count, springs.law);
  fill_up(pairs.count, springs.kept);
  return HWY_DYNAMIC_DISPATCH(forces_of_any)(scene, dt, pairs, springs, forces);
}

}  // namespace scree
#endif
