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

/// Normal stresses, and the mean of both of each pair of shear stresses: yz, xz, xy [Pa].
struct SixStresses {
  Vec3 normal, shear;
};
SixStresses stresses_of(const RunState& s) {
  const CellSums sums = cell_sums(s);
  const auto at = [&](std::size_t i, int j) { return sums.contact[i][j] + sums.kinetic[i][j]; };
  const double by = 1 / s.particles.cell.volume();
  return {by * Vec3{at(0, 0), at(1, 1), at(2, 2)}, 0.5 * by * Vec3{at(1, 2) + at(2, 1), at(0, 2) + at(2, 0), at(0, 1) + at(1, 0)}};
}

}  // namespace

std::vector<ArrayFormat> CellEffect::format() {
  return {{"length", "m", 3},      {"length_remainder", "m", 3}, {"rate", "1/s", 3},
          {"next_rate", "1/s", 3}, {"steady_rate", "1/s", 3},    {"totals", ""}};
}

EffectRecord CellEffect::record(const RunState& s) const {
  const Cell& cell = s.particles.cell;
  return {array_of(cell.periodicity().period()),
          array_of(cell.remainder()),
          array_of(cell.rate()),
          array_of(next_rate_),
          array_of(steady_rate_),
          {.reals = {work_, lost_, power_, losing_, contact_time_}}};
}

void CellEffect::restore(RunState& s, const EffectRecord& record) {
  const Vec3 length = vector_of(record[0]);
  const std::vector<double>& totals = record[5].reals;
  if (totals.size() != 5) throw InputError("cell/totals: {} numbers instead of 5; the file is damaged", totals.size());
  for (int k = 0; k < 3; ++k) {
    if (!(length[k] > 0) || !std::isfinite(length[k])) throw InputError("cell/length: {:g} m; the file is damaged", length[k]);
  }
  s.particles.cell.begin(length, vector_of(record[1]));
  s.particles.cell.set_rate(vector_of(record[2]));
  next_rate_ = vector_of(record[3]);
  steady_rate_ = vector_of(record[4]);
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
  const SixStresses stress = stresses_of(s);
  const Vec3 &h = s.particles.cell.periodicity().period(), now = strain(s);
  for (int k = 0; k < 3; ++k) columns.push_back({fmt::format("cell_{}", "xyz"[k]), "m", exact(h[k])});
  for (int k = 0; k < 3; ++k) columns.push_back({fmt::format("strain_{}", "xyz"[k]), "-", exact(now[k])});
  for (int k = 0; k < 3; ++k) columns.push_back({fmt::format("stress_{0}{0}", "xyz"[k]), "Pa", exact(stress.normal[k])});
  const char* const shears[3] = {"yz", "xz", "xy"};
  for (int k = 0; k < 3; ++k) columns.push_back({fmt::format("stress_{}", shears[k]), "Pa", exact(stress.shear[k])});
  columns.push_back({"solid_fraction", "-", exact(solid_volume_ / s.particles.cell.volume())});
  columns.push_back({"cell_work", "J", exact(energies.cell_work)});
}

void CellEffect::add_frame(const RunState& s, Frame& frame) const {
  const SixStresses stress = stresses_of(s);
  if (s.comm.rank() != 0) return;
  const Periodicity& box = s.particles.cell.periodicity();
  frame.cell.lower = {box.lower()};
  frame.cell.upper = {box.lower() + box.period()};
  frame.cell.rate = {s.particles.cell.rate()};
  frame.cell.normal_stress = {stress.normal};
  frame.cell.shear_stress = {stress.shear};
}

std::vector<PlanLine> CellEffect::plan(const RunState& s) const {
  std::vector<PlanLine> lines;
  for (int k = 0; k < 3; ++k) {
    const char axis = "xyz"[k];
    const std::string length = format_quantity(s.particles.cell.periodicity().period()[k], Dimension::length);
    if (control_.by_stress(k))
      lines.emplace_back("cell", fmt::format("{} along {}, moves to {}; time of its damping {}", length, axis,
                                             format_quantity(control_.stress[k], Dimension::pressure),
                                             format_quantity(1 / damping(s, k), Dimension::time)));
    else if (control_.strain_rate[k] != 0)
      lines.emplace_back("cell", fmt::format("{} along {}, {} at {:.4g} 1/s", length, axis,
                                             control_.strain_rate[k] > 0 ? "shortens" : "lengthens", std::abs(control_.strain_rate[k])));
    else
      lines.emplace_back("cell", fmt::format("{} along {}, which stays", length, axis));
  }
  return lines;
}

}  // namespace scree
