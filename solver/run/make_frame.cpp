#include "solver/run/make_frame.hpp"

#include "solver/scene/origin.hpp"

namespace scree {

namespace {

/// What no column of a body holds: one line for each `computed` of SCREE_FRAME_BODIES.
struct ComputedOfBody {
  const SolverScene& scene;
  const ParticleRecord& body;
  int owner;
  const Vec3& origin;
  std::int32_t rank() const { return owner; }
  Vec3 position() const { return body.x + origin; }
  Quat orientation() const { return mesh_orientation(scene, body.shape, body.q); }
};

/// The same for each column of SCREE_FRAME_WALLS.
struct ComputedOfWall {
  const Wall& wall;
  const WallState& state;
  const WallLoad& load;  ///< in the world
  const Vec3& origin;
  std::int64_t id() const { return wall.id; }
  Vec3 position() const { return wall_position_in_world(wall, state, origin); }
  Quat orientation() const { return state.orientation; }
  Vec3 force() const { return load.force; }
  Vec3 torque() const { return load.torque; }
};

}  // namespace

void add_frame_body(const SolverScene& scene, const ParticleRecord& body, int rank, const Vec3& origin, FrameBodies& bodies) {
  const ComputedOfBody computed{scene, body, rank, origin};
#define SCREE_FILL_STORED(type, name, member, path, unit, csv, uses, what) bodies.name.push_back(body.member);
#define SCREE_FILL_COMPUTED(type, name, path, unit, csv, uses, what) bodies.name.push_back(computed.name());
  SCREE_FRAME_BODIES(SCREE_FILL_STORED, SCREE_FILL_COMPUTED)
#undef SCREE_FILL_STORED
#undef SCREE_FILL_COMPUTED
}

Frame make_frame(Simulation& simulation, const Energies& energies, int rank, bool with_contacts, const Vec3& origin) {
  Frame frame;
  frame.step = simulation.step();
  frame.time = simulation.time();
  frame.kinetic = energies.translational + energies.rotational;
  frame.potential = energies.potential + potential_about_world(simulation.state(), origin);
  frame.elastic = energies.elastic + energies.tangential_elastic;
  frame.dissipated = energies.dissipated;
  const ParticleSet& p = simulation.state().particles;
  for (std::size_t i = 0; i < p.owned; ++i) add_frame_body(simulation.state().scene, record_of(p, i), rank, origin, frame.bodies);
  frame.bodies.has_temperature = simulation.state().scene.source().settings.heat.has_value();
  if (with_contacts) frame.contacts = simulation.contacts();
  for (Vec3& point : frame.contacts.point) point += origin;
  std::vector<WallLoad> loads = wall_loads_of(simulation.state());
  std::vector<WallState> walls = simulation.state().walls;
  move_loads_to_world(loads, walls, origin);
  for (std::size_t w = 0; w < loads.size(); ++w) {
    const ComputedOfWall computed{simulation.state().scene.source().walls[w], simulation.state().walls[w], loads[w], origin};
#define SCREE_FILL_COMPUTED(type, name, path, unit, csv, uses, what) frame.walls.name.push_back(computed.name());
    SCREE_FRAME_WALLS(SCREE_FILL_COMPUTED)
#undef SCREE_FILL_COMPUTED
  }
  for (const std::unique_ptr<Effect>& effect : simulation.state().effects) effect->add_frame(simulation.state(), frame);
  return frame;
}

}  // namespace scree
