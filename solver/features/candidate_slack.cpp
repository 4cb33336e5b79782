#include "solver/features/candidate_slack.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "solver/features/edge_fading.hpp"

namespace scree {

namespace {

constexpr double kChord = 0.866;    // sine over chord of an angle whose chord is at most 1: sqrt(3) / 2, rounded down
constexpr double kMinSine2 = 1e-4;  // of edges about which something is said: s and t are then exact to 1e-11
// Of the conormals of a fold, cosine: below it no normal that leans over neither face by kFadeWedge is square to the direction half way
// between them, 1 - 2 kFadeWedge^2, rounded down. Only knife edges of less than 26 degrees are above it.
constexpr double kFoldSeen = 0.9;
static_assert(kFoldSeen < 1 - 2 * kFadeWedge * kFadeWedge);
constexpr double kSlackRounding = 1 - 1e-6;  // of the slack, and absolute of a lean: far above the rounding of what decides on a feature

}  // namespace

double slack_of_ends(const EdgeLines& e, double s, double t, double margin, double size) {
  if (!(e.sine2 > kMinSine2)) return 0;
  const auto beyond = [](double parameter) { return std::max({-parameter, parameter - 1, 0.0}); };
  const double away = std::max(beyond(s) * std::sqrt(e.uu), beyond(t) * std::sqrt(e.vv));
  const double cosine = std::sqrt(std::max(0.0, 1 - e.sine2));
  return kSlackRounding * away * (1 - cosine) / (1 + margin / size);
}

double slack_of_side(const PairBody& a, const PairBody& b, const RelativePose& pose, std::int32_t edge_a, std::int32_t edge_b,
                     const EdgeLines& e) {
  // of the edge of a wall that begins at `start` and of another one from `from` along `along`, both in A's frame
  const auto beyond = [&](bool of_a, const Vec3& start, const Vec3& from, const Vec3& along) {
    const SolverShape& shape = of_a ? *a.shape : *b.shape;
    if (!shape.is_two_sided) return 0.0;
    const std::int32_t edge = of_a ? edge_a : edge_b;
    const Vec3 first = shape.edge_conormal(edge, 0), second = shape.edge_conormal(edge, 1);
    if (!(squared_length(first) > 0 && squared_length(second) > 0) || !(dot(first, second) < kFoldSeen)) return 0.0;
    const Vec3 into_fold = first + second;
    const double size = length(into_fold);
    if (!(size > 0)) return 0.0;
    const Vec3 direction = of_a ? into_fold : pose.rotation * into_fold;
    const double near = dot(from - start, direction);
    return std::min(near, near + dot(along, direction)) / size;
  };
  return kSlackRounding * std::max({0.0, beyond(true, e.pa, e.pb, e.v), beyond(false, e.pb, e.pa, e.u)});
}

double slack_of_wedge(const PairBody& a, const PairBody& b, const RelativePose& pose, std::int32_t edge_a, std::int32_t edge_b,
                      const EdgeLines& e, double margin, double size, double enough) {
  if (!(e.sine2 > kMinSine2)) return 0;
  const double sine = std::sqrt(e.sine2);
  const Vec3 w = cross(e.u, e.v);
  const Vec3 n = (1 / length(w)) * w;
  const double per_motion = (1 / (kChord * sine) + 1) / size;  // of a lean
  std::array<double, 2> of_wedge{};                            // for n = w / |w| and for the opposite
  for (int i = 0; i < 4; ++i) {
    const bool of_a = i < 2;
    const SolverShape& shape = of_a ? *a.shape : *b.shape;
    const std::int32_t edge = of_a ? edge_a : edge_b;
    if (!shape.has_height(edge, i & 1)) continue;
    const Vec3 conormal = shape.edge_conormal(edge, i & 1);
    const double out = of_a ? -dot(n, conormal) : dot(n, pose.rotation * conormal);
    const double too_far = std::abs(out) - kFadeWedge - (1 - kSlackRounding);
    double& slack = of_wedge[out > 0 ? 0 : 1];
    slack = std::max(slack, too_far / per_motion);
  }
  const double most = kChord * sine * size;  // where c is 1
  const double height = dot(e.r0, n);
  const double of_passing = std::min(enough, std::abs(height) / (1 + (margin + enough) / most));
  const double of_this = of_wedge[height > 0 ? 0 : 1], of_other = std::max(of_wedge[height > 0 ? 1 : 0], of_passing);
  return kSlackRounding * std::min({of_this, of_other, most});
}

}  // namespace scree
