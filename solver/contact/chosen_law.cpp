#include "solver/contact/chosen_law.hpp"

#include <algorithm>
#include <cmath>

#include "solver/built_with.hpp"
#include "solver/contact/contact_models.hpp"
#include "solver/contact/pair_friction.hpp"

namespace scree {

namespace {

static_assert(kNorm == 8, "power7 and the roots of the models are written for the eighth norm");

/// What a thread keeps from pair to pair, so that nothing is allocated for each.
struct LawWorkspace {
  FeatureForces forces;
  std::vector<FrictionSpring> springs;
};

/// A contact's record: the force without friction has the feature's direction, but for what a weight adds that changes with the pose.
ContactOutput output_of(const Vec3& n, double normal_force, const Vec3& from_weight, const Vec3& tangential) {
  if (!(squared_length(from_weight) > 0)) return {n, normal_force, tangential};
  const Vec3 force = normal_force * n + from_weight;
  const double size = normal_force < 0 ? -length(force) : length(force);
  return {size != 0 ? (1 / size) * force : n, size, tangential};
}

/// Rolling and torsional resistance of the pair (laws/rolling.hpp), with its spring kept after those of the features.
void add_rolling(const PairLaw& law, const PairMotion& m, const Vec3& push_force, double push, double load,
                 const std::vector<double>& per_overlap, double tangential_damping, double dt, double friction_dt, const MeanTurn& turned,
                 const std::vector<FrictionSpring>& springs, std::vector<FrictionSpring>& next, PairForce& result) {
  const double size = length(push_force);
  if (!(size > 0) || !(push > 0)) return;
  const Vec3 n = (1 / size) * push_force;
  Vec3 surface_twist;  // a surface that turns twists what lies on it; nothing rolls with it
  if (m.surface != nullptr) surface_twist = dot(m.surface->spin, n) * n;
  double stiffness = 0;
  for (const double s : per_overlap) stiffness += s;
  const double loaded = push * load;
  const RollingState state{n,
                           m.w_a - m.w_b - surface_twist,
                           loaded,
                           push / stiffness,
                           m.radius,
                           tangential_damping,
                           law.rolling_friction * m.radius * loaded,
                           law.torsional_friction * m.radius * loaded,
                           law.tangential_ratio};
  const auto largest = [](const Vec3& v) { return std::max({v.x, v.y, v.z}); };
  const double spin_mobility = largest(m.inverse_inertia_a) + largest(m.inverse_inertia_b);
  const RollingSpring old = remembered<RollingSpring>(springs);
  const RollingMoment moment = rolling_moment(law, state, spin_mobility, turned(old.moment), old.stiffness, dt, friction_dt);
  result.dissipative_torque += moment.moment;
  result.rolling_moment = moment.moment;
  if (m.surface != nullptr) result.surface_power += dot(moment.moment, surface_twist);
  if (!law.rolling_spring) return;
  next.push_back(RollingSpring{moment.spring, moment.stiffness}.row());
  if (moment.stiffness > 0) result.rolling_elastic = 0.5 * squared_length(moment.spring) / moment.stiffness;
  result.tangential_elastic += result.rolling_elastic;
}

/// Whether two bodies remember that they have touched.
bool remembers(const PairLaw& law) { return law.neck_adhesion > 0 || law.bridge != nullptr; }

/// Damping of a pair: each feature's is push chi v_n, never more than the push itself.
template <class Model, class Damp, class Law>
class PairDamping {
 public:
  PairDamping(const PairFeatures& features, const PairLaw& pair_law, const Law& law, const PairMotion& motion, const PairForce& elastic,
              const FeatureForces& forces, const PushSum& push, double dt, const std::vector<FrictionSpring>& springs)
      : pair_law_(pair_law),
        law_(law),
        forces_(forces),
        dt_(dt),
        own_(motion.inverse_mass_a + motion.inverse_mass_b),
        reduced_(motion.is_bonded() ? of_bonded(motion) : own_) {
    if (!Damp::acts(pair_law)) return;
    if (push.force > 0) {
      double mobility = own_;
      if constexpr (!Model::kDampsEachFeature)
        mobility = std::max(mobility, wrench_mobility(motion, elastic.force, elastic.torque) / (push.force * push.force));
      if (motion.is_bonded()) {
        damp_bonded(motion, elastic, push, mobility, springs);
      } else if (mobility > 0) {
        const double chi = Damp::chi(pair_law, push.energy, mobility);
        pair_rate_ = chi * push.force * mobility * dt;
        of_pair_ = Damp::in_step(chi, pair_rate_, pair_rate_);
      }
    }
    if constexpr (Model::kDampsEachFeature) {
      // each contact damps by its own energy and the reduced mass: n coincident ones have sqrt(n) times the damping ratio
      pair_rate_ = 0;
      for (std::size_t j = 0; j < features.list.size(); ++j)
        if (forces.push[j] > 0) pair_rate_ += chi_of(features.list[j]) * forces.push[j] * own_ * dt;
    }
  }
  const Damping& of_pair() const { return of_pair_; }
  Damping of_feature(const ContactFeature& f, std::size_t j) const {
    if constexpr (Model::kDampsEachFeature) {
      if (!Damp::acts(pair_law_) || !(forces_.push[j] > 0) || !(reduced_ > 0)) return of_pair_;
      const double chi = chi_of(f);
      return Damp::in_step(chi, chi * forces_.push[j] * reduced_ * dt_, pair_rate_);
    } else {
      return of_pair_;
    }
  }

