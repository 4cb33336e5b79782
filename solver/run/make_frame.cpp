#include "solver/run/make_frame.hpp"

#include "solver/scene/origin.hpp"
#include "solver/step/impacts.hpp"
#include "solver/step/wall_loads.hpp"

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

/// The same for each column of SCREE_FRAME_LOADS.
struct ComputedOfTriangle {
  const Wall& of;
  std::int32_t number;
  const TriangleLoad& load;
  std::int64_t wall() const { return of.id; }
  std::int32_t triangle() const { return number; }
  Vec3 impulse() const { return {load[kImpulseX].value(), load[kImpulseY].value(), load[kImpulseZ].value()}; }
  double sliding_work() const { return load[kSlidingWork].value(); }
  double damping_work() const { return load[kDampingWork].value(); }
  double contacts() const { return load[kContacts].value(); }
  double impact_energy() const { return load[kImpactEnergy].value(); }
};

void add_frame_loads(const SolverScene& scene, const LoadMap& map, FrameLoads& loads) {
  for (std::size_t w = 0; w < scene.source().walls.size(); ++w) {
    const std::int32_t first = scene.first_mapped(w);
    if (first < 0) continue;
    const Wall& wall = scene.source().walls[w];
    for (std::int32_t t = 0; t < scene.shape(wall.shape).mesh.triangle_count(); ++t) {
      const ComputedOfTriangle computed{wall, t, map.triangles[static_cast<std::size_t>(first + t)]};
#define SCREE_FILL_COMPUTED(type, name, path, unit, csv, uses, what) loads.name.push_back(computed.name());
      SCREE_FRAME_LOADS(SCREE_FILL_COMPUTED)
#undef SCREE_FILL_COMPUTED
    }
  }
}

void add_frame_impacts(const SolverScene& scene, const ImpactTotals& totals, Frame& frame) {
  const std::size_t materials = scene.source().materials.size();
  for (std::size_t b = 0; b < materials; ++b) {
    for (std::size_t a = 0; a <= b; ++a) {
      const MaterialPairTotals& of = totals.pairs[material_pair(a, b)];
      FrameLosses& losses = frame.losses;
      losses.material_a.push_back(static_cast<std::int32_t>(a));
      losses.material_b.push_back(static_cast<std::int32_t>(b));
      losses.damping.push_back(of.lost[kDampingLoss].value());
      losses.friction.push_back(of.lost[kFrictionLoss].value());
      losses.rolling.push_back(of.lost[kRollingLoss].value());
      for (std::size_t k = 0; k < kImpactBins; ++k) {
        const ImpactBin& bin = of.bins[k];
        if (bin.count[kNormalImpact] == 0 && bin.count[kShearImpact] == 0) continue;
        FrameImpacts& impacts = frame.impacts;
        impacts.material_a.push_back(static_cast<std::int32_t>(a));
        impacts.material_b.push_back(static_cast<std::int32_t>(b));
        impacts.energy_from.push_back(impact_bin_end(k));
        impacts.energy_to.push_back(impact_bin_end(k + 1));
        impacts.normal_count.push_back(bin.count[kNormalImpact]);
        impacts.normal_energy.push_back(bin.energy[kNormalImpact].value());
        impacts.shear_count.push_back(bin.count[kShearImpact]);
        impacts.shear_energy.push_back(bin.energy[kShearImpact].value());
      }
    }
  }
}

/// The same for each column of SCREE_FRAME_WEAR.
struct ComputedOfVertex {
  const Wall& of;
  const Vec3& place;
  std::int64_t wall() const { return of.id; }
  Vec3 vertex() const { return place; }
};

void add_frame_wear(const SolverScene& scene, const WearState& state, FrameWear& wear) {
  for (std::size_t w = 0; w < scene.source().walls.size(); ++w) {
    const std::int32_t first = scene.first_worn(w);
    if (first < 0) continue;
    const Wall& wall = scene.source().walls[w];
    for (std::int32_t v = 0; v < scene.shape(wall.shape).mesh.vertex_count(); ++v) {
      const ComputedOfVertex computed{wall, state.vertices[static_cast<std::size_t>(first + v)]};
#define SCREE_FILL_COMPUTED(type, name, path, unit, csv, uses, what) wear.name.push_back(computed.name());
      SCREE_FRAME_WEAR(SCREE_FILL_COMPUTED)
#undef SCREE_FILL_COMPUTED
    }
  }
}

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
  frame.potential = energies.potential;
  frame.elastic = energies.elastic + energies.tangential_elastic;
  frame.dissipated = energies.dissipated;
  const ParticleSet& p = simulation.state().particles;
  for (std::size_t i = 0; i < p.owned; ++i) add_frame_body(simulation.state().scene, record_of(p, i), rank, origin, frame.bodies);
  if (with_contacts) frame.contacts = simulation.contacts();
  for (Vec3& point : frame.contacts.point) point += origin;
  if (const auto& bonds = simulation.state().bonds) {
    frame.has_bonds = true;
    for (std::size_t k = 0; k < bonds->listed().size(); ++k) {
      const ListedBond& bond = bonds->listed()[k];
      if (bonds->is_broken(bond) || !bonds->counts_here(bond, p)) continue;
      const BondForce& force = bonds->forces()[k];
      frame.bonds.bond.push_back(bond.bond);
      frame.bonds.force.push_back(force.force_a);
      frame.bonds.energy.push_back(force.energy);
      frame.bonds.load.push_back(bond_load(bonds->table()[static_cast<std::size_t>(bond.bond)], force));
    }
  }
  std::vector<WallLoad> loads = wall_loads_of(simulation.state());
  std::vector<WallState> walls = simulation.state().walls;
  move_loads_to_world(loads, walls, origin);
  for (std::size_t w = 0; w < loads.size(); ++w) {
    const ComputedOfWall computed{simulation.state().scene.source().walls[w], simulation.state().walls[w], loads[w], origin};
#define SCREE_FILL_COMPUTED(type, name, path, unit, csv, uses, what) frame.walls.name.push_back(computed.name());
    SCREE_FRAME_WALLS(SCREE_FILL_COMPUTED)
#undef SCREE_FILL_COMPUTED
  }
  if (simulation.state().scene.mapped_triangles() > 0) {
    const LoadMap map = loads_now(simulation.state());
    if (rank == 0) add_frame_loads(simulation.state().scene, map, frame.loads);
  }
  if (simulation.state().scene.source().settings.output_impacts) {
    const ImpactTotals totals = impacts_now(simulation.state());
    if (rank == 0) add_frame_impacts(simulation.state().scene, totals, frame);
  }
  if (rank == 0) add_frame_wear(simulation.state().scene, simulation.state().totals.wear, frame.wear);
  return frame;
}

}  // namespace scree
