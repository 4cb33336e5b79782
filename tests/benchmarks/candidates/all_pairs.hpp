// The reference of every search: the distance of every triangle of one mesh from every triangle of the other.
#pragma once

#include <algorithm>
#include <vector>

#include "core/distance/kept_pairs.hpp"
#include "core/distance/mesh_distance.hpp"

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

 private:
  std::vector<double> values_, distance_;
};

/// How many pairs of the reference a search missed, and how many it made up. A pair whose distance is within `rounding`
/// of the margin may go either way: placing a corner rounds differently in a vector than in a scalar.
inline std::int64_t count_differences(std::vector<ClosePair> found, const std::vector<ClosePair>& reference, double margin, double rounding) {
  const auto before = [](const ClosePair& l, const ClosePair& r) { return l.pair.a != r.pair.a ? l.pair.a < r.pair.a : l.pair.b < r.pair.b; };
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
