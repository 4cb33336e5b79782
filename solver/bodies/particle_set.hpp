// Bodies of one rank: owned first, ghosts after them. Every column is a line of body_columns.hpp.
//
// Hot state (x, q and their remainders, v, L, w) is read and written every step; accumulators (force, torque) are written by the gather and
// read by the kick; cold facts never change. Orientation is that of the principal frame: body_from_principal of the shape is applied at
// load and undone at output.
#pragma once

#include <omp.h>

#include <algorithm>
#include <cstdint>
#include <vector>

#include "solver/bodies/body_columns.hpp"
#include "solver/bodies/cell.hpp"
#include "solver/scene/solver_scene.hpp"

namespace scree {

/// What a contact moves on a body that bonds hold to others: the whole fragment. In the body's principal axes, origin at its centre.
struct BondedMass {
  double inverse_mass = 0;  ///< [1/kg]
  Vec3 centre;              ///< of mass [m]
  Mat3 inverse_inertia;     ///< about it [1/(kg m^2)]
  std::int32_t fragment = -1;
};

/// Rows [begin, end).
struct RowRun {
  std::size_t begin, end;
};

struct ParticleSet {
#define SCREE_COLUMN_STATE(type, name, dataset, unit, uses, what) std::vector<type> name;
#define SCREE_COLUMN_DERIVED(type, name, what) std::vector<type> name;
  SCREE_BODY_STATE(SCREE_COLUMN_STATE)
  SCREE_BODY_DERIVED(SCREE_COLUMN_DERIVED)
#undef SCREE_COLUMN_STATE
#undef SCREE_COLUMN_DERIVED

  std::size_t owned = 0;  ///< rows [0, owned) are ours
  Cell cell;              ///< that they lie in, the same on every rank
  /// Of every row the fragment that it is part of, null where it is none; empty in a scene without bonds (neighbours/fragment_masses.hpp).
  std::vector<const BondedMass*> bonded;
  /// Where bodies may sleep (effects/sleep/sleep.hpp): the owned rows that are awake, in ascending order. Else all are, and this is empty.
  std::vector<RowRun> awake;
  bool may_sleep = false;

  std::size_t size() const { return id.size(); }
  std::size_t ghost_count() const { return size() - owned; }
  std::size_t row_bytes() const;  ///< of all columns together
  void resize(std::size_t count);
  void copy_row(std::size_t from, std::size_t to);
};

/// The state of a body as it travels between ranks and into checkpoints.
struct ParticleRecord {
#define SCREE_COLUMN_STATE(type, name, dataset, unit, uses, what) type name;
  SCREE_BODY_STATE(SCREE_COLUMN_STATE)
#undef SCREE_COLUMN_STATE
};

/// A column of the state, for what goes over all of them.
template <class T>
struct BodyColumn {
  using Value = T;
  const char* name;
  const char* dataset;
  const char* unit;
  unsigned uses;
  std::vector<T> ParticleSet::*column;
  T ParticleRecord::*field;
};

/// Calls action(BodyColumn) for every column of the state, in the order of the table.
template <class Action>
constexpr void for_each_body_column(Action&& action) {
#define SCREE_COLUMN_STATE(type, name, dataset, unit, uses, what) \
  action(BodyColumn<type>{#name, dataset, unit, uses, &ParticleSet::name, &ParticleRecord::name});
  SCREE_BODY_STATE(SCREE_COLUMN_STATE)
#undef SCREE_COLUMN_STATE
}

ParticleRecord record_of(const ParticleSet& p, std::size_t i);
/// Mass of a body as its row has it, to the bit [kg].
double body_mass(const SolverScene& scene, std::int32_t shape, std::int32_t material, double scale);
/// Appends a row; mass, inertia and radius follow from shape, scale and material.
void append_record(ParticleSet& p, const ParticleRecord& record, const SolverScene& scene);

/// Calls action(begin, end) with the share of the calling thread in the owned rows that are awake, run by run. In a parallel region.
template <class Action>
void for_awake_rows_of_thread(const ParticleSet& p, Action&& action) {
  const auto thread = static_cast<std::size_t>(omp_get_thread_num()), threads = static_cast<std::size_t>(omp_get_num_threads());
  if (!p.may_sleep) return action(p.owned * thread / threads, p.owned * (thread + 1) / threads);
  std::size_t count = 0, before = 0;
  for (const RowRun& run : p.awake) count += run.end - run.begin;
  const std::size_t first = count * thread / threads, last = count * (thread + 1) / threads;
  for (const RowRun& run : p.awake) {
    const std::size_t size = run.end - run.begin, begin = std::max(first, before), end = std::min(last, before + size);
    if (begin < end) action(run.begin + begin - before, run.begin + end - before);
    before += size;
  }
}

/// Calls action(row) for each owned row that is awake, by all threads.
template <class Action>
void for_each_awake_row(const ParticleSet& p, Action&& action) {
#pragma omp parallel
  for_awake_rows_of_thread(p, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) action(i);
  });
}

/// Wraps the owned bodies into their cell, the places of their lists with them.
void wrap_positions(ParticleSet& p);

/// A body as a user knows it.
struct BodyAtStart {
  std::int64_t id;
  std::int32_t shape, material;
  bool fixed, lock_rotation;
  double scale;
  Vec3 position;
  Quat orientation;  ///< mesh to world
  Vec3 velocity, angular_velocity;
  double temperature = 0;  ///< [K], of scenes with heat
};
/// Its record: orientation moved to the principal frame, L from w, wrapped into periodic axes.
ParticleRecord make_record(const SolverScene& scene, const BodyAtStart& body);
/// The record of body b of a scene at the start.
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
