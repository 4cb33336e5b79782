// The effect itself: what heat.cpp does in a step, and heat_output.cpp keeps and writes. For others: heat.hpp.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

#include "solver/effects/heat/conductance.hpp"
#include "solver/effects/heat/gas_gaps.hpp"
#include "solver/effects/heat/outer_heat.hpp"
#include "solver/state/effect.hpp"
#include "solver/state/run_state.hpp"

namespace scree {

/// Sums that a rank keeps of heat [J], by their names in checkpoints and, after "heat_", in the log.
enum HeatTotal : std::size_t { kMade, kMadeInWalls, kFromSources, kArrived, kRemoved, kHeatTotals };
inline constexpr std::array<const char*, kHeatTotals> kHeatTotalNames{"made", "made_in_walls", "from_sources", "arrived", "removed"};

/// Heat of the whole scene, as log.csv has it. [J] but for the last two.
struct HeatMeasures {
  double stored = 0, balance = 0;
  std::array<double, kHeatTotals> totals{};
  double from_program = 0, from_medium = 0;  ///< of outer_heat.hpp
  double from_all_walls = 0;
  std::vector<double> from_walls, flow_of_walls;  ///< of each wall; its flow [W]
  double critical_step = 0, biot = 0;             ///< [s], [-], of the present contacts and media
};

class HeatEffect : public Effect, public PairObserver {
 public:
  /// A pair that conducts, through its contact or through gas.
  struct Flow {
    std::int32_t a, b;   ///< rows; b is -1 for a wall
    std::int32_t wall;   ///< its index, or -1
    double conductance;  ///< [W/K]
  };
  /// A contact, by the index of its pair.
  struct Contact {
    std::int32_t pair;
    double conductance;  ///< [W/K]; < 0: not known
  };

  /// What the case gives to a body: a power at all times, and that of a table.
  struct Source {
    std::int64_t id;
    double power;        ///< [W]
    std::int32_t table;  ///< index into Heat::source_tables, or -1
  };

  explicit HeatEffect(const RunState& s)
      : state_(s),
        friction_heat_(s.scene.source().settings.heat->friction_heat),
        conductance_(s.scene.source()),
        seen_(most_threads()),
        pending_(s.scene.source().walls.size(), 0.0),
        to_bodies_(pending_.size()) {
    for (const Wall& wall : s.scene.source().walls) has_flux_ = has_flux_ || wall.heat.kind == WallHeatKind::flux;
    for (std::size_t b = 0; b < s.scene.source().bodies.size(); ++b) {
      const BodyTable& bodies = s.scene.source().bodies;
      if (bodies.heat_source[b] != 0 || bodies.heat_table[b] >= 0)
        sources_.push_back({bodies.id[b], bodies.heat_source[b], bodies.heat_table[b]});
    }
    std::sort(sources_.begin(), sources_.end(), [](const Source& l, const Source& r) { return l.id < r.id; });
    if (s.scene.source().settings.heat->has_gas()) gas_.emplace(s.scene.source());
  }

  /// What a program gives to bodies; made at the first call, on every rank alike, between two steps. The log then has its columns.
  OuterHeat& outer() { return outer_ ? *outer_ : outer_.emplace(); }
  /// Null where no program gives anything.
  const OuterHeat* given_outer() const { return outer_ ? &*outer_ : nullptr; }
  /// Collective.
  HeatMeasures measure(const RunState& s) const;

