#include "solver/run/idle_servos.hpp"

#include <fmt/format.h>

#include <cmath>

#include "core/base/units.hpp"

namespace scree {

std::vector<std::string> idle_servos(const RunState& s) {
  std::vector<std::string> lines;
  for (std::size_t w = 0; w < s.totals.drives.size(); ++w) {
    const Drive* drive = s.scene.drive(w);
    if (drive == nullptr || drive->inertia > 0) continue;
    const std::string& name = s.scene.source().walls[w].name;
    const DriveState& at = s.totals.drives[w];
    const auto value = [&](double x, Dimension along, Dimension about) { return format_quantity(x, drive->guide.turns ? about : along); };
    const std::string way = value(at.way, Dimension::length, Dimension::angle);
    constexpr double kShort = 0.01;  // of the force asked
    if (at.force == 0) {
      lines.push_back(
          fmt::format("wall '{}': its servo touches nothing at the end of the run, {} from where it was placed; is anything in "
                      "its way, and does it have the time to get there?",
                      name, way));
    } else if ((at.way == drive->lowest || at.way == drive->highest) && std::abs(drive->push + at.force) > kShort * std::abs(drive->push)) {
      lines.push_back(fmt::format("wall '{}': its servo is at the end of its way, {} from where it was placed, and presses with {} of {}",
                                  name, way, value(-at.force, Dimension::force, Dimension::torque),
                                  value(drive->push, Dimension::force, Dimension::torque)));
    }
  }
  return lines;
}

}  // namespace scree
