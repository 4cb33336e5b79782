// Distances, features and forces of a list of pairs: the heart of a step.
#pragma once

#include <functional>
#include <span>

#include "solver/pairs/force_scratch.hpp"

namespace scree {

/// Evaluates the pairs named by `which` and fills their results. Rebuilds the candidate lists whose skin is used up.
///
/// in   dt        step of the run [s]
/// in   friction_dt  dt, or 0: friction springs stay as they are
/// Returns the largest overlap over its margin sum.
/// in   observers  are shown every contact
/// Throws RunInvalid naming both bodies when two meshes intersect, when they move so fast that they could have passed through each
/// other since the last step, or when the overlap passes kStopOverlapRatio.
/// Threads: parallel inside.   Ranks: local.
double evaluate_pairs(const SolverScene& scene, const ParticleSet& p, const std::vector<WallState>& walls,
                      std::span<const std::int32_t> which, double dt, double friction_dt, std::int64_t step, ForceScratch& scratch,
                      PairList& list, PairObservers observers = {});

/// The same of all pairs of a class, of a step; pairs of balls go in blocks where they can (neighbours/ball_blocks.hpp).
/// in   all   indices of the pairs of the class that are due
double evaluate_class(const SolverScene& scene, const ParticleSet& p, const std::vector<WallState>& walls, PairClass which,
                      std::span<const std::int32_t> all, double dt, double friction_dt, std::int64_t step, ForceScratch& scratch,
                      PairList& list, PairObservers observers = {});

/// Whether pairs of balls of a scene may lie in blocks.
bool may_use_blocks(const SolverScene& scene, const ParticleSet& p);

/// The same where all pairs of the class lie in blocks or wait for their place there, and scratch.ball_rows are those of the present
/// places; the columns of p that change in a step need not be.
/// in   due             of those that wait, all that may touch
/// in   write_columns   is called before pairs go the general path, which reads them
double evaluate_blocks(const SolverScene& scene, const ParticleSet& p, const std::vector<WallState>& walls, PairClass which,
                       const std::vector<std::int32_t>& due, double dt, std::int64_t step, ForceScratch& scratch, PairList& list,
                       const std::function<void()>& write_columns);

/// Results of pairs whose bodies are at rest: a function of where they are and of their springs, which stay as they are to the last bit.
/// Evaluated again, it gives the same bits.   Threads: parallel inside.   Ranks: local.
void evaluate_at_rest(const SolverScene& scene, const ParticleSet& p, const std::vector<WallState>& walls,
                      std::span<const std::int32_t> which, double dt, std::int64_t step, ForceScratch& scratch, PairList& list);

/// Shows every pair in contact to `visit`, one after another; changes neither springs nor results. Damping is shown
/// without its corrections for the step.
void visit_pairs(const SolverScene& scene, const ParticleSet& p, const std::vector<WallState>& walls, std::span<const std::int32_t> which,
                 std::int64_t step, ForceScratch& scratch, PairList& list, const PairVisitor& visit);

/// Appends the contacts of pairs as they stand in frames, of those that this rank counts: damping acts with the velocities that bodies
/// have now. Changes neither springs nor results.
void append_frame_contacts(const SolverScene& scene, const ParticleSet& p, const std::vector<WallState>& walls,
                           std::span<const std::int32_t> which, double dt, std::int64_t step, ForceScratch& scratch, PairList& list,
                           FrameContacts& contacts);

}  // namespace scree
