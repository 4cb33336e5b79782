// A contact as what bonds hold together feels it: on one side a fragment, a body, or a wall.
#pragma once

#include <cstdint>
#include <tuple>
#include <utility>

#include "core/base/index.hpp"
#include "solver/bodies/particle_set.hpp"

namespace scree {

/// One side of a contact as a whole: a fragment, a body, or a wall, which does not move. World axes.
struct FragmentSide {
  std::int64_t kind = 0, id = 0;  ///< 0 fragment, 1 body, 2 wall
  double inverse_mass = 0;        ///< [1/kg]
  Mat3 inverse_inertia;           ///< about its centre [1/(kg m^2)]
  Vec3 from_centre;               ///< of the body from the centre of its fragment [m]; of a body or a wall 0
  Vec3 force, torque;             ///< about its centre
  std::tuple<std::int64_t, std::int64_t> name() const { return {kind, id}; }
};

/// in   force, torque   on the body in that row, about its own centre, world axes
inline FragmentSide side_of(const ParticleSet& p, std::size_t row, const Vec3& force, const Vec3& torque) {
  const Mat3 r = matrix_of(p.q[row]);
  const auto turned = [&r](const Mat3& m) { return r * m * transpose(r); };
  FragmentSide side;
  side.force = force;
  if (const BondedMass* bonded = p.bonded[row]; bonded != nullptr) {
    side.id = bonded->fragment;
    side.inverse_mass = bonded->inverse_mass;
    side.inverse_inertia = turned(bonded->inverse_inertia);
    side.from_centre = -(r * bonded->centre);
    side.torque = torque + cross(side.from_centre, force);
    return side;
  }
  side.kind = 1;
  side.id = p.id[row];
  side.inverse_mass = p.inverse_mass[row];
  const Vec3& w = p.inverse_inertia[row];
  side.inverse_inertia = turned(Mat3{{Vec3{w.x, 0, 0}, Vec3{0, w.y, 0}, Vec3{0, 0, w.z}}});
  side.torque = torque;
  return side;
}

/// All zones of a wall are one partner.
inline FragmentSide side_of_wall(std::int64_t wall, const Vec3& force) {
  FragmentSide side;
  side.kind = 2;
  side.id = wall;
  side.force = force;
  return side;
}

/// Inverse mass that a wrench about the centre of a side moves, times the square of its force [N^2/kg].
inline double mobility_of(const FragmentSide& like, const Vec3& force, const Vec3& torque) {
  return like.inverse_mass * squared_length(force) + dot(torque, like.inverse_inertia * torque);
}

}  // namespace scree
