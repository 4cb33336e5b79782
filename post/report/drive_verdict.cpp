#include "post/report/drive_verdict.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>

#include "core/base/units.hpp"

namespace scree {

namespace {

double number_in(const nlohmann::json& object, const char* key) {
  return object.contains(key) && object[key].is_number() ? object[key].get<double>() : 0;
}

/// Mean over the last tenth of the log of the force of the contacts along the way of a wall [N] or [N m], while it may move.
double mean_drive_force(const Run& run, const Wall& wall, const Guide& guide) {
  const LogTable& log = run.log;
  const std::string name = fmt::format("wall{}_", wall.id);
  if (log.rows() == 0 || !log.has(name + "force_x")) return std::numeric_limits<double>::quiet_NaN();
  const std::vector<double>& time = log.column("time");
  const auto vector = [&](const std::string& of, std::size_t row) {
    return Vec3{log.column(name + of + "_x")[row], log.column(name + of + "_y")[row], log.column(name + of + "_z")[row]};
  };
  const double last = std::min(time.back(), wall.motion.stop);
  double sum = 0, rows = 0;
  for (std::size_t i = 0; i < log.rows(); ++i) {
    if (time[i] < wall.motion.start || time[i] > last || time[i] < last - 0.1 * (last - std::max(wall.motion.start, time.front())))
      continue;
    sum += guide.component(vector("force", i), vector("torque", i));
    rows += 1;
  }
  return rows > 0 ? sum / rows : std::numeric_limits<double>::quiet_NaN();
}

/// " (10 kPa on 100 cm^2)" of a servo that presses with a stress.
std::string stress_of(const Wall& wall) {
  const auto* servo = std::get_if<Servo>(&wall.motion.kind);
  if (servo == nullptr || servo->stress == 0) return "";
  return fmt::format(" ({} on {})", format_quantity(servo->stress, Dimension::pressure), format_quantity(servo->area, Dimension::area));
}

/// A sentence on what a wall did that answers to force, and how it is judged. The record is an entry of `drives` in run.json.
std::pair<std::string, Judgement> drive_sentence(const Run& run, const Wall& wall, const Drive& drive, const nlohmann::json& record) {
  const bool turns = drive.guide.turns;
  const auto force = [&](double x) { return format_quantity(x, turns ? Dimension::torque : Dimension::force); };
  const double way = number_in(record, "way"), rate = number_in(record, "rate"), now = number_in(record, "force");
  const std::string place = turns ? fmt::format("{:.4g} deg", way * 180 / std::numbers::pi) : format_quantity(way, Dimension::length);
  const std::string speed = format_quantity(rate, turns ? Dimension::angular_velocity : Dimension::velocity);
  std::string text = fmt::format("'{}' ({}) ends {} from where it was placed", wall.name, wall.motion.word(), place);
  if (record.contains("at_end") && record["at_end"].is_string())
    text += fmt::format(", at the {} end of its way", record["at_end"].get<std::string>());
  if (!drive.is_servo()) {
    text += fmt::format(", moving at {}; ", speed);
    text += now == 0 ? "it touches nothing" : fmt::format("its contacts push it with {} along its way", force(now));
    return {text + ".", Judgement::information};
  }
  const double mean = -mean_drive_force(run, wall, drive.guide);
  text += now == 0 ? "; it touches nothing"
                   : fmt::format("; it presses with {} of {} requested", force(-now), force(drive.push) + stress_of(wall));
  if (std::isfinite(mean)) text += fmt::format(" ({} on average over the last tenth of the run)", force(mean));
  const bool is_idle = record.contains("note") && record["note"].is_string();
  if (now == 0)
    text += ". Check that something is in its way and that it has the time to get there";
  else if (is_idle)
    text += ". A longer stroke or swing lets it press as asked";
  const bool is_held = !(std::abs(mean - drive.push) > kServoForce * std::abs(drive.push));
  if (!is_held && !is_idle) text += ". What it presses still gives way: a longer run, or a lower max_speed or max_rate, helps";
  return {text + ".", is_idle || !is_held ? Judgement::doubtful : Judgement::good};
}

}  // namespace

Verdict judge_drives(const Run& run) {
  Verdict v{"Walls under force", Judgement::information, "known at the end", ""};
  if (!run.outcome->contains("drives")) return v;
  std::size_t servos = 0, held = 0;
  for (const Wall& wall : run.scene.walls) {
    const std::optional<Drive> drive = wall.motion.drive();
    if (!drive) continue;
    for (const nlohmann::json& record : (*run.outcome)["drives"]) {
      if (record.value("wall", std::int64_t{-1}) != wall.id) continue;
      const auto [text, judgement] = drive_sentence(run, wall, *drive, record);
      v.evidence += (v.evidence.empty() ? "" : " ") + text;
      if (!drive->is_servo()) continue;
      ++servos;
      if (judgement == Judgement::good) ++held;
    }
  }
  v.answer =
      servos == 0 ? "no servo" : fmt::format("{} of {} {} the force requested", held, servos, servos == 1 ? "servo holds" : "servos hold");
  if (servos > 0) v.judgement = held == servos ? Judgement::good : Judgement::doubtful;
  return v;
}

}  // namespace scree
