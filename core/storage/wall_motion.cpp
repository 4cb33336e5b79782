#include "core/storage/wall_motion.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/storage/keys.hpp"

namespace scree {

namespace {

constexpr InFile kAlways{nullptr, true};

}  // namespace

void Rotate::keys(KeyVisitor& k) {
  k.direction({"axis", kRequired, "", kAlways}, axis);
  k.vector({"centre", "", "a point on the axis", kAlways}, centre, Dimension::length);
  k.number({"rate", kRequired, "", kAlways}, rate, Dimension::angular_velocity, Range::any);
}

MotionState Rotate::state(double elapsed, const Pose& pose) const {
  const Quat turn = quaternion_of(axis, rate * elapsed);
  MotionState s{{centre + rotate(turn, pose.position - centre), turn * pose.orientation}, {}, rate * axis};
  s.velocity = cross(s.angular_velocity, s.pose.position - centre);
  return s;
}

double Rotate::fastest(std::span<const Vec3> points) const {
  double lever = 0;
  for (const Vec3& p : points) lever = std::max(lever, length(cross(axis, p - centre)));
  return std::abs(rate) * lever;
}

std::string Rotate::text() const { return fmt::format("rotates at {:.4g} rad/s", rate); }

void Translate::keys(KeyVisitor& k) { k.velocity({"velocity", kRequired, "", kAlways}, rate, axis); }

MotionState Translate::state(double elapsed, const Pose& pose) const {
  return {{pose.position + (rate * elapsed) * axis, pose.orientation}, rate * axis, {}};
}

double Translate::fastest(std::span<const Vec3>) const { return std::abs(rate); }

std::vector<Vec3> Translate::displacements(double first, double last) const { return {(rate * first) * axis, (rate * last) * axis}; }

std::string Translate::text() const { return fmt::format("translates at {:.4g} m/s", rate); }

void Oscillate::keys(KeyVisitor& k) {
  k.direction({"direction", kRequired, "", {"axis", true}}, axis);
  k.number({"amplitude", kRequired, "", kAlways}, amplitude, Dimension::length, Range::not_negative);
  k.number({"frequency", kRequired, "", kAlways}, frequency, Dimension::frequency, Range::not_negative);
  k.number({"phase", "", "", kAlways}, phase, Dimension::angle, Range::any);
}

MotionState Oscillate::state(double elapsed, const Pose& pose) const {
  const double omega = 2 * std::numbers::pi * frequency;
  return {{pose.position + amplitude * (std::sin(omega * elapsed + phase) - std::sin(phase)) * axis, pose.orientation},
          amplitude * omega * std::cos(omega * elapsed + phase) * axis,
          {}};
}

double Oscillate::fastest(std::span<const Vec3>) const { return 2 * std::numbers::pi * std::abs(frequency * amplitude); }

std::vector<Vec3> Oscillate::displacements(double, double last) const {
  if (!(last > 0) || frequency == 0) return {};
  return {amplitude * (-1.0 - std::sin(phase)) * axis, amplitude * (1.0 - std::sin(phase)) * axis};
}

std::string Oscillate::text() const { return fmt::format("oscillates by {:.4g} m at {:.4g} Hz", amplitude, frequency); }

void FollowTable::keys(KeyVisitor& k) {
  k.numbers({"time", kRequired, "from `start`", {"table_time", true}}, time, Dimension::time);
  k.vectors({"position", kRequired, "displacement", {"table_position", true}}, position, Dimension::length);
}

std::optional<KeyFault> FollowTable::fault() const {
  if (time.size() != position.size() || time.empty()) {
    return KeyFault{"time", fmt::format("has {} rows and position {}; expected as many, and at least one", time.size(), position.size())};
  }
  for (std::size_t i = 1; i < time.size(); ++i) {
    if (!(time[i - 1] < time[i])) return KeyFault{"time", "must ascend"};
  }
  return {};
}

MotionState FollowTable::state(double elapsed, const Pose& pose) const {
  MotionState s{pose, {}, {}};
  if (time.empty()) return s;
  const auto next = std::upper_bound(time.begin(), time.end(), elapsed);
  const auto i = static_cast<std::size_t>(next - time.begin());
  if (i == 0) {
    s.pose.position += position.front();
  } else if (i == time.size()) {
    s.pose.position += position.back();
  } else {
    const double width = time[i] - time[i - 1];
    s.velocity = (1 / width) * (position[i] - position[i - 1]);
    s.pose.position += position[i - 1] + (elapsed - time[i - 1]) * s.velocity;
  }
  return s;
}

double FollowTable::fastest(std::span<const Vec3>) const {
  double fastest = 0;
  for (std::size_t i = 1; i < time.size(); ++i) {
    fastest = std::max(fastest, length(position[i] - position[i - 1]) / (time[i] - time[i - 1]));
  }
  return fastest;
}

double FollowTable::last_change() const {
  std::size_t last = time.size();
  while (last > 1 && position[last - 1] == position[last - 2]) --last;
  return last < 2 ? 0 : time[last - 1];
}

std::vector<Vec3> FollowTable::displacements(double, double last) const {
  std::vector<Vec3> all;
  for (std::size_t i = 0; i < time.size(); ++i) {
    all.push_back(position[i]);
    if (time[i] >= last) break;
  }
  return all;
}

double WallMotion::elapsed(double time) const { return std::clamp(time, start, std::max(start, stop)) - start; }

bool WallMotion::moves() const {
  return stop > start && std::visit([](const auto& m) { return m.last_change() > 0; }, kind);
}

double WallMotion::end() const {
  const double end = std::min(stop, start + std::visit([](const auto& m) { return m.last_change(); }, kind));
  return moves() && end > start ? end : 0;
}

const char* WallMotion::word() const {
  return std::visit([](const auto& m) { return std::decay_t<decltype(m)>::kWord; }, kind);
}

MotionState WallMotion::state(double time, const Pose& pose) const {
  MotionState s = std::visit([&](const auto& m) { return m.state(elapsed(time), pose); }, kind);
  if (!(time >= start && time < stop)) s.velocity = s.angular_velocity = {};
  return s;
}

double WallMotion::fastest(std::span<const Vec3> points) const {
  return std::visit([&](const auto& m) { return m.fastest(points); }, kind);
}

std::vector<Vec3> WallMotion::displacements(double duration) const {
  return std::visit([&](const auto& m) { return m.displacements(elapsed(0), elapsed(duration)); }, kind);
}

std::optional<TurnAxis> WallMotion::turn_axis() const {
  return std::visit(
      [](const auto& m) -> std::optional<TurnAxis> {
        if constexpr (requires { m.turn_axis(); }) return m.turn_axis();
        return {};
      },
      kind);
}

void WallMotion::move_origin(const Vec3& origin) {
  std::visit(
      [&](auto& m) {
        if constexpr (requires { m.move_origin(origin); }) m.move_origin(origin);
      },
      kind);
}

std::string WallMotion::text() const {
  return std::visit([](const auto& m) { return m.text(); }, kind);
}

std::optional<KeyFault> WallMotion::fault() const {
  return std::visit(
      [](const auto& m) -> std::optional<KeyFault> {
        if constexpr (requires { m.fault(); }) return m.fault();
        return {};
      },
      kind);
}

}  // namespace scree
