#include "decomposer/packing/placements.hpp"

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
  return row;
}

}  // namespace

void add_placed(const Case& c, const SceneParts& parts, const Placements& placements, Scene& scene) {
  auto id = parts.first_id + static_cast<std::int64_t>(c.bodies.size() + c.walls.size());
  for (std::size_t i = 0; i < parts.draws.size(); ++i) {
    if (placements.is_placed[i] == 0) continue;
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
  for (std::size_t i = 0; i < parts.draws.size(); ++i) {
    if (placements.is_placed[i] == 0) continue;
    BodyRow row = row_of(c, parts, parts.draws[i], placements.body[i]);
    row.id = parts.draws[i].id;
    row.fixed = moves[i] == 0;
    row.velocity = row.fixed ? Vec3{} : velocity[i];
    row.angular_velocity = row.fixed ? Vec3{} : angular_velocity[i];
    b.add(row);
    draw_of_body.push_back(static_cast<std::int64_t>(i));
  }
  scene.inlets.clear();
  scene.outlets.clear();
  scene.settings.fluid.reset();  // packings are made in a void
  // only what the stage ends with is looked at
  scene.settings.output_contacts = false;
  scene.settings.checkpoint_every = 0;
  scene.settings.stop_at_rest = false;
  scene.settings.sleep = false;  // of the run; a packing does not depend on it
  return scene;
}

}  // namespace scree
