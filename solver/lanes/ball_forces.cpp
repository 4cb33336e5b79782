// The kernels of ball_forces.hpp, compiled once for every instruction set (Highway's foreach_target); the best that the processor has is
// taken when the program runs. Compile for the baseline, never with -march=native.
//
// Letters: a, b the two balls; n from B to A; w angular velocities; all in world axes. The law is one text for lanes and for single pairs
// (laws/ball-inl.hpp); what stands around it here has the order of operations of contact/ball_contact.cpp: whoever changes one changes
// both. Tests compare them (tests/solver/ball_forces_test.cpp).
//
// What a contact at rest costs: the roots of the distance, of the overlap and of the stiffness over the mass, the quotients of the normal
// and of the lag. The latency of this chain is the limit, not the number of operations. So all else that would take a root or a quotient is
// kept with the pair (BallConstants), or made only where a lane needs it.
#include "solver/lanes/ball_forces.hpp"

#include <algorithm>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "solver/lanes/ball_forces.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "solver/lanes/ball_lanes-inl.hpp"
#include "solver/lanes/ball_meeting-inl.hpp"
#include "solver/lanes/lane_contact-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace scree::HWY_NAMESPACE {

/// A vector of the balls of some pairs, from rows where there are some.   in   first   its place in a row
HWY_INLINE Lane3 vector_of_a(const BallScene& scene, const std::int32_t* rows, std::size_t first, const std::vector<Vec3>& column) {
  return scene.rows != nullptr ? load_vector<Of::one>(scene, first, rows, rows) : Rows(rows).of(column);
}

template <bool kWall>
void gaps_of(const BallScene& scene, const BallPairs& pairs, double* gap) {
  for (std::size_t k = 0; k < pairs.count; k += kLanes) {
    const Rows a(&pairs.a(k));
    const Lane radius = a.of(scene.p.ball_radius);
    if constexpr (kWall) {
      at_wall(scene, vector_of_a(scene, &pairs.a(k), 0, scene.p.x), radius, WallRows(scene.walls, &pairs.b(k))).gap.store(gap + k);
    } else {
      const Rows b(&pairs.b(k));
      const OfPair pair{radius, b.of(scene.p.ball_radius), {}, {}, {}, {}, {}};
      const Lane3 between = apart<false, false>(scene, pairs, k, pair).between;
      (length(between) - pair.radius_a - pair.radius_b).store(gap + k);
    }
  }
}

HWY_NOINLINE void gaps_in_lanes(const BallScene& scene, const BallPairs& pairs, double* gap) {
  pairs.with_walls ? gaps_of<true>(scene, pairs, gap) : gaps_of<false>(scene, pairs, gap);
}

HWY_INLINE OfPair load_pair(const BallConstants& c, std::size_t place) {
  const std::size_t k = place & c.places;
  return {Lane::load(&c.radius_a[k]), Lane::load(&c.radius_b[k]), Lane::load(&c.radius[k]),       Lane::load(&c.stiffness[k]),
          Lane::load(&c.mobility[k]), Lane::load(&c.mass[k]),     Lane::load(&c.inverse_limit[k])};
}

template <LaneLawKind kKind, bool kWall>
void constants_of_kind(const BallScene& scene, const BallPairs& pairs, const BallSprings& springs, BallConstants& c) {
  for (std::size_t k = 0; k < pairs.count; k += kLanes) {
    const OfPair pair = find_pair<kKind, kWall>(scene, LawRows<LaneLaw>(scene.laws.laws, springs.law.data() + k), pairs, k);
    pair.radius_a.store(&c.radius_a[k]);
    pair.radius_b.store(&c.radius_b[k]);
    pair.radius.store(&c.radius[k]);
    pair.stiffness.store(&c.stiffness[k]);
    pair.mobility.store(&c.mobility[k]);
    pair.mass.store(&c.mass[k]);
    pair.inverse_limit.store(&c.inverse_limit[k]);
  }
}

template <LaneLawKind kKind>
void constants_with(const BallScene& scene, const BallPairs& pairs, const BallSprings& springs, BallConstants& c) {
  pairs.with_walls ? constants_of_kind<kKind, true>(scene, pairs, springs, c) : constants_of_kind<kKind, false>(scene, pairs, springs, c);
}

HWY_NOINLINE void constants_in_lanes(const BallScene& scene, const BallPairs& pairs, const BallSprings& springs, BallConstants& c) {
  if (scene.laws.kind == LaneLawKind::hertz_viscous)
    constants_with<LaneLawKind::hertz_viscous>(scene, pairs, springs, c);
  else  // stiffness alone differs
    constants_with<LaneLawKind::linear_viscous>(scene, pairs, springs, c);
}

