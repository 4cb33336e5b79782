// The reference of every search: the distance of every triangle of one mesh from every triangle of the other.
#pragma once

#include <algorithm>
#include <array>
#include <vector>

#include "core/distance/mesh_distance.hpp"
#include "tests/benchmarks/distance/methods/kept_pairs.hpp"

namespace scree {

/// All pairs in double precision, by the exact kernel, without any search: sorted by (a, b).
class AllPairs {
 public:
  /// Pairs below the margin and intersecting ones; `least` is the smallest distance of all.
  std::vector<ClosePair> below(const MeshView& a, const MeshView& b, const Placement& b_in_a, double margin, double& least) {
    const std::int32_t count = b.mesh->triangle_count();
    const std::int64_t padded = (count + kBatchPadding - 1) / kBatchPadding * kBatchPadding;
    const std::int64_t stride = padded % 512 == 0 ? padded + kBatchPadding : padded;
    values_.assign(static_cast<std::size_t>(18 * stride), 0.0);
    distance_.resize(static_cast<std::size_t>(padded));
    const auto row = [&](int r) { return values_.begin() + r * stride; };
    for (std::int32_t t = 0; t < count; ++t)
      for (int k = 0; k < 3; ++k) {
        const Vec3 p = b_in_a.scale * (b_in_a.rotation * b.mesh->corner(t, k)) + b_in_a.translation;
        for (int c = 0; c < 3; ++c) *(row(9 + 3 * k + c) + t) = p[c];
      }
    std::vector<ClosePair> close;
    least = 1e308;
    for (std::int32_t t = 0; t < a.mesh->triangle_count(); ++t) {
      for (int r = 0; r < 9; ++r) std::fill(row(r), row(r) + padded, a.mesh->corner(t, r / 3)[r % 3]);
      triangle_distances(PairBatch<double>{values_.data(), stride, count}, distance_.data());
      for (std::int32_t u = 0; u < count; ++u) {
        const double d = distance_[static_cast<std::size_t>(u)];
        least = std::min(least, d);
        if (d < margin || d == 0) close.push_back({{t, u}, d});
      }
    }
    return close;
  }

  /// The same, in a tenth of the time or less: every pair is still looked at, one by one, but by its bounding balls first. The
  /// kernel need not see those that are farther apart than the margin and than some other pair.
  std::vector<ClosePair> below_by_balls(const MeshView& a, const MeshView& b, const Placement& b_in_a, double margin, double& least) {
    constexpr double kBallRounding = 1e-9;  // of any length here: far above the rounding of centres and radii
    const auto balls_of = [](const TriangleMesh& mesh, const Placement& placed, Balls& balls) {
      balls.resize(static_cast<std::size_t>(mesh.triangle_count()));
      for (std::int32_t t = 0; t < mesh.triangle_count(); ++t) {
        Vec3 corner[3], sum;
        for (int k = 0; k < 3; ++k) {
          corner[k] = placed.scale * (placed.rotation * mesh.corner(t, k)) + placed.translation;
          sum += corner[k];
        }
        const Vec3 centre = (1.0 / 3) * sum;
        double radius = 0;
        for (const Vec3& p : corner) radius = std::max(radius, length(p - centre));
        const auto i = static_cast<std::size_t>(t);
        balls.x[i] = centre.x, balls.y[i] = centre.y, balls.z[i] = centre.z, balls.radius[i] = radius * (1 + kBallRounding);
      }
    };
    balls_of(*a.mesh, {}, balls_a_);
    balls_of(*b.mesh, b_in_a, balls_b_);
    const std::int32_t count = b.mesh->triangle_count();
    near_.resize(static_cast<std::size_t>(count));
    values_.resize(static_cast<std::size_t>(18 * kBlock));
    distance_.resize(static_cast<std::size_t>(std::max<std::int64_t>(kBlock, static_cast<std::int64_t>(distance_.size()))));
    std::vector<ClosePair> close;
    std::array<std::int32_t, kBlock> with;
    least = 1e308;
    for (std::int32_t t = 0; t < a.mesh->triangle_count(); ++t) {
      const auto i = static_cast<std::size_t>(t);
      const double x = balls_a_.x[i], y = balls_a_.y[i], z = balls_a_.z[i];
      // least is 1e308 to begin with
      const double reach = balls_a_.radius[i] + std::min(std::max(margin, least), 1e100) * (1 + kBallRounding) + kBallRounding;
      std::size_t found = 0;
      for (std::size_t u = 0; u < static_cast<std::size_t>(count); ++u) {
        const double dx = balls_b_.x[u] - x, dy = balls_b_.y[u] - y, dz = balls_b_.z[u] - z, s = reach + balls_b_.radius[u];
        near_[found] = static_cast<std::int32_t>(u);
        found += dx * dx + dy * dy + dz * dz <= s * s ? 1 : 0;
      }
      for (std::size_t begin = 0; begin < found; begin += kBlock) {
        const std::size_t size = std::min<std::size_t>(kBlock, found - begin);
        for (std::size_t k = 0; k < size; ++k) {
          with[k] = near_[begin + k];
          for (int c = 0; c < 9; ++c) values_[static_cast<std::size_t>(c) * kBlock + k] = a.mesh->corner(t, c / 3)[c % 3];
          for (int corner = 0; corner < 3; ++corner) {
            const Vec3 p = b_in_a.scale * (b_in_a.rotation * b.mesh->corner(with[k], corner)) + b_in_a.translation;
            for (int c = 0; c < 3; ++c) values_[static_cast<std::size_t>(9 + 3 * corner + c) * kBlock + k] = p[c];
          }
        }
        triangle_distances(PairBatch<double>{values_.data(), kBlock, static_cast<std::int64_t>(size)}, distance_.data());
        for (std::size_t k = 0; k < size; ++k) {
          least = std::min(least, distance_[k]);
          if (distance_[k] < margin || distance_[k] == 0) close.push_back({{t, with[k]}, distance_[k]});
        }
      }
    }
    return close;
  }

 private:
  static constexpr std::int64_t kBlock = 64 + kBatchPadding;
  struct Balls {
    std::vector<double> x, y, z, radius;
    void resize(std::size_t size) {
      for (auto* v : {&x, &y, &z, &radius}) v->resize(size);
    }
  };
  std::vector<double> values_, distance_;
  Balls balls_a_, balls_b_;
  std::vector<std::int32_t> near_;
};

/// How many pairs of the reference a search missed, and how many it made up. A pair whose distance is within `rounding`
/// of the margin may go either way: placing a corner rounds differently in a vector than in a scalar.
inline std::int64_t count_differences(std::vector<ClosePair> found, const std::vector<ClosePair>& reference, double margin,
                                      double rounding) {
  const auto before = [](const ClosePair& l, const ClosePair& r) {
    return l.pair.a != r.pair.a ? l.pair.a < r.pair.a : l.pair.b < r.pair.b;
  };
  std::sort(found.begin(), found.end(), before);
  std::int64_t differences = 0;
  const auto note = [&](const ClosePair& p) { differences += p.distance < margin - rounding || (p.distance == 0 && margin > 0); };
  auto f = found.begin();
  for (const ClosePair& r : reference) {
    for (; f != found.end() && before(*f, r); ++f) note(*f);
    if (f != found.end() && f->pair == r.pair) {
      differences += std::abs(f->distance - r.distance) > rounding;
      ++f;
    } else {
      note(r);
    }
  }
  for (; f != found.end(); ++f) note(*f);
  return differences;
}

}  // namespace scree
