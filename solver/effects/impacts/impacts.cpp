#include "solver/effects/impacts/impacts.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <vector>

#include "core/base/error.hpp"
#include "core/storage/frame_file.hpp"
#include "solver/contact/beginning.hpp"
#include "solver/effects/bonds/shared_impact.hpp"
#include "solver/ranks/exact_sum.hpp"
#include "solver/state/run_state.hpp"

namespace scree {

namespace {

enum Loss : std::size_t { kDampingLoss, kFrictionLoss, kRollingLoss, kLosses };

/// Two bins for each power of two: from 2^-80 J (8e-25) to 2^40 J (1e12); the first and the last take what lies beyond.
constexpr int kFirstImpactPower = -80;
constexpr std::size_t kImpactBins = 240;
struct ImpactBin {
  std::array<std::int64_t, kImpactParts> count{};
  std::array<ShortSum, kImpactParts> energy;  ///< [J]
};

struct MaterialPairTotals {
  std::array<ShortSum, kLosses> lost;  ///< [J]; friction and rolling with what their springs store
  std::array<ImpactBin, kImpactBins> bins;
};

/// Of one rank, or of all; material_pair(a, b).
using ImpactTotals = std::vector<MaterialPairTotals>;

/// Row of a pair of materials, in any order.
std::size_t material_pair(std::size_t a, std::size_t b) { return a < b ? b * (b + 1) / 2 + a : a * (a + 1) / 2 + b; }
std::size_t material_pairs(std::size_t materials) { return materials * (materials + 1) / 2; }

/// A pair of bodies in contact, world axes; forces on A, and torques about the centres.
struct ImpactEntry {
  std::int32_t materials;                        ///< row of ImpactTotals
  std::int32_t a, b;                             ///< rows of the particle set; -1: a wall
  std::int32_t wall;                             ///< index in the scene; -1: none
  bool counts_here;                              ///< this rank counts what the pair has once
  Vec3 damping, damping_a, damping_b;            ///< force, torques
  Vec3 friction, friction_a, friction_b;         ///< force, torques
  Vec3 rolling;                                  ///< torque
  double surface_friction, surface_rolling;      ///< on a surface that moves [W]
  double stored_by_friction, stored_by_rolling;  ///< in springs [J]
  double yielded;                                ///< what its dent took in the step [J]
  std::array<double, kImpactParts> impact{};     ///< of a contact that begins [J]; 0: none
};

/// A piece that bonds hold begins to touch.
struct BegunPiece {
  std::size_t materials;  ///< row of ImpactTotals
  BegunOnFragment begun;
};

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

template <class Action>
void for_each_entry(const std::vector<std::vector<ImpactEntry>>& entries, Action&& action) {
  for (const std::vector<ImpactEntry>& of_thread : entries) {
    for (const ImpactEntry& e : of_thread) action(e);
  }
}

/// in   energy   [J], > 0
std::size_t impact_bin(double energy) {
  int exponent = 0;
  const double mantissa = std::frexp(energy, &exponent);  // energy = mantissa 2^exponent
  const int bin = 2 * (exponent - 1 - kFirstImpactPower) + (mantissa >= kHalfOctave ? 1 : 0);
  return static_cast<std::size_t>(std::clamp(bin, 0, static_cast<int>(kImpactBins) - 1));
}

/// Lower end of a bin, or upper end of the one before [J].
double impact_bin_end(std::size_t bin) {
  return std::ldexp(bin % 2 == 0 ? 0.5 : kHalfOctave, static_cast<int>(bin / 2) + 1 + kFirstImpactPower);
}

ImpactEntry impact_entry(const PairContact& c, std::size_t materials) {
  ImpactEntry entry{};
  entry.materials = static_cast<std::int32_t>(materials);
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
  entry.yielded = c.force.yielded;
  return entry;
}

void add_impact(const std::array<double, kImpactParts>& energy, MaterialPairTotals& of) {
  for (std::size_t k = 0; k < kImpactParts; ++k) {
    if (!(energy[k] > 0)) continue;
    ImpactBin& bin = of.bins[impact_bin(energy[k])];
    ++bin.count[k];
    bin.energy[k].add(energy[k]);
  }
}

/// Adds the entries of the present forces to the totals.
/// in   dt       that the forces count for [s]     in  events   whether what happened in the step counts too
void add_entries(const RunState& s, const std::vector<std::vector<ImpactEntry>>& entries, double dt, bool events, ImpactTotals& totals) {
  const ParticleSet& p = s.particles;
  const auto is_mine = [&](std::int32_t row) {
    return row >= 0 && static_cast<std::size_t>(row) < p.owned && !p.fixed[static_cast<std::size_t>(row)];
  };
  for_each_entry(entries, [&](const ImpactEntry& e) {
    MaterialPairTotals& of = totals[static_cast<std::size_t>(e.materials)];
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
    if (!events || !e.counts_here) return;
    if (e.yielded > 0) of.lost[kDampingLoss].add(e.yielded);
    add_impact(e.impact, of);
  });
}

constexpr std::size_t kImpactWords = kLosses * ShortSum::kWords + kImpactBins * kImpactParts * (1 + ShortSum::kWords);

/// kImpactWords for each pair of materials.
std::vector<std::int64_t> words_of(const ImpactTotals& totals) {
  std::vector<std::int64_t> words;
  words.reserve(totals.size() * kImpactWords);
  const auto append = [&](const ShortSum& sum) {
    const ShortSum::Words w = sum.words();
    words.insert(words.end(), w.begin(), w.end());
  };
  for (const MaterialPairTotals& of : totals) {
    for (const ShortSum& sum : of.lost) append(sum);
    for (const ImpactBin& bin : of.bins) {
      words.insert(words.end(), bin.count.begin(), bin.count.end());
      for (const ShortSum& sum : bin.energy) append(sum);
    }
  }
  return words;
}

/// Throws InputError for another number of words.
void set_words(const std::vector<std::int64_t>& words, ImpactTotals& totals) {
  if (words.size() != totals.size() * kImpactWords) {
    throw InputError("impacts of {} numbers instead of {}; the file is damaged or of another scene", words.size(),
                     totals.size() * kImpactWords);
  }
  auto next = words.begin();
  const auto take = [&](ShortSum& sum) {
    ShortSum::Words w{};
    std::copy_n(next, w.size(), w.begin());
    next += static_cast<std::ptrdiff_t>(w.size());
    sum.set_words(w);
  };
  for (MaterialPairTotals& of : totals) {
    for (ShortSum& sum : of.lost) take(sum);
    for (ImpactBin& bin : of.bins) {
      for (std::int64_t& count : bin.count) count = *next++;
      for (ShortSum& sum : bin.energy) take(sum);
    }
  }
}

/// The same on every rank. Collective.
void add_over_ranks(MPI_Comm comm, ImpactTotals& totals) {
  std::vector<std::int64_t> words = words_of(totals);
  add_words_over_ranks(comm, words);
  set_words(words, totals);
}

void add_to_frame(const SolverScene& scene, const ImpactTotals& totals, Frame& frame) {
  const std::size_t materials = scene.source().materials.size();
  for (std::size_t b = 0; b < materials; ++b) {
    for (std::size_t a = 0; a <= b; ++a) {
      const MaterialPairTotals& of = totals[material_pair(a, b)];
      FrameLosses& losses = frame.losses;
      losses.material_a.push_back(static_cast<std::int32_t>(a));
      losses.material_b.push_back(static_cast<std::int32_t>(b));
      losses.damping.push_back(of.lost[kDampingLoss].value());
      losses.friction.push_back(of.lost[kFrictionLoss].value());
      losses.rolling.push_back(of.lost[kRollingLoss].value());
      for (std::size_t k = 0; k < kImpactBins; ++k) {
        const ImpactBin& bin = of.bins[k];
        if (bin.count[kNormalImpact] == 0 && bin.count[kShearImpact] == 0) continue;
        FrameImpacts& impacts = frame.impacts;
        impacts.material_a.push_back(static_cast<std::int32_t>(a));
        impacts.material_b.push_back(static_cast<std::int32_t>(b));
        impacts.energy_from.push_back(impact_bin_end(k));
        impacts.energy_to.push_back(impact_bin_end(k + 1));
        impacts.normal_count.push_back(bin.count[kNormalImpact]);
        impacts.normal_energy.push_back(bin.energy[kNormalImpact].value());
        impacts.shear_count.push_back(bin.count[kShearImpact]);
        impacts.shear_energy.push_back(bin.energy[kShearImpact].value());
      }
    }
  }
}

class Impacts : public Effect, public PairObserver {
 public:
  explicit Impacts(const RunState& s)
      : totals_(material_pairs(s.scene.source().materials.size())), state_(s), entries_(most_threads()), begun_(most_threads()) {}

