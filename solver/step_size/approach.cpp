#include "solver/step_size/approach.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "solver/bodies/particle_set.hpp"
#include "solver/features/pass_through.hpp"

namespace scree {

namespace {

struct Mover {
  std::int64_t id;
  PairBody body;
  Vec3 v, w;
  double radius, arm;
};

Mover mover_of(const SolverScene& scene, std::size_t b) {
  const ParticleRecord r = initial_record(scene, b);
  const SolverShape& shape = scene.shape(r.shape);
  return {r.id, {&shape, r.scale, r.x, r.q}, r.v, r.w, r.scale * shape.radius, r.scale * shape.turning_arm};
}

/// No point of the surface moves faster along the surface's normal [m/s].
double surface_speed(const Mover& m) { return length(m.v) + m.arm * length(m.w); }

/// Speed at which the gap of two bodies shrinks while `small` moves with `velocity` against the frame of `large`.
double closing_speed(const PairBody& large, const PairBody& small, const Vec3& velocity, double margin, MeshDistanceScratch& scratch) {
  const double speed = length(velocity);
  if (!(speed > 0)) return 0;
  const Vec3 offset = small.x - large.x;
  if (large.shape->kind == ShapeKind::sphere && small.shape->kind == ShapeKind::sphere)
    return std::max(0.0, -dot(velocity, normalised(offset)));
  // the distance now and a little later: far above its rounding, far below what curves a path
  constexpr double kLittle = 1e-3;  // of the margin
  const double far = 2 * (length(offset) + large.scale * large.shape->radius + small.scale * small.shape->radius);
  PairBody later = small;
  later.x += (kLittle * margin / speed) * velocity;
  TrianglePair nearest{-1, -1};
  const double now = surface_distance(large, small, far, scratch, nearest), then = surface_distance(large, later, far, scratch, nearest);
  return now > 0 ? std::clamp((now - then) / (kLittle * margin), 0.0, 1.0) * speed : speed;
}

double approach_of(const Mover& i, const Mover& j, const SolverScene& scene, MeshDistanceScratch& scratch) {
  const double reach = i.radius + j.radius + 2 * scene.contact_range();
  const Vec3 offset = scene.periodicity().nearest(j.body.x - i.body.x), velocity = i.v - j.v;
  if (squared_length(offset) >= reach * reach) {
    const double along = dot(velocity, offset), speed = length(velocity);
    if (!(along > 0)) return 0;
    const double beside = squared_length(offset) - along * along / (speed * speed);
    return beside < reach * reach ? speed + i.arm * length(i.w) + j.arm * length(j.w) : 0.0;
  }
  // in the frame of the larger body, which turns under the other one
  const bool j_is_large = j.radius > i.radius;
  const Mover &large = j_is_large ? j : i, &small = j_is_large ? i : j;
  PairBody frame = large.body;
  frame.x = j_is_large ? i.body.x + offset : i.body.x;
  PairBody other = small.body;
  other.x = j_is_large ? i.body.x : i.body.x + offset;
  const Vec3 against = small.v - large.v - cross(large.w, other.x - frame.x);
  const double closing =
      closing_speed(frame, other, against, 0.5 * scene.smallest_max_overlap(), scratch) + small.arm * length(small.w - large.w);
  return std::min(closing, surface_speed(i) + surface_speed(j));
}

/// Inside a round wall: the speed across it where a straight path ends. `r` and `u` are place and velocity from the centre or axis.
double speed_across(const Vec3& r, const Vec3& u, double room) {
  const double speed = length(u), end = std::max(length(r), room);
  if (!(speed > 0) || !(end > 0)) return 0;
  const double aside = length(cross(r, u)) / (speed * end);
  return speed * std::sqrt(std::max(0.0, 1 - aside * aside));
}

/// Looks ahead from p along u, both in the frame of a mesh wall: how fast the nearest surface within `reach` comes closer.
double speed_towards(const SolverShape& wall, double scale, const Vec3& p, const Vec3& u, double reach) {
  constexpr double kStride = 0.25;  // of the reach, where a surface is near
  const double speed = length(u), end = length(p) + scale * wall.radius;
  if (!(speed > 0)) return 0;
  const Vec3 ahead = (1 / speed) * u;
  double fastest = 0, gone = 0;
  for (int look = 0; look < kMaxLooks && gone <= end; ++look) {
    const Vec3 x = p + gone * ahead;
    Vec3 foot;
    std::int32_t triangle = -1;
    const double distance = scale * point_mesh_distance({&wall.mesh, &wall.bvh}, (1 / scale) * x, 1e300, foot, triangle);
    if (!(distance > 0)) return speed;
    if (distance < reach) fastest = std::max(fastest, dot(u, (1 / distance) * (scale * foot - x)));
    gone += std::max(distance - reach, kStride * reach);
  }
  return fastest;
}

double approach_of(const Mover& i, const WallZone& zone, const Wall& wall, const WallState& state, const SolverScene& scene, double least) {
  const Vec3 place = i.body.x - state.position;
  const Vec3 velocity = i.v - state.velocity - cross(state.angular_velocity, place);
  const double spin = i.arm * length(i.w - state.angular_velocity), reach = i.radius + 2 * scene.contact_range();
  if (length(velocity) + spin <= least) return 0;
  const Vec3 p = rotate_inverse(state.orientation, place), u = rotate_inverse(state.orientation, velocity);
  double closing = 0;
  bool near = false;
  switch (zone.kind) {
    case WallZone::Kind::plane:
      closing = -dot(u, zone.direction);
      near = dot(p - zone.point, zone.direction) < reach;
      break;
    case WallZone::Kind::cylinder:
    case WallZone::Kind::sphere: {
      const bool round = zone.kind == WallZone::Kind::cylinder;  // a sphere has no axis to leave out
      const auto across = [&](const Vec3& v) { return round ? v - dot(v, zone.direction) * zone.direction : v; };
      const Vec3 r = across(p - zone.point);
      closing = speed_across(r, across(u), zone.radius - i.radius);
      near = length(r) + reach > zone.radius;
      break;
    }
    case WallZone::Kind::mesh: {
      const SolverShape& shape = scene.wall_shape(zone.wall);
      Vec3 foot;
      std::int32_t triangle = -1;
      closing = speed_towards(shape, wall.scale, p, u, reach);
      near = wall.scale * point_mesh_distance({&shape.mesh, &shape.bvh}, (1 / wall.scale) * p, reach / wall.scale, foot, triangle) < reach;
      break;
    }
  }
  return near || closing > 0 ? std::max(closing, 0.0) + spin : 0.0;
}

}  // namespace

Approach fastest_approach(const SolverScene& scene, double least) {
  Approach best;
  double fastest = least;
  const auto found = [&](double speed, const auto& name) {
    if (!(speed > fastest)) return;
    fastest = best.speed = speed;
    best.who = name();
  };
  const BodyTable& bodies = scene.source().bodies;
  std::vector<Mover> movers;
  std::vector<double> speed;
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    movers.push_back(mover_of(scene, b));
    speed.push_back(surface_speed(movers[b]));
  }

