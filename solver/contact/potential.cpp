#include "solver/contact/potential.hpp"

#include "solver/built_with.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace scree {

namespace {

double power7(double x) {
  const double x2 = x * x, x4 = x2 * x2;
  return x4 * x2 * x;
}

/// Share of itself by which rounding moves the stiffness of a feature, times the overlap over the distance of the two bodies: the stiffness
/// goes with powers of the overlap up to the seventh, and the overlap is a difference of places. The worst of 1e7 values in a stiff heap at
/// rest is 35 epsilon.
constexpr double kStiffnessRounding = 64 * std::numeric_limits<double>::epsilon();

/// Effective inverse mass of a wrench Q (force F on A at A's centre with torque T, the opposite on B): Q M^-1 Q.
double wrench_mobility(const PairMotion& m, const Vec3& force, const Vec3& torque) {
  double sum = (m.inverse_mass_a + m.inverse_mass_b) * squared_length(force);
  sum += torque.x * torque.x * m.inverse_inertia_a.x + torque.y * torque.y * m.inverse_inertia_a.y +
         torque.z * torque.z * m.inverse_inertia_a.z;
  // T_B = -T_A - (x_A - x_B) x F, with x_A = 0
  const Vec3 on_b = transpose_times(m.b_to_a, cross(m.centre_b, force) - torque);
  sum += on_b.x * on_b.x * m.inverse_inertia_b.x + on_b.y * on_b.y * m.inverse_inertia_b.y + on_b.z * on_b.z * m.inverse_inertia_b.z;
  return sum;
}

/// Takes springs, kept in the frame of A, along with both bodies: by half of what B has turned against A since they were set. Seen from B
/// it is the same rotation, so that which of the two is A changes nothing but rounding.
class MeanTurn {
 public:
  /// in   springs   of the last step, with their kTurnKey     in  turn  B to A, now
  MeanTurn(const std::vector<FrictionSpring>& springs, const Quat& turn, double friction_dt) {
    if (springs.empty() || springs.back().key != kTurnKey || !(friction_dt > 0)) return;
    const FrictionSpring& kept = springs.back();
    const Quat before{kept.stiffness, kept.force.x, kept.force.y, kept.force.z};
    if (before == turn) return;  // at rest, to the last bit
    Quat by = turn * conjugate(before);
    if (by.w < 0) by = {-by.w, -by.x, -by.y, -by.z};
    w_ = std::sqrt(0.5 * (1 + by.w));
    u_ = (0.5 / w_) * Vec3{by.x, by.y, by.z};
  }
  Vec3 operator()(const Vec3& s) const {
    const Vec3 t = cross(2 * u_, s);
    return s + w_ * t + cross(u_, t);
  }
  static FrictionSpring entry(const Quat& turn) { return {kTurnKey, {turn.x, turn.y, turn.z}, turn.w}; }

