#include "solver/features/pair_features.hpp"

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

namespace {

/// Of the smaller body from one pose to another, each given by its centre in the frame of the larger one and by the turn between them.
double motion_between(const Vec3& centre, const Quat& p, const Vec3& old_centre, const Quat& q, double size) {
  // A point at distance R from the centre moves by 2 R sin(angle / 2), and two unit quaternions differ by 2 sin(angle / 4):
  // twice that is never less. Of the two quaternions of a rotation the nearer one counts.
  const double side = p.w * q.w + p.x * q.x + p.y * q.y + p.z * q.z < 0 ? -1 : 1;
  const double w = p.w - side * q.w, x = p.x - side * q.x, y = p.y - side * q.y, z = p.z - side * q.z;
  return length(centre - old_centre) + 2 * std::sqrt(w * w + x * x + y * y + z * z) * size;
}

Vec3 centre_of_smaller(const RelativePose& pose, double radius_a, double radius_b) {
  return larger_is_a(radius_a, radius_b) ? pose.centre : -transpose_times(pose.rotation, pose.centre);
}

}  // namespace

double motion_since_listed(const CandidateLists& lists, const RelativePose& pose, double radius_a, double radius_b) {
  return motion_between(centre_of_smaller(pose, radius_a, radius_b), pose.turn, lists.centre, lists.turn, std::min(radius_a, radius_b));
}

double follow_motion(CandidateLists& lists, const RelativePose& pose, double radius_a, double radius_b) {
  const Vec3 centre = centre_of_smaller(pose, radius_a, radius_b);
  const double size = std::min(radius_a, radius_b);
  lists.way += kWayRounding * motion_between(centre, pose.turn, lists.last_centre, lists.last_turn, size);
  lists.last_centre = centre;
  lists.last_turn = pose.turn;
  return motion_between(centre, pose.turn, lists.centre, lists.turn, size);
}

void begin_lists(const PairBody& a, const PairBody& b, double skin, double radius_a, double radius_b, CandidateLists& lists) {
  lists.corners_a.clear();
  lists.corners_b.clear();
  lists.edges.clear();
  lists.slacks.clear();
  const RelativePose pose(a, b);
  lists.centre = lists.last_centre = centre_of_smaller(pose, radius_a, radius_b);
  lists.turn = lists.last_turn = pose.turn;
  lists.skin = skin;
  lists.first_slack = skin;
  lists.way = lists.next_examination = 0;
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
