#include "solver/contact/pair_features.hpp"

#include <algorithm>
#include <cmath>

namespace scree {

namespace {

/// Frame of the larger body, in which the smaller one's motion is measured: a small body that spins beside a wide
/// floor uses up its own radius, not the floor's.
bool larger_is_a(double radius_a, double radius_b) { return radius_a > radius_b; }

}  // namespace

float slack_below(double distance, double margin, double size) {
  constexpr double kDistanceRounding = 1e-12;  // of the body size: far above the error of the double formulas
  const double slack = distance - margin - kDistanceRounding * size;
  return slack <= 0 ? 0.0f : std::nextafterf(static_cast<float>(slack), 0.0f);
}

double motion_since_listed(const CandidateLists& lists, const RelativePose& pose, double radius_a, double radius_b) {
  const Vec3 centre = larger_is_a(radius_a, radius_b) ? pose.centre : -transpose_times(pose.rotation, pose.centre);
  // A point at distance R from the centre moves by 2 R sin(angle / 2), and two unit quaternions differ by 2 sin(angle / 4):
  // twice that is never less. Of the two quaternions of a rotation the nearer one counts.
  const Quat &p = pose.turn, &q = lists.turn;
  const double side = p.w * q.w + p.x * q.x + p.y * q.y + p.z * q.z < 0 ? -1 : 1;
  const double w = p.w - side * q.w, x = p.x - side * q.x, y = p.y - side * q.y, z = p.z - side * q.z;
  return length(centre - lists.centre) + 2 * std::sqrt(w * w + x * x + y * y + z * z) * std::min(radius_a, radius_b);
}

void begin_lists(const PairBody& a, const PairBody& b, double skin, double radius_a, double radius_b, CandidateLists& lists) {
  lists.corners_a.clear();
  lists.corners_b.clear();
  lists.edges.clear();
  const RelativePose pose(a, b);
  lists.centre = larger_is_a(radius_a, radius_b) ? pose.centre : -transpose_times(pose.rotation, pose.centre);
  lists.turn = pose.turn;
  lists.skin = skin;
  lists.first_slack = skin;
}

void end_lists(CandidateLists& lists) {
  double first = lists.skin;
  for (const auto* corners : {&lists.corners_a, &lists.corners_b}) {
    for (const CornerCandidate& c : *corners) first = std::min(first, static_cast<double>(c.slack));
  }
  for (const EdgeCandidate& e : lists.edges) first = std::min(first, static_cast<double>(e.slack));
  lists.first_slack = first;
}

}  // namespace scree
