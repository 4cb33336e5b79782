#include "mesher/edit/sieve_opening.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace scree {

namespace {

double width(const std::vector<Vec3>& corners, const Vec3& direction) {
  double least = 1e308, most = -1e308;
  for (const Vec3& p : corners) {
    const double x = dot(p, direction);
    least = std::min(least, x);
    most = std::max(most, x);
  }
  return most - least;
}

/// The opening for one pair of directions, the first two axes of a frame.
struct Passage {
  Quat frame;
  double opening = 0;
};

Passage passage(const std::vector<Vec3>& corners, const Quat& frame) {
  return {frame, std::max(width(corners, rotate(frame, Vec3{1, 0, 0})), width(corners, rotate(frame, Vec3{0, 1, 0})))};
}

Quat turn(const Vec3& axis, double angle) {
  const double s = std::sin(0.5 * angle) / length(axis);
  return {std::cos(0.5 * angle), s * axis.x, s * axis.y, s * axis.z};
}

/// Directions through half of the sphere, each turned about itself: a square looks the same after a quarter turn.
std::vector<Passage> spread(const std::vector<Vec3>& corners) {
  constexpr int kDirections = 150, kTurns = 12;
  std::vector<Passage> all;
  for (int i = 0; i < kDirections; ++i) {
    const double z = (i + 0.5) / kDirections, azimuth = i * std::numbers::pi * (3 - std::sqrt(5.0));  // a spiral of equal areas
    const Quat tilt = turn(Vec3{std::cos(azimuth), std::sin(azimuth), 0}, std::acos(z));
    for (int k = 0; k < kTurns; ++k)
      all.push_back(passage(corners, normalised(tilt * turn(Vec3{0, 0, 1}, 0.5 * std::numbers::pi * k / kTurns))));
  }
  return all;
}

/// Goes down in small rotations about 26 axes, with ever smaller angles. Two widths bound the opening at its least, and a search along
/// three axes alone would stop in the edge between them; the axes are turned as the angle shrinks.
Passage descend(const std::vector<Vec3>& corners, Passage at) {
  constexpr double kFirst = 0.1, kLast = 1e-10;  // [rad]
  Quat basis;
  const Quat next = normalised(Quat{0.8, 0.3, 0.4, 0.33});  // any rotation that does not soon return
  for (double angle = kFirst; angle > kLast; angle *= 0.6) {
    bool moves = true;
    for (int n = 0; moves && n < 30; ++n) {
      moves = false;
      for (int code = 0; code < 27; ++code) {
        const Vec3 axis{static_cast<double>(code % 3 - 1), static_cast<double>(code / 3 % 3 - 1), static_cast<double>(code / 9 - 1)};
        if (!(length(axis) > 0)) continue;
        const Passage tried = passage(corners, normalised(turn(rotate(basis, axis), angle) * at.frame));
        if (!(tried.opening < at.opening)) continue;
        at = tried;
        moves = true;
      }
    }
    basis = normalised(basis * next);
  }
  return at;
}

}  // namespace

double sieve_opening(const std::vector<Vec3>& corners) {
  constexpr std::size_t kStarts = 4;
  constexpr double kOther = 0.3;  // [rad] between two starts
  std::vector<Passage> all = spread(corners);
  std::sort(all.begin(), all.end(), [](const Passage& a, const Passage& b) { return a.opening < b.opening; });
  std::vector<Passage> starts;
  for (const Passage& p : all) {
    const auto is_near = [&](const Passage& q) {
      const double cosine = std::abs(dot(rotate(p.frame, Vec3{0, 0, 1}), rotate(q.frame, Vec3{0, 0, 1})));
      return cosine > std::cos(kOther);
    };
    if (starts.size() < kStarts && std::none_of(starts.begin(), starts.end(), is_near)) starts.push_back(p);
  }
  double least = all.front().opening;
  for (const Passage& start : starts) least = std::min(least, descend(corners, start).opening);
  return least;
}

}  // namespace scree
