// The motions of walls. A kind of motion is one struct here and one line in MotionKind: the case, the scene file, the solver,
// the choice of the margin, the checks at seams and reports take all that they need of it from the struct.
//
// A kind has
//   kWord, kMeaning              its word in a case and a scene file, and what CASE.md says of it
//   keys(KeyVisitor&)            its keys (keys.hpp)
//   state(elapsed, pose)         where a frame is that was placed at `pose`, and how fast it moves
//   fastest(points)              no point of a wall is faster [m/s]
//   last_change()                how long after its start it moves for the last time [s]; 0: never, kForever: always
//   displacements(first, last)   of the frame [m]: a box around these holds all of those between two times
//   text()                       in a few words, for reports
// and where they apply
//   turn_axis()                  the axis about which the wall turns; it does not move otherwise
//   move_origin(origin)          takes what is a place to a world whose origin lies there
//   fault()                      what its values cannot be
//   drive()                      of one that answers to force: how. It has no place of its own in time: state() is where it was placed
#pragma once

#include <limits>
#include <optional>
#include <span>
#include <string>
#include <variant>
#include <vector>

#include "core/geometry/vec3.hpp"

namespace scree {

class KeyVisitor;

inline constexpr double kForever = std::numeric_limits<double>::infinity();
inline constexpr double kUnlimitedRate = 1e300;  ///< finite, as files need it

struct Pose {
  Vec3 position;
  Quat orientation;
};

struct MotionState {
  Pose pose;
  Vec3 velocity, angular_velocity;  ///< [m/s] of the frame's origin, [rad/s]
};

struct TurnAxis {
  Vec3 point, direction;  ///< [m], unit
};

/// A key of a motion and what is wrong with its value.
struct KeyFault {
  const char* key;
  std::string text;
};

/// The one way that a wall can go which answers to force: along a direction, or about an axis.
struct Guide {
  bool turns = false;
  Vec3 axis{0, 0, 1};  ///< unit
  Vec3 centre{};       ///< of one that turns: a point on the axis [m]

  /// in   way   from where the wall was placed [m] or [rad]     in   rate   [m/s] or [rad/s]
  MotionState state(double way, double rate, const Pose& placed) const;
  /// What a force and a torque about the origin come to along it [N] or [N m].
  double component(const Vec3& force, const Vec3& torque) const {
    return turns ? dot(torque - cross(centre, force), axis) : dot(force, axis);
  }
};

/// How a wall answers to force. [kg] and [N] of one that goes along a direction are [kg m^2] and [N m] of one that turns.
struct Drive {
  Guide guide;
  double inertia = 0;  ///< 0: a servo, whose rate follows from what is missing of `push`
  double push = 0;     ///< on the wall, beside contacts and weight; of a servo: by the wall on what it meets
  double damping = 0;  ///< [N s/m] or [N m s]
  double most_rate = kUnlimitedRate;
  double share = 0;                               ///< of a servo: of what is missing, within the time of a contact
  bool is_outer = false;                          ///< its rate is set from outside, at most `most_rate`
  double lowest = -kForever, highest = kForever;  ///< ends of its way
  double mass = 0;                                ///< that gravity acts on [kg]
  Vec3 mass_centre{};                             ///< where, as placed [m]

