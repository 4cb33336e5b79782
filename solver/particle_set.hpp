// Bodies of one rank: owned first, ghosts after them.
//
// Hot state (x, q and their remainders, v, L, w) is read and written every step; accumulators (f, t) are written by the gather and
// read by the kick; cold facts never change. When a body changes rank everything of its row travels; a ghost
// refresh carries x, q, v, w only. Orientation is that of the principal frame: body_from_principal of the
// shape is applied at load and undone at output.
#pragma once

#include <cstdint>
#include <vector>

#include "solver/solver_scene.hpp"

namespace scree {

struct ParticleSet {
  // cold
  std::vector<std::int64_t> id;
  std::vector<std::int32_t> shape, material;
  std::vector<double> scale, radius;           ///< radius: bounding, scaled [m]
  std::vector<double> mass, inverse_mass;      ///< inverse 0 for a fixed body
  std::vector<Vec3> inertia, inverse_inertia;  ///< principal [kg m^2]; inverse 0 for fixed or locked bodies
  std::vector<std::uint8_t> fixed, lock_rotation, isotropic;
  // hot
  std::vector<Vec3> x;        ///< centre of mass, world [m]
  std::vector<Vec3> x_remainder;  ///< what rounding took from x, below one unit in its last place; the next drift adds it [m]
  std::vector<Quat> q;        ///< principal frame to world
  std::vector<Quat> q_remainder;  ///< the same of q
  std::vector<Vec3> v;        ///< [m/s]
  std::vector<Vec3> L;        ///< angular momentum about the centre, world [kg m^2/s]
  std::vector<Vec3> w;        ///< angular velocity, world [rad/s]; follows from q and L
  // accumulators
  std::vector<Vec3> force, torque;             ///< contact and gravity, world; torque about the centre
  std::vector<Vec3> lossy_force, lossy_torque; ///< the part from damping and friction
  std::vector<double> dissipated;              ///< energy taken from this body by damping and friction [J]
  std::vector<double> work;                    ///< measured work since the last cut, arbitrary unit
  std::vector<Vec3> x_listed;                  ///< centre when the body lists were made
  std::vector<Vec3> image;                     ///< periods gone along periodic axes, see Periodicity::wrap

  std::size_t owned = 0;                       ///< rows [0, owned) are ours

  std::size_t size() const { return id.size(); }
  std::size_t ghost_count() const { return size() - owned; }
  std::size_t row_bytes() const;               ///< of all columns together
  void resize(std::size_t count);
  void copy_row(std::size_t from, std::size_t to);
};

/// The row of a body as it travels between ranks and into checkpoints.
struct ParticleRecord {
  std::int64_t id;
  std::int32_t shape, material;
  std::uint8_t fixed, lock_rotation, unused[6];
  double scale;
  Vec3 x, x_remainder, v, L, w, force, torque, image;
  Quat q, q_remainder;
  double dissipated, work;
};

ParticleRecord record_of(const ParticleSet& p, std::size_t i);
/// Appends a row; mass, inertia and radius follow from shape, scale and material.
void append_record(ParticleSet& p, const ParticleRecord& record, const SolverScene& scene);

/// Wraps the owned bodies into a periodic domain, the places of their lists with them.
void wrap_positions(const Periodicity& periodicity, ParticleSet& p);

/// The record of body b of a scene at the start: orientation moved to the principal frame, L from w.
ParticleRecord initial_record(const SolverScene& scene, std::size_t body);

/// Mesh orientation of a body (what the user knows) from its principal orientation.
inline Quat mesh_orientation(const SolverScene& scene, std::int32_t shape, const Quat& q) {
  return q * conjugate(scene.shape(shape).body_from_principal);
}

/// Angular velocity [rad/s] of a body from its angular momentum.
inline Vec3 angular_velocity(const Quat& q, const Vec3& inverse_inertia, const Vec3& L) {
  const Vec3 l = rotate_inverse(q, L);
  return rotate(q, Vec3{l.x * inverse_inertia.x, l.y * inverse_inertia.y, l.z * inverse_inertia.z});
}

}  // namespace scree
