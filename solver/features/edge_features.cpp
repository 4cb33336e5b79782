#include "solver/features/edge_features.hpp"

#include <algorithm>
#include <cmath>

#include "solver/features/candidate_slack.hpp"

namespace scree {

namespace {

// What is a feature here, edge_lanes.cpp computes too, line by line: whoever changes one changes both.

/// S(y) = y^2 (3 - 2 y) on [0, 1] and its derivative: the smooth switch of the fading.
double smooth_switch(double y, double& derivative) {
  derivative = 0;
  if (y <= 0) return 0;
  if (y >= 1) return 1;
  derivative = 6 * y * (1 - y);
  return y * y * (3 - 2 * y);
}

/// Motion over the size of the smaller body that the slack of a wedge is made for.
constexpr double kLeanLook = 0.01;

/// Two edges of a candidate at the present pose, A frame. Letters of docs/reference/contact-law.md section 3.2: u, v edge vectors, s, t
/// parameters, r = x_A - x_B = g n.
struct EdgePair {
  std::int32_t edge_a, edge_b;
  Vec3 u, v;
  double uu, uv, vv, det, sine2;
  double s, t;
  Vec3 xa, r, n;
  double g;
  double y[4];       ///< how far the normal leans out of the wedge over each face, where it does
  Vec3 conormal[4];  ///< of the faces that it leans over, A frame
  bool leans = false;
};

/// How far the normal leans out of the wedge over each face. It is perpendicular to both edges, so for most the sides tell: conormals
/// are needed where it leans out. Returns false when it is outside, or looks into the fold of a wall.
bool find_lean(const PairBody& a, const PairBody& b, const RelativePose& pose, EdgePair& e) {
  const Vec3 n_b = transpose_times(pose.rotation, e.n);
  for (int i = 0; i < 4; ++i) {
    const double sign = i < 2 ? -1 : 1;
    const SolverShape& shape = i < 2 ? *a.shape : *b.shape;
    const std::int32_t edge = i < 2 ? e.edge_a : e.edge_b;
    e.y[i] = 0;
    if (!(sign * dot(i < 2 ? e.n : n_b, shape.into_face(edge, i & 1)) > 0)) continue;
    e.conormal[i] = shape.edge_conormal(edge, i & 1);
    if (i >= 2) e.conormal[i] = pose.rotation * e.conormal[i];
    e.y[i] = sign * dot(e.n, e.conormal[i]);
    e.leans = e.leans || e.y[i] > 0;
    if (e.y[i] >= kFadeWedge) return false;
  }
  const auto in_fold = [](const SolverShape& shape, std::int32_t edge, const Vec3& away) {
    return shape.is_two_sided && is_in_fold(shape.edge_conormal(edge, 0), shape.edge_conormal(edge, 1), away);
  };
  return !in_fold(*a.shape, e.edge_a, -e.n) && !in_fold(*b.shape, e.edge_b, n_b);
}

/// Weight of a faded feature and its gradient: a product of switches; each adds weight / switch * slope times the gradient of its
/// argument. Returns false for a weight too small to count.
bool fade(const EdgePair& e, ContactFeature& f) {
  double of_s, of_t, of_sine, of_y[4] = {};
  const double switch_s = smooth_switch(std::min(e.s, 1 - e.s) / kFadeEnd, of_s);
  const double switch_t = smooth_switch(std::min(e.t, 1 - e.t) / kFadeEnd, of_t);
  const double switch_sine = smooth_switch(e.sine2 / kFadeParallel, of_sine);
  double switch_y[4] = {1, 1, 1, 1};
  f.weight = switch_s * switch_t * switch_sine;
  for (int i = 0; i < 4; ++i) {
    if (!(e.y[i] > 0)) continue;
    switch_y[i] = smooth_switch(1 - e.y[i] / kFadeWedge, of_y[i]);
    f.weight *= switch_y[i];
  }
  if (f.weight < kWeightCutoff) return false;
  of_s *= f.weight / switch_s / kFadeEnd * (e.s < 0.5 ? 1 : -1);
  of_t *= f.weight / switch_t / kFadeEnd * (e.t < 0.5 ? 1 : -1);
  of_sine *= f.weight / switch_sine / kFadeParallel;
  f.faded = of_s != 0 || of_t != 0 || of_sine != 0;

  // For a virtual motion of A, B held: of the directions y with s and t held, and what they add to those of s and t
  Vec3 across, turning;
  for (int i = 0; i < 4; ++i) {
    if (of_y[i] == 0) continue;
    f.faded = true;
    const double sign = i < 2 ? -1 : 1;
    const double c = -sign * f.weight / switch_y[i] * of_y[i] / kFadeWedge;
    const Vec3 tp = e.conormal[i] - dot(e.conormal[i], e.n) * e.n;
    across += (c / e.g) * tp;
    of_s += c / e.g * dot(tp, e.u);
    of_t -= c / e.g * dot(tp, e.v);
    if (i < 2) turning += c * cross(e.conormal[i], e.n);
  }
  // ds = (vv b1 - uv b2) / -det and dt = (uv b1 - uu b2) / -det, where a translation has b1 = u, b2 = v as coefficients and a
  // rotation about A's centre has b1 = x_A x u + u x r, b2 = x_A x v
  const double p = -(e.vv * of_s + e.uv * of_t) / e.det, q = -(e.uv * of_s + e.uu * of_t) / e.det;
  f.weight_gradient.force = across + p * e.u - q * e.v;
  f.weight_gradient.couple = cross(e.xa, f.weight_gradient.force) + p * cross(e.u, e.r) + turning;
  if (of_sine != 0) f.weight_gradient.couple += (of_sine * -2 * e.uv / (e.uu * e.vv)) * cross(e.u, e.v);
  return true;
}

}  // namespace

double examine_edges(const PairBody& a, const PairBody& b, const RelativePose& pose, double margin, double size,
                     const EdgeCandidate& candidate, std::vector<ContactFeature>& features) {
  const EdgeLines lines(a, b, pose, candidate.edge_a, candidate.edge_b);
  const auto& [pa, u, pb, v, r0, uu, uv, vv, ur, vr, det, sine2] = lines;
  const auto lacks = [&](double known) {
    return a.shape->is_two_sided || b.shape->is_two_sided
               ? std::max(known, slack_of_side(a, b, pose, candidate.edge_a, candidate.edge_b, lines))
               : known;
  };
  if (!(sine2 > kParallelCutoff)) return lacks(0);
  const double s = lines.s(), t = lines.t();
  if (s <= 0 || s >= 1 || t <= 0 || t >= 1) return lacks(std::max(lines.distance() - margin, slack_of_ends(lines, s, t, margin, size)));
  const Vec3 xa = pa + s * u, xb = pb + t * v;
  const Vec3 r = xa - xb;
  const double g = length(r);
  if (g >= margin || !(g > 0)) return g - margin;
  EdgePair e{candidate.edge_a, candidate.edge_b, u, v, uu, uv, vv, det, sine2, s, t, xa, r, (1 / g) * r, g, {}, {}};
  if (!find_lean(a, b, pose, e))
    return lacks(slack_of_wedge(a, b, pose, candidate.edge_a, candidate.edge_b, lines, margin, size, kLeanLook * size));

  ContactFeature f{};
  name_edge_feature(a, b, candidate, f);
  f.x = 0.5 * (xa + xb);
  f.n = e.n;
  f.overlap = margin - g;
  f.weight = 1;
  const bool fades = e.leans || std::min({s, 1 - s, t, 1 - t}) < kFadeEnd || sine2 < kFadeParallel;
  if (!fades || fade(e, f)) features.push_back(f);
  return 0;
}

}  // namespace scree
