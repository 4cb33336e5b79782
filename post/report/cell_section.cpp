#include "post/report/cell_section.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "core/base/units.hpp"
#include "core/chart/svg_chart.hpp"
#include "post/report/html.hpp"

namespace scree {

std::string cell_section(const Run& run) {
  const LogTable& log = run.log;
  if (log.rows() < 2 || !log.has("stress_xx")) return "<p class=\"missing\">log.csv has no rows of the cell yet.</p>\n";
  std::array<const std::vector<double>*, 6> strain{}, stress{};
  const bool may_shear = log.has("strain_xy");  // logs of older versions have three strains
  for (std::size_t k = 0; k < 6; ++k) {
    if (k < 3 || may_shear) strain[k] = &log.column(fmt::format("strain_{}", kUpperNames[k]));
    stress[k] = &log.column(fmt::format("stress_{}{}", kUpperNames[k], k < 3 ? kUpperNames[k] : ""));
  }
  const bool shears =
      may_shear && std::any_of(strain.begin() + 3, strain.end(), [](const std::vector<double>* s) { return s->back() != 0; });
  const std::size_t shown = shears ? 6 : 3;
  const std::vector<double>& t = log.column("time");
  std::vector<double> volume(log.rows()), p(log.rows()), q(log.rows());
  for (std::size_t i = 0; i < log.rows(); ++i) {
    const double x = (*stress[0])[i], y = (*stress[1])[i], z = (*stress[2])[i];
    volume[i] = (*strain[0])[i] + (*strain[1])[i] + (*strain[2])[i];
    p[i] = (x + y + z) / 3;
    double squares = 0.5 * ((x - y) * (x - y) + (y - z) * (y - z) + (z - x) * (z - x));
    for (std::size_t k = 3; k < 6; ++k) squares += 3 * (*stress[k])[i] * (*stress[k])[i];
    q[i] = std::sqrt(squares);
  }
  // against the strain of the axis or shear that went furthest
  std::size_t axis = 0;
  for (std::size_t k = 1; k < shown; ++k) {
    if (std::abs(strain[k]->back()) > std::abs(strain[axis]->back())) axis = k;
  }
  const std::string along = fmt::format("{} {}", axis < 3 ? "strain along" : "shear strain", kUpperNames[axis]);
  LineChart stresses{"Stress", along, "", shears ? "stress" : "normal stress", "Pa", false, false, {}, {}},
      strains{"Strain", "time", "s", "strain", "", false, false, {}, {}};
  for (std::size_t k = 0; k < shown; ++k) {
    const std::string name = fmt::format("{} {}", k < 3 ? "along" : "shear", kUpperNames[k]);
    stresses.lines.push_back({name, *strain[axis], *stress[k]});
    strains.lines.push_back({name, t, *strain[k]});
  }
  strains.lines.push_back({"of the volume", t, volume});
  const auto length = [&](const char* name) { return format_quantity(log.column(name).back(), Dimension::length); };
  FactRows rows = {{"Lengths at the end", length("cell_x") + ", " + length("cell_y") + ", " + length("cell_z")}};
  const auto is_sheared = [&](const char* name) { return log.column(name).back() != 0; };
  if (may_shear && (is_sheared("cell_yz") || is_sheared("cell_xz") || is_sheared("cell_xy")))
    rows.push_back({"Shears at the end", length("cell_yz") + ", " + length("cell_xz") + ", " + length("cell_xy") + " (yz, xz, xy)"});
  rows.push_back({"Solid fraction at the end", fmt::format("{:.4f}", log.column("solid_fraction").back())});
  rows.push_back({"Mean stress at the end", format_quantity(p.back(), Dimension::pressure)});
  rows.push_back({"Work of the cell on the bodies", format_quantity(log.column("cell_work").back(), Dimension::energy)});
  return table_of(rows) + figure(stresses) + figure(strains) +
         figure(LineChart{"Stress path", "mean stress p", "Pa", "deviator q", "Pa", false, true, {{"path", p, q}}, {}}) +
         figure(LineChart{
             "Solid fraction", "time", "s", "solid fraction", "", false, false, {{"solid fraction", t, log.column("solid_fraction")}}, {}});
}

}  // namespace scree
