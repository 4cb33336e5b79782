#include "decomposer/cut/compare_cuts.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>

#include "core/base/error.hpp"
#include "core/geometry/triangle_mesh.hpp"
#include "core/placing/random_numbers.hpp"
#include "core/surface/touch_surface.hpp"

namespace scree {

namespace {

// What the solver sends of a ghost in a step: position, velocity, angular velocity and orientation.
constexpr double kBytesPerGhost = 13 * sizeof(double);
constexpr double kSmallMotion = 0.01;  // of the radius

/// Which boxes a ball may touch, without looking at all of them: boxes by the cells of a coarse grid.
class BoxGrid {
 public:
  explicit BoxGrid(const std::vector<Box3>& boxes) : boxes_(boxes) {
    for (const Box3& b : boxes) {
      if (!b.is_empty()) all_.add(b);
    }
    per_axis_ = std::max(1, static_cast<int>(2 * std::cbrt(static_cast<double>(boxes.size()))));
    cells_.resize(static_cast<std::size_t>(per_axis_) * static_cast<std::size_t>(per_axis_) * static_cast<std::size_t>(per_axis_));
    for (std::size_t part = 0; part < boxes.size(); ++part) {
      if (boxes[part].is_empty()) continue;
      for_each_cell(boxes[part], [&](std::vector<int>& cell) { cell.push_back(static_cast<int>(part)); });
    }
    seen_.assign(boxes.size(), -1);
  }

  /// Calls visit(part) once for every box within `reach` of a point.
  template <class Visit>
  void for_each_near(const Vec3& x, double reach, std::int64_t stamp, Visit&& visit) {
    const Box3 ball{x - Vec3{reach, reach, reach}, x + Vec3{reach, reach, reach}};
    for_each_cell(ball, [&](std::vector<int>& cell) {
      for (const int part : cell) {
        const auto p = static_cast<std::size_t>(part);
        if (seen_[p] == stamp) continue;
        seen_[p] = stamp;
        const Vec3 nearest = component_min(component_max(x, boxes_[p].lower), boxes_[p].upper);
        if (squared_length(x - nearest) < reach * reach) visit(part);
      }
    });
  }

 private:
  template <class Visit>
  void for_each_cell(const Box3& box, Visit&& visit) {
    int low[3], high[3];
    for (int k = 0; k < 3; ++k) {
      const double extent = all_.upper[k] - all_.lower[k];
      const double scale = extent > 0 ? per_axis_ / extent : 0;
      low[k] = std::clamp(static_cast<int>((box.lower[k] - all_.lower[k]) * scale), 0, per_axis_ - 1);
      high[k] = std::clamp(static_cast<int>((box.upper[k] - all_.lower[k]) * scale), 0, per_axis_ - 1);
    }
    for (int x = low[0]; x <= high[0]; ++x)
      for (int y = low[1]; y <= high[1]; ++y)
        for (int z = low[2]; z <= high[2]; ++z) {
          visit(cells_[static_cast<std::size_t>((x * per_axis_ + y) * per_axis_ + z)]);
        }
  }

  const std::vector<Box3>& boxes_;
  Box3 all_;
  int per_axis_ = 1;
  std::vector<std::vector<int>> cells_;
  std::vector<std::int64_t> seen_;
};

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

  const auto count = static_cast<std::size_t>(parts);
  const double own_reach = common_margin(scene.settings) + 0.5 * skin;
  std::vector<double> work_of(count), bodies(count), ghosts(count), sent(count);
  std::vector<Box3> box(count);
  for (std::size_t i = 0; i < x.size(); ++i) {
    const auto p = static_cast<std::size_t>(part[i]);
    const double r = radius[i] + own_reach;
    work_of[p] += work[i];
    bodies[p] += 1;
    box[p].add(x[i] - Vec3{r, r, r});
    box[p].add(x[i] + Vec3{r, r, r});
  }
  BoxGrid grid(box);
  std::vector<std::vector<int>> neighbours(count);
  for (std::size_t i = 0; i < x.size(); ++i) {
    grid.for_each_near(x[i], radius[i] + own_reach, static_cast<std::int64_t>(i), [&](int other) {
      if (other == part[i]) return;
      ghosts[static_cast<std::size_t>(other)] += 1;
      sent[static_cast<std::size_t>(part[i])] += kBytesPerGhost;
      auto& known = neighbours[static_cast<std::size_t>(other)];
      if (std::find(known.begin(), known.end(), part[i]) == known.end()) known.push_back(part[i]);
    });
  }
  std::vector<double> neighbour_count;
  for (const auto& known : neighbours) neighbour_count.push_back(static_cast<double>(known.size()));
  m.imbalance = imbalance(work_of);
  mean_and_largest(bodies, m.bodies_mean, m.bodies_max);
  mean_and_largest(neighbour_count, m.neighbours_mean, m.neighbours_max);
  mean_and_largest(ghosts, m.ghosts_mean, m.ghosts_max);
  mean_and_largest(sent, m.bytes_mean, m.bytes_max);

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
