// What the effect keeps for a restart, and adds to log, frames and plan.
#include <fmt/format.h>

#include "core/base/error.hpp"
#include "core/base/units.hpp"
#include "core/storage/frame_file.hpp"
#include "solver/effects/cell/cell_effect.hpp"

namespace scree {

namespace {

StateArray array_of(const Vec3& v) { return {.reals = {v.x, v.y, v.z}}; }
Vec3 vector_of(const StateArray& array) {
  if (array.reals.size() != 3) throw InputError("cell: {} numbers instead of 3; the file is damaged", array.reals.size());
  return {array.reals[0], array.reals[1], array.reals[2]};
}

/// The stress, positive in compression [Pa].
UpperMatrix stress_of(const RunState& s) { return (1 / s.particles.cell.volume()) * cell_sums(s).symmetric(); }

}  // namespace

std::vector<ArrayFormat> CellEffect::format() {
  return {{"length", "m", 3},
          {"length_remainder", "m", 3},
          {"rate", "1/s", 3},
          {"next_rate", "1/s", 3},
          {"steady_rate", "1/s", 3},
          {"totals", ""},
          {"shear", "m", 3},
          {"shear_remainder", "m", 3},
          {"shear_rate", "1/s", 3},
          {"next_shear_rate", "1/s", 3},
          {"steady_shear_rate", "1/s", 3},
          {"sheared", "", 3},
          {"sheared_remainder", "", 3},
          {"mean_stress", "Pa", 3},
          {"mean_shear_stress", "Pa", 3}};
}

EffectRecord CellEffect::record(const RunState& s) const {
  const Cell& cell = s.particles.cell;
  const UpperMatrix edges = cell.edges();
  return {array_of(edges.diagonal),      array_of(cell.remainder().diagonal), array_of(cell.rate().diagonal),
          array_of(next_rate_.diagonal), array_of(steady_rate_.diagonal),     {.reals = {work_, lost_, power_, losing_, contact_time_}},
          array_of(edges.above),         array_of(cell.remainder().above),    array_of(cell.rate().above),
          array_of(next_rate_.above),    array_of(steady_rate_.above),        array_of(sheared_),
          array_of(sheared_rest_),       array_of(mean_stress_.diagonal),     array_of(mean_stress_.above)};
}

void CellEffect::restore(RunState& s, const EffectRecord& record) {
  const Vec3 length = vector_of(record[0]);
  const std::vector<double>& totals = record[5].reals;
  if (totals.size() != 5) throw InputError("cell/totals: {} numbers instead of 5; the file is damaged", totals.size());
  for (int k = 0; k < 3; ++k) {
    if (!(length[k] > 0) || !std::isfinite(length[k])) throw InputError("cell/length: {:g} m; the file is damaged", length[k]);
  }
  const Vec3 shear = vector_of(record[6]);
  if (!is_finite(shear)) throw InputError("cell/shear: not a finite number; the file is damaged");
  s.particles.cell.begin({length, shear}, {vector_of(record[1]), vector_of(record[7])});
  s.particles.cell.set_rate({vector_of(record[2]), vector_of(record[8])});
  next_rate_ = {vector_of(record[3]), vector_of(record[9])};
  steady_rate_ = {vector_of(record[4]), vector_of(record[10])};
  sheared_ = vector_of(record[11]);
  sheared_rest_ = vector_of(record[12]);
  mean_stress_ = {vector_of(record[13]), vector_of(record[14])};
  work_ = totals[0];
  lost_ = totals[1];
  power_ = totals[2];
  losing_ = totals[3];
  contact_time_ = totals[4];
  is_restored_ = true;
}

/// Half of what the forces of the last step were counted with lies ahead.
void CellEffect::add_energies(const RunState& s, Energies& energies) const {
  energies.cell_work = work_ - 0.5 * s.clock.dt * power_;
  energies.dissipated += lost_ - 0.5 * s.clock.dt * losing_;
}

void CellEffect::add_log_columns(const RunState& s, const Energies& energies, std::vector<Column>& columns) const {
  const UpperMatrix stress = stress_of(s), edges = s.particles.cell.edges(), now = strain(s);
  for (int k = 0; k < 3; ++k) columns.push_back({fmt::format("cell_{}", "xyz"[k]), "m", exact(edges.diagonal[k])});
  for (int k = 0; k < 3; ++k)
    columns.push_back({fmt::format("cell_{}", kUpperNames[static_cast<std::size_t>(k) + 3]), "m", exact(edges.above[k])});
  for (int k = 0; k < 3; ++k) columns.push_back({fmt::format("strain_{}", "xyz"[k]), "-", exact(now.diagonal[k])});
  for (int k = 0; k < 3; ++k)
    columns.push_back({fmt::format("strain_{}", kUpperNames[static_cast<std::size_t>(k) + 3]), "-", exact(now.above[k])});
  for (int k = 0; k < 3; ++k) columns.push_back({fmt::format("stress_{0}{0}", "xyz"[k]), "Pa", exact(stress.diagonal[k])});
  for (int k = 0; k < 3; ++k)
    columns.push_back({fmt::format("stress_{}", kUpperNames[static_cast<std::size_t>(k) + 3]), "Pa", exact(stress.above[k])});
  columns.push_back({"solid_fraction", "-", exact(solid_volume_ / s.particles.cell.volume())});
  columns.push_back({"cell_work", "J", exact(energies.cell_work)});
}

void CellEffect::add_frame(const RunState& s, Frame& frame) const {
  const UpperMatrix stress = stress_of(s);
  if (s.comm.rank() != 0) return;
  const UpperMatrix& edges = s.particles.cell.edges();
  const Vec3& lower = s.particles.cell.periodicity().lower();
  frame.cell.lower = {lower};
  frame.cell.upper = {lower + edges.diagonal};
  frame.cell.rate = {s.particles.cell.rate().diagonal};
  frame.cell.shear = {edges.above};
  frame.cell.shear_rate = {s.particles.cell.rate().above};
  frame.cell.normal_stress = {stress.diagonal};
  frame.cell.shear_stress = {stress.above};
}

std::vector<PlanLine> CellEffect::plan(const RunState& s) const {
  std::vector<PlanLine> lines;
  const auto towards = [&](int k) {
    return fmt::format("moves to {}; time of its damping {}", format_quantity(control_.stress[k], Dimension::pressure),
                       format_quantity(1 / damping(s, k), Dimension::time));
  };
  for (int k = 0; k < 3; ++k) {
    const char axis = "xyz"[k];
    const std::string length = format_quantity(s.particles.cell.edges().diagonal[k], Dimension::length);
    const TimeTable& rate = control_.rate(k);
    if (!s.particles.cell.periodicity().is_periodic(k))
      lines.emplace_back("cell", fmt::format("{} along {}, between planes", length, axis));
    else if (control_.by_stress(k))
      lines.emplace_back("cell", fmt::format("{} along {}, {}", length, axis, towards(k)));
    else if (control_.by_rate(k) && !rate.is_constant())
      lines.emplace_back(
          "cell", fmt::format("{} along {}, shortens at {:.4g} to {:.4g} 1/s by a table", length, axis, rate.least(), rate.largest()));
    else if (control_.by_rate(k))
      lines.emplace_back("cell", fmt::format("{} along {}, {} at {:.4g} 1/s", length, axis, rate.largest() > 0 ? "shortens" : "lengthens",
                                             std::abs(rate.largest())));
    else
      lines.emplace_back("cell", fmt::format("{} along {}, which stays", length, axis));
  }
  for (int k = 3; k < 6; ++k) {
    const char* name = kUpperNames[static_cast<std::size_t>(k)];
    const TimeTable& rate = control_.rate(k);
    if (control_.by_stress(k))
      lines.emplace_back("cell", fmt::format("sheared {}, {}", name, towards(k)));
    else if (control_.by_rate(k) && !rate.is_constant())
      lines.emplace_back("cell", fmt::format("sheared {} at {:.4g} to {:.4g} 1/s by a table", name, rate.least(), rate.largest()));
    else if (control_.by_rate(k))
      lines.emplace_back("cell", fmt::format("sheared {} at {:.4g} 1/s", name, rate.largest()));
  }
  return lines;
}

}  // namespace scree
