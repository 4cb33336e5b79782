#include "core/storage/wall_motion.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/storage/keys.hpp"

namespace scree {

namespace {

double largest_lever(std::span<const Vec3> points, const Vec3& axis, const Vec3& centre) {
  double lever = 0;
  for (const Vec3& p : points) lever = std::max(lever, length(cross(axis, p - centre)));
  return lever;
}

}  // namespace

void Rotate::keys(KeyVisitor& k) {
  k.direction({"axis", kRequired, "", kAlways}, axis);
  k.vector({"centre", "", "a point on the axis", kAlways}, centre, Dimension::length);
  k.number({"rate", kRequired, "", kAlways}, rate, Dimension::angular_velocity, Range::any);
}

MotionState Rotate::state(double elapsed, const Pose& pose) const { return Guide{true, axis, centre}.state(rate * elapsed, rate, pose); }

double Rotate::fastest(std::span<const Vec3> points) const { return std::abs(rate) * largest_lever(points, axis, centre); }

std::string Rotate::text() const { return fmt::format("rotates at {:.4g} rad/s", rate); }

void Translate::keys(KeyVisitor& k) { k.velocity({"velocity", kRequired, "", kAlways}, rate, axis); }

MotionState Translate::state(double elapsed, const Pose& pose) const { return Guide{false, axis, {}}.state(rate * elapsed, rate, pose); }

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

MotionState Guide::state(double way, double rate, const Pose& placed) const {
  if (!turns) return {{placed.position + way * axis, placed.orientation}, rate * axis, {}};
  const Quat turn = quaternion_of(axis, way);
  MotionState s{{centre + rotate(turn, placed.position - centre), turn * placed.orientation}, {}, rate * axis};
  s.velocity = cross(s.angular_velocity, s.pose.position - centre);
  return s;
}

double Drive::weight(const Vec3& gravity, double way) const {
  if (!guide.turns) return mass * dot(gravity, guide.axis);
  const Vec3 arm = rotate(quaternion_of(guide.axis, way), mass_centre - guide.centre);
  return mass * dot(cross(arm, gravity), guide.axis);
}

namespace {

constexpr double kShortest = 1e-100;  // of a vector whose length can be taken

bool is_given(const Vec3& v) { return length(v) > kShortest; }

Guide guide_of(const Vec3& along, const Vec3& about, const Vec3& centre) {
  return is_given(along) ? Guide{false, normalised(along), {}} : Guide{true, normalised(about), centre};
}

void set_ends(const std::vector<double>& ends, Drive& drive) {
  if (ends.size() != 2) return;
  drive.lowest = ends[0];
  drive.highest = ends[1];
}

/// in   along, about   keys of which one must be given
std::optional<KeyFault> fault_of_guide(const char* along, const Vec3& direction, const char* about, const Vec3& axis) {
  if (is_given(direction) != is_given(axis)) return {};
  return KeyFault{along, is_given(axis) ? fmt::format("is there beside `{}`; expected one of the two", about)
                                        : fmt::format("is missing, as is `{}`, or has no length; expected one of the two", about)};
}

/// in   key, other   for the way that the wall goes, and for the one that it does not
std::optional<KeyFault> fault_of_ends(const char* key, const std::vector<double>& ends, const char* other,
                                      const std::vector<double>& others) {
  if (!others.empty()) return KeyFault{other, fmt::format("is there, but the wall goes another way; expected `{}`", key)};
  if (ends.empty() || (ends.size() == 2 && ends[0] <= 0 && 0 <= ends[1] && ends[0] < ends[1])) return {};
  return KeyFault{key, "expected [lowest, highest] from where the wall is placed, such as [0, highest]"};
}

/// Of a motion along a direction, without an axis, none.   in   axis   of any length
std::optional<TurnAxis> turn_axis_of(const Vec3& axis, const Vec3& centre) {
  if (!is_given(axis)) return {};
  return TurnAxis{centre, normalised(axis)};
}

/// No point of a wall is faster that goes at most at the rate of its drive [m/s].
double fastest_of(const Drive& drive, std::span<const Vec3> points) {
  return drive.guide.turns ? drive.most_rate * largest_lever(points, drive.guide.axis, drive.guide.centre) : drive.most_rate;
}

/// Where a wall can go along a direction that is not turned; without ends, anywhere.
std::vector<Vec3> reach_of(const Drive& drive, double farthest) {
  if (drive.guide.turns) return {};
  const double low = std::max(drive.lowest, -farthest), high = std::min(drive.highest, farthest);
  return {low * drive.guide.axis, high * drive.guide.axis};
}

constexpr double kAnywhere = 1e30;  // [m]: beyond every domain, and finite

}  // namespace

void Servo::keys(KeyVisitor& k) {
  k.vector({"direction", "or `axis`", "in which it presses"}, direction, Dimension::none);
  k.vector({"axis", "or `direction`", "about which it turns"}, axis, Dimension::none);
  k.vector({"centre", "", "a point on the axis"}, centre, Dimension::length);
  k.number({"force", "or `stress`", "with `direction`"}, force, Dimension::force, Range::not_negative);
  k.number({"stress", "or `force`", "with `direction` and `area`"}, stress, Dimension::pressure, Range::not_negative);
  k.number({"area", "with `stress`", "that the stress acts on"}, area, Dimension::area, Range::not_negative);
  k.number({"torque", "with `axis`", ""}, torque, Dimension::torque, Range::not_negative);
  k.number({"max_speed", "with `direction`", ""}, max_speed, Dimension::velocity, Range::not_negative);
  k.number({"max_rate", "with `axis`", ""}, max_rate, Dimension::angular_velocity, Range::not_negative);
  k.number({"share", "", "of the force error that is corrected within the duration of a contact"}, share, Dimension::none,
           Range::unit_interval);
  k.numbers({"stroke", "none", "`[lowest, highest]`: limits of its displacement, with `direction`"}, stroke, Dimension::length);
  k.numbers({"swing", "none", "`[lowest, highest]`: limits of its rotation, with `axis`"}, swing, Dimension::angle);
}

Drive Servo::drive() const {
  Drive d;
  d.guide = guide_of(direction, axis, centre);
  d.push = d.guide.turns ? torque : force != 0 ? force : stress * area;
  d.most_rate = d.guide.turns ? max_rate : max_speed;
  d.share = share;
  set_ends(d.guide.turns ? swing : stroke, d);
  return d;
}

std::optional<KeyFault> Servo::fault() const {
  if (const auto fault = fault_of_guide("direction", direction, "axis", axis)) return fault;
  const bool turns = is_given(axis);
  if (turns) {
    if (force != 0 || stress != 0) return KeyFault{force != 0 ? "force" : "stress", "is there with `axis`; expected `torque`"};
    if (torque == 0) return KeyFault{"torque", "is 0 or missing; expected what it presses with, such as \"2 N m\""};
    if (max_speed > 0) return KeyFault{"max_speed", "is there with `axis`; expected `max_rate`"};
    if (area > 0) return KeyFault{"area", "is there with `axis`; expected `torque`"};
    if (!(max_rate > 0)) return KeyFault{"max_rate", "is 0 or missing; expected how fast it may turn, such as \"5 rpm\""};
  } else {
    if (torque != 0) return KeyFault{"torque", "is there with `direction`; expected `force` or `stress`"};
    if (max_rate > 0) return KeyFault{"max_rate", "is there with `direction`; expected `max_speed`"};
    if ((force != 0) == (stress != 0))
      return KeyFault{"force", force != 0 ? "is there beside `stress`; expected one of the two"
                                          : "is 0 or missing, as is `stress`; expected one of the two"};
    if (stress != 0 && !(area > 0))
      return KeyFault{"area", "is 0 or missing; expected the area that the stress acts on, such as \"0.01 m^2\""};
    if (stress == 0 && area > 0) return KeyFault{"area", "is there with `force`; expected `stress`"};
    if (!(max_speed > 0)) return KeyFault{"max_speed", "is 0 or missing; expected how fast it may move, such as \"0.1 m/s\""};
  }
  if (!(share > 0)) return KeyFault{"share", "must be > 0"};
  return turns ? fault_of_ends("swing", swing, "stroke", stroke) : fault_of_ends("stroke", stroke, "swing", swing);
}

double Servo::fastest(std::span<const Vec3> points) const { return fastest_of(drive(), points); }

std::vector<Vec3> Servo::displacements(double first, double last) const { return reach_of(drive(), max_speed * (last - first)); }

std::optional<TurnAxis> Servo::turn_axis() const { return turn_axis_of(axis, centre); }

std::string Servo::text() const {
  const Drive d = drive();
  return d.guide.turns ? fmt::format("presses with {:.4g} N m, at most at {:.4g} rad/s", d.push, max_rate)
                       : fmt::format("presses with {:.4g} N, at most at {:.4g} m/s", d.push, max_speed);
}

void OuterMotion::keys(KeyVisitor& k) {
  k.vector({"direction", "or `axis`", "along which it moves"}, direction, Dimension::none);
  k.vector({"axis", "or `direction`", "about which it turns"}, axis, Dimension::none);
  k.vector({"centre", "", "a point on the axis"}, centre, Dimension::length);
  k.number({"max_speed", "with `direction`", "above which the program's rate is refused"}, max_speed, Dimension::velocity,
           Range::not_negative);
  k.number({"max_rate", "with `axis`", "the same"}, max_rate, Dimension::angular_velocity, Range::not_negative);
  k.numbers({"stroke", "none", "`[lowest, highest]`: limits of its displacement, with `direction`"}, stroke, Dimension::length);
  k.numbers({"swing", "none", "`[lowest, highest]`: limits of its rotation, with `axis`"}, swing, Dimension::angle);
}

Drive OuterMotion::drive() const {
  Drive d;
  d.guide = guide_of(direction, axis, centre);
  d.most_rate = d.guide.turns ? max_rate : max_speed;
  d.is_outer = true;
  set_ends(d.guide.turns ? swing : stroke, d);
  return d;
}

std::optional<KeyFault> OuterMotion::fault() const {
  if (const auto fault = fault_of_guide("direction", direction, "axis", axis)) return fault;
  const bool turns = is_given(axis);
  if (turns) {
    if (max_speed > 0) return KeyFault{"max_speed", "is there with `axis`; expected `max_rate`"};
    if (!(max_rate > 0)) return KeyFault{"max_rate", "is 0 or missing; expected how fast it may turn, such as \"5 rpm\""};
  } else {
    if (max_rate > 0) return KeyFault{"max_rate", "is there with `direction`; expected `max_speed`"};
    if (!(max_speed > 0)) return KeyFault{"max_speed", "is 0 or missing; expected how fast it may move, such as \"0.1 m/s\""};
  }
  return turns ? fault_of_ends("swing", swing, "stroke", stroke) : fault_of_ends("stroke", stroke, "swing", swing);
}

double OuterMotion::fastest(std::span<const Vec3> points) const { return fastest_of(drive(), points); }

std::vector<Vec3> OuterMotion::displacements(double first, double last) const { return reach_of(drive(), max_speed * (last - first)); }

std::optional<TurnAxis> OuterMotion::turn_axis() const { return turn_axis_of(axis, centre); }

std::string OuterMotion::text() const {
  return drive().guide.turns ? fmt::format("moves as a program says, at most at {:.4g} rad/s", max_rate)
                             : fmt::format("moves as a program says, at most at {:.4g} m/s", max_speed);
}

void Free::keys(KeyVisitor& k) {
  k.vector({"guide", "or `hinge`", "along which it moves"}, guide, Dimension::none);
  k.vector({"hinge", "or `guide`", "about which it turns"}, hinge, Dimension::none);
  k.vector({"centre", "", "a point on the hinge"}, centre, Dimension::length);
  k.number({"mass", "with `guide`", "of the whole part; with `hinge` its weight at `mass_centre`, 0 for one that is balanced"}, mass,
           Dimension::mass, Range::not_negative);
  k.vector({"mass_centre", "", "with `hinge`: the centre of mass, as placed"}, mass_centre, Dimension::length);
  k.number({"inertia", "with `hinge`", "about the hinge"}, inertia, Dimension::moment_of_inertia, Range::not_negative);
  k.number({"force", "", "along the guide"}, force, Dimension::force, Range::any);
  k.number({"torque", "", "about the hinge"}, torque, Dimension::torque, Range::any);
  k.number({"damping", "", "with `guide`"}, damping, Dimension::damping, Range::not_negative);
  k.number({"turn_damping", "", "with `hinge`"}, turn_damping, Dimension::rotational_damping, Range::not_negative);
  k.numbers({"stroke", "none", "`[lowest, highest]`: limits of its displacement, with `guide`; it stops there without a rebound"}, stroke,
            Dimension::length);
  k.numbers({"swing", "none", "`[lowest, highest]`: the same, with `hinge`"}, swing, Dimension::angle);
}

Drive Free::drive() const {
  Drive d;
  d.guide = guide_of(guide, hinge, centre);
  d.inertia = d.guide.turns ? inertia : mass;
  d.push = d.guide.turns ? torque : force;
  d.damping = d.guide.turns ? turn_damping : damping;
  d.mass = mass;
  d.mass_centre = mass_centre;
  set_ends(d.guide.turns ? swing : stroke, d);
  return d;
}

std::optional<KeyFault> Free::fault() const {
  if (const auto fault = fault_of_guide("guide", guide, "hinge", hinge)) return fault;
  if (is_given(hinge)) {
    if (!(inertia > 0)) return KeyFault{"inertia", "is 0 or missing; expected that about the hinge, such as \"0.02 kg m^2\""};
    if (force != 0) return KeyFault{"force", "is there with `hinge`; expected `torque`"};
    if (damping != 0) return KeyFault{"damping", "is there with `hinge`; expected `turn_damping`"};
    return fault_of_ends("swing", swing, "stroke", stroke);
  }
  if (!(mass > 0)) return KeyFault{"mass", "is 0 or missing; expected that of the part that moves, such as \"3 kg\""};
  if (inertia != 0) return KeyFault{"inertia", "is there with `guide`; expected `mass`"};
  if (torque != 0) return KeyFault{"torque", "is there with `guide`; expected `force`"};
  if (turn_damping != 0) return KeyFault{"turn_damping", "is there with `guide`; expected `damping`"};
  if (is_given(mass_centre)) return KeyFault{"mass_centre", "is there with `guide`, where it means nothing; leave it out"};
  return fault_of_ends("stroke", stroke, "swing", swing);
}

std::vector<Vec3> Free::displacements(double, double) const { return reach_of(drive(), kAnywhere); }

std::optional<TurnAxis> Free::turn_axis() const { return turn_axis_of(hinge, centre); }

void Free::move_origin(const Vec3& origin) {
  centre -= origin;
  mass_centre -= origin;
}

std::string Free::text() const {
  return is_given(hinge) ? fmt::format("swings freely about a hinge, {:.4g} kg m^2", inertia)
                         : fmt::format("moves freely along a guide, {:.4g} kg", mass);
}

void Motor::keys(KeyVisitor& k) {
  k.direction({"axis", kRequired, "", kAlways}, axis);
  k.vector({"centre", "", "a point on the axis", kAlways}, centre, Dimension::length);
  k.number({"torque", kRequired, "of the drive"}, torque, Dimension::torque, Range::any);
  k.number({"inertia", kRequired, "of all rotating parts, about the axis"}, inertia, Dimension::moment_of_inertia, Range::positive);
  k.number({"max_rate", "none", "the highest rate; the drive holds it with any torque that this needs"}, max_rate,
           Dimension::angular_velocity, Range::positive);
}

Drive Motor::drive() const {
  Drive d;
  d.guide = {true, axis, centre};
  d.inertia = inertia;
  d.push = torque;
  d.most_rate = max_rate;
  return d;
}

double Motor::fastest(std::span<const Vec3> points) const {
  return max_rate < kUnlimitedRate ? max_rate * largest_lever(points, axis, centre) : 0;
}

std::string Motor::text() const {
  return fmt::format("is turned by {:.4g} N m on {:.4g} kg m^2{}", torque, inertia,
                     max_rate < kUnlimitedRate ? fmt::format(", at most at {:.4g} rad/s", max_rate) : "");
}

std::optional<Drive> WallMotion::drive() const {
  return std::visit(
      [](const auto& m) -> std::optional<Drive> {
        if constexpr (requires { m.drive(); }) return m.drive();
        return {};
      },
      kind);
}

double WallMotion::elapsed(double time) const { return std::clamp(time, start, std::max(start, stop)) - start; }

bool WallMotion::moves() const {
  if (const auto* several = std::get_if<Several>(&kind)) return several->last_change() > 0;
  return stop > start && std::visit([](const auto& m) { return m.last_change() > 0; }, kind);
}

double WallMotion::end() const {
  if (const auto* several = std::get_if<Several>(&kind)) return several->last_change();
  const double end = std::min(stop, start + std::visit([](const auto& m) { return m.last_change(); }, kind));
  return moves() && end > start ? end : 0;
}

const char* WallMotion::word() const {
  return std::visit([](const auto& m) { return std::decay_t<decltype(m)>::kWord; }, kind);
}

MotionState Several::state(double time, const Pose& pose) const {
  MotionState s{pose, {}, {}};
  for (const WallMotion& part : parts) {
    MotionState next = part.state(time, s.pose);
    const Quat turn = next.pose.orientation * conjugate(s.pose.orientation);
    next.velocity += rotate(turn, s.velocity);
    next.angular_velocity += rotate(turn, s.angular_velocity);
    s = next;
  }
  return s;
}

/// The sum of what each part alone would give, with levers that reach as far as the other parts displace the wall while they last.
double Several::fastest(std::span<const Vec3> points) const {
  std::vector<Vec3> farther(points.begin(), points.end());
  for (const WallMotion& part : parts) {
    constexpr double kNever = 1e300;  // as WallMotion::stop
    const double end = std::min(part.end(), part.stop);
    if (std::holds_alternative<Translate>(part.kind) && !(end < kNever)) continue;  // its travel is not known beforehand
    for (const Vec3& way : part.displacements(end)) {
      for (const Vec3& p : points) farther.push_back(p + way);
    }
  }
  double sum = 0;
  for (const WallMotion& part : parts) sum += part.fastest(farther);
  return sum;
}

double Several::last_change() const {
  double last = 0;
  for (const WallMotion& part : parts) last = std::max(last, part.end());
  return last;
}

/// Corners of the box that the sums of the parts' ways lie in: of a part that a later one turns, whatever its direction.
std::vector<Vec3> Several::displacements(double, double last) const {
  Vec3 lower, upper;
  for (std::size_t k = 0; k < parts.size(); ++k) {
    const bool turned = std::any_of(parts.begin() + static_cast<std::ptrdiff_t>(k), parts.end(),
                                    [](const WallMotion& later) { return later.turn_axis().has_value(); });
    Vec3 low, high;
    for (const Vec3& way : parts[k].displacements(last)) {
      const double size = length(way);
      low = component_min(low, turned ? Vec3{-size, -size, -size} : way);
      high = component_max(high, turned ? Vec3{size, size, size} : way);
    }
    lower += low;
    upper += high;
  }
  std::vector<Vec3> corners;
  for (int c = 0; c < 8; ++c) corners.push_back({(c & 1 ? upper : lower).x, (c & 2 ? upper : lower).y, (c & 4 ? upper : lower).z});
  return corners;
}

std::string Several::text() const {
  std::string all;
  for (const WallMotion& part : parts) all += (all.empty() ? "" : ", then ") + part.text();
  return all;
}

void Several::move_origin(const Vec3& origin) {
  for (WallMotion& part : parts) part.move_origin(origin);
}

std::optional<KeyFault> Several::fault() const {
  for (const WallMotion& part : parts) {
    if (part.drive() || std::holds_alternative<Several>(part.kind))
      return KeyFault{"motion", "answers to force, which goes with no other motion of the same wall"};
    if (const auto fault = part.fault()) return fault;
  }
  return {};
}

Vec3 Several::pivot(double time, const Pose& placed) const {
  for (std::size_t k = parts.size(); k-- > 0;) {
    const std::optional<TurnAxis> axis = parts[k].turn_axis();
    if (!axis) continue;
    Pose carried{axis->point, {}};
    for (std::size_t later = k + 1; later < parts.size(); ++later) carried = parts[later].state(time, carried).pose;
    return carried.position;
  }
  return state(time, placed).pose.position;
}

void WallMotion::advance_clock(double by) {
  start -= by;
  stop -= by;
  if (auto* several = std::get_if<Several>(&kind)) {
    for (WallMotion& part : several->parts) part.advance_clock(by);
  }
}

std::span<const WallMotion> WallMotion::parts() const {
  if (const auto* several = std::get_if<Several>(&kind)) return several->parts;
  return {this, 1};
}

MotionState WallMotion::state(double time, const Pose& pose) const {
  if (const auto* several = std::get_if<Several>(&kind)) return several->state(time, pose);
  MotionState s = std::visit([&](const auto& m) { return m.state(elapsed(time), pose); }, kind);
  if (!(time >= start && time < stop)) s.velocity = s.angular_velocity = {};
  return s;
}

double WallMotion::fastest(std::span<const Vec3> points) const {
  return std::visit([&](const auto& m) { return m.fastest(points); }, kind);
}

std::vector<Vec3> WallMotion::displacements(double duration) const {
  if (const auto* several = std::get_if<Several>(&kind)) return several->displacements(0, duration);
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
