// What pairs do to each body, added up (pair_list.hpp).
#include <omp.h>

#include <algorithm>

#include "solver/lanes/ball_motion.hpp"
#include "solver/laws/ball.hpp"
#include "solver/neighbours/pair_list.hpp"
#include "solver/neighbours/prefetch.hpp"

namespace scree {

namespace {

// Bodies read the results of their pairs in an order that is nearly that of the list for one side, and scattered for the other: so many
// entries earlier a result is asked for, about as long as a line takes from the last cache.
constexpr std::int32_t kAhead = 12;

}  // namespace

void PairList::sum_onto_bodies(const Vec3& gravity, ParticleSet& p) const {
  if (blocks_.are_filled()) return sum_blocks(gravity, p);
  const auto last = static_cast<std::int32_t>(entry_.size()) - 1;
  for_each_awake_row(p, [&](std::size_t i) {
    Vec3 force, torque, dissipative_force, dissipative_torque;
    for (std::int32_t s = start_[i]; s < start_[i + 1]; ++s) {
      const std::int32_t entry = entry_[static_cast<std::size_t>(s)];
      const std::int32_t later = entry_[static_cast<std::size_t>(std::min(s + kAhead, last))];
      prefetch<sizeof(PairResult)>(&results_[static_cast<std::size_t>(later / 2)]);
      const PairResult& r = results_[static_cast<std::size_t>(entry / 2)];
      if (!r.active) continue;
      if (entry % 2 == 0) {
        force += r.force_a;
        torque += r.torque_a;
        dissipative_force += r.dissipative_force_a;
        dissipative_torque += r.dissipative_torque_a;
      } else {
        force -= r.force_a;
        torque += r.torque_b;
        dissipative_force -= r.dissipative_force_a;
        dissipative_torque += r.dissipative_torque_b;
      }
    }
    p.force[i] = force + p.mass[i] * gravity;
    p.torque[i] = torque;
    p.dissipative_force[i] = dissipative_force;
    p.dissipative_torque[i] = dissipative_torque;
  });
}

BallSums PairList::sums_of_blocks() const {
  const std::vector<PaddedVec3>& moments = blocks_.moments();
  return {blocks_.slots().data(), moments.empty() ? nullptr : moments.data(),
          blocks_.slots().size(), start_.data(),
          due_count_.data(),      due_.data()};
}

BallsMoved PairList::move_balls(const Vec3& gravity, double dt, double share, ParticleSet& p, std::vector<BallGroup>& groups,
                                std::vector<BallRow>& rows) const {
  const BallMotion motion{sums_of_blocks(), due_others_.data(), p, gravity, dt, share, groups.data(), rows.data()};
  double squared = 0;
  bool go_far = false;
#pragma omp parallel reduction(max : squared) reduction(|| : go_far)
  {
    const auto thread = static_cast<std::size_t>(omp_get_thread_num()), threads = static_cast<std::size_t>(omp_get_num_threads());
    const std::size_t begin = groups.size() * thread / threads, end = groups.size() * (thread + 1) / threads;
    for (std::size_t i = begin * BallGroup::kBalls; i < std::min(end * BallGroup::kBalls, p.owned); ++i)
      if (due_others_[i] != 0) sum_with_others(i, motion.sums, gravity, p);
    const BallsMoved moved = scree::move_balls(motion, begin, end);
    squared = std::max(squared, moved.squared_speed);
    go_far = go_far || moved.go_far;
  }
  return {squared, go_far};
}

/// The same sums in the same order. Of a body's entries those alone are met that may have a force. Bodies whose entries are all in blocks
/// go together.
void PairList::sum_blocks(const Vec3& gravity, ParticleSet& p) const {
  const BallSums sums = sums_of_blocks();
#pragma omp parallel
  for_awake_rows_of_thread(p, [&](std::size_t begin, std::size_t end) {
    std::size_t i = begin;
    while (i < end) {
      const std::size_t first = i;
      while (i < end && due_others_[i] == 0) ++i;
      if (i > first) sum_onto_balls(sums, gravity, first, i, p);
      if (i < end) sum_with_others(i++, sums, gravity, p);
    }
  });
}

void PairList::sum_with_others(std::size_t i, const BallSums& sums, const Vec3& gravity, ParticleSet& p) const {
  Vec3 force, torque, dissipative_force, dissipative_torque;
  const std::int32_t* const due = &due_[static_cast<std::size_t>(start_[i])];
  for (std::int32_t n = 0; n < due_count_[i]; ++n) {
    const std::int32_t code = due[n] >= 0 ? due[n] : -1 - due[n];
    const double sign = code % 2 == 0 ? 1 : -1;
    const auto at = static_cast<std::size_t>(code / 2);
    if (due[n] >= 0) {
      const BallSlot& slot = sums.slots[at];
      Vec3 of_pair = ball_torque(slot.across, p.ball_radius[i], slot.half);
      if (sums.moments != nullptr) of_pair += sign * sums.moments[at].v;
      force += sign * slot.force;
      torque += of_pair;
      dissipative_force += sign * slot.lost;
      dissipative_torque += of_pair;
      continue;
    }
    const PairResult& r = results_[at];
    if (!r.active) continue;
    force += sign * r.force_a;
    torque += sign > 0 ? r.torque_a : r.torque_b;
    dissipative_force += sign * r.dissipative_force_a;
    dissipative_torque += sign > 0 ? r.dissipative_torque_a : r.dissipative_torque_b;
  }
  p.force[i] = force + p.mass[i] * gravity;
  p.torque[i] = torque;
  p.dissipative_force[i] = dissipative_force;
  p.dissipative_torque[i] = dissipative_torque;
}

}  // namespace scree
