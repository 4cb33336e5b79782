// Where in a region the centre of a body may still lie, voxel by voxel: late in a packing nearly every place drawn
// at random lies in a body that is there already, and this map leaves those out before they cost anything.
//
// Two bodies cannot be closer than the largest balls about their centres that lie within their solids allow. A voxel
// is closed when that rule forbids every point of it, so that no place that is free is ever lost.
// Source of the idea: Brosilow, Ziff and Vigil (1991), Phys. Rev. A 43, 631 (random sequential adsorption on vacant
// cells).
#pragma once

#include <cstdint>
#include <vector>

#include "core/geometry/triangle_mesh.hpp"
#include "core/placing/random_numbers.hpp"

namespace scree {

class VacancyMap {
 public:
  /// in   box           where centres may lie [m]
  /// in   smallest_ball radius of the smallest inner ball that will be placed [m], 0 when unknown
  /// in   smallest_body bounding radius of the smallest body that will be placed [m], > 0
  VacancyMap(const Box3& box, double smallest_ball, double smallest_body);

  /// No centre may lie closer than `distance` to `centre` from now on. Cost: one visit per voxel in reach.
  void close(const Vec3& centre, double distance);

  bool is_full() const { return open_count_ == 0; }
  /// Share of the box that is open.
  double open_share() const { return static_cast<double>(open_count_) / static_cast<double>(open_.size()); }

  /// A point of the open voxels, uniform over them. Not to be called when the map is full.
  /// in   first    which of the random numbers choose the voxel: this one and those after it
  /// in   within   place in the voxel, components in [0, 1)
  Vec3 draw(const RandomNumbers& random, std::uint64_t first, const Vec3& within);

 private:
  std::size_t index(std::int64_t x, std::int64_t y, std::int64_t z) const {
    return static_cast<std::size_t>((z * count_[1] + y) * count_[0] + x);
  }
  Vec3 lower_, edge_;  // of the box; of one voxel
  std::int64_t count_[3];
  std::vector<std::uint8_t> open_;
  std::vector<std::uint32_t> list_;  // open voxels, and some closed since the list was made
  std::size_t open_count_;
};

}  // namespace scree
