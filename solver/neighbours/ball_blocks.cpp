#include "solver/neighbours/ball_blocks.hpp"

#include <algorithm>

namespace scree {

namespace {

constexpr std::int64_t kSpringKey = kCornerOfA << 60;  // of the one contact of such a pair
constexpr std::size_t kMostSprings = 3;                // of friction, of rolling, and the turn that goes with them
constexpr std::size_t kMostLanes = 8;

[[gnu::noinline]] void begin_springs(std::size_t count, std::vector<FrictionSpring>& springs) {
  springs.assign(count, FrictionSpring{kRollingKey, {}, 0});
  springs.front().key = kSpringKey;
  springs.back().key = kTurnKey;
}

/// Lanes beyond the last pair repeat it.
void repeat_last(BallBlock& b) {
  const std::size_t last = b.pairs.count - 1;
  for (std::size_t n = b.pairs.count; n % kMostLanes != 0; ++n) {
    b.pairs.a[n] = b.pairs.a[last];
    b.pairs.b[n] = b.pairs.b[last];
    b.springs.law[n] = b.springs.law[last];
    b.springs.kept[n] = b.springs.kept[last];
    for (BallFours* fours : {&b.springs.spring, &b.springs.turn, &b.springs.rolling, &b.springs.normal})
      std::copy_n(fours->begin() + static_cast<std::ptrdiff_t>(4 * last), 4, fours->begin() + static_cast<std::ptrdiff_t>(4 * n));
  }
}

}  // namespace

std::size_t ball_spring_count(const LaneLaws& laws) {
  if (!laws.friction) return 0;
  return laws.rolling.empty() ? kMostSprings - 1 : kMostSprings;
}

bool load_springs(const std::vector<FrictionSpring>& springs, std::size_t spring_count, std::size_t n, BallSprings& lanes) {
  lanes.kept[n] = 0;
  if (springs.empty()) return true;
  const FrictionSpring* const kept = springs.data();
  if (springs.size() != spring_count || kept[0].key != kSpringKey || springs.back().key != kTurnKey) return false;
  lanes.kept[n] = 1;
  store(kept[0], &lanes.spring[4 * n]);
  store(kept[0].normal, &lanes.normal[4 * n]);
  store(springs.back(), &lanes.turn[4 * n]);
  if (spring_count == kMostSprings) {
    if (kept[1].key != kRollingKey) return false;
    store(kept[1], &lanes.rolling[4 * n]);
  }
  return true;
}

void save_springs(const BallSprings& lanes, std::size_t n, std::size_t spring_count, std::vector<FrictionSpring>& springs) {
  if (springs.size() != spring_count) begin_springs(spring_count, springs);
  FrictionSpring* const kept = springs.data();
  load(&lanes.spring[4 * n], kept[0]);
  load(&lanes.normal[4 * n], kept[0].normal);
  load(&lanes.turn[4 * n], kept[spring_count - 1]);
  if (spring_count == kMostSprings) load(&lanes.rolling[4 * n], kept[1]);
}

void BallBlock::part(std::size_t n) {
  state[n] = State::apart;
  springs.kept[n] = 0;
  for (BallFours& fours : forces.fours) std::fill_n(fours.begin() + static_cast<std::ptrdiff_t>(4 * n), 4, 0.0);
}

std::size_t BallBlocks::law_of(const LaneLaws& laws, const ParticleSet& p, std::int32_t a, std::int32_t b) {
  return laws.laws.size() == 1 ? 0 : laws.row(p.material[static_cast<std::size_t>(a)], p.material[static_cast<std::size_t>(b)]);
}

bool BallBlocks::append(std::size_t of, std::int32_t k, const LaneLaws& laws, const ParticleSet& p, const BodyPair& pair) {
  std::vector<std::int32_t>& mine = of_class_[of];
  if (mine.empty() || blocks_[static_cast<std::size_t>(mine.back())]->pairs.count == kBallPairs) {
    if (used_ == blocks_.size()) blocks_.push_back(std::make_unique<BallBlock>());
    blocks_[used_]->pairs.count = 0;
    blocks_[used_]->all_touch = true;
    mine.push_back(static_cast<std::int32_t>(used_++));
  }
  BallBlock& block = *blocks_[static_cast<std::size_t>(mine.back())];
  const std::size_t n = block.pairs.count;
  const std::size_t law = law_of(laws, p, pair.a, pair.b);
  const bool fits = laws.holds[law] != 0 && load_springs(pair.state.springs, spring_count_, n, block.springs);
  if (fits) {
    block.springs.law[n] = static_cast<std::int64_t>(law);
    block.pairs.a[n] = pair.a;
    block.pairs.b[n] = pair.b;
    block.index[n] = k;
    block.state[n] = BallBlock::State::touches;
    ++block.pairs.count;
    place_[static_cast<std::size_t>(k)] = mine.back() * static_cast<std::int32_t>(kBallPairs) + static_cast<std::int32_t>(n);
  } else if (n == 0) {  // no block without pairs
    mine.pop_back();
    --used_;
  }
  return fits;
}

void BallBlocks::fill(const LaneLaws& laws, const ParticleSet& p, const std::array<std::span<const std::int32_t>, kPairClasses>& lists,
                      const std::vector<BodyPair>& pairs, std::vector<IdlePair>& idle, const std::vector<PairResult>& results) {
  filled_ = true;
  spring_count_ = ball_spring_count(laws);
  used_ = 0;
  place_.assign(pairs.size(), kOther);
  for (std::size_t c = 0; c < kPairClasses; ++c) {
    of_class_[c].clear();
    others_[c].clear();
    for (const std::int32_t k : lists[c]) {
      const auto at = static_cast<std::size_t>(k);
      const IdlePair& i = idle[at];
      const bool balls = i.b >= 0 && p.ball_radius[static_cast<std::size_t>(i.a)] > 0 && p.ball_radius[static_cast<std::size_t>(i.b)] > 0;
      const bool touches = i.way == kTouching || !pairs[at].state.springs.empty();
      if (!balls || !touches || !append(c, k, laws, p, pairs[at])) {
        others_[c].push_back(k);
        if (balls && !touches && laws.holds[law_of(laws, p, i.a, i.b)] != 0) place_[at] = kWaits;
        continue;
      }
      store(results[at], static_cast<std::size_t>(place_[at]) % kBallPairs,
            blocks_[static_cast<std::size_t>(place_[at]) / kBallPairs]->forces.fours);
    }
  }
  for (std::size_t n = 0; n < used_; ++n) repeat_last(*blocks_[n]);
}

void BallBlocks::add(PairClass which, std::span<const std::int32_t> begun, const LaneLaws& laws, const ParticleSet& p,
                     const std::vector<BodyPair>& pairs, const std::vector<PairResult>& results) {
  const auto c = static_cast<std::size_t>(which);
  std::vector<std::int32_t> taken;
  for (const std::int32_t k : begun) {
    const auto at = static_cast<std::size_t>(k);
    if (!append(c, k, laws, p, pairs[at])) {
      place_[at] = kOther;
      continue;
    }
    taken.push_back(k);
    BallBlock& block = *blocks_[static_cast<std::size_t>(place_[at]) / kBallPairs];
    store(results[at], static_cast<std::size_t>(place_[at]) % kBallPairs, block.forces.fours);
    repeat_last(block);
  }
  if (taken.empty()) return;
  auto next = taken.begin();
  std::erase_if(others_[c], [&](std::int32_t k) {  // both ascend
    while (next != taken.end() && *next < k) ++next;
    return next != taken.end() && *next == k;
  });
}

void BallBlocks::write_back(std::vector<BodyPair>& pairs, std::vector<PairResult>& results, std::vector<IdlePair>& idle) {
  filled_ = false;
  for (std::size_t b = 0; b < used_; ++b) {
    const BallBlock& block = *blocks_[b];
    for (std::size_t n = 0; n < block.pairs.count; ++n) {
      const auto k = static_cast<std::size_t>(block.index[n]);
      if (block.state[n] == BallBlock::State::general) continue;
      PairResult& result = results[k];
      result.active = block.state[n] == BallBlock::State::touches;
      result.contact_count = result.active ? 1 : 0;
      idle[k].way = result.active ? kTouching : kNeverIdle;
      if (!result.active) {
        pairs[k].state.keep_lasting();
        continue;
      }
      load(block.forces.fours, n, result);
      if (spring_count_ > 0 && block.springs.kept[n] > 0) save_springs(block.springs, n, spring_count_, pairs[k].state.springs);
    }
  }
  used_ = 0;
}

}  // namespace scree