 private:
  static double of_bonded(const PairMotion& m) {
    return (m.bonded_a != nullptr ? m.bonded_a->inverse_mass : m.inverse_mass_a) +
           (m.bonded_b != nullptr ? m.bonded_b->inverse_mass : m.inverse_mass_b);
  }
  /// Fragments turn round as a whole; within a step it is the piece that damping must not turn round.
  /// in   own       mobility of the two bodies [1/kg]
  /// in   springs   of the pair, with what other pieces add that press on the same partner
  [[gnu::noinline]] void damp_bonded(const PairMotion& motion, const PairForce& elastic, const PushSum& push, double own,
                                     const std::vector<FrictionSpring>& springs) {
    double mobility = reduced_;
    if constexpr (!Model::kDampsEachFeature)
      mobility = std::max(mobility, wrench_mobility_of_bonded(motion, elastic.force, elastic.torque) / (push.force * push.force));
    if (!(mobility > 0)) return;
    const double chi = Damp::chi(pair_law_, push.energy * remembered<DampingShare>(springs).factor, mobility),
                 damping = chi * push.force * dt_;
    pair_rate_ = damping * own;
    of_pair_ = Damp::in_step(chi, damping * mobility, pair_rate_);
  }
  double chi_of(const ContactFeature& f) const { return Damp::chi(pair_law_, law_.energy(f.overlap), reduced_); }