  void before_forces(RunState&) override {
    for (std::vector<ImpactEntry>& of_thread : entries_) of_thread.clear();
    for (std::vector<BegunPiece>& of_thread : begun_) of_thread.clear();
  }
  PairObserver* observer() override { return this; }
  bool observes(const PairView&) const override { return true; }
  void observe(const PairContact& c) override {
    const ParticleSet& p = state_.particles;
    const auto a = static_cast<std::size_t>(p.material[static_cast<std::size_t>(c.pair.a)]);
    const auto b = static_cast<std::size_t>(c.view.zone == nullptr
                                                ? p.material[static_cast<std::size_t>(c.pair.b)]
                                                : state_.scene.source().walls[static_cast<std::size_t>(c.view.zone->wall)].material);
    entries_[c.thread].push_back(impact_entry(c, material_pair(a, b)));
    const Beginning begins = beginning_of(c.features, c.motion, c.friction_dt);
    if (!c.motion.is_bonded()) {
      entries_[c.thread].back().impact = begins.energy;
    } else if (begins.overlaps > 0 && c.counts_here) {
      begun_[c.thread].push_back({material_pair(a, b), begun_on_fragment(p, c, begins)});
    }
  }
  void start(RunState& s) override { add_entries(s, entries_, 0.5 * s.clock.dt, false, totals_); }
  void after_kick(RunState& s) override { add_entries(s, entries_, s.clock.dt, true, totals_); }
  /// Pieces that strike together are on any ranks.
  void end_step(const StepParts& parts) override {
    if (!parts.state.fragments) return;
    std::vector<BegunOnFragment> begun;
    std::vector<std::size_t> materials;
    for (const std::vector<BegunPiece>& of_thread : begun_) {
      for (const BegunPiece& piece : of_thread) {
        begun.push_back(piece.begun);
        materials.push_back(piece.materials);
      }
    }
    const std::vector<ShareOfImpact> shares = share_impacts(parts.state, begun);
    for (std::size_t n = 0; n < shares.size(); ++n)
      if (shares[n].is_first) add_impact(shares[n].energy, totals_[materials[n]]);
  }
  /// As for all that is dissipated (StepLevels::change).
  void on_step_change(RunState& s, double difference) override { add_entries(s, entries_, difference, false, totals_); }

