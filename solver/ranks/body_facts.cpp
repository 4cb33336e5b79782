#include "solver/ranks/body_facts.hpp"

#include <algorithm>

namespace scree {

BodyFacts agree_on_facts(const mpi::Communicator& comm, const ParticleSet& p) {
  constexpr double kNone = 1e300;
  BodyFacts mine{static_cast<std::int64_t>(p.owned), kNone, 0};
  for (std::size_t i = 0; i < p.owned; ++i) {
    mine.smallest_radius = std::min(mine.smallest_radius, p.radius[i]);
    mine.largest_radius = std::max(mine.largest_radius, p.radius[i]);
  }
  BodyFacts all{0, kNone, 0};
  for (const BodyFacts& of_rank : comm.of_all(std::vector{mine})) {
    all.count += of_rank.count;
    all.smallest_radius = std::min(all.smallest_radius, of_rank.smallest_radius);
    all.largest_radius = std::max(all.largest_radius, of_rank.largest_radius);
  }
  if (all.count == 0) all.smallest_radius = BodyFacts{}.smallest_radius;
  return all;
}

}  // namespace scree