/// What pairs keep no spring for, what they keep one for, and what two.
enum class Rubs { no, slides, slides_and_rolls };

/// What the lanes of one vector say of themselves.
struct LanesFound {
  Mask<double> fits;
  Lane ratio;  ///< overlap over maximum overlap
  bool all_fit;
};

/// How much of the push damping takes away or adds.
struct PushDamping {
  Lane damping, damped;  ///< [N s/m], [N]
  Mask<double> fits;     ///< lanes have the formula
};

template <LaneLawKind kKind>
HWY_INLINE PushDamping damp(const LawRows<LaneLaw>& law, const OfPair& pair, const BallMeeting& m, Lane push, Lane secant, Lane step) {
  constexpr bool kViscous = kKind != LaneLawKind::linear_hunt_crossley;
  const Lane one(1.0), number = law.at(&LaneLaw::damping);
  BallDamping d;
  if constexpr (kViscous) {
    const Lane factor = kKind == LaneLawKind::hertz_viscous ? number * Lane(kHertzEnergyFactor) : number;
    d = viscous_damping(factor, secant, pair.mobility, pair.mass, step);
  } else {
    const Lane damping = number * push;
    d = {damping, damping * pair.mobility * step, one};
  }
  const Lane closing = (-m.vn) * step;
  Lane weight = one;  // never above the most that it may be
  if (any(m.overlap < closing)) {
    const Lane most = kViscous ? most_onset_of(d.rate, d.lagged, Lane(ViscousDamping::kMaxOnset)) : one;
    const Lane onset = onset_weight(m.overlap, closing);
    weight = select(onset < most, onset, most);
  }
  const Lane free_rate(kViscous ? ViscousDamping::kFreeRate : HuntCrossleyDamping::kFreeRate), zero(0.0);
  return {d.damping, damped_by(push, d.damping, weight, m.vn), (push > zero) & (pair.mobility > zero) & (d.rate <= free_rate)};
}

