#include "solver/run/thread_choice.hpp"

#include <fmt/format.h>
#include <omp.h>

#include <algorithm>
#include <cstdlib>

#include "core/base/error.hpp"

namespace scree {

namespace {

void take_threads(double meshes, double balls, int most) {
  if (most > 0) omp_set_num_threads(std::min(most, worthwhile_threads(meshes, balls)));
}

}  // namespace

int worthwhile_threads(double meshes, double balls) {
  constexpr double kMost = 1e6;
  return static_cast<int>(std::clamp(meshes / kMeshesPerThread + balls / kBallsPerThread, 1.0, kMost));
}

void fit_threads(const Simulation& simulation, int most) {
  const RunState& s = simulation.state();
  std::size_t balls = 0;
  for (std::size_t i = 0; i < s.particles.owned; ++i) balls += s.scene.shape(s.particles.shape[i]).kind == ShapeKind::sphere ? 1 : 0;
  take_threads(static_cast<double>(s.particles.owned - balls), static_cast<double>(balls), most);
}

void fit_threads(const Scene& scene, int ranks, int most) {
  double balls = 0;
  for (const std::int32_t shape : scene.bodies.shape)
    balls += scene.shapes[static_cast<std::size_t>(shape)].kind == ShapeKind::sphere ? 1 : 0;
  take_threads((static_cast<double>(scene.bodies.size()) - balls) / ranks, balls / ranks, most);
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

void warn_of_slowdown(const CoreWatch& cores) {
  if (cores.seconds() > kWorthWatching && cores.slowdown() > kSlowedDown) warn_once("scree-solver", slowdown_text(cores.slowdown()));
}

}  // namespace scree
