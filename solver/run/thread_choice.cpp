#include "solver/run/thread_choice.hpp"

#include <fmt/format.h>
#include <omp.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>

namespace scree {

namespace {

/// Threads that bodies keep busy, at least one.   in   is_ball   (i): whether body i is
template <class IsBall>
int threads_for(std::size_t bodies, int ranks, const IsBall& is_ball) {
  constexpr double kMax = 1e6;
  double meshes = 0, balls = 0;
  for (std::size_t i = 0; i < bodies; ++i) ++(is_ball(i) ? balls : meshes);
  return static_cast<int>(std::clamp(meshes / ranks / kMeshesPerThread + balls / ranks / kBallsPerThread, 1.0, kMax));
}

}  // namespace

int worthwhile_threads(const Scene& scene, int ranks) {
  return threads_for(scene.bodies.size(), ranks, [&](std::size_t i) {
    return scene.shapes[static_cast<std::size_t>(scene.bodies.shape[i])].kind == ShapeKind::sphere;
  });
}

void fit_threads(const Simulation& simulation, int most) {
  if (most <= 0) return;
  const RunState& s = simulation.state();
  const auto is_ball = [&](std::size_t i) { return s.scene.shape(s.particles.shape[i]).kind == ShapeKind::sphere; };
  omp_set_num_threads(std::min(most, threads_for(s.particles.owned, 1, is_ball)));
}

void fit_threads(const Scene& scene, int ranks, int most) {
  if (most > 0) omp_set_num_threads(std::min(most, worthwhile_threads(scene, ranks)));
}

CoreWatch::CoreWatch() : time_(std::chrono::steady_clock::now()), used_(thread_seconds()) {}

void CoreWatch::leave_out() {
  time_ = std::chrono::steady_clock::now();
  used_ = thread_seconds();
}

void CoreWatch::take_in() {
  const auto time = time_;
  const double used = used_;
  leave_out();
  clock_ += std::chrono::duration<double>(time_ - time).count();
  computed_ += used_ - used;
}

std::string slowdown_text(double slowdown) {
  double load = 0;
  const std::string others =
      getloadavg(&load, 1) == 1 ? fmt::format("; {:.0f} threads of this machine want its {} cores", load, omp_get_num_procs()) : "";
  return fmt::format(
      "steps take {:.0f} times as long as they compute: this process waits for cores that others have{}. {}", slowdown, others,
      omp_get_max_threads() > 1 ? "OMP_NUM_THREADS=1 waits least; the result is the same" : "A free machine computes the same faster");
}

void CoreWatch::report_once() {
  if (is_told_ || !(seconds() > kWorthWatching) || !(slowdown() > kSlowedDown)) return;
  is_told_ = true;
  std::fprintf(stderr, "scree-solver: note: %s\n", slowdown_text(slowdown()).c_str());
}

}  // namespace scree
