#include "solver/contact/ball_contact.hpp"

#include <algorithm>
#include <cmath>
#include <type_traits>

#include "core/base/error.hpp"
#include "solver/built_with.hpp"
#include "solver/laws/ball.hpp"

namespace scree {

namespace {

double radius_of(const PairBody& ball) { return ball.scale * ball.shape->rounding; }

BallMeeting meeting_of(const BallContact& c, double half, double half_step) {
  const PairView& view = c.view;
  const PairVelocities& m = c.velocities;
  if (view.zone == nullptr) {
    const Vec3 between = view.a.x - view.b.x;
    return meeting_of(
        BallsApart{between, m.v_a - m.v_b, m.w_a + m.w_b, radius_of(view.a) * m.w_a + radius_of(view.b) * m.w_b, m.w_a - m.w_b},
        length(between), c.feature.overlap, half, half_step);
  }
  const double reach = radius_of(view.a) - half;
  double curvature = 0;
  if (view.zone->kind == WallZone::Kind::cylinder) {
    const double from_axis = view.zone->radius - (reach - half);
    curvature = from_axis > 0 ? 1 / from_axis : 0;
  }
  return meeting_of(WallBeside{c.feature.n, view.pose.rotation * view.zone->direction, curvature, view.a.x - m.pivot_b, m.pivot_v_b, m.w_b,
                               length(view.b.x - view.a.x)},
                    m.v_a, m.w_a, reach, c.feature.overlap, half_step);
}

struct Push {
  double push, secant, energy;
};

template <class Law>
Push push_of(const PairLaw& pair_law, const Law& law, double overlap) {
  if constexpr (LimitedLaw<Law>) {
    if (pair_law.limit > 0 && overlap > pair_law.limit) {
      Law beyond = law;
      beyond.limit = pair_law.limit;
      const double push = beyond.force(overlap);
      return {push, push / overlap, beyond.energy(overlap)};
    }
  }
  // the order of operations is that of lanes
  double secant;
  if constexpr (std::is_same_v<Law, HertzLaw>)
    secant = law.c * std::sqrt(overlap);
  else
    secant = law.k;
  const double push = secant * overlap;
  return {push, secant, 1 / (1 + Law::kExponent) * push * overlap};
}

struct Damped {
  double damping = 0;  ///< [N s/m]
  double most_onset = 1;
};

template <class Damp, class Law>
Damped damping_of(const PairLaw& law, const Push& push, double overlap, double mobility, double dt) {
  if (!Damp::acts(law) || !(mobility > 0)) return {};
  if constexpr (std::is_same_v<Damp, ViscousDamping>) {
    constexpr bool kHertz = std::is_same_v<Law, HertzLaw>;
    double factor = kHertz ? 2 * law.damping_ratio * kHertzEnergyFactor : 2 * law.damping_ratio;
    // beyond the limit of a law its energy is another share of push and overlap
    if (LimitedLaw<Law> && law.limit > 0 && overlap > law.limit)
      factor = 2 * law.damping_ratio / std::sqrt(2 * push.energy / (push.push * overlap));
    const BallDamping d = viscous_damping(factor, push.secant, mobility, 1 / mobility, dt);
    if (!(d.rate > Damp::kFreeRate)) return {d.damping, most_onset_of(d.rate, d.lagged, Damp::kMaxOnset)};
    const Damping limited = Damp::in_step(1, d.rate, d.rate);
    return {d.damping * d.lagged * limited.chi, limited.most_onset};
  } else {
    const double damping = law.damping_slope * push.push, rate = damping * mobility * dt;
    return {rate > Damp::kFreeRate ? damping * Damp::in_step(1, rate, rate).chi : damping, 1};
  }
}

/// The spring of a kind from the step before; none: a stiffness of 0.
ContactSpring old_spring(const std::vector<FrictionSpring>& springs, bool rolling) {
  for (const FrictionSpring& s : springs)
    if (is_of_feature(s) != rolling && is_spring(s)) return {s.force, s.stiffness};
  return {{}, 0};
}

template <class Law, class Damp, bool kFriction, bool kRolling>
BallForce ball_force(const BallContact& c, double dt, double friction_dt, std::vector<FrictionSpring>& springs,
                     std::vector<ContactOutput>* outputs) {
  const PairLaw& law = c.law;
  const double overlap = c.feature.overlap, half = 0.5 * (overlap - c.view.margin), half_step = 0.5 * friction_dt;
  const BallMeeting m = meeting_of(c, half, half_step);
  const Law law_of_overlap(law, c.radius);
  const Push push = push_of(law, law_of_overlap, overlap);
  const double mobility = c.inverse_mass_a + c.inverse_mass_b;
  const Damped d = damping_of<Damp, Law>(law, push, overlap, mobility, dt);
  const double weight = std::min(d.most_onset, onset_weight(overlap, (-m.vn) * dt));
  const double damped = damped_by(push.push, d.damping, weight, m.vn);

  BallForce result;
  PairForce& f = result.force;
  f.largest_overlap = overlap;
  f.elastic = push.energy;
  f.damping = push.push > 0 ? d.damping / push.push : 0;
  f.push = push.push * m.n;
  Vec3 tangential, across;
  double slid = 0;
  const ContactSpring before = old_spring(springs, false), rolled = old_spring(springs, true);
  springs.clear();
  const double tangential_damping = tangential_damping_share(law, Law::kExponent) * d.damping;
  if constexpr (kFriction) {
    const bool kept = before.stiffness != 0;
    const SlidingContact contact{m.n,
                                 slip_of(m),
                                 m.vn,
                                 overlap,
                                 law.tangential_ratio * push.secant,
                                 tangential_damping,
                                 law.friction * damped,
                                 law.friction_sliding * damped};
    ContactSpring spring{{}, before.stiffness};
    double stretched = 0;
    tangential = friction_force(contact, kept, taken_along(m, before.force, half_step), kStiffnessRounding * m.distance, friction_dt,
                                spring, stretched);
    across = cross(m.n, tangential);
    f.tangential_elastic = with_energy(spring, 0);
    springs.push_back({c.feature.key, spring.force, spring.stiffness});
    const double limit = contact.slide_limit;
    if (spring.stiffness < 0 && stretched > limit * limit) slid = limit * (std::sqrt(stretched) - limit) / -spring.stiffness;
  }
  Vec3 moment;
  if constexpr (kRolling) {
    const RollingState state{m.n,
                             m.relative_spin,
                             push.push,
                             overlap,
                             c.radius,
                             tangential_damping / push.push,
                             law.rolling_friction * c.radius * push.push,
                             law.torsional_friction * c.radius * push.push,
                             law.tangential_ratio};
    const RollingMoment rolls =
        rolling_spring(state, turned_by(mean_turn(m.spins, half_step), rolled.force), rolled.stiffness, friction_dt);
    moment = f.rolling_moment = rolls.moment;
    const double stored = with_energy({rolls.spring, rolls.stiffness}, f.tangential_elastic);
    f.rolling_elastic = stored - f.tangential_elastic;
    f.tangential_elastic = stored;
    springs.push_back(RollingSpring{rolls.spring, rolls.stiffness}.row());
  }
  f.dissipative_force = (damped - push.push) * m.n + tangential;
  f.force = f.push + f.dissipative_force;
  f.torque = ball_torque(across, radius_of(c.view.a), half);
  if (c.view.zone == nullptr) result.torque_b = ball_torque(across, radius_of(c.view.b), half);
  if constexpr (kRolling) {
    f.torque += moment;
    if (c.view.zone == nullptr) result.torque_b -= moment;
  }
  f.dissipative_torque = f.torque;
  if (outputs != nullptr) outputs->assign(1, {m.n, damped, tangential, damped - push.push, slid});
  return result;
}

template <class Law, class Damp>
BallForceFunction specialise(const LawChoice& choice) {
  if (!built_with::kFriction || !choice.friction) return &ball_force<Law, Damp, false, false>;
  return choice.rolling ? &ball_force<Law, Damp, true, true> : &ball_force<Law, Damp, true, false>;
}

}  // namespace

BallForceFunction ball_force_function(const LawChoice& choice) {
  BallForceFunction function = nullptr;
  for_law(choice.law, [&]<class Entry>() {
    using Law = typename Entry::Normal;
    using Damp = typename Entry::Damp;
    constexpr bool kViscous = std::is_same_v<Damp, ViscousDamping>;
    if constexpr (std::is_same_v<Law, LinearLaw> && (kViscous || std::is_same_v<Damp, HuntCrossleyDamping>))
      function = specialise<Law, Damp>(choice);
    else if constexpr (std::is_same_v<Law, HertzLaw> && kViscous)
      function = specialise<Law, Damp>(choice);
  });
  SCREE_ASSERT(function != nullptr, "balls have no lane law for {}", word_of(choice.law));
  return function;
}

void set_axes_of_springs(bool ball_contact, const Quat& q, std::vector<FrictionSpring>& springs) {
  if (springs.empty() || !is_spring(springs.front())) return;  // no spring
  const bool has_turn = springs.back().key == Turn::kKey;
  if (ball_contact != has_turn) return;  // as they should be
  if (has_turn) springs.pop_back();
  for (FrictionSpring& s : springs) {
    if (!is_spring(s)) continue;
    s.force = has_turn ? rotate(q, s.force) : rotate_inverse(q, s.force);
    s.normal = {};
  }
}

}  // namespace scree
