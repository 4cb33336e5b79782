#include "solver/effects/cell/cell.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "core/base/error.hpp"
#include "solver/bodies/cell_motion.hpp"
#include "solver/bodies/kept_sum.hpp"
#include "solver/bodies/motion.hpp"
#include "solver/effects/cell/cell_effect.hpp"

namespace scree {

namespace {

/// Most that a step may change a length, of itself: far beyond what the step of contacts leaves room for, and where cell.cpp's series for
/// exp(z) is exact to rounding.
constexpr double kMostGrowth = 1e-3;
/// Of the largest body: see check_period().
constexpr double kRoomForSkin = 1.01;

/// The steady rate r follows in the time in which the stress would move the damped cell alone by this strain. So long that a gas
/// overshoots its target by some 20 % only when it becomes a bed, and short beside the strains over which a bed changes its way to flow.
constexpr double kSteadyStrain = 0.01;
/// The same for the mean stress. Ten times as long brings its mean nearer to the target (0.996 for 0.991 of a fast flow), and lets a gas
/// overshoot by 43 % for 18.
constexpr double kMeanStrain = 0.01;

/// What of the momentum is more than rounding: over the sum of the sizes of its terms.
constexpr double kMomentumRounding = 1e-13;

double largest_of(const UpperMatrix& m) {
  double largest = 0;
  for (int k = 0; k < 6; ++k) largest = std::max(largest, std::abs(m[k]));
  return largest;
}

/// The axis across which a component changes the cell: a shear xy goes with the way along y.
constexpr std::array<int, 6> kAcross = {0, 1, 2, 2, 2, 1};

}  // namespace

void CellEffect::begin(RunState& s) {
  ParticleSet& p = s.particles;
  ExactSum mass, solid;
  for (std::size_t i = 0; i < p.owned; ++i) {
    mass.add(p.mass[i]);
    solid.add(p.mass[i] / s.scene.source().materials[static_cast<std::size_t>(p.material[i])].density);
  }
  mass_ = over_ranks(s.comm.get(), mass).value();
  solid_volume_ = over_ranks(s.comm.get(), solid).value();
  if (is_restored_) return;
  contact_time_ = s.clock.size.contact_time;
  if (!(contact_time_ > 0) && control_.any_by_stress())
    throw UsageError("cell.stress: no two bodies can touch, so that nothing withstands a stress; use cell.strain_rate");
  p.cell.begin({first_, s.scene.periodicity().shear()}, {});
  UpperMatrix rate;
  for (int k = 0; k < 6; ++k) rate[k] = -control_.rate(k).at(s.clock.time());
  p.cell.set_rate(rate);
  take_mean_velocity(s);
}

/// The momentum of all bodies together is 0 from then on, dP/dt = -L P, but for what planes take along z.
void CellEffect::take_mean_velocity(RunState& s) const {
  ParticleSet& p = s.particles;
  std::vector<ExactSum> sums(6);
  for (std::size_t i = 0; i < p.owned; ++i) {
    for (int k = 0; k < 3; ++k) {
      sums[static_cast<std::size_t>(k)].add(p.mass[i] * p.v[i][k]);
      sums[static_cast<std::size_t>(3 + k)].add(p.mass[i] * std::abs(p.v[i][k]));
    }
  }
  add_over_ranks(s.comm.get(), sums);
  Vec3 mean, size;
  for (int k = 0; k < 3; ++k) {
    mean[k] = sums[static_cast<std::size_t>(k)].value() / mass_;
    size[k] = sums[static_cast<std::size_t>(3 + k)].value() / mass_;
  }
  if (!p.cell.periodicity().is_periodic(2)) mean.z = 0;  // planes hold the bodies
  for (std::size_t i = 0; i < p.owned; ++i) p.v[i] -= mean;
  if (length(mean) > kMomentumRounding * length(size) && s.comm.rank() == 0)
    warn_once("scree-solver",
              fmt::format("the bodies of the cell have a mean velocity of [{:.4g}, {:.4g}, {:.4g}] m/s, which was taken from each: they "
                          "move with the cell",
                          mean.x, mean.y, mean.z));
}

CellSums CellEffect::sums_of_step(const RunState& s) const { return shears_ ? cell_sums(s) : diagonal_cell_sums(s); }

double CellEffect::inertia(const RunState& s, int component) const {
  const double h = s.particles.cell.edges().diagonal[kAcross[static_cast<std::size_t>(component)]];
  return mass_ * h * h / (std::numbers::pi * std::numbers::pi);
}

double CellEffect::damping(const RunState& s, int component) const {
  const Cell& cell = s.particles.cell;
  const double spacing = std::cbrt(cell.volume() / static_cast<double>(s.facts.count));
  const double h = cell.edges().diagonal[kAcross[static_cast<std::size_t>(component)]];
  return std::numbers::sqrt2 * std::numbers::pi * std::numbers::pi * spacing / (h * contact_time_);
}

/// Minus the mean of what is given over the step that begins.
double CellEffect::next_given_rate(const RunState& s, int component) const {
  const double now = s.clock.time();
  return -control_.rate(component).mean(now, now + s.clock.dt);
}

void CellEffect::start(RunState& s) {
  const double dt = s.clock.dt;
  const CellSums sums = sums_of_step(s);
  const UpperMatrix sum = sums.symmetric(), rate = s.particles.cell.rate();
  next_rate_ = rate;
  for (int k = 0; k < 6; ++k) {
    if (control_.by_rate(k)) next_rate_[k] = next_given_rate(s, k);
    if (!control_.by_stress(k)) continue;
    const double push = (sum[k] - control_.stress[k] * s.particles.cell.volume()) / inertia(s, k);
    next_rate_[k] = 0.5 * dt * push / (1 + 0.5 * damping(s, k) * dt);  // from rest, half a step
    mean_stress_[k] = sum[k] / s.particles.cell.volume();
  }
  power_ = -dot(sums.upper(), rate);
  losing_ = -dot(sums.lost, rate);
  work_ += 0.5 * dt * power_;  // as of walls: the first kick is by half a step
  lost_ += 0.5 * dt * losing_;
}

void CellEffect::before_drift(RunState& s) {
  Cell& cell = s.particles.cell;
  const double dt = s.clock.dt;
  for (int k = 0; k < 6; ++k) {
    const double change = std::abs(next_rate_[k] * dt);
    if (change <= kMostGrowth) continue;
    const char* const control = control_.by_stress(k) ? "stress" : "strain_rate";
    if (k < 3)
      throw RunInvalid(
          "step {}: the cell changes its length along {} by {:.3g} of it in a step of {:.3g} s, more than {:g}: reduce the "
          "step, or cell.{}",
          s.clock.step, kUpperNames[static_cast<std::size_t>(k)], change, dt, kMostGrowth, control);
    throw RunInvalid("step {}: the cell has a shear {} of {:.3g} in a step of {:.3g} s, more than {:g}: reduce the step, or cell.{}",
                     s.clock.step, kUpperNames[static_cast<std::size_t>(k)], change, dt, kMostGrowth, control);
  }
  cell.deform(next_rate_, dt);
  for (int k = 0; k < 3; ++k) add_keeping_rest(dt * next_rate_.above[k], sheared_[k], sheared_rest_[k]);
  carry_with_cell(s.particles);
  const double needed = 4 * (kRoomForSkin * s.facts.largest_radius + s.scene.contact_range());
  for (int k = 0; k < 3; ++k) {
    if (!cell.periodicity().is_periodic(k) || cell.periodicity().period()[k] >= needed) continue;
    throw RunInvalid(
        "step {}: the cell is {:g} m long along {}, and its largest body, with a bounding radius of {:g} m, needs {:g} m, two "
        "diameters and margins: end the run before, by cell.stop_when or time.duration, or use more bodies",
        s.clock.step, cell.periodicity().period()[k], "xyz"[k], s.facts.largest_radius, needed);
  }
}

void CellEffect::drift(RunState& s) { slow_with_cell(s.particles); }

void CellEffect::end_step(const StepParts& parts) {
  RunState& s = parts.state;
  Cell& cell = s.particles.cell;
  const double dt = s.clock.dt;
  const CellSums sums = sums_of_step(s);
  const UpperMatrix sum = sums.symmetric();
  UpperMatrix rate = cell.rate();
  // of a target of 0, which has no size of its own: how far the stress of a bed that is sheared goes
  const double pressure = std::max(0.0, sum.diagonal.x + sum.diagonal.y + sum.diagonal.z) / (3 * cell.volume());
  for (int k = 0; k < 6; ++k) {
    if (control_.by_rate(k)) {
      const double last = next_rate_[k];
      next_rate_[k] = next_given_rate(s, k);
      rate[k] = 0.5 * (last + next_rate_[k]);
    }
    if (!control_.by_stress(k)) continue;
    const double target = control_.stress[k] * cell.volume(), w = inertia(s, k), gamma = damping(s, k);
    const double push = (sum[k] - target) / w, half = 0.5 * gamma * dt, last = next_rate_[k];
    next_rate_[k] = ((1 - half) * last + dt * push + 2 * half * steady_rate_[k]) / (1 + half);
    rate[k] = 0.5 * (last + next_rate_[k]);
    const double asked = control_.stress[k], mean = mean_stress_[k];
    const double size = asked != 0 ? std::abs(asked) : pressure;
    const double held = asked == 0 ? pressure : mean * asked > 0 ? std::min(std::abs(mean), size) : 0;
    const double moves = dt * cell.volume() / (w * gamma);  // strain of the damped cell in a step, per stress
    steady_rate_[k] += std::min(1.0, moves * held / kSteadyStrain) * (rate[k] - steady_rate_[k]);
    mean_stress_[k] += std::min(1.0, moves * size / kMeanStrain) * (sum[k] / cell.volume() - mean);
  }
  cell.set_rate(rate);
  power_ = -dot(sums.upper(), rate);
  losing_ = -dot(sums.lost, rate);
  work_ += dt * power_;
  lost_ += dt * losing_;
}

UpperMatrix CellEffect::strain(const RunState& s) const {
  const Vec3& h = s.particles.cell.edges().diagonal;
  return {{std::log(first_.x / h.x), std::log(first_.y / h.y), std::log(first_.z / h.z)}, Vec3{} - sheared_};
}

std::string CellEffect::ends_run(const RunState& s) const {
  const CellControl& c = control_;
  const double now = largest_of(strain(s));
  if (c.stop_strain > 0 && now >= c.stop_strain) return fmt::format("the cell has the strain {:.4g} of cell.stop_when", now);
  if (!(c.stop_stress_error > 0) && !(c.stop_kinetic_ratio > 0)) return {};
  const ParticleSet& p = s.particles;
  const UpperMatrix sum = sums_of_step(s).symmetric();
  double error = 0;
  const double largest = largest_of(c.stress);
  for (int k = 0; k < 6; ++k) {
    if (c.by_stress(k)) error = std::max(error, std::abs(sum[k] / p.cell.volume() - c.stress[k]) / largest);
  }
  if (c.stop_stress_error > 0 && !(error <= c.stop_stress_error)) return {};
  // of bodies that touch others: what flies or spins in a hole of a bed may do so for good
  std::vector<ExactSum> energies(2);
  std::vector<std::uint8_t> touches(p.size(), 0);
  const auto add = [&](const std::vector<std::int32_t>& pairs, bool counts_here) {
    for (const std::int32_t k : pairs) {
      const PairResult& r = s.pairs.results()[static_cast<std::size_t>(k)];
      const BodyPair& pair = s.pairs.stored_pairs()[static_cast<std::size_t>(k)];
      if (!r.active || pair.b < 0) continue;
      touches[static_cast<std::size_t>(pair.a)] = touches[static_cast<std::size_t>(pair.b)] = 1;
      if (counts_here) energies[1].add(r.elastic + r.tangential_elastic);
    }
  };
  add(s.pairs.inner(), true);
  add(s.pairs.outer(), true);
  add(s.pairs.duplicated(), false);
  for (std::size_t i = 0; i < p.owned; ++i) {
    if (touches[i] != 0) energies[0].add(translational_energy(p, i) + rotational_energy(p, i));
  }
  add_over_ranks(s.comm.get(), energies);
  const double kinetic = energies[0].value(), stored = energies[1].value();
  if (c.stop_kinetic_ratio > 0 && !(stored > 0 && kinetic <= c.stop_kinetic_ratio * stored)) return {};
  return fmt::format(
      "the stresses of the cell are within {:.2g} of their targets, and the kinetic energy of bodies that touch is {:.2g} of that of their "
      "contacts",
      error, stored > 0 ? kinetic / stored : 0);
}

EffectKind cell_effect() {
  return {{"cell", "the cell differs", CellEffect::format()},
          {"cell", "no [cell]: the domain stays as it is"},
          [](const RunState& s) -> std::unique_ptr<Effect> {
            if (!s.scene.source().settings.cell) return nullptr;
            if (const CellBlocker blocker = cell_blocker(s.scene.source()); blocker.key != nullptr)
              throw UsageError("cell: does not go with {}: {}", blocker.key, blocker.why);
            return std::make_unique<CellEffect>(s);
          }};
}

}  // namespace scree
