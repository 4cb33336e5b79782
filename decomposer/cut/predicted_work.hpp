// The first cut of a scene: what each body is expected to cost, and which rank owns it.
#pragma once

#include "core/partition/partition.hpp"
#include "core/storage/scene_file.hpp"

namespace scree {

/// A pair of bodies that the solver will list: rows in the scene, and its work.
struct PairWork {
  std::int32_t a, b;
  double work;
};

struct PredictedWork {
  std::vector<double> of_body;  ///< of each body in one step, half of each of its pairs included
  std::vector<PairWork> pairs;
};

/// Expected work of the first steps, relative to the motion of a body that touches nothing.
///
/// How: motion, less for bodies with equal moments of inertia; half of each pair whose balls meet and, far dearer, whose surfaces touch;
/// contacts with walls; all as the scene stands. A contact patch of a body with C corners and edges sees about sqrt(C) of them.
/// What it is for: a first cut that saves the solver from cutting at once. Contacts that form later are not in it: the solver measures the
/// true work and cuts again when it differs.
/// Fails: throws InputError when a body is wider than half a period, which the solver refuses too.   Cost: a distance for each pair of near
/// bodies.
PredictedWork predicted_work(const Scene& scene);

/// Fills scene.partition and bodies.owner. Collective over MPI_COMM_SELF only: MPI must be started.
/// The predicted imbalance counts a pair across ranks for both, since both compute it.
void partition_scene(Scene& scene, const PredictedWork& work, int ranks, CutMethod method = CutMethod::rcb);

}  // namespace scree