template <LaneLawKind kKind, Rubs kRubs, bool kWall, bool kBlock>
HWY_INLINE LanesFound forces_in_lanes(const BallScene& scene, double dt, const BallPairs& pairs, const BallConstants* constants,
                                      BallSprings& springs, std::size_t k, BallForces& out) {
  const LaneLaws& laws = scene.laws;
  const LawRows<LaneLaw> law(laws.laws, springs.law.data() + k);
  const Lane zero(0.0), one(1.0), half(0.5), step(dt), half_step(0.5 * dt);
  OfPair pair;
  if constexpr (kBlock)
    pair = load_pair(*constants, k);
  else
    pair = find_pair<kKind, kWall>(scene, law, pairs, k);

  BallMeeting m;
  Lane gap, depth;  // half of the overlap without margins
  Mask<double> fits{};
  if constexpr (kWall) {
    const std::int32_t* const rows = &pairs.a(k);
    Lane3 x, v, w;
    AtWall at;
    if constexpr (kBlock) {
      x = load_vector<Of::one>(scene, 0, rows, rows);
      v = load_vector<Of::one>(scene, 4, rows, rows);
      w = load_vector<Of::one>(scene, 8, rows, rows);
      at = at_wall(scene, x, pair.radius_a, OneWall(scene.walls[static_cast<std::size_t>(pairs.b(0))]));
    } else {
      x = vector_of_a(scene, rows, 0, scene.p.x);
      v = vector_of_a(scene, rows, 4, scene.p.v);
      w = vector_of_a(scene, rows, 8, scene.p.w);
      at = at_wall(scene, x, pair.radius_a, WallRows(scene.walls, &pairs.b(k)));
    }
    gap = at.gap;
    const Lane overlap = Lane(laws.margin) - gap;
    depth = half * (overlap - Lane(laws.margin));
    const Lane reach = pair.radius_a - depth, from_axis = at.wall.curvature - (reach - depth);  // it holds the radius so far
    at.wall.curvature = select((at.wall.curvature > zero) & (from_axis > zero), one / from_axis, zero);
    m = meeting_of(at.wall, v, w, reach, overlap, half_step);
  } else {
    const BallsApart balls = apart<kBlock, kRubs == Rubs::slides_and_rolls>(scene, pairs, k, pair);
    const Lane distance = length(balls.between);
    gap = distance - pair.radius_a - pair.radius_b;
    const Lane overlap = Lane(laws.margin) - gap;
    depth = half * (overlap - Lane(laws.margin));
    m = meeting_of(balls, distance, overlap, depth, half_step);
    fits = distance > zero;
  }
  Lane secant = pair.stiffness;
  if constexpr (kKind == LaneLawKind::hertz_viscous) secant = pair.stiffness * sqrt(m.overlap);
  const Lane push = secant * m.overlap, energy = Lane(kKind == LaneLawKind::hertz_viscous ? 0.4 : 0.5) * push * m.overlap;
  const PushDamping d = damp<kKind>(law, pair, m, push, secant, step);
  fits = kWall ? d.fits : fits & d.fits;

  Lane3 lost = (d.damped - push) * m.n, across{zero, zero, zero};
  if constexpr (kRubs != Rubs::no) {
    const Lane3 before{Lane::load(&pairs.spring(k, 0)), Lane::load(&pairs.spring(k, 1)), Lane::load(&pairs.spring(k, 2))};
    const Lane stiffness = Lane::load(&pairs.spring(k, 3));
    const Lane damping = law.at(&LaneLaw::tangential_damping) * d.damping;
    const SlidingContact contact{m.n,
                                 slip_of(m),
                                 m.vn,
                                 m.overlap,
                                 law.at(&LaneLaw::tangential_ratio) * secant,
                                 damping,
                                 law.at(&LaneLaw::friction) * d.damped,
                                 law.at(&LaneLaw::friction_sliding) * d.damped};
    ContactSpring spring{before, stiffness};
    Lane stretched;
    const Lane3 tangential = friction_force(contact, !equal(stiffness, zero), taken_along(m, before, half_step),
                                            Lane(kStiffnessRounding) * m.distance, step, spring, stretched);
    across = cross(m.n, tangential);
    lost = lost + tangential;
    if constexpr (kRubs == Rubs::slides_and_rolls) {
      const LawRows<BallRolling> rolling(laws.rolling, springs.law.data() + k);
      const RollingState state{m.n,
                               m.relative_spin,
                               push,
                               m.overlap,
                               pair.radius,
                               damping / push,
                               rolling.at(&BallRolling::friction) * pair.radius * push,
                               rolling.at(&BallRolling::torsional) * pair.radius * push,
                               law.at(&LaneLaw::tangential_ratio)};
      const auto [rolled, old_stiffness] = load_fours(springs.rolling, k);
      const RollingMoment rolls = rolling_spring(state, turned_by(mean_turn(m.spins, half_step), rolled), old_stiffness, step);
      store_fours(select(fits, rolls.spring, rolled), select(fits, rolls.stiffness, old_stiffness), k, springs.rolling);
      store_rows(rolls.moment, zero, &out.moments[k].v.x, sizeof(PaddedVec3) / sizeof(double));
    }
    // those that are left keep what they have
    const Lane3 kept = select(fits, spring.force, before);
    kept.x.store(&pairs.spring(k, 0));
    kept.y.store(&pairs.spring(k, 1));
    kept.z.store(&pairs.spring(k, 2));
    select(fits, spring.stiffness, stiffness).store(&pairs.spring(k, 3));
  }
  const Lane ratio = m.overlap * pair.inverse_limit;
  const bool all_fit = !any(!fits);
  if (!kBlock || !all_fit) {
    select(fits, zero, one).store(out.left.data() + k);
    gap.store(out.gap.data() + k);
  }
  BallSlot* const slots = out.slots + k;
  constexpr std::size_t kStride = sizeof(BallSlot) / sizeof(double);
  store_rows(push * m.n + lost, energy, &slots->force.x, kStride);
  store_rows(across, depth, &slots->across.x, kStride);
  store_rows(lost, ratio, &slots->lost.x, kStride);
  return {fits, ratio, all_fit};
}

template <LaneLawKind kKind, Rubs kRubs, bool kWall, bool kBlock>
HWY_NOINLINE BallSummary forces_of(const BallScene& scene, double dt, const BallPairs& pairs, const BallConstants* constants,
                                   BallSprings& springs, BallForces& out) {
  const Lane zero(0.0);
  Lane largest = zero;
  BallSummary summary;
  for (std::size_t k = 0; k < pairs.count; k += kLanes) {
    const LanesFound found = forces_in_lanes<kKind, kRubs, kWall, kBlock>(scene, dt, pairs, constants, springs, k, out);
    largest = select(found.fits & (largest < found.ratio), found.ratio, largest);
    if (kBlock && found.all_fit) continue;
    summary.some_left = summary.some_left || !found.all_fit;
    summary.written |= (~std::uint64_t{0} >> (64 - kLanes)) << k;
  }
  alignas(64) double of_lanes[kLanes];
  largest.store(of_lanes);
  summary.largest = *std::max_element(of_lanes, of_lanes + kLanes);
  return summary;
}