 private:
  Vec3 u_;
  double w_ = 1;
};

/// A contact's record: the force without friction has the feature's direction, but for what a weight adds that changes with the pose.
ContactOutput output_of(const Vec3& n, double damped, const Vec3& from_weight, const Vec3& tangential) {
  if (!(squared_length(from_weight) > 0)) return {n, damped, tangential};
  const Vec3 force = damped * n + from_weight;
  const double size = length(force);
  return {size > 0 ? (1 / size) * force : n, size, tangential};
}

/// Rolling and torsional resistance of the pair (laws/rolling.hpp), with its spring kept after those of the features.
void add_rolling(const PairLaw& law, const PairMotion& m, const Vec3& elastic_force, double normal_sum,
                 const std::vector<double>& per_overlap, double tangential_damping, double dt, double friction_dt, const MeanTurn& turned,
                 const std::vector<FrictionSpring>& springs, std::vector<FrictionSpring>& next, PairForce& result) {
  const double size = length(elastic_force);
  if (!(size > 0)) return;
  RollingState state;
  state.n = (1 / size) * elastic_force;
  state.relative_spin = m.w_a - m.w_b;
  state.normal_force = normal_sum;
  double stiffness = 0;
  for (const double s : per_overlap) stiffness += s;
  state.overlap = normal_sum / stiffness;
  state.radius = m.radius;
  state.damping = tangential_damping;
  const auto largest = [](const Vec3& v) { return std::max({v.x, v.y, v.z}); };
  state.spin_mobility = largest(m.inverse_inertia_a) + largest(m.inverse_inertia_b);
  FrictionSpring old{kRollingKey, Vec3{}, 0};
  for (auto s = springs.rbegin(); s != springs.rend() && s->key >= kRollingKey; ++s) {
    if (s->key == kRollingKey) old = *s;
  }
  old.force = turned(old.force);
  const RollingMoment moment = rolling_moment(law, state, old.force, old.stiffness, dt, friction_dt);
  result.dissipative_torque += moment.moment;
  if (!law.rolling_spring) return;
  next.push_back({kRollingKey, moment.spring, moment.stiffness});
  if (moment.stiffness > 0) result.tangential_elastic += 0.5 * squared_length(moment.spring) / moment.stiffness;
}

/// The potential of all features: energy, forces and wrench. Returns the sum of the forces.
/// `from_weight`, where not null, is given each feature's force from a weight that changes with the pose, as in the two after it.
template <class Normal>
double add_potential(const std::vector<ContactFeature>& features, const Normal& law_of_overlap, std::vector<double>& normal,
                     std::vector<double>& per_overlap, std::vector<Vec3>* from_weight, PairForce& result) {
  // U(D), D = (sum a_j d_j^8)^(1/8), scaled by the largest_overlap so that nothing under- or overflows
  for (const ContactFeature& f : features) result.largest_overlap = std::max(result.largest_overlap, f.overlap);
  double sum = 0;
  for (const ContactFeature& f : features) {
    const double r = f.overlap / result.largest_overlap;
    sum += f.weight * power7(r) * r;
  }
  const double D = result.largest_overlap * std::sqrt(std::sqrt(std::sqrt(sum)));
  result.elastic = law_of_overlap.energy(D);
  const double dU = law_of_overlap.force(D);
  double normal_sum = 0;
  for (std::size_t j = 0; j < features.size(); ++j) {
    const ContactFeature& f = features[j];
    const double r = f.overlap / D, r7 = power7(r);
    normal[j] = dU * f.weight * r7;
    per_overlap[j] = normal[j] / D;
    normal_sum += normal[j];
    const Vec3 force = normal[j] * f.n;
    result.force += force;
    result.torque += cross(f.x, force);
    if (f.faded) {
      const double c = dU * D / kNorm * r7 * r;  // dU/da_j
      result.force -= c * f.weight_gradient.force;
      result.torque -= c * f.weight_gradient.couple;
      if (from_weight != nullptr) (*from_weight)[j] -= c * f.weight_gradient.force;
    }
  }
  return normal_sum;
}

/// The same with one potential per cell (wall_cells.hpp), each with a part of the energy.
template <class Normal>
double add_cell_potentials(const std::vector<ContactFeature>& features, const std::vector<CellShare>& shares, double part,
                           const Normal& law_of_overlap, std::vector<double>& normal, std::vector<double>& per_overlap,
                           std::vector<Vec3>* from_weight, PairForce& result) {
  constexpr double kPower = kNorm / (1 + Normal::kExponent);  // a single feature's energies then sum to U(d)
  for (const ContactFeature& f : features) result.largest_overlap = std::max(result.largest_overlap, f.overlap);
  double normal_sum = 0;
  for (std::size_t begin = 0, end = 0; begin < shares.size(); begin = end) {
    double sum = 0;
    for (end = begin; end < shares.size() && shares[end].cell == shares[begin].cell; ++end) {
      const ContactFeature& f = features[static_cast<std::size_t>(shares[end].feature)];
      const double r = f.overlap / result.largest_overlap;
      sum += f.weight * std::pow(shares[end].weight, kPower) * power7(r) * r;
    }
    const double D = result.largest_overlap * std::sqrt(std::sqrt(std::sqrt(sum)));
    if (!(D > 0)) continue;
    result.elastic += part * law_of_overlap.energy(D);
    const double dU = part * law_of_overlap.force(D);
    for (std::size_t s = begin; s < end; ++s) {
      const CellShare& share = shares[s];
      const auto j = static_cast<std::size_t>(share.feature);
      const ContactFeature& f = features[j];
      const double ratio = f.overlap / D, slope = kPower * std::pow(share.weight, kPower - 1), weight = std::pow(share.weight, kPower);
      const double r7 = power7(ratio), force = dU * f.weight * weight * r7;
      normal[j] += force;
      per_overlap[j] += force / D;
      normal_sum += force;
      result.force += force * f.n;
      result.torque += cross(f.x, force * f.n);
      const double c = dU * D / kNorm * r7 * ratio;  // dU / d(a_j w^power)
      if (f.faded) {
        result.force -= (c * weight) * f.weight_gradient.force;
        result.torque -= (c * weight) * f.weight_gradient.couple;
        if (from_weight != nullptr) (*from_weight)[j] -= (c * weight) * f.weight_gradient.force;
      }
      result.force -= (c * f.weight * slope) * share.gradient.force;
      result.torque -= (c * f.weight * slope) * share.gradient.couple;
      if (from_weight != nullptr) (*from_weight)[j] -= (c * f.weight * slope) * share.gradient.force;
    }
  }
  return normal_sum;
}

/// The barrier of each feature that is near enough, on top of the potential. Returns the sum of its forces.
double add_barrier(const std::vector<ContactFeature>& features, const PairLaw& law, std::vector<double>& normal,
                   std::vector<double>& per_overlap, std::vector<Vec3>* from_weight, PairForce& result) {
  const Barrier barrier(law);
  double sum = 0;
  for (std::size_t j = 0; j < features.size(); ++j) {
    const ContactFeature& f = features[j];
    const double gap = law.margin - f.overlap;
    if (!barrier.acts(gap)) continue;
    const double force = f.weight * barrier.force(gap), energy = barrier.energy(gap);
    normal[j] += force;
    per_overlap[j] += force / f.overlap;
    sum += force;
    result.barrier += f.weight * energy;
    result.force += force * f.n;
    result.torque += cross(f.x, force * f.n);
    if (f.faded) {
      result.force -= energy * f.weight_gradient.force;
      result.torque -= energy * f.weight_gradient.couple;
      if (from_weight != nullptr) (*from_weight)[j] -= energy * f.weight_gradient.force;
    }
  }
  result.elastic += result.barrier;
  return sum;
}

/// The elastic layer of two meshes: energy, pressure and wrench as area_pressure.hpp found them.
double add_patches(const AreaContact& contact, double kappa, std::vector<double>& normal, std::vector<double>& per_overlap,
                   std::vector<Vec3>* from_weight, const std::vector<ContactFeature>& features, PairForce& result) {
  double sum = 0;
  for (std::size_t j = 0; j < contact.patches.size(); ++j) {
    const AreaPatch& patch = contact.patches[j];
    result.elastic += kappa * patch.energy;
    result.largest_overlap = std::max(result.largest_overlap, patch.largest_overlap);
    result.force -= kappa * patch.gradient.force;
    result.torque -= kappa * patch.gradient.couple;
    normal[j] = kappa * patch.force;
    if (from_weight != nullptr) (*from_weight)[j] = -kappa * patch.gradient.force - normal[j] * features[j].n;
    sum += normal[j];
  }
  // F / D with U = F D / 2: kappa times the area where the overlap is even
  for (std::size_t j = 0; j < normal.size(); ++j) per_overlap[j] = normal[j] * sum / (2 * result.elastic);
  return sum;
}

/// Friction and rolling are compiled in or left out; a scene without them pays nothing for either.
template <class Entry, bool kFriction, bool kRolling>
PairForce pair_force(const std::vector<ContactFeature>& features, const PairLaw& law, const PairMotion& motion, double dt,
                     double friction_dt, std::vector<FrictionSpring>& springs, std::vector<ContactOutput>* outputs) {
  using Normal = typename Entry::Normal;
  using Damp = typename Entry::Damp;
  static_assert(kNorm == 8, "power7 and the roots below are written for the eighth norm");
  PairForce result;
  const std::size_t count = features.size();
  if (outputs != nullptr) outputs->resize(count);
  if (count == 0) {
    springs.clear();
    return result;
  }

  const Normal law_of_overlap(law, motion.radius);
  thread_local std::vector<double> normal, per_overlap;  // f_j, and f_j / D for the tangential stiffness
  thread_local std::vector<Vec3> weight_forces;
  std::vector<Vec3>* from_weight = nullptr;
  if (outputs != nullptr) {
    weight_forces.assign(count, Vec3{});
    from_weight = &weight_forces;
  }
  normal.assign(count, 0);
  per_overlap.assign(count, 0);
  double normal_sum = [&] {
    if constexpr (std::is_same_v<Normal, LayerLaw>) {
      if (motion.area != nullptr)
        return add_patches(*motion.area, law_of_overlap.kappa, normal, per_overlap, from_weight, features, result);
    }
    return motion.cells == nullptr
               ? add_potential(features, law_of_overlap, normal, per_overlap, from_weight, result)
               : add_cell_potentials(features, *motion.cells, motion.cell_energy, law_of_overlap, normal, per_overlap, from_weight, result);
  }();

  if (law.barrier > 0) normal_sum += add_barrier(features, law, normal, per_overlap, from_weight, result);

  // damping of a feature is f_j chi v_n, never more than f_j itself
  const double reduced = motion.inverse_mass_a + motion.inverse_mass_b;
  const bool on_their_own = motion.independent && Damp::acts(law);
  Damping damping;
  double pair_rate = 0;
  if (Damp::acts(law) && normal_sum > 0) {
    double mobility = reduced;
    if (!motion.independent)
      mobility = std::max(mobility, wrench_mobility(motion, result.force, result.torque) / (normal_sum * normal_sum));
    if (mobility > 0) {
      const double chi = Damp::chi(law, result.elastic, mobility);
      pair_rate = chi * normal_sum * mobility * dt;
      damping = Damp::in_step(chi, pair_rate, pair_rate);
    }
  }
  if (on_their_own) {
    // each contact damps by its own energy and the reduced mass: n coincident ones have sqrt(n) times the damping ratio
    pair_rate = 0;
    for (std::size_t j = 0; j < count; ++j)
      pair_rate += Damp::chi(law, law_of_overlap.energy(features[j].overlap), reduced) * normal[j] * reduced * dt;
  }
  double chi = damping.chi;
  result.damping = chi;
  const bool frictional = kFriction && law.friction > 0;
  const bool rolls = kRolling && (law.rolling_friction > 0 || law.torsional_friction > 0);
  if (chi == 0 && !frictional && !rolls) {
    if (outputs != nullptr) {
      for (std::size_t j = 0; j < count; ++j) (*outputs)[j] = output_of(features[j].n, normal[j], weight_forces[j], Vec3{});
    }
    springs.clear();
    return result;
  }

  const double tangential_share = tangential_damping_share(law, Normal::kExponent);
  const Vec3 elastic_force = result.force;
  const MeanTurn turned(springs, motion.turn, friction_dt);
  const double rounding = kStiffnessRounding * length(motion.centre_b);
  thread_local std::vector<FrictionSpring> next;
  next.clear();
  std::size_t old = 0;
  for (std::size_t j = 0; j < count; ++j) {
    const ContactFeature& f = features[j];
    const Vec3 arm_b = f.x - motion.pivot_b;
    const Vec3 turning_a = cross(motion.w_a, f.x), turning_b = cross(motion.w_b, arm_b);
    const Vec3 velocity = motion.v_a + turning_a - motion.pivot_v_b - turning_b;
    const double vn = dot(velocity, f.n);
    if (on_their_own) {
      chi = Damp::chi(law, law_of_overlap.energy(f.overlap), reduced);
      damping = Damp::in_step(chi, chi * normal[j] * reduced * dt, pair_rate);
      chi = damping.chi;
    }
    const double damped = normal[j] * std::max(0.0, 1 - chi * std::min(damping.most_onset, onset_weight(f.overlap, vn, dt)) * vn);
    Vec3 lossy = (damped - normal[j]) * f.n;
    Vec3 tangential;
    if (frictional) {
      double kappa = law.tangential_ratio * per_overlap[j];
      Vec3 spring;
      while (old < springs.size() && springs[old].key < f.key) ++old;
      // The velocities are those of half a step ago, the arms those of now. Turned back by half a step the arms give no
      // slip to bodies that stick together while they turn about one axis (0.3 % creep in 9 s on a turntable otherwise).
      // Where springs do not move, at the start and for output, the velocities are those of now.
      const Vec3 slip = velocity - (0.5 * friction_dt) * (cross(motion.w_a, turning_a) - cross(motion.w_b, turning_b));
      const Vec3 vt = slip - dot(slip, f.n) * f.n;
      if (old < springs.size() && springs[old].key == f.key) {
        // turn with the bodies' mean frame, back into the tangent plane at its own length
        Vec3 s = turned(springs[old].force);
        s -= dot(s, f.n) * f.n;
        const double flat = squared_length(s);
        if (flat > 0) s *= std::sqrt(squared_length(springs[old].force) / flat);
        // Unloading gives force back in proportion; loading must not create any (passivity, docs/reference/contact-law.md 3.4). A load that
        // only rounding moves up and down is neither (docs/decisions/012): springs would lose a little each time, and a stiff heap creep
        // for ever.
        const double before = springs[old].stiffness;
        if (std::abs(kappa - before) * f.overlap <= rounding * before) kappa = before;
        if (kappa < before) s *= kappa / before;
        spring = s - (kappa * friction_dt) * vt;
      } else {
        // a new feature has slid only since it touched
        spring = (-kappa * (f.overlap < -vn * friction_dt ? f.overlap / -vn : friction_dt)) * vt;
      }
      const double limit = law.friction * damped, sliding = law.friction_sliding * damped;
      // squares: the root is taken only where something slides
      const double stretched = squared_length(spring);
      const bool slides = stretched > limit * limit;
      if (slides) spring *= sliding / std::sqrt(stretched);
      tangential = spring - (tangential_share * chi * normal[j]) * vt;
      const double total = squared_length(tangential), cap = slides ? sliding : limit;
      if (total > cap * cap) tangential *= cap / std::sqrt(total);
      if (kappa > 0) result.tangential_elastic += 0.5 * squared_length(spring) / kappa;
      lossy += tangential;
      next.push_back({f.key, spring, kappa});
    }
    result.dissipative_force += lossy;
    result.dissipative_torque += cross(f.x, lossy);
    if (outputs != nullptr) (*outputs)[j] = output_of(f.n, damped, weight_forces[j], tangential);
  }
  if (rolls)
    add_rolling(law, motion, elastic_force, normal_sum, per_overlap, tangential_share * chi, dt, friction_dt, turned, springs, next,
                result);
  if (!next.empty()) next.push_back(MeanTurn::entry(motion.turn));
  springs.swap(next);
  result.force += result.dissipative_force;
  result.torque += result.dissipative_torque;
  return result;
}

template <class Entry>
PairForceFunction without_the_unneeded(const LawChoice& choice) {
  if constexpr (!built_with::kFriction) return &pair_force<Entry, false, false>;
  if (choice.rolling) return choice.friction ? &pair_force<Entry, true, true> : &pair_force<Entry, false, true>;
  return choice.friction ? &pair_force<Entry, true, false> : &pair_force<Entry, false, false>;
}

}  // namespace

PairForceFunction pair_force_function(const LawChoice& choice) {
  PairForceFunction function = nullptr;
  int index = 0;
  std::apply(
      [&](const auto&... entry) {
        ((index++ == choice.law ? void(function = without_the_unneeded<std::decay_t<decltype(entry)>>(choice)) : void()), ...);
      },
      kLaws);
  SCREE_ASSERT(function != nullptr, "law {} of the list", choice.law);
  return function;
}

}  // namespace scree
