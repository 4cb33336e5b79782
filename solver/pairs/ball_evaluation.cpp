#include "solver/pairs/ball_evaluation.hpp"

#include <algorithm>
#include <chrono>
#include <cstddef>

#include "solver/neighbours/lane_rows.hpp"

namespace scree {

namespace {

BallWall ball_wall(const WallZone& zone, const WallState& wall) {
  BallWall w;
  w.x = wall.position;
  w.q = Quat{} * wall.orientation;
  w.w = wall.angular_velocity_before;
  w.pivot = wall.pivot;
  w.pivot_v = wall.pivot == wall.position ? wall.velocity_before : wall.pivot_velocity_before;
  w.point = zone.point;
  w.direction = zone.direction;
  w.radius = zone.kind == WallZone::Kind::cylinder ? zone.radius : 0;
  return w;
}

/// What pairs read of the first bodies.
void collect_rows(const ParticleSet& p, std::size_t count, std::vector<BallRow>& rows) {
  rows.resize(p.size());
#pragma omp parallel
  {
    const auto thread = static_cast<std::size_t>(omp_get_thread_num()), threads = static_cast<std::size_t>(omp_get_num_threads());
    const std::size_t begin = count * thread / threads, end = count * (thread + 1) / threads;
    if (begin < end) collect_ball_rows(p, begin, end, rows.data());
  }
}

}  // namespace

bool has_ball_way(const PairPass& pass) { return pass.scene.ball_laws().kind != LaneLawKind::none && pass.asks_for_forces_alone(); }

BallPass::BallPass(PairPass& pass) : pass_(pass), scene_{pass.p, pass.p.cell.periodicity(), pass.scene.ball_laws()} {
  if (pass.blocks) {
    // ghosts are not here yet while the pairs of owned bodies are computed
    if (!pass.has_ball_rows) collect_rows(pass.p, *pass.blocks == PairClass::inner ? pass.p.owned : pass.p.size(), pass.scratch.ball_rows);
    scene_.rows = pass.scratch.ball_rows.data();
  }
  scene_.walls.reserve(scene_.laws.zones.size());
  for (const BallZone& z : scene_.laws.zones) {
    const WallZone& zone = pass.scene.zones()[static_cast<std::size_t>(z.zone)];
    scene_.walls.push_back(ball_wall(zone, pass.walls[static_cast<std::size_t>(zone.wall)]));
  }
}

BallEvaluation::BallEvaluation(const BallPass& balls) : balls_(balls), pass_(balls.pass()) {
  at_walls_.pairs.with_walls = old_contacts_at_walls_.pairs.with_walls = true;
  spring_count_ = ball_spring_count(balls.scene().laws);
  forces_.slots = slots_.data();
  if (spring_count_ == kMaxSprings) forces_.moments = moments_.data();
}

template <class Work>
void BallEvaluation::timed(Due& due, Work&& work) {
  std::vector<float>& seconds = pass_.scratch.pair_seconds;
  using Clock = std::chrono::steady_clock;
  const Clock::time_point start = seconds.empty() ? Clock::time_point{} : Clock::now();
  work(due);
  if (!seconds.empty()) {
    const float each = std::chrono::duration<float>(Clock::now() - start).count() / static_cast<float>(due.pairs.count);
    for (std::size_t n = 0; n < due.pairs.count; ++n) seconds[static_cast<std::size_t>(due.index[n])] = each;
  }
  due.pairs.count = 0;
}

/// Pairs of which is not known whether they touch.
void BallEvaluation::look(Due& due) {
  timed(due, [this](Due& all) {
    for (std::size_t n = 0; n < all.pairs.count; ++n) ask_for_springs(all.index[n]);  // they arrive while the gaps are found
    find_ball_gaps(balls_.scene(), all.pairs, gap_.data());
    touching_.pairs.with_walls = all.pairs.with_walls;
    const double margin = balls_.scene().laws.margin;
    std::size_t count = 0;
    for (std::size_t n = 0; n < all.pairs.count; ++n) {
      if (gap_[n] >= margin)
        part(all.index[n], static_cast<std::size_t>(all.pairs.a(n)), static_cast<std::size_t>(all.pairs.b(n)), all.pairs.with_walls,
             gap_[n]);
      else
        take_touching(all, n, count);
    }
    touching_.pairs.count = count;
    find_forces();
  });
}

/// Pairs that touched in the last step.
void BallEvaluation::press(Due& due) {
  timed(due, [this](Due& all) {
    for (std::size_t n = all.pairs.count - std::min(all.pairs.count, kAhead); n < all.pairs.count; ++n) ask_for_springs(all.index[n]);
    touching_.pairs.with_walls = all.pairs.with_walls;
    std::size_t count = 0;
    for (std::size_t n = 0; n < all.pairs.count; ++n) take_touching(all, n, count);
    touching_.pairs.count = count;
    find_forces();
  });
}

/// Adds the n-th pair to those that touch, with its springs, if lanes have its law.   in, out   count   of them
[[gnu::always_inline]] inline void BallEvaluation::take_touching(const Due& due, std::size_t n, std::size_t& count) {
  const LaneLaws& laws = balls_.scene().laws;
  const std::int32_t k = due.index[n];
  std::size_t law = 0;
  if (laws.laws.size() != 1) {
    const std::vector<std::int32_t>& material = pass_.p.material;
    const auto a = static_cast<std::size_t>(due.pairs.a(n)), b = static_cast<std::size_t>(due.pairs.b(n));
    law = laws.row(material[a], due.pairs.with_walls ? laws.zones[b].material : material[b]);
  }
  const std::vector<FrictionSpring>& springs = pass_.list.stored_pairs()[static_cast<std::size_t>(k)].state.springs;
  if (laws.holds[law] == 0 || !are_of_balls(springs, spring_count_)) {
    left_.push_back(k);
    return;
  }
  load_springs(springs, spring_count_, count, touching_.pairs, springs_);
  touching_.pairs.a(count) = due.pairs.a(n);
  touching_.pairs.b(count) = due.pairs.b(n);
  touching_.index[count] = k;
  springs_.law[count] = static_cast<std::int64_t>(law);
  ++count;
}

void BallEvaluation::find_forces() {
  if (touching_.pairs.count == 0) return;
  repeat_last_pair(touching_.pairs, springs_);
  find_ball_forces(balls_.scene(), pass_.dt, touching_.pairs, nullptr, springs_, forces_);
  hand_out();
}

/// A pair that does not touch.   in   a, b   rows, as in BallPairs
void BallEvaluation::part(std::int32_t k, std::size_t a, std::size_t b, bool at_wall, double gap) {
  const std::vector<double>& radius = pass_.p.ball_radius;
  PairResult& result = pass_.list.stored_results()[static_cast<std::size_t>(k)];
  result.active = false;
  result.contact_count = 0;
  IdlePair& idle = pass_.list.idle()[static_cast<std::size_t>(k)];
  // the way of a wall that moves is in no bound but that of steps without a break (step/ball_steps.hpp)
  idle.way = at_wall && pass_.scene.has_driven_walls() && pass_.has_columns
                 ? kNeverIdle
                 : pass_.way_of(idle) + slack_below(gap - balls_.scene().laws.margin, 0, radius[a] + (at_wall ? 0 : radius[b]));
  pass_.list.stored_pairs()[static_cast<std::size_t>(k)].state.keep_lasting();
}

/// Gives the pairs that touch what was computed. One loop with all that it reads at hand: it is a tenth of a step of balls.
void BallEvaluation::hand_out() {
  const std::size_t spring_count = spring_count_;
  BodyPair* const pairs = pass_.list.stored_pairs().data();
  PairResult* const results = pass_.list.stored_results().data();
  IdlePair* const idle = pass_.list.idle().data();
  const double stop_ratio = pass_.stop_ratio, margin = balls_.scene().laws.margin;
  double largest = largest_overlap_;
  bool too_deep = too_deep_;
  const bool continues = pass_.continues, with_walls = touching_.pairs.with_walls;
  const std::vector<double>& radius = pass_.p.ball_radius;
  for (std::size_t n = 0; n < touching_.pairs.count; ++n) {
    const auto k = static_cast<std::size_t>(touching_.index[n]);
    if (forces_.left[n] != 0) {
      if (forces_.gap[n] >= margin)
        part(touching_.index[n], static_cast<std::size_t>(touching_.pairs.a(n)), static_cast<std::size_t>(touching_.pairs.b(n)),
             touching_.pairs.with_walls, forces_.gap[n]);
      else
        left_.push_back(touching_.index[n]);
      continue;
    }
    if (idle[k].way != kTouching) begun_.push_back(touching_.index[n]);
    idle[k].way = kTouching;
    PairResult& result = results[k];
    result.active = true;
    result.contact_count = 1;
    const auto a = static_cast<std::size_t>(touching_.pairs.a(n)), b = static_cast<std::size_t>(touching_.pairs.b(n));
    load(slots_[n], forces_.moments != nullptr ? &moments_[n] : nullptr, radius[a], with_walls ? 0 : radius[b], result);
    if (with_walls) result.torque_b = result.dissipative_torque_b = {};
    result.tangential_elastic = energy_of_springs(touching_.pairs, springs_, n, spring_count);
    if (continues && !(result.overlap_ratio < stop_ratio)) {
      left_.push_back(touching_.index[n]);
      continue;
    }
    largest = std::max(largest, result.overlap_ratio);
    too_deep = too_deep || !(result.overlap_ratio < stop_ratio);  // or not a number
    if (spring_count == 0) continue;
    save_springs(touching_.pairs, springs_, n, spring_count, pairs[k].state.springs);
  }
  largest_overlap_ = largest;
  too_deep_ = too_deep;
}

void BallEvaluation::compute(BallBlock& block) {
  const BallSummary found = find_ball_forces(balls_.scene(), pass_.dt, block.pairs, &block.constants, block.springs, block.forces);
  largest_overlap_ = std::max(largest_overlap_, found.largest);
  too_deep_ = too_deep_ || !(found.largest < pass_.stop_ratio);
  if (!found.some_left && block.all_touch) return;
  block.all_touch = true;
  for (std::size_t n = 0; n < block.pairs.count; ++n) {
    const bool is_left = (found.written >> n & 1) != 0 && block.forces.left[n] != 0;
    if (block.index[n] < 0 || (is_left && block.forces.gap[n] >= balls_.scene().laws.margin))
      block.part(n);
    else if (!is_left)
      block.touches[n] = 1;
    else
      leave(block, n);
  }
}

/// Leaves a pair of a block to the general path.
void BallEvaluation::leave(BallBlock& block, std::size_t n) {
  const auto k = static_cast<std::size_t>(block.index[n]);
  PairState& state = pass_.list.stored_pairs()[k].state;
  // what touches first has no springs yet
  if (spring_count_ > 0 && block.pairs.spring(n, 3) != 0)
    save_springs(block.pairs, block.springs, n, spring_count_, state.springs);
  else
    state.keep_lasting();
  pass_.list.idle()[k].way = kNeverIdle;
  left_.push_back(block.index[n]);
  left_of_blocks_.push_back(block.index[n]);
  block.part(n);
}

std::vector<std::int32_t> BallEvaluation::begun_to_touch() const {
  std::vector<std::int32_t> begun;
  for (const std::vector<std::int32_t>* const some : {&begun_, &left_}) {
    for (const std::int32_t k : *some) {
      if (pass_.list.blocks().place_of(k) == BallBlocks::kWaits && pass_.list.stored_results()[static_cast<std::size_t>(k)].active)
        begun.push_back(k);
    }
  }
  return begun;
}

}  // namespace scree
