#include "solver/pairs/squeezed.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>
#include <vector>

#include "core/base/index.hpp"
#include "core/base/units.hpp"
#include "core/distance/mesh_distance.hpp"

namespace scree {

namespace {

/// A zone of a wall that a body touches.
struct Touched {
  std::int32_t zone, body;  ///< row of the body
};

/// The place of a wall that is nearest to a point, world axes.
Vec3 nearest_of_zone(const PairPass& pass, const WallZone& zone, const Vec3& point) {
  const WallState& state = pass.walls[at(zone.wall)];
  const Vec3 p = rotate_inverse(state.orientation, point - state.position);
  Vec3 nearest;
  if (zone.kind == WallZone::Kind::mesh) {
    const double scale = pass.scene.source().walls[at(zone.wall)].scale;
    const SolverShape& shape = pass.scene.wall_shape(zone.wall);
    std::int32_t triangle = -1;
    point_mesh_distance({&shape.mesh, &shape.bvh}, (1 / scale) * p, 1e300, nearest, triangle);
    nearest = scale * nearest;
  } else {
    Vec3 normal;
    const double gap = zone_gap(zone, p, normal);
    nearest = p - gap * normal;
  }
  return state.position + rotate(state.orientation, nearest);
}

}  // namespace

std::string squeezed_between_walls(const PairPass& pass, std::int32_t k) {
  const Scene& scene = pass.scene.source();
  const BodyPair& pressed = pass.list.stored_pairs()[at(k)];
  std::vector<Touched> touched;
  for (const std::int32_t n : pass.list.with_walls()) {
    const BodyPair& pair = pass.list.stored_pairs()[at(n)];
    if (pair.a != pressed.a && !(pressed.b >= 0 && pair.a == pressed.b)) continue;
    if (n == k || pass.list.stored_results()[at(n)].active) touched.push_back({pair.key.zone, pair.a});
  }
  const auto wall_of = [&](const Touched& t) { return pass.scene.zones()[at(t.zone)].wall; };
  const auto moves = [&](const Touched& t) { return scene.walls[at(wall_of(t))].motion.moves(); };
  // the wall that moves first; of a body and a wall, this wall is one of the two
  const Touched *driven = nullptr, *other = nullptr;
  double gap_between = 0;
  for (const Touched& first : touched) {
    if (!moves(first)) continue;
    for (const Touched& second : touched) {
      if (wall_of(first) == wall_of(second)) continue;
      if (pressed.b < 0 && pressed.key.zone != first.zone && pressed.key.zone != second.zone) continue;
      const Vec3 across = nearest_of_zone(pass, pass.scene.zones()[at(first.zone)], pass.p.x[at(first.body)]) -
                          nearest_of_zone(pass, pass.scene.zones()[at(second.zone)], pass.p.x[at(second.body)]);
      if (driven != nullptr && !(length(across) < gap_between)) continue;
      driven = &first;
      other = &second;
      gap_between = length(across);
    }
  }
  if (driven == nullptr) return "";
  const auto size_of = [&](std::int32_t row) {
    return 2 * pass.p.scale[at(row)] * pass.scene.shape(pass.p.shape[at(row)]).equivalent_radius;
  };
  const bool two = pressed.b >= 0;
  return fmt::format(
      "{} squeezed between wall '{}', which moves, and wall '{}'{}: they are {} apart there, and {} measures {} (the ball of its volume). "
      "No stiffness holds against a wall that is driven: leave a gap that bodies fit through, or that is closed to them; or move the "
      "wall by a torque or a force (motor, servo), which stops{}",
      two ? "they are" : "it is", scene.walls[at(wall_of(*driven))].name, scene.walls[at(wall_of(*other))].name,
      moves(*other) ? ", which moves too" : "", format_quantity(gap_between, Dimension::length), two ? "the first" : "the body",
      format_quantity(size_of(pressed.a), Dimension::length),
      pass.continues ? "" : "; or set contact.on_overlap = \"continue\", with a doubtful result");
}

}  // namespace scree
