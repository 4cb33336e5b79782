// The first cut of a scene: what each body is expected to cost, and who owns it.
#pragma once

#include "core/partition/partition.hpp"
#include "core/storage/scene_file.hpp"

namespace scree {

/// Expected work of each body in one step, relative to the motion of a body that touches nothing.
///
/// How: motion, and half of each pair whose balls meet or, dearer, whose surfaces touch, as the scene stands. A contact patch of a body
/// with C corners and edges sees about sqrt(C) of them. Walls are left out. The solver measures the true work and cuts again when it differs.
/// Fails: throws InputError when a body is wider than half a period, which the solver refuses too.   Cost: a distance for each pair of near bodies.
std::vector<double> predicted_work(const Scene& scene);

/// Fills scene.partition and bodies.owner. Collective over MPI_COMM_SELF only: MPI must be started.
/// in   work   of each body
void partition_scene(Scene& scene, const std::vector<double>& work, int ranks, CutMethod method = CutMethod::rcb);

}  // namespace scree
