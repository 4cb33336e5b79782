#include "solver/neighbours/waiting_balls.hpp"

#include <algorithm>

namespace scree {

namespace {

/// How far both bodies of a pair may still go before it is looked at, from its idle time [m].
double room_of(const IdlePair& idle, const TravelBounds& travel) {
  if (idle.way < 0) return 0;
  return idle.way - travel[idle.a] - (idle.b >= 0 ? travel[idle.b] : 0.0);
}

}  // namespace

void WaitingBalls::begin(const PairList& list, PairClass which) {
  groups_.clear();
  first_.clear();
  std::size_t place = kTogether;
  for (const std::int32_t k : list.blocks().others(which)) {
    if (list.blocks().place_of(k) != BallBlocks::kWaits) continue;
    if (place == kTogether) {
      groups_.emplace_back();
      groups_.back().pair.fill(-1);
      groups_.back().limit.fill(kNever);
      first_.push_back(kNever);
      place = 0;
    }
    groups_.back().pair[place] = k;
    groups_.back().limit[place] = room_of(list.idle()[static_cast<std::size_t>(k)], list.travel());
    first_.back() = std::min(first_.back(), groups_.back().limit[place]);
    ++place;
  }
}

const std::vector<std::int32_t>& WaitingBalls::due(double bound, PairList& list) {
  due_.clear();
  due_places_.clear();
  for (std::size_t g = 0; g < groups_.size(); ++g) {
    if (first_[g] > bound) continue;
    for (std::size_t n = 0; n < kTogether; ++n) {
      if (groups_[g].limit[n] > bound) continue;
      due_.push_back(groups_[g].pair[n]);
      due_places_.push_back(static_cast<std::int32_t>(g * kTogether + n));
      list.idle()[static_cast<std::size_t>(due_.back())].way = kNeverIdle;
    }
  }
  return due_;
}

void WaitingBalls::note(double bound, const PairList& list) {
  for (std::size_t n = 0; n < due_.size(); ++n) {
    const std::size_t g = static_cast<std::size_t>(due_places_[n]) / kTogether,
                      place = static_cast<std::size_t>(due_places_[n]) % kTogether;
    const IdlePair& idle = list.idle()[static_cast<std::size_t>(due_[n])];
    // one that touches is in a block from the next step on, also where the general path has computed it, which does not say so in `way`
    const bool touches = idle.way == kTouching || list.stored_results()[static_cast<std::size_t>(due_[n])].active;
    groups_[g].limit[place] = touches ? kNever : bound + room_of(idle, list.travel());
    if (n + 1 == due_.size() || static_cast<std::size_t>(due_places_[n + 1]) / kTogether != g)
      first_[g] = *std::min_element(groups_[g].limit.begin(), groups_[g].limit.end());
  }
}

void WaitingBalls::end_of_walls(PairList& list) const {
  for (const Group& group : groups_) {
    for (std::size_t n = 0; n < kTogether; ++n) {
      if (group.pair[n] < 0 || group.limit[n] == kNever) continue;  // one that touches is in a block
      IdlePair& idle = list.idle()[static_cast<std::size_t>(group.pair[n])];
      if (idle.b < 0) idle.way = kNeverIdle;
    }
  }
}

}  // namespace scree
