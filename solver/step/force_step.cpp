#include "solver/step/force_step.hpp"

#include <algorithm>

#include "solver/built_with.hpp"
#include "solver/effects/sleep/sleep.hpp"

namespace scree {

namespace {

void add_travel(RunState& s, Balance& balance, bool of_ghosts) {
  if ((of_ghosts ? s.particles.ghost_count() : s.particles.owned) == 0) return;
  const PhaseTimer timer(s.times, Phase::contact);
  const WorkTimer work(balance.computing(), balance.weight_of(s.clock.step));
  if (of_ghosts)
    s.pairs.travel().add_motion_of_ghosts(s.particles);
  else
    s.pairs.travel().add_motion_of_owned(s.particles);
}

}  // namespace

void ForceStep::compute(RunState& s, Decomposition& decomposition, FirstFailure& failure, double friction_dt, bool refresh) {
  ParticleSet& p = s.particles;
  Halo& halo = decomposition.halo();
  Balance& balance = decomposition.balance();
  const bool refresh_ghosts = built_with::kRanks && refresh, overlap = decomposition.options().strategy == HaloStrategy::overlap;
  const bool timed = refresh_ghosts && balance.is_sample(s.clock.step);
  observers_.clear();
  for (const std::unique_ptr<Effect>& effect : s.effects) {
    failure.watch(s.clock.step, [&] { effect->before_forces(s); });
    if (PairObserver* const observer = effect->observer()) observers_.push_back(observer);
  }
  if (s.sleep) s.sleep->sort_pairs(s, scratch_, failure);
  const auto due = [&s](Sleep::Which which, const std::vector<std::int32_t>& all) {
    return s.sleep ? s.sleep->due(which, all) : std::span(all);
  };
  if (timed) scratch_.pair_seconds.assign(s.pairs.stored_pairs().size(), 0.0f);

  if (refresh_ghosts) halo.start_refresh(p, s.times);
  if (refresh_ghosts && !overlap) halo.finish_refresh(p, s.times);
  if (refresh) add_travel(s, balance, false);
  compute_pairs(s, balance, failure, PairClass::inner, due(Sleep::kInner, s.pairs.inner()), friction_dt);
  if (refresh_ghosts && overlap) halo.finish_refresh(p, s.times);
  if (refresh) add_travel(s, balance, true);
  if (built_with::kRanks && s.sleep) s.sleep->update_ghosts(s, scratch_, failure);
  if (built_with::kRanks) compute_pairs(s, balance, failure, PairClass::outer, due(Sleep::kOuter, s.pairs.outer()), friction_dt);
  if (built_with::kRanks)
    compute_pairs(s, balance, failure, PairClass::duplicated, due(Sleep::kDuplicated, s.pairs.duplicated()), friction_dt);

  if (timed) {
    balance.add_sample(scratch_.pair_seconds, s.pairs.stored_pairs(), p);
    scratch_.pair_seconds.clear();
  }
  const PhaseTimer timer(s.times, Phase::sum);
  const WorkTimer work(balance.computing(), balance.weight_of(s.clock.step));
  if (s.sleep) s.sleep->wake_disturbed(s);
  s.pairs.sum_onto_bodies(s.scene.source().settings.gravity, p);
  if (s.fluid) s.fluid->add_buoyancy(p);
  for (const std::unique_ptr<Effect>& effect : s.effects) effect->add_forces(s);
}

void ForceStep::compute_new_contacts(RunState& s, FirstFailure& failure, std::span<const std::int32_t> which) {
  if (failure.exists() || which.empty()) return;
  failure.watch(s.clock.step, [&] {
    double& largest = s.totals.max_overlap_ratio;
    // no observer is shown these contacts: bodies do not get their forces in this step
    largest = std::max(largest, evaluate_pairs(s.scene, s.particles, s.walls, which, s.clock.dt, 0, s.clock.step, scratch_, s.pairs));
  });
}

/// in   evaluate   returns the largest overlap over its maximum
template <class Evaluate>
void ForceStep::compute_timed(RunState& s, Balance& balance, FirstFailure& failure, Phase phase, Evaluate&& evaluate) {
  const PhaseTimer timer(s.times, phase);
  const WorkTimer work(balance.computing(), balance.weight_of(s.clock.step));
  failure.watch(s.clock.step, [&] {
    double& largest = s.totals.max_overlap_ratio;
    largest = std::max(largest, evaluate());
    for (ExactSum& released : scratch_.released) {
      s.totals.walls.dissipated.add(released);
      released = {};
    }
    for (std::vector<DeepContact>& of_thread : scratch_.deep) {
      for (const DeepContact& contact : of_thread) s.totals.deep.add(contact, s.clock.step);
      of_thread.clear();
    }
  });
}

void ForceStep::compute_pairs(RunState& s, Balance& balance, FirstFailure& failure, PairClass of, std::span<const std::int32_t> which,
                              double friction_dt) {
  if (failure.exists() || which.empty()) return;
  compute_timed(s, balance, failure, of == PairClass::duplicated ? Phase::duplicated : Phase::contact, [&] {
    return evaluate_class(s.scene, s.particles, s.walls, of, which, s.clock.dt, friction_dt, s.clock.step, scratch_, s.pairs, observers_);
  });
}

void ForceStep::compute_balls(RunState& s, Balance& balance, FirstFailure& failure, const std::vector<std::int32_t>& due,
                              const std::function<void()>& write_columns) {
  compute_timed(s, balance, failure, Phase::contact, [&] {
    return evaluate_blocks(s.scene, s.particles, s.walls, PairClass::inner, due, s.clock.dt, s.clock.step, scratch_, s.pairs,
                           write_columns);
  });
}

FrameContacts ForceStep::contacts(RunState& s, Halo& halo) {
  // ghosts have the velocities that forces are computed with; their owners have been kicked since
  if (built_with::kRanks) {
    halo.start_refresh(s.particles, s.times);
    halo.finish_refresh(s.particles, s.times);
  }
  FrameContacts out;
  for (const auto* which : {&s.pairs.inner(), &s.pairs.outer()})
    append_frame_contacts(s.scene, s.particles, s.walls, *which, s.clock.dt, s.clock.step, scratch_, s.pairs, out);
  return out;
}

}  // namespace scree
