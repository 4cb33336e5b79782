// Weighted points that every rank makes alike, and the share of each rank.
#pragma once

#include <mpi.h>

#include <random>
#include <vector>

#include "core/partition/partition.hpp"

namespace scree::test {

struct Cloud {
  std::vector<std::int64_t> ids;
  std::vector<Vec3> points;
  std::vector<double> weights;
};

inline int rank_here() {
  int rank = 0;
  MPI_Comm_rank(MPI_COMM_WORLD, &rank);
  return rank;
}
inline int rank_count() {
  int size = 1;
  MPI_Comm_size(MPI_COMM_WORLD, &size);
  return size;
}

/// Two clusters, weights over a factor of four, ids beyond 32 bits.
inline Cloud clustered_cloud(std::size_t count) {
  std::mt19937_64 random(5);
  std::normal_distribution<double> normal(0, 0.1);
  std::uniform_real_distribution<double> uniform(1, 4);
  Cloud cloud;
  for (std::size_t i = 0; i < count; ++i) {
    const Vec3 centre = i % 3 == 0 ? Vec3{1, 0.3, -0.2} : Vec3{};
    cloud.ids.push_back((std::int64_t{1} << 40) + static_cast<std::int64_t>(7 * i));
    cloud.points.push_back(centre + Vec3{normal(random), normal(random), normal(random)});
    cloud.weights.push_back(uniform(random));
  }
  return cloud;
}

/// The share of this rank: every k-th point, or none at all on rank `without`.
inline Cloud share(const Cloud& all, int without = -1) {
  Cloud own;
  const int givers = without >= 0 && rank_count() > 1 ? rank_count() - 1 : rank_count();
  for (std::size_t i = 0; i < all.ids.size(); ++i) {
    int owner = static_cast<int>(i) % givers;
    if (without >= 0 && rank_count() > 1 && owner >= without) ++owner;
    if (owner != rank_here()) continue;
    own.ids.push_back(all.ids[i]);
    own.points.push_back(all.points[i]);
    own.weights.push_back(all.weights[i]);
  }
  return own;
}

}  // namespace scree::test
