#include "decomposer/packing/placements.hpp"

#include <algorithm>
#include <utility>

#include "core/storage/wall_state.hpp"

namespace scree {

Placements::Placements(const SceneParts& parts) : is_placed(parts.draws.size(), 0) {
  for (const Draw& d : parts.draws) body.push_back({&parts.shape(d.shape), d.scale, {}, {}});
}

std::size_t Placements::count_placed(const SceneParts& parts, std::size_t population) const {
  std::size_t count = 0;
  for (std::size_t i = 0; i < body.size(); ++i) count += parts.draws[i].population == population ? is_placed[i] : 0;
  return count;
}

double Placements::volume_placed(const SceneParts& parts, std::size_t population) const {
  double volume = 0;
  for (std::size_t i = 0; i < body.size(); ++i) {
    if (parts.draws[i].population == population && is_placed[i] != 0) volume += parts.draws[i].volume;
  }
  return volume;
}

namespace {

BodyRow row_of(const Case& c, const SceneParts& parts, const Draw& d, const PlacedBody& body) {
  const CasePopulation& p = c.populations[d.population];
  BodyRow row;
  row.shape = parts.scene_shape[static_cast<std::size_t>(d.shape)];
  row.material = p.material;
  row.scale = body.scale;
  row.position = body.position;
  row.orientation = body.orientation;
  row.velocity = p.velocity;
  row.angular_velocity = p.angular_velocity;
  row.population = static_cast<std::int32_t>(d.population);
  row.temperature = p.temperature;
  row.heat_source = p.heat_source;
  row.heat_table = p.heat_table;
  return row;
}

/// Place of a point on the curve of G. M. Morton (1966) through a box: those near each other are mostly near each other on it.
std::uint64_t place_on_curve(const Vec3& x, const Box3& box) {
  constexpr int kBits = 20;  // of each coordinate
  const Vec3 e = box.extent();
  const double longest = std::max({e.x, e.y, e.z}), cells = longest > 0 ? ((1 << kBits) - 1) / longest : 0;
  std::uint64_t place = 0;
  for (int axis = 0; axis < 3; ++axis) {
    const auto cell = static_cast<std::uint64_t>(cells * (x[axis] - box.lower[axis]));
    for (int bit = 0; bit < kBits; ++bit) place |= ((cell >> bit) & 1) << (3 * bit + axis);
  }
  return place;
}

/// The placed draws: populations one after the other, those of a lattice as drawn, others along the curve.
std::vector<std::size_t> draws_by_place(const Case& c, const SceneParts& parts, const Placements& placements) {
  std::vector<std::size_t> order;
  Box3 box;
  for (std::size_t i = 0; i < parts.draws.size(); ++i) {
    if (placements.is_placed[i] == 0) continue;
    order.push_back(i);
    box.add(placements.body[i].position);
  }
  std::vector<std::uint64_t> place(parts.draws.size(), 0);
  for (const std::size_t i : order) {
    if (c.populations[parts.draws[i].population].method != PackingMethod::lattice)
      place[i] = place_on_curve(placements.body[i].position, box);
  }
  std::stable_sort(order.begin(), order.end(), [&](std::size_t i, std::size_t j) {
    return std::pair(parts.draws[i].population, place[i]) < std::pair(parts.draws[j].population, place[j]);
  });
  return order;
}

}  // namespace

void add_placed(const Case& c, const SceneParts& parts, const Placements& placements, Scene& scene) {
  auto id = parts.first_id + static_cast<std::int64_t>(c.bodies.size() + c.walls.size());
  for (const std::size_t i : draws_by_place(c, parts, placements)) {
    BodyRow row = row_of(c, parts, parts.draws[i], placements.body[i]);
    row.id = id++;
    scene.bodies.add(row);
  }
}

Scene stage_scene(const Case& c, const SceneParts& parts, const Scene& so_far, const Placements& placements,
                  const std::vector<std::uint8_t>& moves, const std::vector<Vec3>& velocity, const std::vector<Vec3>& angular_velocity,
                  std::vector<std::int64_t>& draw_of_body) {
  Scene scene = so_far;
  for (Wall& wall : scene.walls) wall = wall_at_start(wall);
  BodyTable& b = scene.bodies;
  for (std::size_t i = 0; i < b.size(); ++i) {
    b.fixed[i] = 1;
    b.velocity[i] = b.angular_velocity[i] = {};
  }
  draw_of_body.assign(b.size(), -1);
  const std::vector<std::size_t> order = draws_by_place(c, parts, placements);
  std::vector<std::int64_t> ids;
  for (const std::size_t i : order) ids.push_back(parts.draws[i].id);
  std::sort(ids.begin(), ids.end());
  for (std::size_t n = 0; n < order.size(); ++n) {
    const std::size_t i = order[n];
    BodyRow row = row_of(c, parts, parts.draws[i], placements.body[i]);
    row.id = ids[n];
    row.fixed = moves[i] == 0;
    row.velocity = row.fixed ? Vec3{} : velocity[i];
    row.angular_velocity = row.fixed ? Vec3{} : angular_velocity[i];
    b.add(row);
    draw_of_body.push_back(static_cast<std::int64_t>(i));
  }
  scene.inlets.clear();
  scene.outlets.clear();
  scene.settings.fluid.reset();  // packings are made in a void, and without heat
  scene.settings.heat.reset();
  // only what the stage ends with is looked at
  scene.settings.output_contacts = false;
  scene.settings.checkpoint_every = 0;
  scene.settings.stop_at_rest = false;
  scene.settings.sleep = false;  // of the run; a packing does not depend on it
  return scene;
}

}  // namespace scree
