// A scene in memory that runs on the ranks of the test, and sums over all its bodies.
#pragma once

#include <memory>
#include <utility>

#include "solver/run/measures.hpp"
#include "tests/support/scenes.hpp"

namespace scree::test {

inline mpi::Communicator* g_comm = nullptr;  // set by the main() of an MPI test

/// `scene` must be complete before start().
struct TestRun {
  Scene scene;
  std::unique_ptr<SolverScene> prepared;
  std::unique_ptr<Simulation> simulation;
  const mpi::Communicator& comm;
  explicit TestRun(Scene s, const mpi::Communicator& on = *g_comm) : scene(std::move(s)), comm(on) {}
  void start(const ParallelOptions& options = {}) {
    make(options);
    simulation->start_from_scene();
  }
  /// Without starting it.
  void make(const ParallelOptions& options = {}) {
    prepared = std::make_unique<SolverScene>(scene);
    simulation = std::make_unique<Simulation>(comm, *prepared, options);
  }
  template <class Get>
  Vec3 total(Get&& get) const {
    const ParticleSet& p = simulation->state().particles;
    Vec3 mine;
    for (std::size_t i = 0; i < p.owned; ++i) mine += get(p, i);
    return {comm.sum(mine.x), comm.sum(mine.y), comm.sum(mine.z)};
  }
  Vec3 velocity(std::int64_t id) const {
    return total([id](const ParticleSet& p, std::size_t i) { return p.id[i] == id ? p.v[i] : Vec3{}; });
  }
  Vec3 spin(std::int64_t id) const {
    return total([id](const ParticleSet& p, std::size_t i) { return p.id[i] == id ? p.w[i] : Vec3{}; });
  }
  Vec3 position(std::int64_t id) const {
    return total([id](const ParticleSet& p, std::size_t i) { return p.id[i] == id ? p.x[i] : Vec3{}; });
  }
  Vec3 momentum() const {
    return total([](const ParticleSet& p, std::size_t i) { return p.mass[i] * p.v[i]; });
  }
  Vec3 angular_momentum() const {
    return total([](const ParticleSet& p, std::size_t i) { return p.L[i] + cross(p.x[i], p.mass[i] * p.v[i]); });
  }
  void run_for(double duration) {
    const auto steps = static_cast<std::int64_t>(duration / simulation->state().clock.size.step);
    for (std::int64_t n = 0; n < steps; ++n) simulation->advance();
  }
};

}  // namespace scree::test
