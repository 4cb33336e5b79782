#include "decomposer/cut/compare_cuts.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>

#include "core/base/error.hpp"
#include "core/geometry/triangle_mesh.hpp"
#include "core/partition/part_counts.hpp"
#include "core/placing/random_numbers.hpp"
#include "core/surface/touch_surface.hpp"

namespace scree {

namespace {

constexpr double kSmallMotion = 0.01;  // of the radius

std::vector<int> parts_of(const Partitioner& partitioner, const Scene& scene, const std::vector<Vec3>& x) {
  std::vector<int> parts(x.size());
  for (std::size_t i = 0; i < x.size(); ++i) parts[i] = partitioner.part_of(scene.bodies.id[i], x[i]);
  return parts;
}

void mean_and_largest(const std::vector<double>& values, double& mean, double& largest) {
  mean = largest = 0;
  for (const double v : values) {
    mean += v / static_cast<double>(values.size());
    largest = std::max(largest, v);
  }
}

}  // namespace

std::vector<double> bounding_radii(const Scene& scene) {
  std::vector<double> of_shape, radii;
  for (const Shape& shape : scene.shapes) of_shape.push_back(bounding_radius(shape.mesh) + shape.sphere_radius);
  for (std::size_t i = 0; i < scene.bodies.size(); ++i) {
    radii.push_back(scene.bodies.scale[i] * of_shape[static_cast<std::size_t>(scene.bodies.shape[i])]);
  }
  return radii;
}

CutMeasures measure_cut(const Scene& scene, const std::vector<double>& work, CutMethod method, int parts, double skin) {
  const std::vector<double> radius = bounding_radii(scene);
  const std::vector<Vec3>& x = scene.bodies.position;
  CutMeasures m;
  m.method = method;
  m.parts = parts;
  const auto start = std::chrono::steady_clock::now();
  Partitioner partitioner(MPI_COMM_SELF, parts, method);
  partitioner.cut(scene.bodies.id, x, work);
  m.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  const std::vector<int> part = parts_of(partitioner, scene, x);

  std::vector<double> reach = radius;
  for (double& r : reach) r += common_margin(scene.settings) + 0.5 * skin;
  const PartCounts counts = count_parts(part, x, reach, work, parts);
  m.imbalance = imbalance(counts.work);
  mean_and_largest(counts.bodies, m.bodies_mean, m.bodies_max);
  mean_and_largest(counts.neighbours, m.neighbours_mean, m.neighbours_max);
  mean_and_largest(counts.ghosts, m.ghosts_mean, m.ghosts_max);
  mean_and_largest(counts.sent, m.bytes_mean, m.bytes_max);

  // Cut again after a small motion. The motion is made twice: a scene of equal tiles has several equally good first cuts, any other
  // only one.
  std::vector<Vec3> moving = x;
  std::vector<int> before, after;
  for (const std::uint64_t motion : {0, 1}) {
    for (std::size_t i = 0; i < moving.size(); ++i) {
      const RandomNumbers random(scene.settings.seed, scene.bodies.id[i], motion);
      moving[i] += rotate(random.orientation(0), Vec3{kSmallMotion * radius[i], 0, 0});
    }
    partitioner.cut(scene.bodies.id, moving, work);
    before = std::move(after);
    after = parts_of(partitioner, scene, moving);
  }
  for (std::size_t i = 0; i < x.size(); ++i) m.moved += before[i] == after[i] ? 0 : 1;
  m.moved /= std::max<double>(1, static_cast<double>(x.size()));
  return m;
}

std::string cut_table(const std::vector<CutMeasures>& cuts) {
  std::string text =
      "cut,parts,imbalance,bodies_mean,bodies_max,neighbours_mean,neighbours_max,ghosts_mean,ghosts_max,bytes_mean,bytes_max,moved,"
      "seconds\n";
  for (const CutMeasures& m : cuts) {
    text += fmt::format("{},{},{:.4f},{:.1f},{:.0f},{:.2f},{:.0f},{:.1f},{:.0f},{:.0f},{:.0f},{:.5f},{:.3f}\n", cut_method_name(m.method),
                        m.parts, m.imbalance, m.bodies_mean, m.bodies_max, m.neighbours_mean, m.neighbours_max, m.ghosts_mean, m.ghosts_max,
                        m.bytes_mean, m.bytes_max, m.moved, m.seconds);
  }
  return text;
}

}  // namespace scree