  /// It moves by what is missing of its force: by no inertia, and not from outside.
  bool is_servo() const { return !(inertia > 0) && !is_outer; }
  /// Weight along the guide [N] or [N m].
  double weight(const Vec3& gravity, double way) const;
};

/// No motion.
struct Still {
  static constexpr const char* kWord = "none";
  static constexpr const char* kMeaning = "";
  void keys(KeyVisitor&) {}
  MotionState state(double, const Pose& pose) const { return {pose, {}, {}}; }
  double fastest(std::span<const Vec3>) const { return 0; }
  double last_change() const { return 0; }
  std::vector<Vec3> displacements(double, double) const { return {}; }
  std::string text() const { return "fixed"; }
};

struct Rotate {
  static constexpr const char* kWord = "rotate";
  static constexpr const char* kMeaning = "turns about an axis";
  Vec3 axis{0, 0, 1};  ///< unit
  Vec3 centre{};       ///< a point on the axis [m]
  double rate = 0;     ///< [rad/s]
  void keys(KeyVisitor& k);
  MotionState state(double elapsed, const Pose& pose) const;
  double fastest(std::span<const Vec3> points) const;
  double last_change() const { return rate == 0 ? 0 : kForever; }
  std::vector<Vec3> displacements(double, double) const { return {}; }
  std::string text() const;
  TurnAxis turn_axis() const { return {centre, axis}; }
  void move_origin(const Vec3& origin) { centre -= origin; }
};

struct Translate {
  static constexpr const char* kWord = "translate";
  static constexpr const char* kMeaning = "moves at a constant velocity";
  Vec3 axis{0, 0, 1};  ///< unit
  double rate = 0;     ///< [m/s] along it
  void keys(KeyVisitor& k);
  MotionState state(double elapsed, const Pose& pose) const;
  double fastest(std::span<const Vec3> points) const;
  double last_change() const { return rate == 0 ? 0 : kForever; }
  std::vector<Vec3> displacements(double first, double last) const;
  std::string text() const;
};

struct Oscillate {
  static constexpr const char* kWord = "oscillate";
  static constexpr const char* kMeaning = "oscillates, `amplitude (sin(2 pi frequency t + phase) - sin(phase))`";
  Vec3 axis{0, 0, 1};    ///< unit
  double amplitude = 0;  ///< [m]
  double frequency = 0;  ///< [Hz]
  double phase = 0;      ///< [rad]
  void keys(KeyVisitor& k);
  MotionState state(double elapsed, const Pose& pose) const;
  double fastest(std::span<const Vec3> points) const;
  double last_change() const { return amplitude == 0 || frequency == 0 ? 0 : kForever; }
  std::vector<Vec3> displacements(double first, double last) const;
  std::string text() const;
};

struct FollowTable {
  static constexpr const char* kWord = "table";
  static constexpr const char* kMeaning = "is displaced by a table, linear in between";
  std::vector<double> time{};    ///< [s] from the start, ascending
  std::vector<Vec3> position{};  ///< displacement [m]
  void keys(KeyVisitor& k);
  MotionState state(double elapsed, const Pose& pose) const;
  double fastest(std::span<const Vec3> points) const;
  double last_change() const;
  std::vector<Vec3> displacements(double first, double last) const;
  std::string text() const { return "follows a table"; }
  std::optional<KeyFault> fault() const;
};

/// Presses with a force or a torque, at whatever speed that takes.
struct Servo {
  static constexpr const char* kWord = "servo";
  static constexpr const char* kMeaning =
      "presses with a `force`, a `stress` on an `area`, or a `torque`, and moves as fast as needed, at most at `max_speed` or `max_rate`; "
      "it approaches at that speed while it touches nothing";
  Vec3 direction{}, axis{}, centre{};  ///< the first or the second is given, of any length > 0; a point on the axis [m]
  double force = 0, stress = 0, area = 0, torque = 0;
  double max_speed = 0, max_rate = 0;
  double share = 0.5;
  std::vector<double> stroke{}, swing{};  ///< lowest and highest; empty: no end
  void keys(KeyVisitor& k);
  MotionState state(double, const Pose& pose) const { return {pose, {}, {}}; }
  double fastest(std::span<const Vec3> points) const;
  double last_change() const { return kForever; }
  std::vector<Vec3> displacements(double first, double last) const;
  std::string text() const;
  std::optional<TurnAxis> turn_axis() const;
  void move_origin(const Vec3& origin) { centre -= origin; }
  std::optional<KeyFault> fault() const;
  Drive drive() const;
};

/// Moves as a program says that steps the run.
struct OuterMotion {
  static constexpr const char* kWord = "outer";
  static constexpr const char* kMeaning =
      "moves along a `direction` or about an `axis` at the rate that a program sets which steps the run (`scree.Engine`), and stands still "
      "until "
      "then";
  Vec3 direction{}, axis{}, centre{};  ///< the first or the second is given, of any length > 0; a point on the axis [m]
  double max_speed = 0, max_rate = 0;
  std::vector<double> stroke{}, swing{};  ///< lowest and highest; empty: no end
  void keys(KeyVisitor& k);
  MotionState state(double, const Pose& pose) const { return {pose, {}, {}}; }
  double fastest(std::span<const Vec3> points) const;
  double last_change() const { return kForever; }
  std::vector<Vec3> displacements(double first, double last) const;
  std::string text() const;
  std::optional<TurnAxis> turn_axis() const;
  void move_origin(const Vec3& origin) { centre -= origin; }
  std::optional<KeyFault> fault() const;
  Drive drive() const;
};

/// A part with a mass that moves by what acts on it.
struct Free {
  static constexpr const char* kWord = "free";
  static constexpr const char* kMeaning =
      "has a mass and moves along a direction (`guide`) or about an axis (`hinge`) under its weight, contact forces, and `force` or "
      "`torque`";
  Vec3 guide{}, hinge{}, centre{};  ///< the first or the second is given, of any length > 0; a point on the hinge [m]
  double mass = 0, inertia = 0;
  Vec3 mass_centre{};
  double force = 0, torque = 0, damping = 0, turn_damping = 0;
  std::vector<double> stroke{}, swing{};  ///< lowest and highest; empty: no end
  void keys(KeyVisitor& k);
  MotionState state(double, const Pose& pose) const { return {pose, {}, {}}; }
  double fastest(std::span<const Vec3>) const { return 0; }  // the speed is not known beforehand
  double last_change() const { return kForever; }
  std::vector<Vec3> displacements(double first, double last) const;
  std::string text() const;
  std::optional<TurnAxis> turn_axis() const;
  void move_origin(const Vec3& origin);
  std::optional<KeyFault> fault() const;
  Drive drive() const;
};

/// Turns by a torque against what it meets.
struct Motor {
  static constexpr const char* kWord = "motor";
  static constexpr const char* kMeaning =
      "turns about an axis by a `torque` on its `inertia`, against contact forces; at most at `max_rate`";
  Vec3 axis{0, 0, 1};  ///< unit
  Vec3 centre{};       ///< a point on the axis [m]
  double torque = 0, inertia = 0;
  double max_rate = kUnlimitedRate;
  void keys(KeyVisitor& k);
  MotionState state(double, const Pose& pose) const { return {pose, {}, {}}; }
  double fastest(std::span<const Vec3> points) const;
  double last_change() const { return kForever; }
  std::vector<Vec3> displacements(double, double) const { return {}; }
  std::string text() const;
  TurnAxis turn_axis() const { return {centre, axis}; }
  void move_origin(const Vec3& origin) { centre -= origin; }
  Drive drive() const;
};

struct WallMotion;

/// Several prescribed motions, applied in order: the second moves the wall from where the first has it, about axes and along directions
/// that stay where the case draws them. Times are those of its parts.
struct Several {
  static constexpr const char* kWord = "several";
  static constexpr const char* kMeaning = "";
  std::vector<WallMotion> parts{};
  void keys(KeyVisitor&) {}
  MotionState state(double time, const Pose& pose) const;
  double fastest(std::span<const Vec3> points) const;
  double last_change() const;
  std::vector<Vec3> displacements(double first, double last) const;
  std::string text() const;
  void move_origin(const Vec3& origin);
  std::optional<KeyFault> fault() const;
  /// A point that the wall turns about at a time, carried along by the parts after the one that turns it last; where none turns, the wall's
  /// origin.
  Vec3 pivot(double time, const Pose& placed) const;
};

using MotionKind = std::variant<Still, Rotate, Translate, Oscillate, FollowTable, Servo, OuterMotion, Free, Motor, Several>;

/// A motion of a wall: before `start` and after `stop` it stands still.
struct WallMotion {
  MotionKind kind;
  double start = 0;     ///< [s]
  double stop = 1e300;  ///< [s]