  const PairLaw& pair_law_;
  const Law& law_;
  const FeatureForces& forces_;
  double dt_, own_, reduced_, pair_rate_ = 0;  // own_, reduced_: of both bodies [1/kg], and of the fragments that they are part of
  Damping of_pair_;
};

/// Friction and rolling are compiled in or left out; a scene without them pays nothing for either.
template <class Model, class Entry, class Law, bool kFriction, bool kRolling>
PairForce pair_force(const PairFeatures& features, const PairLaw& law, const PairMotion& motion, double dt, double friction_dt,
                     std::vector<FrictionSpring>& springs, std::vector<ContactOutput>* outputs) {
  PairForce result;
  const std::size_t count = features.list.size();
  if (outputs != nullptr) outputs->resize(count);
  if (count == 0) {
    springs.clear();
    return result;
  }

  Law law_of_overlap(law, motion.radius);
  if constexpr (YieldingLaw<Law>) {
    // what started from a run, of materials that are elastic now, has no dent
    if (law.unloading_ratio > 1) law_of_overlap.dent = remembered<Dent>(springs).depth;
  }
  thread_local LawWorkspace work;
  FeatureForces& forces = work.forces;
  forces.push.assign(count, 0);
  forces.push_per_overlap.assign(count, 0);
  forces.wants_from_weight = outputs != nullptr;
  if (outputs != nullptr) forces.from_weight.assign(count, Vec3{});
  const PushSum push = Model::potential(features, law, law_of_overlap, forces, result);

  if (!(friction_dt > 0)) result.yielded = 0;  // of no step
  bool linked = false;
  if constexpr (NeckedLaw<Law> || AttractingLaw<Law>) linked = remembers(law);
  /// What the pair remembers besides its springs, in the order of keys.
  const auto remember = [&](std::vector<FrictionSpring>& rows) {
    if (linked) rows.push_back(Link{}.row());
    if constexpr (YieldingLaw<Law>) {
      if (forces.dent > 0) rows.push_back(Dent{forces.dent}.row());
    }
  };

  const PairDamping<Model, typename Entry::Damp, Law> dampings(features, law, law_of_overlap, motion, result, forces, push, dt, springs);
  Damping damping = dampings.of_pair();
  result.damping = damping.chi;
  const Vec3 push_force = result.push = result.force;
  constexpr bool kPulls = PullingLaw<Law> || AttractingLaw<Law>;
  if constexpr (kPulls) {
    result.force += forces.pull_force;
    result.torque += forces.pull_torque;
  }
  /// Of a feature, with its push damped.
  const auto normal_force = [&](std::size_t j, double push_j) {
    if constexpr (kPulls)
      return push_j - forces.pull[j];
    else
      return push_j;
  };
  const bool frictional = kFriction && law.friction > 0;
  const bool rolls = kRolling && (law.rolling_friction > 0 || law.torsional_friction > 0);
  if (damping.chi == 0 && !frictional && !rolls) {
    if (outputs != nullptr) {
      for (std::size_t j = 0; j < count; ++j)
        (*outputs)[j] = output_of(features.list[j].n, normal_force(j, forces.push[j]), forces.from_weight[j], Vec3{});
    }
    springs.clear();
    remember(springs);
    return result;
  }

  const double tangential_share = tangential_damping_share(law, tangent_over_secant(law_of_overlap, result.largest_overlap));
  const MeanTurn turned(springs, motion.surface == nullptr ? motion.turn : motion.turn * motion.surface->turned, friction_dt);
  std::vector<FrictionSpring>& next = work.springs;
  next.clear();
  PairFriction friction(features, AttractingLaw<Law> ? &forces.push : nullptr, law, motion, friction_dt, springs, turned, next);
  for (std::size_t j = 0; j < count; ++j) {
    const ContactFeature& f = features.list[j];
    if constexpr (AttractingLaw<Law>) {
      if (!(forces.push[j] > 0)) {  // beyond touch: it has neither damping nor friction, and keeps nothing
        if (outputs != nullptr) (*outputs)[j] = output_of(f.n, normal_force(j, 0), forces.from_weight[j], Vec3{});
        continue;
      }
    }
    const Vec3 arm_b = f.x - motion.pivot_b;
    const Vec3 turning_a = cross(motion.w_a, f.x), turning_b = cross(motion.w_b, arm_b);
    const Vec3 velocity = motion.v_a + turning_a - motion.pivot_v_b - turning_b;
    const double vn = dot(velocity, f.n);
    if constexpr (Model::kDampsEachFeature) damping = dampings.of_feature(f, j);
    double damped = 0;
    if (!PullingLaw<Law> || forces.push[j] > 0) {
      double in_touch = f.overlap;
      if constexpr (NeckedLaw<Law>) in_touch = forces.push_overlap;
      const double weight = std::min(damping.most_onset, onset_weight(in_touch, -vn * dt));
      damped = damped_push(forces.push[j], damping.chi, weight, vn, NeckedLaw<Law> ? forces.least_push : 0.0);
    }
    Vec3 dissipative = (damped - forces.push[j]) * f.n;
    Vec3 tangential;
    double slid = 0;
    if (frictional) {
      // The velocities are those of half a step ago, the arms those of now. Turned back by half a step the arms give no
      // slip to bodies that stick together while they turn about one axis (0.3 % creep in 9 s on a turntable otherwise).
      // Where springs do not move, at the start and for output, the velocities are those of now.
      // The contact point of a ball follows the normal, however the ball spins.
      Vec3 before_a = turning_a, before_b = turning_b;
      if (motion.ball_a || motion.ball_b) {
        const Vec3 spin = spin_of_normal(motion, f.n);
        if (motion.ball_a) before_a = cross(spin, f.x);
        if (motion.ball_b) before_b = cross(spin, arm_b);
      }
      Vec3 slip = velocity - (0.5 * friction_dt) * (cross(motion.w_a, before_a) - cross(motion.w_b, before_b));
      if (motion.surface != nullptr) {
        const Vec3 surface = motion.surface->at(f.x);
        slip -= surface - (0.5 * friction_dt) * cross(motion.surface->spin, surface);
      }
      const Vec3 vt = slip - dot(slip, f.n) * f.n;
      const auto friction_of = [&](const ContactFeature& feature, double load) {
        return friction.force(feature, vt, vn, load, law.tangential_ratio * forces.push_per_overlap[j],
                              tangential_share * damping.chi * forces.push[j], result.tangential_elastic,
                              outputs != nullptr ? &slid : nullptr);
      };
      if constexpr (NeckedLaw<Law>) {
        ContactFeature necked = f;
        necked.overlap = forces.push_overlap;
        tangential = friction_of(necked, damped + (forces.load - 1) * forces.push[j]);
      } else {
        tangential = friction_of(f, damped);
      }
      dissipative += tangential;
      if (motion.surface != nullptr) result.surface_power += dot(tangential, motion.surface->at(f.x));
    }
    result.dissipative_force += dissipative;
    result.dissipative_torque += cross(f.x, dissipative);
    if (outputs != nullptr) {
      ContactOutput& out = (*outputs)[j];
      out = output_of(f.n, normal_force(j, damped), forces.from_weight[j], tangential);
      out.damping = damped - forces.push[j];
      out.slid = slid;
    }
  }
  if (rolls)
    add_rolling(law, motion, push_force, push.force, NeckedLaw<Law> ? forces.load : 1.0, forces.push_per_overlap,
                tangential_share * damping.chi, dt, friction_dt, turned, springs, next, result);
  const bool has_springs = !next.empty();
  remember(next);
  if (has_springs) next.push_back(Turn::of(motion.turn).row());
  springs.swap(next);
  result.force += result.dissipative_force;
  result.torque += result.dissipative_torque;
  return result;
}

template <class Model, class Entry, class Law>
PairForceFunction specialise(const LawChoice& choice) {
  if constexpr (!built_with::kFriction) return &pair_force<Model, Entry, Law, false, false>;
  if (choice.rolling) {
    return choice.friction ? &pair_force<Model, Entry, Law, true, true> : &pair_force<Model, Entry, Law, false, true>;
  }
  return choice.friction ? &pair_force<Model, Entry, Law, true, false> : &pair_force<Model, Entry, Law, false, false>;
}

}  // namespace

PairHoldsFunction pair_holds_function(const LawChoice& choice) {
  PairHoldsFunction function = nullptr;
  if (!choice.remembers) return function;
  for_chosen_law(choice, [&]<class Model, class Entry, class Law>() {
    if constexpr (std::is_same_v<Model, PotentialModel> && (NeckedLaw<Law> || AttractingLaw<Law>)) {
      function = [](const PairFeatures& features, const PairLaw& law, double radius, const std::vector<FrictionSpring>& springs,
                    double& released) {
        const Law law_of_overlap(law, radius);
        const bool linked = row_of<Link>(springs) != nullptr, holds = Model::holds(features, law, law_of_overlap, linked);
        released = holds && !linked && remembers(law) ? Model::released(features, law, law_of_overlap) : 0;
        return holds;
      };
    }
  });
  return function;
}

PairForceFunction pair_force_function(const LawChoice& choice) {
  PairForceFunction function = nullptr;
  for_chosen_law(choice, [&]<class Model, class Entry, class Law>() { function = specialise<Model, Entry, Law>(choice); });
  SCREE_ASSERT(function != nullptr, "law {} does not go with this gathering", word_of(choice.law));
  return function;
}

LineariseFunction linearise_function(const LawChoice& choice) {
  LineariseFunction function = nullptr;
  for_chosen_law(choice, [&]<class Model, class Entry, class Normal>() {
    function = [](const LinearContact& contact) { Model::linearise(contact, Normal(contact.law, contact.motion.radius)); };
  });
  SCREE_ASSERT(function != nullptr, "law {} does not go with this gathering", word_of(choice.law));
  return function;
}

}  // namespace scree
