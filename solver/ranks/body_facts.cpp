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
  for (const auto& block : comm.exchange(std::vector<std::vector<BodyFacts>>(static_cast<std::size_t>(comm.size()), {mine}))) {
    all.count += block[0].count;
    all.smallest_radius = std::min(all.smallest_radius, block[0].smallest_radius);
    all.largest_radius = std::max(all.largest_radius, block[0].largest_radius);
  }
  if (all.count == 0) all.smallest_radius = BodyFacts{}.smallest_radius;
  return all;
}

}  // namespace scree
