#include "solver/neighbours/ball_blocks.hpp"

#include <algorithm>
#include <bit>

#include "solver/features/pair_view.hpp"
#include "solver/lanes/ball_forces.hpp"

namespace scree {

namespace {

constexpr std::int64_t kSpringKey = kCornerOfA << 60;  // of the one contact of such a pair
constexpr std::size_t kMostSprings = 2;                // of friction, of rolling

[[gnu::noinline]] void begin_springs(std::size_t count, std::vector<FrictionSpring>& springs) {
  springs.assign(count, RollingSpring{}.row());
  springs.front().key = kSpringKey;
}

/// The spring of friction as four numbers.
std::array<double, 4> spring_at(const BallPairs& pairs, std::size_t n) {
  return {pairs.spring(n, 0), pairs.spring(n, 1), pairs.spring(n, 2), pairs.spring(n, 3)};
}
void set_spring(const std::array<double, 4>& four, const BallPairs& pairs, std::size_t n) {
  for (std::size_t number = 0; number < four.size(); ++number) pairs.spring(n, number) = four[number];
}
ContactSpring contact_spring(const double* four) { return {{four[0], four[1], four[2]}, four[3]}; }

void clear(const BallPairs& pairs, BallSprings& lanes, std::size_t n) {
  set_spring({}, pairs, n);
  std::fill_n(&lanes.rolling[4 * n], 4, 0.0);
}

}  // namespace

std::size_t ball_spring_count(const LaneLaws& laws) {
  if (!laws.friction) return 0;
  return laws.rolling.empty() ? kMostSprings - 1 : kMostSprings;
}

bool are_of_balls(const std::vector<FrictionSpring>& springs, std::size_t spring_count) {
  if (springs.empty()) return true;
  return springs.size() == spring_count && springs[0].key == kSpringKey &&
         (spring_count < kMostSprings || springs[1].key == RollingSpring::kKey);
}

void load_springs(const std::vector<FrictionSpring>& springs, std::size_t spring_count, std::size_t n, const BallPairs& pairs,
                  BallSprings& lanes) {
  if (springs.empty()) return clear(pairs, lanes, n);
  std::array<double, 4> four;
  store(springs[0], four.data());
  set_spring(four, pairs, n);
  if (spring_count == kMostSprings) store(springs[1], &lanes.rolling[4 * n]);
}

void save_springs(const BallPairs& pairs, const BallSprings& lanes, std::size_t n, std::size_t spring_count,
                  std::vector<FrictionSpring>& springs) {
  if (springs.size() != spring_count) begin_springs(spring_count, springs);
  FrictionSpring* const kept = springs.data();
  load(spring_at(pairs, n).data(), kept[0]);
  if (spring_count == kMostSprings) load(&lanes.rolling[4 * n], kept[1]);
}

double energy_of_springs(const BallPairs& pairs, const BallSprings& lanes, std::size_t n, std::size_t spring_count) {
  double stored = 0;
  if (spring_count > 0) stored = with_energy(contact_spring(spring_at(pairs, n).data()), stored);
  if (spring_count == kMostSprings) stored = with_energy(contact_spring(&lanes.rolling[4 * n]), stored);
  return stored;
}

void BallBlock::part(std::size_t n) {
  touches[n] = 0;
  all_touch = false;
  clear(pairs, springs, n);
  forces.slots[n] = {};
  if (forces.moments != nullptr) forces.moments[n] = {};
}

BallBlock& BallBlocks::with_slots(std::int32_t n) {
  const auto at = static_cast<std::size_t>(n);
  BallBlock& b = *blocks_[at];
  b.pairs.eights = &eights_[at * kBallPairs / BallEight::kPairs];
  b.forces.slots = &slots_[at * kBallPairs];
  b.forces.moments = have_rolling() ? &moments_[at * kBallPairs] : nullptr;
  return b;
}

/// in   wall   as in BallContactRows
std::int32_t BallBlocks::block_with_room(std::size_t of, std::int32_t wall) {
  std::int32_t& last = last_[of][static_cast<std::size_t>(wall + 1)];
  if (last >= 0 && blocks_[static_cast<std::size_t>(last)]->pairs.count < kBallPairs) return last;
  if (used_ == blocks_.size()) blocks_.push_back(std::make_unique<BallBlock>());
  BallBlock& block = *blocks_[used_];
  block.pairs.count = 0;
  block.pairs.with_walls = wall >= 0;
  block.all_touch = true;
  last = static_cast<std::int32_t>(used_++);
  of_class_[of].push_back(last);
  if (wall >= 0) with_walls_.push_back(last);
  slots_.resize(std::max(slots_.size(), used_ * kBallPairs));
  eights_.resize(slots_.size() / BallEight::kPairs);
  moments_.resize(have_rolling() ? slots_.size() : 0);
  return last;
}

/// in   pair   a ball contact, or any other, which is not taken
bool BallBlocks::append(std::size_t of, std::int32_t k, const BallScene& scene, const BodyPair& pair) {
  const BallContactRows found = find_ball_contact(scene.laws, scene.p, pair.a, pair.b, pair.key.zone);
  if (!found.is_one || !are_of_balls(pair.state.springs, spring_count_)) return false;
  const std::int32_t last = block_with_room(of, found.wall);
  BallBlock& block = with_slots(last);
  const std::size_t n = block.pairs.count++;
  load_springs(pair.state.springs, spring_count_, n, block.pairs, block.springs);
  block.springs.law[n] = static_cast<std::int64_t>(found.law);
  block.pairs.a(n) = pair.a;
  block.pairs.b(n) = found.wall >= 0 ? found.wall : pair.b;
  block.index[n] = k;
  block.touches[n] = 1;
  place_[static_cast<std::size_t>(k)] = last * static_cast<std::int32_t>(kBallPairs) + static_cast<std::int32_t>(n);
  return true;
}

void BallBlocks::complete(std::int32_t n, const BallScene& scene) {
  BallBlock& block = with_slots(n);
  repeat_last_pair(block.pairs, block.springs);
  BallConstants& c = block.constants;
  find_ball_constants(scene, block.pairs, block.springs, c);
  const auto same = [&](const std::array<double, kBallPairs>& of_pairs) {
    return std::all_of(of_pairs.begin(), of_pairs.begin() + static_cast<std::ptrdiff_t>(block.pairs.count),
                       [&](double x) { return std::bit_cast<std::uint64_t>(x) == std::bit_cast<std::uint64_t>(of_pairs[0]); });
  };
  const bool is_one = same(c.radius_a) && same(c.radius_b) && same(c.radius) && same(c.stiffness) && same(c.mobility) && same(c.mass) &&
                      same(c.inverse_limit);
  c.places = is_one ? 0 : ~std::size_t{0};
}

void BallBlocks::fill(const BallScene& scene, const std::array<std::span<const std::int32_t>, kPairClasses>& lists,
                      const std::vector<BodyPair>& pairs, const std::vector<IdlePair>& idle) {
  filled_ = true;
  spring_count_ = ball_spring_count(scene.laws);
  used_ = outside_ = 0;
  with_walls_.clear();
  place_.assign(pairs.size(), kOther);
  for (std::size_t c = 0; c < kPairClasses; ++c) {
    of_class_[c].clear();
    others_[c].clear();
    last_[c].assign(scene.laws.zones.size() + 1, -1);
    for (const std::int32_t k : lists[c]) {
      const auto at = static_cast<std::size_t>(k);
      const bool touches = idle[at].way == kTouching || !pairs[at].state.springs.empty();
      if (touches && append(c, k, scene, pairs[at])) continue;
      others_[c].push_back(k);
      if (!touches && find_ball_contact(scene.laws, scene.p, idle[at].a, idle[at].b, idle[at].b < 0 ? pairs[at].key.zone : -1).is_one)
        place_[at] = kWaits;
      else
        ++outside_;
    }
    for (const std::int32_t n : of_class_[c]) complete(n, scene);
  }
}

void BallBlocks::take_out(PairClass which, std::span<const std::int32_t> pairs) {
  std::vector<std::int32_t>& others = others_[static_cast<std::size_t>(which)];
  for (const std::int32_t k : pairs) {
    std::int32_t& place = place_[static_cast<std::size_t>(k)];
    if (place >= 0) {
      blocks_[static_cast<std::size_t>(place) / kBallPairs]->index[static_cast<std::size_t>(place) % kBallPairs] = -1;
      others.insert(std::lower_bound(others.begin(), others.end(), k), k);
    }
    if (place != kOther) ++outside_;
    place = kOther;
  }
}

void BallBlocks::add(PairClass which, std::span<const std::int32_t> begun, const BallScene& scene, const std::vector<BodyPair>& pairs) {
  const auto c = static_cast<std::size_t>(which);
  std::vector<std::int32_t> taken;
  for (const std::int32_t k : begun) {
    if (!append(c, k, scene, pairs[static_cast<std::size_t>(k)])) continue;
    taken.push_back(k);
    --outside_;
    complete(place_[static_cast<std::size_t>(k)] / static_cast<std::int32_t>(kBallPairs), scene);
  }
  if (taken.empty()) return;
  auto next = taken.begin();
  std::erase_if(others_[c], [&](std::int32_t k) {  // both ascend
    while (next != taken.end() && *next < k) ++next;
    return next != taken.end() && *next == k;
  });
}

void BallBlocks::give_back(std::size_t place, std::size_t k, std::vector<BodyPair>& pairs, std::vector<PairResult>& results,
                           std::vector<IdlePair>& idle) const {
  const BallBlock& block = *blocks_[place / kBallPairs];
  const BallPairs& lanes = block.pairs;
  const std::size_t n = place % kBallPairs;
  PairResult& result = results[k];
  result.active = block.touches[n] != 0;
  result.contact_count = result.active ? 1 : 0;
  idle[k].way = result.active ? kTouching : kNeverIdle;
  if (!result.active) {
    pairs[k].state.keep_lasting();
    return;
  }
  load_result(static_cast<std::int32_t>(place), result);
  result.tangential_elastic = energy_of_springs(lanes, block.springs, n, spring_count_);
  if (spring_count_ > 0) save_springs(lanes, block.springs, n, spring_count_, pairs[k].state.springs);
}

void BallBlocks::load_result(std::int32_t place, PairResult& result) const {
  const auto at = static_cast<std::size_t>(place);
  const BallConstants& c = blocks_[at / kBallPairs]->constants;
  load(slots_[at], have_rolling() ? &moments_[at] : nullptr, c.radius_a[at % kBallPairs], c.radius_b[at % kBallPairs], result);
  if (blocks_[at / kBallPairs]->pairs.with_walls) result.torque_b = result.dissipative_torque_b = {};
}

void BallBlocks::write_back(std::vector<BodyPair>& pairs, std::vector<PairResult>& results, std::vector<IdlePair>& idle) {
  filled_ = false;
  for (std::size_t b = 0; b < used_; ++b) {
    const BallBlock& block = with_slots(static_cast<std::int32_t>(b));
    for (std::size_t n = 0; n < block.pairs.count; ++n)
      if (block.index[n] >= 0) give_back(b * kBallPairs + n, static_cast<std::size_t>(block.index[n]), pairs, results, idle);
  }
  used_ = 0;
}

}  // namespace scree
