#include "solver/step_size/bond_stiffness.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/base/index.hpp"
#include "solver/bodies/motion.hpp"

namespace scree {

PairStiffness linearise(const BondList& bonds, const ListedBond& bond, const ParticleSet& p) {
  PairStiffness result;
  const Bond& of = bonds.table()[at(bond.bond)];
  result.key = {of.a, of.b, kBondZone};
  result.a = bond.a;
  result.b = bond.b;
  const std::size_t a = at(bond.a), b = at(bond.b);
  const auto mode = [&](const Vec3& force, const Vec3& torque) {
    const Vec3 fa = rotate(bond.law.frame_a, force), fb = -rotate(bond.law.frame_b, force);
    const Vec3 ta = cross(bond.law.arm_a, fa) + rotate(bond.law.frame_a, torque);
    const Vec3 tb = cross(bond.law.arm_b, fb) - rotate(bond.law.frame_b, torque);
    const double ma = std::sqrt(p.inverse_mass[a]), mb = std::sqrt(p.inverse_mass[b]);
    std::array<double, 12> m{};
    for (int k = 0; k < 3; ++k) {
      const auto n = static_cast<std::size_t>(k);
      m[n] = ma * fa[k];
      m[3 + n] = std::sqrt(p.inverse_inertia[a][k]) * ta[k];
      m[6 + n] = mb * fb[k];
      m[9 + n] = std::sqrt(p.inverse_inertia[b][k]) * tb[k];
    }
    return m;
  };
  for (int k = 0; k < 3; ++k) {
    Vec3 unit;
    unit[k] = 1;
    result.add_mode(bond.law.push[k], bond.law.push_damping[k], mode(unit, {}));
    result.add_mode(bond.law.turn[k], bond.law.turn_damping[k], mode({}, unit));
  }
  return result;
}

CriticalStep critical_step_of_bonds(const SolverScene& scene) {
  if (scene.source().bonds.empty()) return {};
  ParticleSet p;
  BondList bonds(scene);
  const BodyTable& bodies = scene.source().bodies;
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    if (std::binary_search(bonds.bodies().begin(), bonds.bodies().end(), bodies.id[b])) append_record(p, initial_record(scene, b), scene);
  }
  p.owned = p.size();
  bonds.list(p);
  StabilityBound bound(p.size());
  for (const ListedBond& bond : bonds.listed()) bound.add(linearise(bonds, bond, p));
  return bound.critical_step(false);
}

}  // namespace scree
