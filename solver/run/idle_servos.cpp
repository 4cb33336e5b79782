#include "solver/run/idle_servos.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <cmath>

#include "core/base/units.hpp"

namespace scree {

namespace {

/// Why the servo `w` does not press as asked; "" of one that does, and of what is no servo.
std::string fault_of_servo(const RunState& s, std::size_t w) {
  const Drive* drive = s.scene.drive(w);
  if (drive == nullptr || !drive->is_servo()) return "";
  const std::string& name = s.scene.source().walls[w].name;
  const DriveState& at = s.drives[w];
  const auto value = [&](double x, Dimension along, Dimension about) { return format_quantity(x, drive->guide.turns ? about : along); };
  const std::string way = value(at.way, Dimension::length, Dimension::angle);
  constexpr double kShort = 0.01;  // of the force asked
  if (at.force == 0) {
    return fmt::format(
        "wall '{}': its servo touches nothing at the end of the run, {} from where it was placed; is anything in "
        "its way, and does it have the time to get there?",
        name, way);
  }
  if ((at.way == drive->lowest || at.way == drive->highest) && std::abs(drive->push + at.force) > kShort * std::abs(drive->push)) {
    return fmt::format("wall '{}': its servo is at the end of its way, {} from where it was placed, and presses with {} of {}", name, way,
                       value(-at.force, Dimension::force, Dimension::torque), value(drive->push, Dimension::force, Dimension::torque));
  }
  return "";
}

}  // namespace

std::vector<std::string> idle_servos(const RunState& s) {
  std::vector<std::string> lines;
  for (std::size_t w = 0; w < s.drives.size(); ++w) {
    if (std::string line = fault_of_servo(s, w); !line.empty()) lines.push_back(std::move(line));
  }
  return lines;
}

nlohmann::json drives_json(const RunState& s) {
  nlohmann::json all = nlohmann::json::array();
  for (std::size_t w = 0; w < s.drives.size(); ++w) {
    const Drive* drive = s.scene.drive(w);
    if (drive == nullptr) continue;
    const Wall& wall = s.scene.source().walls[w];
    const DriveState& at = s.drives[w];
    nlohmann::json j{{"wall", wall.id}, {"name", wall.name}, {"kind", wall.motion.word()}, {"way", at.way},
                     {"rate", at.rate}, {"force", at.force}, {"at_end", nullptr},          {"note", nullptr}};
    if (drive->is_servo()) j["asked"] = drive->push;
    if (at.way == drive->lowest || at.way == drive->highest) j["at_end"] = at.way == drive->lowest ? "lowest" : "highest";
    if (const std::string note = fault_of_servo(s, w); !note.empty()) j["note"] = note;
    all.push_back(std::move(j));
  }
  return all;
}

}  // namespace scree