  /// There is one, as the case prescribes it or in answer to force.
  bool is_prescribed() const { return !std::holds_alternative<Still>(kind); }
  /// Of one that answers to force.
  std::optional<Drive> drive() const;
  /// It moves at some time.
  bool moves() const;
  /// When it moves for the last time [s]; 0 for a wall that never moves.
  double end() const;
  /// The word of its kind.
  const char* word() const;
  MotionState state(double time, const Pose& pose) const;
  /// No point of the wall is ever faster [m/s].   in   points   whose hull holds the wall, where it is placed
  double fastest(std::span<const Vec3> points) const;
  /// Where the frame goes from its place between 0 s and `duration` [m]: all of it lies in the box around these and the origin.
  std::vector<Vec3> displacements(double duration) const;
  std::optional<TurnAxis> turn_axis() const;
  void move_origin(const Vec3& origin);
  std::string text() const;
  std::optional<KeyFault> fault() const;
  /// Since its start, while it moves [s].
  double elapsed(double time) const;
  /// The same motion, so much earlier [s].
  void advance_clock(double by);
  /// The parts of several motions, or this one.
  std::span<const WallMotion> parts() const;
};

/// Calls action(Kind{}) for each kind of motion, that without any and that of several left out.
template <class Action>
void for_each_motion(Action&& action) {
  const auto one = [&](const auto& kind) {
    if constexpr (!std::is_same_v<std::decay_t<decltype(kind)>, Several>) action(kind);
  };
  const auto call = [&]<class... Kinds>(const std::variant<Still, Kinds...>*) { (one(Kinds{}), ...); };
  call(static_cast<const MotionKind*>(nullptr));
}

}  // namespace scree