  EffectRecord record(const RunState& s) const override {
    ImpactTotals all = totals_;
    add_over_ranks(s.comm.get(), all);
    return {{.integers = words_of(all)}};
  }
  void restore(RunState& s, const EffectRecord& record) override {
    if (s.comm.rank() == 0) set_words(record.front().integers, totals_);
  }

  void add_frame(const RunState& s, Frame& frame) const override {
    const ImpactTotals now = at_present(s);
    if (s.comm.rank() == 0) add_to_frame(s.scene, now, frame);
  }

  std::vector<PlanLine> plan(const RunState&) const override {
    return {{"impacts", fmt::format("energies and losses by {} pairs of materials, {:.1f} kB on each rank", totals_.size(),
                                    static_cast<double>(totals_.size() * sizeof(MaterialPairTotals)) / 1e3)}};
  }

 private:
  /// Of all ranks, without the half of the last step that lies ahead and without what springs store. Collective.
  ImpactTotals at_present(const RunState& s) const {
    ImpactTotals now = totals_;
    add_entries(s, entries_, -0.5 * s.clock.dt, false, now);
    for_each_entry(entries_, [&](const ImpactEntry& e) {
      if (!e.counts_here) return;
      MaterialPairTotals& of = now[static_cast<std::size_t>(e.materials)];
      of.lost[kFrictionLoss].add(-e.stored_by_friction);
      of.lost[kRollingLoss].add(-e.stored_by_rolling);
    });
    add_over_ranks(s.comm.get(), now);
    return now;
  }

  ImpactTotals totals_;  // of this rank
  const RunState& state_;
  std::vector<std::vector<ImpactEntry>> entries_;  // of the present forces, by thread
  std::vector<std::vector<BegunPiece>> begun_;
};

}  // namespace

EffectKind impacts_effect() {
  return {{"", "impacts or losses by pair of materials differ", {{"impacts", "", kImpactWords, false}}},
          {"impacts", "output.impacts = false"},
          [](const RunState& s) -> std::unique_ptr<Effect> {
            if (!s.scene.source().settings.output_impacts) return nullptr;
            return std::make_unique<Impacts>(s);
          }};
}

}  // namespace scree
