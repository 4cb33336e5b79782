#include "decomposer/packing/vacancy_map.hpp"

#include <algorithm>
#include <cmath>

namespace scree {

namespace {

// Finer voxels close more of what is closed, and cost more to close: a quarter of the ball loses a fifth of a radius.
constexpr double kVoxelShare = 0.25;
constexpr double kMaxVoxels = 1 << 24;  // 80 MB with the list

}  // namespace

VacancyMap::VacancyMap(const Box3& box, double smallest_ball, double smallest_body) : lower_(box.lower) {
  const Vec3 extent = box.extent();
  double size = kVoxelShare * std::max(smallest_ball, kVoxelShare * smallest_body);
  const auto voxels = [&] {
    double product = 1;
    for (int k = 0; k < 3; ++k) product *= std::max(1.0, std::ceil(extent[k] / size));
    return product;
  };
  while (voxels() > kMaxVoxels) size *= 1.1;
  for (int k = 0; k < 3; ++k) {
    count_[k] = static_cast<std::int64_t>(std::max(1.0, std::ceil(extent[k] / size)));
    edge_[k] = std::max(0.0, extent[k]) / static_cast<double>(count_[k]);
  }
  open_count_ = static_cast<std::size_t>(count_[0] * count_[1] * count_[2]);
  open_.assign(open_count_, 1);
}

void VacancyMap::close(const Vec3& centre, double distance) {
  constexpr double kRounding = 1e-9;  // of the distance: a place exactly at the limit stays open
  const double limit = distance * (1 - kRounding);
  if (!(limit > 0)) return;
  std::int64_t first[3], last[3];
  for (int k = 0; k < 3; ++k) {
    const auto voxel = [&](double x) {
      return edge_[k] > 0 ? std::floor(std::clamp((x - lower_[k]) / edge_[k], -1.0, static_cast<double>(count_[k]))) : 0.0;
    };
    first[k] = std::max<std::int64_t>(0, static_cast<std::int64_t>(voxel(centre[k] - limit)));
    last[k] = std::min<std::int64_t>(count_[k] - 1, static_cast<std::int64_t>(voxel(centre[k] + limit)));
  }
  // squared distance of the far side of a voxel along one axis
  const auto farthest2 = [&](int k, std::int64_t i) {
    const double low = lower_[k] + static_cast<double>(i) * edge_[k] - centre[k];
    const double far = std::max(std::abs(low), std::abs(low + edge_[k]));
    return far * far;
  };
  for (std::int64_t z = first[2]; z <= last[2]; ++z) {
    const double z2 = farthest2(2, z);
    for (std::int64_t y = first[1]; y <= last[1]; ++y) {
      const double yz2 = z2 + farthest2(1, y);
      if (yz2 >= limit * limit) continue;
      for (std::int64_t x = first[0]; x <= last[0]; ++x) {
        if (yz2 + farthest2(0, x) >= limit * limit) continue;
        std::uint8_t& cell = open_[index(x, y, z)];
        open_count_ -= cell;
        cell = 0;
      }
    }
  }
}

Vec3 VacancyMap::draw(const RandomNumbers& random, std::uint64_t first, const Vec3& within) {
  std::size_t voxel = 0;
  do {
    // made again whenever half of it has been closed: drawing from it costs two trials on average
    if (list_.empty() || 2 * open_count_ < list_.size()) {
      list_.clear();
      for (std::size_t i = 0; i < open_.size(); ++i) {
        if (open_[i] != 0) list_.push_back(static_cast<std::uint32_t>(i));
      }
    }
    voxel = list_[static_cast<std::size_t>(random.uniform(first++) * static_cast<double>(list_.size()))];
  } while (open_[voxel] == 0);
  const auto i = static_cast<std::int64_t>(voxel);
  const Vec3 corner{static_cast<double>(i % count_[0]), static_cast<double>(i / count_[0] % count_[1]),
                    static_cast<double>(i / count_[0] / count_[1])};
  Vec3 point;
  for (int k = 0; k < 3; ++k) point[k] = lower_[k] + (corner[k] + within[k]) * edge_[k];
  return point;
}

}  // namespace scree
