#include "solver/features/pass_through.hpp"

#include <algorithm>
#include <cmath>

namespace scree {

namespace {

/// Both bodies as they were, share of a step ago; A's present frame is the frame.
struct Past {
  PairBody a, b;
  Past(const PairBody& now_a, const PairBody& now_b, const PairMotion& m, double time) : a(now_a), b(now_b) {
    a.x = (-time) * m.v_a;
    b.x = m.centre_b - time * m.v_b;
    a.q = turned_back(m.w_a, time);
    b.q = turned_back(m.w_b, time) * (conjugate(now_a.q) * now_b.q);
  }
  static Quat turned_back(const Vec3& w, double time) {
    const double rate = length(w);
    return rate > 0 ? quaternion_of((1 / rate) * w, -rate * time) : Quat{};
  }
};

/// How far a point of a body may be from where constant spin says it was: with |dw/dt| <= |w|^2 (of the moments each is at most
/// the sum of the others), twice what half of that over a step gives.
double unsteadiness(const PairBody& body, const Vec3& w, double radius, double dt) {
  const bool steady = body.shape->kind == ShapeKind::surface || body.shape->isotropic;
  return steady ? 0.0 : radius * squared_length(w) * dt * dt;
}

}  // namespace

double surface_distance(const PairBody& a, const PairBody& b, double reach, MeshDistanceScratch& scratch, TrianglePair& nearest) {
  const bool a_is_sphere = a.shape->kind == ShapeKind::sphere;
  if (a_is_sphere || b.shape->kind == ShapeKind::sphere) {
    const PairBody &sphere = a_is_sphere ? a : b, &mesh = a_is_sphere ? b : a;
    Vec3 foot;
    std::int32_t triangle = -1;
    const Vec3 centre = (1 / mesh.scale) * rotate_inverse(mesh.q, sphere.x - mesh.x);
    return mesh.scale * point_mesh_distance({&mesh.shape->mesh, &mesh.shape->bvh}, centre, reach / mesh.scale, foot, triangle);
  }
  const Placement placement = relative_placement(a.x, a.q, a.scale, b.x, b.q, b.scale);
  return a.scale *
         mesh_distance({&a.shape->mesh, &a.shape->bvh}, {&b.shape->mesh, &b.shape->bvh}, placement, reach / a.scale, scratch, &nearest);
}

bool may_have_passed_through(const PairBody& a, const PairBody& b, const PairMotion& m, double radius_a, double radius_b, double margin,
                             double dt, double motion, const CandidateLists& lists, MeshDistanceScratch& scratch) {
  constexpr double kRounding = 1 + 1e-9;
  // the smaller body in the frame of the larger one
  const bool frame_is_a = radius_a > radius_b;
  const double small = frame_is_a ? radius_b : radius_a;
  const Vec3& frame_spin = frame_is_a ? m.w_a : m.w_b;
  const Vec3 between = m.v_a - m.v_b, spin = m.w_a - m.w_b, velocity = between + cross(frame_spin, m.centre_b);
  const bool has_sphere = a.shape->kind == ShapeKind::sphere || b.shape->kind == ShapeKind::sphere;
  // a ball that touches has its centre further away than half its radius
  const PairBody& ball = a.shape->kind == ShapeKind::sphere ? a : b;
  const double room = has_sphere ? 0.5 * ball.scale * ball.shape->rounding : 0.0;
  const double limit = kRounding * (margin + room) / dt;
  // (a + b)^2 <= 2 (a^2 + b^2): no root for the many that are slow
  if (2 * (squared_length(velocity) + small * small * squared_length(spin)) <= limit * limit) return false;
  // velocity changes as the frame turns under the smaller body
  const double way = dt * (length(velocity) + length(frame_spin) * length(between) * dt + small * length(spin));
  if (way <= kRounding * (margin + room)) return false;
  if (motion <= lists.first_slack + room) return false;

  const double unsure = unsteadiness(a, m.w_a, radius_a, dt) + unsteadiness(b, m.w_b, radius_b, dt);
  TrianglePair nearest{-1, -1};
  double gone = 0;  // part of the step, backwards
  for (int look = 0; look < kMaxLooks; ++look) {
    const Past past(a, b, m, gone * dt);
    const double left = kRounding * ((1 - gone) * way + unsure);
    const double distance = surface_distance(past.a, past.b, 2 * left, scratch, nearest);
    if (distance > left) return false;
    if (!(distance > 0)) return true;
    gone = std::min(1.0, gone + distance / (kRounding * way));
  }
  return true;
}

}  // namespace scree
