#include "solver/step/impacts.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/base/error.hpp"
#include "solver/step/run_state.hpp"

namespace scree {

namespace {

constexpr double kHalfOctave = 0.5 * std::numbers::sqrt2;  // within the powers of two, as frexp() gives them: from .5 to 1

/// What a force with a torque does in a time at the velocities of a body [W].
double power(const Vec3& force, const Vec3& torque, const Vec3& v, const Vec3& w) { return dot(force, v) + dot(torque, w); }

/// What acts on one side of a pair loses in a time, by cause. Each side is added by itself: the two may be on different ranks, and only the
/// sums are exact.
void add_side(double side, const ImpactEntry& e, const Vec3& damping_torque, const Vec3& friction_torque, const Vec3& v, const Vec3& w,
              double dt, std::array<ShortSum, kLosses>& lost) {
  lost[kDampingLoss].add(-dt * power(side * e.damping, damping_torque, v, w));
  lost[kFrictionLoss].add(-dt * power(side * e.friction, friction_torque, v, w));
  lost[kRollingLoss].add(-dt * side * dot(e.rolling, w));
}

}  // namespace

std::size_t impact_bin(double energy) {
  int exponent = 0;
  const double mantissa = std::frexp(energy, &exponent);  // energy = mantissa 2^exponent
  const int bin = 2 * (exponent - 1 - kFirstImpactPower) + (mantissa >= kHalfOctave ? 1 : 0);
  return static_cast<std::size_t>(std::clamp(bin, 0, static_cast<int>(kImpactBins) - 1));
}

double impact_bin_end(std::size_t bin) {
  return std::ldexp(bin % 2 == 0 ? 0.5 : kHalfOctave, static_cast<int>(bin / 2) + 1 + kFirstImpactPower);
}

Beginning beginning_of(const PairFeatures& features, const PairMotion& m, double friction_dt) {
  Beginning begins;
  if (!(friction_dt > 0)) return begins;
  Vec3 force, torque, slip, at;
  double speed = 0;
  for (const ContactFeature& f : features.list) {
    if (!(f.overlap > 0)) continue;
    const Vec3 velocity = m.v_a + cross(m.w_a, f.x) - m.pivot_v_b - cross(m.w_b, f.x - m.pivot_b);
    const double vn = dot(velocity, f.n);
    // bodies drift by these velocities: one step before, the overlap was this much less
    if (f.overlap + vn * friction_dt > 0) return {};
    begins.overlaps += f.overlap;
    speed += f.overlap * vn;
    force += f.overlap * f.n;
    torque += cross(f.x, f.overlap * f.n);
    Vec3 sliding = velocity;
    if (m.surface != nullptr) sliding -= m.surface->at(f.x);
    slip += f.overlap * (sliding - dot(sliding, f.n) * f.n);
    at += f.overlap * f.x;
  }
  const double mobility = wrench_mobility(m, force, torque);
  if (mobility > 0) begins.energy[kNormalImpact] = 0.5 * speed * speed / mobility;
  const double slides = squared_length(slip);
  if (slides > 0) {
    // the mean slip, at the mean place: (s . s / o)^2 / (2 Q M^-1 Q) for the wrench Q of the force s at the place
    const double along = wrench_mobility(m, slip, cross((1 / begins.overlaps) * at, slip));
    const double power = slides / begins.overlaps;
    if (along > 0) begins.energy[kShearImpact] = 0.5 * power * power / along;
  }
  return begins;
}

ImpactEntry impact_entry(const RecordedContact& c) {
  ImpactEntry entry{};
  entry.materials = static_cast<std::int32_t>(c.materials);
  entry.a = c.pair.a;
  entry.b = c.view.zone == nullptr ? c.pair.b : -1;
  entry.wall = c.view.zone == nullptr ? -1 : c.view.zone->wall;
  entry.counts_here = c.counts_here;
  Vec3 damping, damping_torque, friction, friction_torque;
  for (std::size_t j = 0; j < c.features.list.size(); ++j) {
    const ContactFeature& f = c.features.list[j];
    const ContactOutput& out = c.outputs[j];
    damping += out.damping * f.n;
    damping_torque += cross(f.x, out.damping * f.n);
    friction += out.tangential_force;
    friction_torque += cross(f.x, out.tangential_force);
    if (c.motion.surface != nullptr) entry.surface_friction += dot(out.tangential_force, c.motion.surface->at(f.x));
  }
  const Vec3 branch = c.view.b.x - c.view.a.x;
  entry.damping = c.a_to_world * damping;
  entry.damping_a = c.a_to_world * damping_torque;
  entry.damping_b = cross(branch, entry.damping) - entry.damping_a;
  entry.friction = c.a_to_world * friction;
  entry.friction_a = c.a_to_world * friction_torque;
  entry.friction_b = cross(branch, entry.friction) - entry.friction_a;
  entry.rolling = c.a_to_world * c.force.rolling_moment;
  entry.surface_rolling = c.force.surface_power - entry.surface_friction;
  entry.stored_by_rolling = c.force.rolling_elastic;
  entry.stored_by_friction = c.force.tangential_elastic - c.force.rolling_elastic;
  entry.impact = beginning_of(c.features, c.motion, c.friction_dt).energy;
  return entry;
}

void book_impacts(const RunState& s, double dt, bool events, ImpactTotals& totals) {
  const ParticleSet& p = s.particles;
  const auto is_mine = [&](std::int32_t row) {
    return row >= 0 && static_cast<std::size_t>(row) < p.owned && !p.fixed[static_cast<std::size_t>(row)];
  };
  for (const ImpactEntry& e : s.impacts) {
    MaterialPairTotals& of = totals.pairs[static_cast<std::size_t>(e.materials)];
    const auto a = static_cast<std::size_t>(e.a);
    if (is_mine(e.a)) add_side(1, e, e.damping_a, e.friction_a, p.v[a], p.w[a], dt, of.lost);
    if (is_mine(e.b)) {
      const auto b = static_cast<std::size_t>(e.b);
      add_side(-1, e, e.damping_b, e.friction_b, p.v[b], p.w[b], dt, of.lost);
    }
    if (e.wall >= 0 && e.counts_here) {
      // about the wall's own point, as for its work: minus the torque on A, plus the lever
      const WallState& wall = s.walls[static_cast<std::size_t>(e.wall)];
      const Vec3 lever = p.x[a] - wall.position;
      add_side(-1, e, -cross(lever, e.damping) - e.damping_a, -cross(lever, e.friction) - e.friction_a, wall.velocity,
               wall.angular_velocity, dt, of.lost);
      of.lost[kFrictionLoss].add(dt * e.surface_friction);
      of.lost[kRollingLoss].add(dt * e.surface_rolling);
    }
    if (!events || !e.counts_here) continue;
    for (std::size_t k = 0; k < kImpactParts; ++k) {
      if (!(e.impact[k] > 0)) continue;
      ImpactBin& bin = of.bins[impact_bin(e.impact[k])];
      ++bin.count[k];
      bin.energy[k].add(e.impact[k]);
    }
  }
}

ImpactTotals impacts_now(const RunState& s) {
  ImpactTotals now = s.totals.impacts;
  book_impacts(s, -0.5 * s.clock.dt, false, now);
  for (const ImpactEntry& e : s.impacts) {
    if (!e.counts_here) continue;
    MaterialPairTotals& of = now.pairs[static_cast<std::size_t>(e.materials)];
    of.lost[kFrictionLoss].add(-e.stored_by_friction);
    of.lost[kRollingLoss].add(-e.stored_by_rolling);
  }
  add_over_ranks(s.comm.get(), now);
  return now;
}

void add_over_ranks(MPI_Comm comm, ImpactTotals& totals) {
  if (totals.pairs.empty()) return;
  std::vector<std::int64_t> words = words_of(totals);
  MPI_Allreduce(MPI_IN_PLACE, words.data(), static_cast<int>(words.size()), MPI_INT64_T, MPI_SUM, comm);
  set_words(words, totals);
}

std::vector<std::int64_t> words_of(const ImpactTotals& totals) {
  std::vector<std::int64_t> words;
  words.reserve(totals.pairs.size() * kImpactWords);
  const auto append = [&](const ShortSum& sum) {
    const ShortSum::Words w = sum.words();
    words.insert(words.end(), w.begin(), w.end());
  };
  for (const MaterialPairTotals& of : totals.pairs) {
    for (const ShortSum& sum : of.lost) append(sum);
    for (const ImpactBin& bin : of.bins) {
      words.insert(words.end(), bin.count.begin(), bin.count.end());
      for (const ShortSum& sum : bin.energy) append(sum);
    }
  }
  return words;
}

void set_words(const std::vector<std::int64_t>& words, ImpactTotals& totals) {
  if (words.size() != totals.pairs.size() * kImpactWords) {
    throw InputError("impacts of {} numbers instead of {}; the file is damaged or of another scene", words.size(),
                     totals.pairs.size() * kImpactWords);
  }
  auto next = words.begin();
  const auto take = [&](ShortSum& sum) {
    ShortSum::Words w{};
    std::copy_n(next, w.size(), w.begin());
    next += static_cast<std::ptrdiff_t>(w.size());
    sum.set_words(w);
  };
  for (MaterialPairTotals& of : totals.pairs) {
    for (ShortSum& sum : of.lost) take(sum);
    for (ImpactBin& bin : of.bins) {
      for (std::int64_t& count : bin.count) count = *next++;
      for (ShortSum& sum : bin.energy) take(sum);
    }
  }
}

}  // namespace scree