  for (const WallZone& zone : scene.zones()) {
    const Wall& wall = scene.source().walls[static_cast<std::size_t>(zone.wall)];
    const WallState state = wall_state(wall, 0);
    for (std::size_t b = 0; b < bodies.size(); ++b) {
      if (bodies.fixed[b] || (!scene.has_driven_walls() && speed[b] <= fastest)) continue;
      found(approach_of(movers[b], zone, wall, state, scene, fastest),
            [&] { return fmt::format("body {} and wall {} ('{}')", bodies.id[b], wall.id, wall.name); });
    }
  }

  std::vector<std::size_t> order(bodies.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::sort(order.begin(), order.end(),
            [&](std::size_t l, std::size_t r) { return speed[l] != speed[r] ? speed[l] > speed[r] : bodies.id[l] < bodies.id[r]; });
  const MeshDistanceScratchPtr scratch = make_mesh_distance_scratch();
  std::int64_t pairs = 0;
  for (std::size_t i = 0; i < order.size(); ++i) {
    const std::size_t a = order[i];
    for (std::size_t j = i + 1; j < order.size() && speed[a] + speed[order[j]] > fastest; ++j) {
      const std::size_t b = order[j];
      const bool is_last = ++pairs > kMaxPairs;
      found(is_last ? speed[a] + speed[b] : approach_of(movers[a], movers[b], scene, *scratch),
            [&] { return fmt::format("bodies {} and {}", std::min(bodies.id[a], bodies.id[b]), std::max(bodies.id[a], bodies.id[b])); });
      if (is_last) return best;
    }
  }
  return best;
}

}  // namespace scree