template <LaneLawKind kKind, Rubs kRubs>
BallSummary forces_with(const BallScene& scene, double dt, const BallPairs& pairs, const BallConstants* constants, BallSprings& springs,
                        BallForces& out) {
  if (pairs.with_walls)
    return constants != nullptr ? forces_of<kKind, kRubs, true, true>(scene, dt, pairs, constants, springs, out)
                                : forces_of<kKind, kRubs, true, false>(scene, dt, pairs, constants, springs, out);
  return constants != nullptr ? forces_of<kKind, kRubs, false, true>(scene, dt, pairs, constants, springs, out)
                              : forces_of<kKind, kRubs, false, false>(scene, dt, pairs, constants, springs, out);
}

template <LaneLawKind kKind>
BallSummary forces_of_kind(const BallScene& scene, double dt, const BallPairs& pairs, const BallConstants* constants, BallSprings& springs,
                           BallForces& out) {
  if (!scene.laws.friction) return forces_with<kKind, Rubs::no>(scene, dt, pairs, constants, springs, out);
  if (scene.laws.rolling.empty()) return forces_with<kKind, Rubs::slides>(scene, dt, pairs, constants, springs, out);
  return forces_with<kKind, Rubs::slides_and_rolls>(scene, dt, pairs, constants, springs, out);
}

HWY_NOINLINE BallSummary forces_of_any(const BallScene& scene, double dt, const BallPairs& pairs, const BallConstants* constants,
                                       BallSprings& springs, BallForces& out) {
  switch (scene.laws.kind) {
    case LaneLawKind::linear_viscous:
      return forces_of_kind<LaneLawKind::linear_viscous>(scene, dt, pairs, constants, springs, out);
    case LaneLawKind::linear_hunt_crossley:
      return forces_of_kind<LaneLawKind::linear_hunt_crossley>(scene, dt, pairs, constants, springs, out);
    case LaneLawKind::hertz_viscous:
      return forces_of_kind<LaneLawKind::hertz_viscous>(scene, dt, pairs, constants, springs, out);
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
HWY_EXPORT(constants_in_lanes);
HWY_EXPORT(forces_of_any);

constexpr std::size_t kMaxLanes = BallEight::kPairs;
static_assert(kBallPairs % kMaxLanes == 0);

/// Lanes beyond the last pair repeat it.   in   width   numbers of a pair
template <class Column>
void fill_up(std::size_t count, Column& column, std::size_t width = 1) {
  for (std::size_t k = count; k % kMaxLanes != 0; ++k)
    std::copy_n(column.begin() + static_cast<std::ptrdiff_t>(width * (count - 1)), width,
                column.begin() + static_cast<std::ptrdiff_t>(width * k));
}

void repeat_last_rows(const BallPairs& pairs) {
  for (std::size_t n = pairs.count; n % kMaxLanes != 0; ++n) {
    pairs.a(n) = pairs.a(pairs.count - 1);
    pairs.b(n) = pairs.b(pairs.count - 1);
  }
}

}  // namespace

void repeat_last_pair(BallPairs& pairs, BallSprings& springs) {
  repeat_last_rows(pairs);
  for (std::size_t n = pairs.count; n % kMaxLanes != 0; ++n)
    for (std::size_t number = 0; number < 4; ++number) pairs.spring(n, number) = pairs.spring(pairs.count - 1, number);
  fill_up(pairs.count, springs.law);
  fill_up(pairs.count, springs.rolling, 4);
}

void find_ball_gaps(const BallScene& scene, BallPairs& pairs, double* gap) {
  repeat_last_rows(pairs);
  HWY_DYNAMIC_DISPATCH(gaps_in_lanes)(scene, pairs, gap);
}

void find_ball_constants(const BallScene& scene, const BallPairs& pairs, const BallSprings& springs, BallConstants& constants) {
  HWY_DYNAMIC_DISPATCH(constants_in_lanes)(scene, pairs, springs, constants);
}

BallSummary find_ball_forces(const BallScene& scene, double dt, const BallPairs& pairs, const BallConstants* constants,
                             BallSprings& springs, BallForces& forces) {
  return HWY_DYNAMIC_DISPATCH(forces_of_any)(scene, dt, pairs, constants, springs, forces);
}

}  // namespace scree
#endif
