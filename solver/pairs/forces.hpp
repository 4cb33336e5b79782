// Distances, features and forces of a list of pairs: the heart of a step.
#pragma once

#include <span>
#include <string>

#include "core/storage/contact_limits.hpp"
#include "core/storage/frame_file.hpp"
#include "solver/neighbours/pair_list.hpp"
#include "solver/pairs/deep_contacts.hpp"
#include "solver/pairs/pair_observer.hpp"
#include "solver/ranks/exact_sum.hpp"

namespace scree {

/// Scratch memory of each thread, and of a step whose pairs are timed.
struct ForceScratch {
  std::vector<MeshDistanceScratchPtr> distance;  ///< one per thread
  std::vector<float> pair_seconds;               ///< when not empty, one per pair: evaluate_pairs fills in what each took
  /// One per thread where necks or bridges may form: evaluate_pairs adds the energy that goes as they do, of the pairs counted here [J].
  std::vector<ExactSum> released;
  /// One per thread where contacts go on beyond their maximum overlap: evaluate_pairs appends those that do, of the pairs counted here.
  std::vector<std::vector<DeepContact>> deep;
  ForceScratch();
};

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
