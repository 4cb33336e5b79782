// Two bodies near contact, and how they move: poses and paths shared by the benchmark and the tests of kept lists.
#pragma once

#include <cmath>
#include <string>
#include <vector>

#include "core/distance/mesh_distance.hpp"
#include "tests/distance/rocks.hpp"

namespace scree {

/// A shape and its tree, kept at one place.
struct BenchShape {
  TriangleMesh mesh;
  Bvh bvh;
  explicit BenchShape(TriangleMesh m) : mesh(std::move(m)), bvh(build_bvh(mesh)) {}
  MeshView view() const { return {&mesh, &bvh}; }
};

/// How B moves against A, step by step, at about `speed` (of the radius) a step.
enum class Path { roll, spin, slide, jitter, tumble };
inline const std::vector<std::pair<std::string, Path>>& all_paths() {
  static const std::vector<std::pair<std::string, Path>> paths = {
      {"roll", Path::roll}, {"spin", Path::spin}, {"slide", Path::slide}, {"jitter", Path::jitter}, {"tumble", Path::tumble}};
  return paths;
}

/// Poses of both bodies in the world. The gap is brought back to a part of the margin that swings in time, as in a
/// packing that shakes: A is pulled along the line of centres, by the distance of the meshes.
class Trajectory {
 public:
  Trajectory(const BenchShape& a, const BenchShape& b, double size_ratio, double margin, double speed, Path path, std::uint64_t seed)
      : a_(a), b_(b), margin_(margin), speed_(speed), path_(path), random_(seed), scratch_(make_mesh_distance_scratch()) {
    scale_b_ = size_ratio;
    q_a_ = random_.rotation();
    q_b_ = random_.rotation();
    x_a_ = 10.0 * random_.direction();
    axis_ = random_.direction();
    x_b_ = x_a_ + 1.3 * (1 + scale_b_) * random_.direction();
    close_gap(0.5 * margin_);
  }

  Placement placement() const { return relative_placement(x_a_, q_a_, 1, x_b_, q_b_, scale_b_); }

  /// One step. The gap stays between 0.1 and 1.5 margins, so that contacts come and go.
  void advance() {
    ++step_;
    const Vec3 between = x_b_ - x_a_, normal = normalised(between);
    const Vec3 side = normalised(cross(normal, axis_)), forward = cross(normal, side);
    const double small = std::min(1.0, scale_b_);
    switch (path_) {
      case Path::roll:  // both turn about parallel axes, so that the surfaces roll on one another
        turn(q_a_, side, speed_);
        turn(q_b_, side, -speed_ / scale_b_);
        break;
      case Path::spin:  // about its own centre, nothing else moves
        turn(q_b_, axis_, speed_ / scale_b_);
        return;
      case Path::slide:
        x_b_ += speed_ * forward;
        break;
      case Path::jitter:
        x_b_ += (0.3 * speed_ * random_.normal()) * random_.direction();
        turn(q_b_, random_.direction(), 0.3 * speed_ / scale_b_ * random_.normal());
        break;
      case Path::tumble:
        x_b_ += (0.5 * speed_) * forward;
        turn(q_a_, axis_, 0.5 * speed_);
        turn(q_b_, cross(axis_, normal), speed_ / scale_b_);
        break;
    }
    if (step_ % 8 == 0) close_gap((0.8 + 0.7 * std::sin(0.01 * step_)) * margin_ * small);
  }

 private:
  void turn(Quat& q, const Vec3& axis, double angle) { q = normalised(quaternion_of(axis, angle) * q); }

  /// Moves B along the line of centres until the surfaces are `gap` apart, at most by the speed a step; at first, all the way.
  void close_gap(double gap) {
    const int turns = step_ == 0 ? 30 : 1;
    for (int k = 0; k < turns; ++k) {
      const double d = mesh_distance(a_.view(), b_.view(), placement(), 1e308, *scratch_);
      double move = d - gap;
      if (d == 0) move = -0.1 * (1 + scale_b_);
      if (step_ > 0) move = std::clamp(move, -8 * speed_, 8 * speed_);
      x_b_ -= move * normalised(x_b_ - x_a_);
    }
  }

  const BenchShape &a_, &b_;
  double margin_, speed_, scale_b_;
  Path path_;
  Random random_;
  MeshDistanceScratchPtr scratch_;
  Quat q_a_, q_b_;
  Vec3 x_a_, x_b_, axis_;
  int step_ = 0;
};

}  // namespace scree
