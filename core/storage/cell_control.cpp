// What a periodic cell that deforms does not go with.
#include <algorithm>
#include <array>
#include <cmath>

#include "core/storage/scene.hpp"

namespace scree {

namespace {

/// Of the length of the cell: a plane lies at its end. What the same number in two units differs by is far below.
constexpr double kAtSide = 1e-9;

/// Components that change the cell along z, or shear it across z.
constexpr std::array kWithZ = {2, 3, 4};

bool is_along_z(const Vec3& normal) { return normal.x == 0 && normal.y == 0; }

}  // namespace

CellBlocker cell_blocker(const Settings& s) {
  const auto& periodic = s.domain.periodic;
  if (!s.domain.bounded || !periodic[0] || !periodic[1])
    return {"domain",
            "the cell is the domain, periodic along x, y and z, or along x and y between two planes; give domain.min, domain.max and "
            "periodic = [\"x\", \"y\", \"z\"]"};
  for (const int k : kWithZ) {
    constexpr const char* kStays = "the domain is not periodic along z: its length there stays, and it has no other shear than xy";
    if (!periodic[2] && s.cell && s.cell->by_rate(k)) return {"cell.strain_rate", kStays};
    if (!periodic[2] && s.cell && s.cell->by_stress(k)) return {"cell.stress", kStays};
  }
  if (s.domain.outside == Outside::remove) return {"domain.outside", "no body can leave it; leave outside out"};
  if (!(s.gravity == Vec3{})) return {"gravity", "nothing holds up what is in it; write gravity = [0, 0, 0]"};
  if (s.sleep) return {"time.sleep", "what sleeps would not go with the cell; leave sleep out"};
  if (s.stop_at_rest) return {"time.stop_at_rest", "rest is told by falls, and nothing falls; use cell.stop_when"};
  if (s.stop_when_empty) return {"time.stop_when_empty", "no body can leave it; leave stop_when_empty out"};
  if (s.step_control == StepControl::quantised) return {"time.step_control", "the cell moves by steps of one length; use \"fixed\""};
  if (s.integrator == Integrator::euler) return {"motion.integrator", "euler has no middle of a step to deform in; use another one"};
  if (s.fluid) return {"fluid", "a fluid does not go with the cell; leave [fluid] out"};
  if (s.heat) return {"heat", "the work of the cell is not part of the heat balance; leave [heat] out"};
  if (s.output_impacts) return {"output.impacts", "what contacts lose is counted by the velocities of bodies alone; leave impacts out"};
  return {};
}

const char* cell_blocker(const Domain& cell, const Wall& wall) {
  if (cell.periodic[2]) return "walls do not deform with it; leave them out";
  if (wall.kind != WallKind::plane || wall.motion.moves() || wall.surface.moves() || wall.motion.drive() || !is_along_z(wall.normal))
    return "walls do not deform with it, but for planes across z that stand still; leave others out";
  const double side = wall.normal.z > 0 ? cell.lower.z : cell.upper.z;
  if (!(std::abs(wall.point.z - side) <= kAtSide * (cell.upper.z - cell.lower.z)))
    return "its planes lie at both ends of the domain along z, with normals towards each other; move the plane, or domain.min and max";
  return nullptr;
}

namespace {

/// Whether bodies rub on a wall of this material.
bool rubs(const Scene& scene, std::int32_t material) {
  const std::vector<std::int32_t>& of_bodies = scene.bodies.material;
  return std::any_of(scene.pairs.begin(), scene.pairs.end(), [&](const MaterialPair& pair) {
    if (pair.a != material && pair.b != material) return false;
    if (!(pair.friction > 0 || pair.rolling_friction > 0 || pair.torsional_friction > 0)) return false;
    return std::find(of_bodies.begin(), of_bodies.end(), pair.a == material ? pair.b : pair.a) != of_bodies.end();
  });
}

}  // namespace

CellBlocker cell_blocker(const Scene& scene) {
  if (const CellBlocker of_settings = cell_blocker(scene.settings); of_settings.key != nullptr) return of_settings;
  bool below = scene.settings.domain.periodic[2], above = below;
  for (const Wall& wall : scene.walls) {
    if (const char* why = cell_blocker(scene.settings.domain, wall)) return {"walls", why};
    if (rubs(scene, wall.material))
      return {"pairs",
              "bodies would rub on the planes, which do not move with it; give the planes a material of their own, without friction"};
    (wall.normal.z > 0 ? below : above) = true;
  }
  if (!below || !above)
    return {"domain",
            "it is not periodic along z, and no plane holds the bodies at one end; give two walls of kind plane, at domain.min and max"};
  if (scene.settings.cell && scene.settings.cell->any_by_stress() && scene.bodies.size() < 2)
    return {"cell.stress", "a single body withstands none; use cell.strain_rate"};
  if (!scene.inlets.empty()) return {"inlets", "the momentum of all bodies together must stay 0; leave them out"};
  if (!scene.outlets.empty()) return {"outlets", "the momentum of all bodies together must stay 0; leave them out"};
  if (!scene.forces.empty()) return {"bodies.force", "the momentum of all bodies together must stay 0; leave it out"};
  if (!scene.bonds.empty()) return {"bonds", "forces of bonds are not part of the stress that it measures; leave them out"};
  const std::vector<std::uint8_t>& fixed = scene.bodies.fixed;
  if (std::any_of(fixed.begin(), fixed.end(), [](std::uint8_t f) { return f != 0; }))
    return {"bodies.fixed", "a fixed body would not go with it; leave fixed out"};
  return {};
}

}  // namespace scree
