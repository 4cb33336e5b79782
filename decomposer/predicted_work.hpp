// The first cut of a scene: what each body is expected to cost, and who owns it.
#pragma once

#include "core/partition/partition.hpp"
#include "core/storage/scene_file.hpp"

namespace scree {

/// Expected work of each body in one step, relative to an analytic sphere without neighbours.
///
/// How: a constant for motion and bookkeeping, plus what its contacts look at. A contact patch of a body with C
/// corners and edges sees about sqrt(C) of them. The solver measures the true work and cuts again when it differs.
std::vector<double> predicted_work(const Scene& scene);

/// Fills scene.partition and bodies.owner. Collective over MPI_COMM_SELF only: MPI must be started.
void partition_scene(Scene& scene, int ranks, CutMethod method = CutMethod::rcb);

}  // namespace scree
