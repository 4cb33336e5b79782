// Every column of a body, once. The structures of particle_set.hpp and what goes over them follow from this table: migration, ghosts,
// checkpoints, state_hash and verify. A new column is one line here, and the code that computes it.
//
//   column(type, name, dataset, unit, uses, what it is)
//
// name      of the member in ParticleSet and ParticleRecord
// dataset   its name in checkpoints (CHECKPOINT_FORMAT.md); old files keep their names
// uses      see BodyUse below
#pragma once

#include <cstdint>

#include "core/geometry/vec3.hpp"

namespace scree {

/// What besides migration and checkpoints, which take every column of the state, reads a column.
enum BodyUse : unsigned {
  kPlain = 0,
  kGhost = 1,         ///< sent to the ranks that hold a ghost of the body, in every step
  kHashed = 2,        ///< part of state_hash, in the order of the table
  kMeasured = 4,      ///< a time or a count of work: verify does not compare it
  kLater = 8,         ///< checkpoints of earlier versions lack it: it is 0 then
  kIfNotZero = 16,    ///< part of state_hash where it is not 0, after those with kHashed
  kOfHeatState = 32,  ///< of scenes with heat: checkpoints of others do not have it
};

/// In place of the number of looks: the body sleeps (effects/sleep/sleep.hpp).
inline constexpr std::int32_t kAsleep = -1;

}  // namespace scree

// clang-format off

/// The state: travels with the body to another rank and into checkpoints.
#define SCREE_BODY_STATE(column)                                                                                                              \
  column(std::int64_t, id, "id", "", kHashed, "global, never used again")                                                                     \
  column(std::int32_t, shape, "shape", "", kPlain, "index into the scene's shapes")                                                           \
  column(std::int32_t, material, "material", "", kPlain, "index into the scene's materials")                                                  \
  column(std::uint8_t, fixed, "fixed", "", kPlain, "never moves")                                                                             \
  column(std::uint8_t, lock_rotation, "lock_rotation", "", kPlain, "translates only")                                                         \
  column(double, scale, "scale", "", kPlain, "of the shape")                                                                                  \
  column(Vec3, x, "x", "m", kGhost | kHashed, "centre of mass, world")                                                                        \
  column(Vec3, x_remainder, "x_remainder", "m", kHashed, "what rounding took from x, below one unit in its last place; the next drift adds it") \
  column(Quat, q, "q_principal", "", kGhost | kHashed, "principal frame to world")                                                            \
  column(Quat, q_remainder, "q_remainder", "", kHashed, "the same of q")                                                                      \
  column(Vec3, v, "v", "m/s", kGhost | kHashed, "velocity")                                                                                   \
  column(Vec3, L, "L", "kg m^2/s", kHashed, "angular momentum about the centre, world")                                                       \
  column(Vec3, w, "w", "rad/s", kGhost, "angular velocity, world; follows from q and L")                                                      \
  column(Vec3, force, "force", "N", kPlain, "contact and gravity, world")                                                                     \
  column(Vec3, torque, "torque", "N m", kPlain, "about the centre, world")                                                                    \
  column(double, dissipated, "dissipated", "J", kPlain, "energy taken from this body by damping and friction")                                \
  column(double, work, "work", "", kMeasured, "measured work since the last cut, arbitrary unit")                                             \
  column(Vec3, image, "image", "", kPlain, "periods gone along periodic axes, see Periodicity::wrap")                                     \
  column(double, entered, "entered", "s", kLater, "when it came into the run; 0 for those that the scene starts with")                         \
  column(std::int32_t, rest, "rest", "", kGhost | kLater | kIfNotZero, "looks that found it at rest, one after the other; kAsleep: it sleeps") \
  column(double, temperature, "temperature", "K", kLater | kIfNotZero | kOfHeatState, "of the whole body (effects/heat)")                          \
  column(double, temperature_remainder, "temperature_remainder", "K", kLater | kIfNotZero | kOfHeatState, "what rounding took from it")

/// What follows from the state, the scene and the step: made again where the body arrives.
#define SCREE_BODY_DERIVED(column)                                                                           \
  column(double, radius, "bounding, scaled [m]")                                                             \
  column(double, ball_radius, "of an analytic sphere without cells and margin, scaled [m]; 0 of any other")  \
  column(double, equivalent_radius, "of the ball of its volume, scaled [m]")                                 \
  column(double, mass, "[kg]")                                                                               \
  column(double, inverse_mass, "[1/kg]; 0 for a fixed body")                                                 \
  column(Vec3, inertia, "principal [kg m^2]")                                                                \
  column(Vec3, inverse_inertia, "0 for fixed or locked bodies")                                              \
  column(std::uint8_t, isotropic, "all three principal moments equal")                                       \
  column(const double*, weights, "of the shape's corners at this scale, SolverScene::weights()")              \
  column(const double*, pull_weights, "the same of an attraction, SolverScene::pull_weights()")               \
  column(Vec3, dissipative_force, "the part of force from damping and friction [N]")                               \
  column(Vec3, dissipative_torque, "the same of torque [N m]")                                                     \
  column(Vec3, x_listed, "centre when the body lists were made [m]")

// clang-format on
