// What the effect keeps for a restart, and adds to log and plan.
#include <fmt/format.h>

#include <algorithm>
#include <vector>

#include "core/base/error.hpp"
#include "core/base/index.hpp"
#include "core/base/units.hpp"
#include "solver/effects/heat/contact_losses.hpp"
#include "solver/effects/heat/heat_effect.hpp"

namespace scree {

namespace {

/// In a record: after the totals, walls and what they keep.
constexpr std::ptrdiff_t kFirstOuter = kHeatTotals + 2;

/// For a plan.
std::string text_of(const TimeTable& table, Dimension dimension) {
  if (table.is_constant()) return format_quantity(table.value.front(), dimension);
  return fmt::format("{} at {} to {} at {} (a table of {} rows)", format_quantity(table.value.front(), dimension),
                     format_quantity(table.time.front(), Dimension::time), format_quantity(table.value.back(), dimension),
                     format_quantity(table.time.back(), Dimension::time), table.value.size());
}

}  // namespace

EffectRecord HeatEffect::record(const RunState& s) const {
  EffectRecord record;
  for (const ExactSum& total : totals_) record.push_back(array_of(over_ranks(s.comm.get(), total)));
  StateArray& walls = record.emplace_back();
  std::vector<ExactSum> to_bodies = to_bodies_;
  add_over_ranks(s.comm.get(), to_bodies);
  for (const ExactSum& sum : to_bodies) {
    const ExactSum::Words words = sum.words();
    walls.integers.insert(walls.integers.end(), words.begin(), words.end());
  }
  record.push_back({.reals = pending_});
  const EffectRecord outer = outer_ ? outer_->record(s) : EffectRecord(OuterHeat::kArrays);
  record.insert(record.end(), outer.begin(), outer.end());
  return record;
}

/// Without what a program holds, and has not taken yet: temperatures follow from it, and what the program reads changes no state.
std::vector<ItemHash> HeatEffect::hashes(const RunState& s) const {
  EffectRecord kept = record(s);
  kept.resize(static_cast<std::size_t>(kFirstOuter) + OuterHeat::kSums);
  ItemHash h;
  for (const StateArray& array : kept) {
    for (const double value : array.reals) h.add(value);
    for (const std::int64_t value : array.integers) h.add(value);
  }
  return {h};
}

void HeatEffect::restore(RunState& s, const EffectRecord& record) {
  const std::vector<std::int64_t>& words = record[kHeatTotals].integers;
  const std::vector<double>& pending = record[kHeatTotals + 1].reals;
  if (words.size() != to_bodies_.size() * ExactSum::kWords || pending.size() != pending_.size())
    throw InputError("heat of {} walls instead of {}; the file is damaged or of another scene", pending.size(), pending_.size());
  pending_ = pending;
  const EffectRecord of_program(record.begin() + kFirstOuter, record.end());
  if (!of_program.front().integers.empty()) outer().restore(s, of_program);
  if (s.comm.rank() != 0) return;
  for (std::size_t t = 0; t < kHeatTotals; ++t) totals_[t] = sum_of(record[t]);
  for (std::size_t w = 0; w < to_bodies_.size(); ++w) {
    ExactSum::Words of_wall{};
    std::copy_n(words.begin() + static_cast<std::ptrdiff_t>(w * ExactSum::kWords), ExactSum::kWords, of_wall.begin());
    to_bodies_[w].set_words(of_wall);
  }
}

HeatMeasures HeatEffect::measure(const RunState& s) const {
  const ParticleSet& p = s.particles;
  const std::size_t walls = to_bodies_.size();
  // totals, what is stored, of a program two sums, then of each wall what it gave and what it gives
  std::vector<ExactSum> sums(totals_.begin(), totals_.end());
  ExactSum& stored = sums.emplace_back();
  for (std::size_t i = 0; i < p.owned; ++i) add_heat_of(p, i, stored);
  sums.push_back(outer_ ? outer_->from_program() : ExactSum{});
  sums.push_back(outer_ ? outer_->from_medium() : ExactSum{});
  sums.insert(sums.end(), to_bodies_.begin(), to_bodies_.end());
  sums.insert(sums.end(), flow_now_.begin(), flow_now_.end());
  for (std::size_t k = 0; k < stored_.size(); ++k) {
    // half of what the last step was counted with lies ahead
    if (!s.pairs.results()[k].active) continue;
    const double quarter = 0.5 * contact_loss(s, k, 0.5 * s.clock.dt);
    const BodyPair& pair = s.pairs.pairs()[k];
    for (const std::int32_t row : {pair.a, pair.b}) {
      if (row < 0) {
        sums[kMadeInWalls].add(-quarter);
      } else if (at(row) < p.owned) {
        sums[kMade].add(-quarter);
        sums[kHeatTotals].add(-quarter);
      }
    }
  }
  add_over_ranks(s.comm.get(), sums);
  constexpr std::size_t kProgram = kHeatTotals + 1, kMedium = kProgram + 1, kWalls = kMedium + 1;
  ExactSum balance = sums[kHeatTotals];
  const auto subtract = [&](const ExactSum& sum) {
    ExactSum::Words words = sum.words();
    for (std::int64_t& word : words) word = -word;
    ExactSum negative;
    negative.set_words(words);
    balance.add(negative);
  };
  for (const HeatTotal total : {kMade, kFromSources, kArrived}) subtract(sums[total]);
  balance.add(sums[kRemoved]);
  for (std::size_t k = kProgram; k < kWalls + walls; ++k) subtract(sums[k]);
  HeatMeasures all;
  all.stored = sums[kHeatTotals].value();
  all.balance = balance.value();
  for (std::size_t t = 0; t < kHeatTotals; ++t) all.totals[t] = sums[t].value();
  all.from_program = sums[kProgram].value();
  all.from_medium = sums[kMedium].value();
  ExactSum of_walls;
  for (std::size_t w = 0; w < walls; ++w) {
    of_walls.add(sums[kWalls + w]);
    all.from_walls.push_back(sums[kWalls + w].value());
    all.flow_of_walls.push_back(sums[kWalls + walls + w].value());
  }
  all.from_all_walls = of_walls.value();
  all.critical_step = -s.comm.max(-critical_step_);
  all.biot = s.comm.max(biot_);
  return all;
}

void HeatEffect::add_log_columns(const RunState& s, const Energies&, std::vector<Column>& columns) const {
  const HeatMeasures all = measure(s);
  const double biot = all.biot;
  columns.push_back({"heat", "J", exact(all.stored)});
  columns.push_back({"heat_balance", "J", exact(all.balance)});
  for (std::size_t t = 0; t < kHeatTotals; ++t) columns.push_back({fmt::format("heat_{}", kHeatTotalNames[t]), "J", exact(all.totals[t])});
  if (outer_) {
    columns.push_back({"heat_from_program", "J", exact(all.from_program)});
    columns.push_back({"heat_from_medium", "J", exact(all.from_medium)});
  }
  columns.push_back({"heat_critical_step", "s", fmt::format("{:.6g}", all.critical_step)});
  columns.push_back({"biot", "-", fmt::format("{:.6g}", biot)});
  if (biot > kLargestBiot && s.comm.rank() == 0) {
    warn_once("scree-solver",
              fmt::format("contacts conduct more than one temperature a body can stand for: the Biot number of a body is above {:g} "
                          "(biot in log.csv); its temperature is then that of no place in it{}",
                          kLargestBiot, outer_ ? ". The conductance of the medium that a program gives counts as well" : ""));
  }
  for (std::size_t w = 0; w < to_bodies_.size(); ++w) {
    const Wall& wall = s.scene.source().walls[w];
    if (wall.heat.kind == WallHeatKind::adiabatic) continue;
    columns.push_back({fmt::format("wall{}_heat", wall.id), "J", exact(all.from_walls[w])});
    columns.push_back({fmt::format("wall{}_heat_flow", wall.id), "W", exact(all.flow_of_walls[w])});
    if (!wall.heat.temperature.is_constant())
      columns.push_back({fmt::format("wall{}_temperature", wall.id), "K", exact(wall.heat.temperature.at(s.clock.time()))});
    if (wall.heat.kind == WallHeatKind::flux) columns.push_back({fmt::format("wall{}_heat_kept", wall.id), "J", exact(pending_[w])});
  }
}

std::vector<PlanLine> HeatEffect::plan(const RunState& s) const {
  const Scene& scene = s.scene.source();
  std::vector<PlanLine> lines;
  const std::size_t bodies = scene.bodies.size();
  lines.emplace_back("heat", fmt::format("one temperature a body, {} bodies; no contact is computed in lanes{}", bodies,
                                         friction_heat_ ? "; what contacts dissipate heats both sides" : ""));
  if (outer_) {
    const auto sources = static_cast<double>(outer_->source_count()), media = static_cast<double>(outer_->medium_count());
    lines.emplace_back("heat of a program", fmt::format("on this rank sources of {:.0f} bodies, media of {:.0f}", sources, media));
  }
  for (std::size_t table = 0; table < scene.settings.heat->source_tables.size(); ++table) {
    const auto& of = scene.bodies.heat_table;
    const auto bodies_of = std::count(of.begin(), of.end(), static_cast<int>(table));
    lines.emplace_back("heat source",
                       fmt::format("{} given {}", bodies_of == 1 ? "1 body is" : fmt::format("{} bodies are each", bodies_of),
                                   text_of(scene.settings.heat->source_tables[table], Dimension::power)));
  }
  if (s.scene.is_frozen()) lines.emplace_back("frozen", "bodies and contacts stay as they are; conduction sets the step");
  if (gas_) {
    const Heat& heat = *scene.settings.heat;
    lines.emplace_back("heat through gas",
                       fmt::format("{}, in gaps of up to {}", format_quantity(heat.gas_conductivity, Dimension::conductivity),
                                   format_quantity(heat.gas_range, Dimension::length)));
  }
  for (const MaterialPair& pair : scene.pairs) {
    const bool area = scene.settings.gather == Gathering::area;
    const char* how = conductance_.has_real_modulus(at(pair.a), at(pair.b))
                          ? "that of Hertz under the same force, with real_young"
                          : "that of Hertz with the overlap that is simulated; real_young of both would give that of the real materials";
    lines.emplace_back("heat through contacts",
                       fmt::format("'{}' and '{}': radius {}{}", scene.materials[at(pair.a)].name, scene.materials[at(pair.b)].name,
                                   area ? "of the area of the layer between faces; elsewhere " : "", how));
  }
  for (const Wall& wall : scene.walls) {
    if (wall.heat.kind == WallHeatKind::adiabatic) continue;
    const std::string temperature = text_of(wall.heat.temperature, Dimension::temperature);
    lines.emplace_back("heat of a wall", wall.heat.kind == WallHeatKind::isothermal ? fmt::format("'{}' has {}", wall.name, temperature)
                                         : wall.heat.kind == WallHeatKind::flux
                                             ? fmt::format("'{}' gives {}", wall.name, text_of(wall.heat.flux, Dimension::power))
                                             : fmt::format("'{}' exchanges {} with {}", wall.name,
                                                           format_quantity(wall.heat.coefficient, Dimension::heat_transfer), temperature));
  }
  lines.emplace_back("heat, present contacts",
                     flows_.empty()
                         ? std::string("none on this rank")
                         : fmt::format("on this rank {}, with a critical step of {} and a largest Biot number of {:.3g} (one temperature "
                                       "a body stands for up to {:g})",
                                       flows_.size(), format_quantity(critical_step_, Dimension::time), biot_, kLargestBiot));
  return lines;
}

}  // namespace scree
