#include "decomposer/placements.hpp"

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

void add_draw(const Case& c, const SceneParts& parts, const Draw& d, const PlacedBody& body, BodyTable& b) {
  const CasePopulation& p = c.populations[d.population];
  b.shape.push_back(parts.scene_shape[static_cast<std::size_t>(d.shape)]);
  b.material.push_back(p.material);
  b.scale.push_back(body.scale);
  b.position.push_back(body.position);
  b.orientation.push_back(body.orientation);
  b.velocity.push_back(p.velocity);
  b.angular_velocity.push_back(p.angular_velocity);
  b.fixed.push_back(0);
  b.lock_rotation.push_back(0);
  b.population.push_back(static_cast<std::int32_t>(d.population));
}

}  // namespace

void add_placed(const Case& c, const SceneParts& parts, const Placements& placements, Scene& scene) {
  auto id = static_cast<std::int64_t>(c.bodies.size() + c.walls.size());
  for (std::size_t i = 0; i < parts.draws.size(); ++i) {
    if (placements.is_placed[i] == 0) continue;
    scene.bodies.id.push_back(id++);
    add_draw(c, parts, parts.draws[i], placements.body[i], scene.bodies);
  }
}

Scene stage_scene(const Case& c, const SceneParts& parts, const Scene& so_far, const Placements& placements,
                  const std::vector<std::uint8_t>& moves, const std::vector<Vec3>& velocity, const std::vector<Vec3>& angular_velocity,
                  std::vector<std::int64_t>& draw_of_body) {
  Scene scene = so_far;
  for (Wall& wall : scene.walls) wall.motion = {};
  BodyTable& b = scene.bodies;
  for (std::size_t i = 0; i < b.size(); ++i) {
    b.fixed[i] = 1;
    b.velocity[i] = b.angular_velocity[i] = {};
  }
  draw_of_body.assign(b.size(), -1);
  for (std::size_t i = 0; i < parts.draws.size(); ++i) {
    if (placements.is_placed[i] == 0) continue;
    b.id.push_back(parts.draws[i].id);
    add_draw(c, parts, parts.draws[i], placements.body[i], b);
    b.fixed.back() = moves[i] != 0 ? 0 : 1;
    b.velocity.back() = moves[i] != 0 ? velocity[i] : Vec3{};
    b.angular_velocity.back() = moves[i] != 0 ? angular_velocity[i] : Vec3{};
    draw_of_body.push_back(static_cast<std::int64_t>(i));
  }
  // only what the stage ends with is looked at
  scene.settings.output_contacts = false;
  scene.settings.checkpoint_every = 0;
  scene.settings.stop_at_rest = false;
  return scene;
}

}  // namespace scree