  void start(RunState& s) override;
  void after_migration(RunState& s, bool left) override {
    if (outer_) outer_->after_migration(s, left);
  }
  void on_rebuild(const StepParts& parts) override;
  void body_leaves(const RunState& s, std::size_t row) override { add_heat_of(s.particles, row, totals_[kRemoved]); }
  void body_joins(const RunState& s, std::size_t row) override { add_heat_of(s.particles, row, totals_[kArrived]); }
  void before_forces(RunState& s) override;
  PairObserver* observer() override { return this; }
  bool observes(const PairView&) const override { return true; }
  bool needs_outputs() const override { return false; }
  void observe(const PairContact& contact) override {
    const auto pair = static_cast<std::int32_t>(&contact.pair - state_.pairs.pairs().data());
    seen_[contact.thread].push_back({pair, conductance_.of(contact, state_.particles)});
    if (contact.force.yielded > 0 && friction_heat_) stored_[static_cast<std::size_t>(pair)] += contact.force.yielded;
  }
  void end_step(const StepParts& parts) override;
  void on_step_change(RunState& s, double difference) override;
  void falls_asleep(RunState& s, std::size_t row) override;
  double extra_reach(const RunState&, bool) const override { return gas_ ? gas_->range() : 0; }
  StepBound bound(const RunState& s) const override;

  EffectRecord record(const RunState& s) const override;
  void restore(RunState& s, const EffectRecord& record) override;
  std::vector<ItemHash> hashes(const RunState& s) const override;
  void add_log_columns(const RunState& s, const Energies&, std::vector<Column>& columns) const override;
  std::vector<PlanLine> plan(const RunState& s) const override;

 private:
  double capacity(const ParticleSet& p, std::size_t row) const {
    return p.mass[row] * state_.scene.source().materials[static_cast<std::size_t>(p.material[row])].heat_capacity;
  }
  void add_heat_of(const ParticleSet& p, std::size_t row, ExactSum& sum) const {
    const double mc = capacity(p, row);
    sum.add(mc * p.temperature[row]);
    sum.add(mc * p.temperature_remainder[row]);
  }
  const Wall& wall_of(const Flow& flow) const { return state_.scene.source().walls[static_cast<std::size_t>(flow.wall)]; }

  void collect_contacts();
  void add_resting(const StepParts& parts);
  void find_frozen(const StepParts& parts);
  void list_flows(const RunState& s);
  void review_conduction(const RunState& s);
  void check_step(const StepParts& parts) const;
  void add_made(const RunState& s, double share);
  void add_loss(const BodyPair& pair, std::size_t owned, double loss);
  void add_sources(const RunState& s);
  void add_flux(const RunState& s);
  std::vector<double> temperatures_of_walls(double time) const;
  void add_conducted(const RunState& s, const std::vector<double>& of_walls, const std::vector<double>& temperature,
                     std::vector<double>& power) const;
  void advance(const StepParts& parts);
  void heat_body(ParticleSet& p, std::size_t row, double heat);

  const RunState& state_;
  bool friction_heat_, has_flux_ = false;
  ContactConductance conductance_;
  std::vector<Source> sources_;  // of the case, by id

  std::optional<GasGaps> gas_;
  std::optional<OuterHeat> outer_;

  std::vector<std::vector<Contact>> seen_;  // contacts whose forces were computed, by thread
  std::vector<Contact> contacts_;           // of this step, in the order of pairs
  std::vector<Flow> flows_;                 // the same, then gaps with gas in the order of theirs
  std::vector<double> at_rest_;             // of each pair: conductance between two sides that do not move; < 0: not known [W/K]
  std::vector<double> stored_;              // of each pair: in its springs before the step, and what its dent took in it [J]
  std::vector<std::pair<std::size_t, std::size_t>> source_rows_;  // rows with a source, and its index
  std::vector<double> given_;                                     // the same: what it gets in the step whatever temperatures are [J]
  std::vector<double> stage_, power_first_, power_;

  // present, of the bodies of this rank
  double critical_step_ = std::numeric_limits<double>::infinity();  // [s]
  std::int64_t critical_body_ = -1;
  double critical_medium_ = 0;  // its conductance to its medium [W/K]
  double biot_ = 0;

  std::array<ExactSum, kHeatTotals> totals_;  // of this rank
  std::vector<double> pending_;               // of each wall with a flux: given by it and not yet taken by a body [J]
  std::vector<ExactSum> to_bodies_;           // of each wall: what it has given to bodies [J]
  std::vector<ExactSum> flow_now_ = std::vector<ExactSum>(to_bodies_.size());  // the same in the last step, of this rank [W]
};

}  // namespace scree
