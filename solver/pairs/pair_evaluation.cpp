#include "solver/pairs/pair_evaluation.hpp"

namespace scree {

namespace {

// The skin of a pair follows its speed: long enough that lists are rebuilt every few tens of steps, short enough that they stay small. It
// never changes a result. Candidates grow with the triangles, and so does what each step pays for a longer list: steps that a skin lasts at
// the present relative speed, at one triangle, and their bounds. Moving packings of 20, 320 and 1280 triangles are cheapest at 72, 48, 24.
constexpr double kSkinSteps = 860, kMinSkinSteps = 12, kMaxSkinSteps = 64;
constexpr double kSkinStepsOfBalls = 24;  // on meshes
constexpr double kSmallestSkin = 0.25;    // of the maximum overlap
constexpr double kLargestSkin = 0.1;      // of the smaller radius

/// What a ball may go beyond its partner's margin before its centre is near it (features/pass_through.hpp).
double half_radius_of_ball(const PairView& view) {
  if (view.a.shape->kind == ShapeKind::sphere) return 0.5 * view.a.scale * view.a.shape->rounding;
  return view.b.shape != nullptr && view.b.shape->kind == ShapeKind::sphere ? 0.5 * view.b.scale * view.b.shape->rounding : 0.0;
}

double skin_steps(const PairView& view) {
  const auto triangles = [](const PairBody& body) { return body.shape != nullptr ? body.shape->mesh.triangles.size() : 0; };
  const auto most = static_cast<double>(std::max(triangles(view.a), view.zone == nullptr ? triangles(view.b) : 0));
  if (most == 0) return kSkinStepsOfBalls;
  return std::clamp(kSkinSteps / std::sqrt(most), kMinSkinSteps, kMaxSkinSteps);
}

}  // namespace

double candidate_skin(const PairView& view, const PairVelocities& m, double dt) {
  const double small = std::min(view.radius_a, view.radius_b);
  const double speed = length(m.v_a - m.v_b) + (length(m.w_a) + length(m.w_b)) * small;
  const double lower = std::min(kSmallestSkin * view.max_overlap, kLargestSkin * small);
  return std::clamp(skin_steps(view) * speed * dt, lower, kLargestSkin * small);
}

double squared_speed_of(const PairView& view, const PairVelocities& m) {
  const bool frame_is_a = view.radius_a > view.radius_b;
  const double small = frame_is_a ? view.radius_b : view.radius_a;
  const Vec3 velocity = (m.v_a - m.v_b) + cross(frame_is_a ? m.w_a : m.w_b, view.b.x - view.a.x);
  return 2 * (squared_length(velocity) + small * small * squared_length(m.w_a - m.w_b));
}

bool is_fast(const PairView& view, double squared_speed, double dt) {
  constexpr double kRounding = 1 - 1e-9;  // these velocities are rounded otherwise than those
  const double limit = kRounding * (view.margin + half_radius_of_ball(view));
  return squared_speed * (dt * dt) > limit * limit;
}

double count_from_rest(const std::vector<FrictionSpring>& springs, PairFeatures& features) {
  const FrictionSpring* const row = row_of<RestOverlap>(springs);
  if (row == nullptr || features.has_layer) return 0;
  const double rest_overlap = RestOverlap::of(*row).overlap;
  double deepest = 0;
  for (ContactFeature& f : features.list) {
    deepest = std::max(deepest, f.overlap);
    f.overlap -= rest_overlap;
  }
  std::erase_if(features.list, [](const ContactFeature& f) { return !(f.overlap > 0); });
  return deepest > 0 ? rest_overlap : 0;
}

void set_result(const PairView& view, const PairForce& f, std::size_t features, const Mat3& a_to_world, PairResult& result) {
  result.active = true;
  result.contact_count = static_cast<std::int32_t>(features);
  // torques about B's centre: T_B = (x_B - x_A) x F - T_A
  const Vec3 branch = view.b.x - view.a.x;
  result.force_a = a_to_world * f.force;
  result.torque_a = a_to_world * f.torque;
  result.torque_b = cross(branch, result.force_a) - result.torque_a;
  result.dissipative_force_a = a_to_world * f.dissipative_force;
  result.dissipative_torque_a = a_to_world * f.dissipative_torque;
  result.dissipative_torque_b = cross(branch, result.dissipative_force_a) - result.dissipative_torque_a;
  result.elastic = f.elastic;
  result.tangential_elastic = f.tangential_elastic;
  result.surface_power = f.surface_power;
  result.overlap_ratio = view.max_overlap > 0 ? f.largest_overlap / view.max_overlap : 0;
}

void set_result(const PairView& view, const BallForce& force, PairResult& result) {
  const PairForce& f = force.force;
  result.active = true;
  result.contact_count = 1;
  result.force_a = f.force;
  result.torque_a = result.dissipative_torque_a = f.torque;
  result.torque_b = force.torque_b;
  result.dissipative_force_a = f.dissipative_force;
  result.dissipative_torque_b = force.torque_b;
  result.elastic = f.elastic;
  result.tangential_elastic = f.tangential_elastic;
  result.surface_power = 0;
  result.overlap_ratio = view.max_overlap > 0 ? f.largest_overlap * (1 / view.max_overlap) : 0;
}

void append_contacts(const BodyPair& pair, const PairView& view, const std::vector<ContactFeature>& features,
                     const std::vector<ContactOutput>& outputs, FrameContacts& out) {
  // In files the lower id is A; a wall may have the lower id, then everything is mirrored.
  const bool mirrored = pair.key.b < pair.key.a;
  const double side = mirrored ? -1 : 1;
  for (std::size_t j = 0; j < features.size(); ++j) {
    const ContactFeature& f = features[j];
    out.body_a.push_back(std::min(pair.key.a, pair.key.b));
    out.body_b.push_back(std::max(pair.key.a, pair.key.b));
    // the zone of a wall is part of the key: two faces of a box touch the same corner
    out.feature.push_back(f.key + (pair.key.zone < 0 ? 0 : pair.key.zone));
    out.point.push_back(view.a.x + rotate(view.a.q, f.x));
    out.normal.push_back(side * rotate(view.a.q, outputs[j].normal));
    out.overlap.push_back(f.overlap);
    out.margin.push_back(view.max_overlap);
    out.normal_force.push_back(outputs[j].normal_force);
    out.tangential_force.push_back(side * rotate(view.a.q, outputs[j].tangential_force));
  }
}

}  // namespace scree
