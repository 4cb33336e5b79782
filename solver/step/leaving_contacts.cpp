#include "solver/step/leaving_contacts.hpp"

#include <unordered_set>

namespace scree {

void book_contacts_of_leaving(RunState& s, const std::vector<std::uint8_t>& leaves) {
  // who counts a pair may not own the body that leaves: all ranks hear of all
  std::vector<std::int64_t> mine;
  for (std::size_t i = 0; i < leaves.size(); ++i) {
    if (leaves[i] != 0) mine.push_back(s.particles.id[i]);
  }
  std::unordered_set<std::int64_t> all;
  for (const auto& block : s.comm.exchange(std::vector<std::vector<std::int64_t>>(static_cast<std::size_t>(s.comm.size()), mine)))
    all.insert(block.begin(), block.end());
  for (std::size_t k = 0; k < s.pairs.pairs().size(); ++k) {
    const BodyPair& pair = s.pairs.pairs()[k];
    const PairResult& r = s.pairs.results()[k];
    if (!r.active || !counts_here(pair, s.particles)) continue;
    if (all.contains(pair.key.a) || (pair.b >= 0 && all.contains(pair.key.b))) s.totals.departed.energy.add(r.elastic);
  }
}

}  // namespace scree
