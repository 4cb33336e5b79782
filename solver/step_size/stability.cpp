#include "solver/step_size/stability.hpp"
#include "solver/contact/chosen_law.hpp"

#include <algorithm>
#include <unordered_map>

namespace scree {

namespace {

struct NamedBound {
  std::int64_t id;
  BodyBound bound;
};

/// Pairs in contact in the order of their keys, which is that of their numbers.
std::vector<std::int32_t> pairs_in_contact(const PairList& pairs) {
  std::vector<std::int32_t> touching;
  for (const auto* which : {&pairs.inner(), &pairs.outer(), &pairs.duplicated()}) {
    for (const std::int32_t k : *which) {
      if (pairs.results()[static_cast<std::size_t>(k)].active) touching.push_back(k);
    }
  }
  std::sort(touching.begin(), touching.end());
  return touching;
}

/// The owner of a ghost knows all of its pairs: ghosts get their bounds from there.
void fetch_bounds_of_ghosts(const RunState& s, const std::vector<std::int32_t>& touching, StabilityBound& bounds) {
  const ParticleSet& p = s.particles;
  std::vector<NamedBound> shared;
  std::vector<std::uint8_t> is_shared(p.size(), 0);
  const auto share = [&](std::int32_t row_a, std::int32_t row_b) {
    if (row_b < 0) return;
    const auto a = static_cast<std::size_t>(row_a), b = static_cast<std::size_t>(row_b);
    if ((a < p.owned) == (b < p.owned)) return;
    const std::size_t own = a < p.owned ? a : b;
    if (std::exchange(is_shared[own], std::uint8_t{1}) == 0) shared.push_back({p.id[own], bounds.bound_of(own)});
  };
  for (const std::int32_t k : touching)
    share(s.pairs.pairs()[static_cast<std::size_t>(k)].a, s.pairs.pairs()[static_cast<std::size_t>(k)].b);
  for (const std::unique_ptr<Effect>& effect : s.effects) {
    for (const BodyLink& link : effect->links(s)) share(link.a, link.b);
  }
  std::unordered_map<std::int64_t, BodyBound> of_id;
  for (const NamedBound& n : s.comm.of_all(shared)) of_id[n.id] = n.bound;
  for (std::size_t i = p.owned; i < p.size(); ++i) {
    if (const auto it = of_id.find(p.id[i]); it != of_id.end()) bounds.set_bound(i, it->second);
  }
}

/// The smallest of all ranks; the lower pair among equals.
CriticalStep smallest_of(const mpi::Communicator& comm, CriticalStep critical) {
  for (const CriticalStep& other : comm.of_all(std::vector{critical})) {
    if (other.step < critical.step || (other.step == critical.step && other.key < critical.key)) critical = other;
  }
  return critical;
}

}  // namespace

CriticalStep critical_step(RunState& s, ForceScratch& scratch) {
  const std::vector<std::int32_t> touching = pairs_in_contact(s.pairs);
  StabilityBound bounds(s.particles.size());
  const LineariseFunction function = linearise_function(s.scene.law_choice());
  const PairVisitor look = [&](const PairContact& pair) {
    const std::int32_t zone = pair.pair.key.zone;
    const double of_wall = zone < 0 || !s.scene.has_answering_walls()
                               ? 0
                               : wall_share_of_frequency(s, static_cast<std::size_t>(s.scene.zones()[static_cast<std::size_t>(zone)].wall));
    bounds.add(linearise(pair, function), of_wall);
  };
  visit_pairs(s.scene, s.particles, s.walls, touching, s.clock.step, scratch, s.pairs, look);
  for (const std::unique_ptr<Effect>& effect : s.effects) effect->add_stiffness(s, bounds);
  if (s.comm.size() > 1) fetch_bounds_of_ghosts(s, touching, bounds);
  const CriticalStep mine = bounds.critical_step(s.scene.law_choice().lag_corrected);
  return s.comm.size() > 1 ? smallest_of(s.comm, mine) : mine;
}

}  // namespace scree
