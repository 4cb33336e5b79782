#include "solver/pairs/forces.hpp"
#include "solver/contact/chosen_law.hpp"

#include <omp.h>

#include <algorithm>
#include <optional>

#include "solver/built_with.hpp"
#include "solver/neighbours/work_shares.hpp"
#include "solver/pairs/ball_evaluation.hpp"
#include "solver/pairs/pair_evaluation.hpp"
#include "solver/pairs/squeezed.hpp"

namespace scree {

namespace {

constexpr std::size_t kPairsAtOnce = 64;  // that a thread takes

struct Deepest {
  double overlap = 0;  ///< over the margin sum
  bool too_deep = false;
};

/// All pairs of a pass, by all threads.
template <ContactModel Model>
Deepest evaluate_all(PairPass& pass, std::span<const std::int32_t> which) {
  double overlap = 0;
  bool too_deep = false;
  std::optional<BallPass> of_balls;
  if (has_ball_way(pass)) of_balls.emplace(pass);
  const MeshPass of_meshes(pass);
  WorkShares shares(which.size(), omp_get_max_threads(), kPairsAtOnce);
  WorkShares blocks(pass.blocks ? pass.list.blocks().count(*pass.blocks) : 0, omp_get_max_threads(), 1);
  std::vector<std::int32_t> begun, taken_out;  // pairs of balls that may go into blocks, and that have left them
#pragma omp parallel if (pass.at_rest || !pass.is_read_only()) reduction(max : overlap) reduction(|| : too_deep)
  {
    const int thread = omp_get_thread_num();
    MeshEvaluation meshes(of_meshes);
    PairEvaluation<Model> evaluation(pass, thread, of_meshes.has_lanes() ? &meshes : nullptr);
    const auto finish = [&] {
      evaluation.finish();
      meshes.finish();
      for (const std::int32_t k : meshes.left()) evaluation.evaluate_alone(k);
    };
    if (of_balls) {
      BallEvaluation balls(*of_balls);
      blocks.take(thread, [&](std::size_t n) { balls.compute(pass.list.blocks().block(*pass.blocks, n)); });
      shares.take(thread, [&](std::size_t n) {
        if (!balls.take(which[n])) evaluation.evaluate(which[n]);
      });
      balls.finish();
      if (pass.has_columns)
        for (const std::int32_t k : balls.left()) evaluation.evaluate(k);
      finish();
      overlap = balls.largest_overlap();
      too_deep = balls.too_deep();
      if (pass.blocks) {
        const std::vector<std::int32_t> mine = balls.begun_to_touch();
#pragma omp critical
        {
          begun.insert(begun.end(), mine.begin(), mine.end());
          taken_out.insert(taken_out.end(), balls.left_of_blocks().begin(), balls.left_of_blocks().end());
          if (!pass.has_columns) pass.scratch.left.insert(pass.scratch.left.end(), balls.left().begin(), balls.left().end());
        }
      }
    } else {
      shares.take_chunks(thread, [&](std::size_t begin, std::size_t end) {
        PairsAhead ahead(pass.list, which.subspan(begin, end - begin));
        for (std::size_t n = begin; n < end; ++n) {
          ahead.advance(n - begin);
          evaluation.evaluate(which[n]);
        }
      });
      finish();
    }
    overlap = std::max({overlap, meshes.largest_overlap(), evaluation.largest_overlap()});
    too_deep = too_deep || meshes.too_deep() || evaluation.too_deep();
  }
  if (!begun.empty() || !taken_out.empty()) {
    std::sort(begun.begin(), begun.end());
    std::sort(taken_out.begin(), taken_out.end());
    pass.list.take_out_of_blocks(*pass.blocks, begun, taken_out, pass.p);
  }
  return {overlap, too_deep};
}

/// Names the pair that makes the run invalid, if one does.
void check_pass(const PairPass& pass, std::span<const std::int32_t> which, std::int64_t step, const Deepest& deepest) {
  const auto describe = [&](std::int32_t k) { return name_of_pair(pass.scene, pass.list.stored_pairs()[static_cast<std::size_t>(k)].key); };
  // balls touch each other, and walls that are no meshes, where they are drawn
  const auto has_margin = [&](std::int32_t k) {
    const BodyPair& pair = pass.list.stored_pairs()[static_cast<std::size_t>(k)];
    const auto is_ball = [&](std::int32_t row) {
      return pass.scene.shape(pass.p.shape[static_cast<std::size_t>(row)]).kind == ShapeKind::sphere;
    };
    return pass.scene.source().settings.margin > 0 && !(pass.scene.margins_by_size() && is_ball(pair.a) && (pair.b < 0 || is_ball(pair.b)));
  };
  const auto general = [&](std::int32_t k) {
    return step == 0       ? "they overlap at the start: move them, or let scree-decomposer part them with contact.relax = true"
           : has_margin(k) ? "the contact is too soft for this speed or load: raise the stiffness or the margin, or lower the speed"
                           : "the contact is too soft for this speed or load: raise the stiffness, or lower the speed";
  };
  const auto cure = [&](std::int32_t k) {
    const std::string squeezed = squeezed_between_walls(pass, k);
    return squeezed.empty() ? std::string(general(k)) : squeezed;
  };
  if (pass.intersecting.exists()) {
    const std::int32_t k = pass.intersecting.index();
    throw RunInvalid("step {}: {} intersect; {}", step, describe(k), cure(k));
  }
  if (pass.passing.exists()) {
    throw RunInvalid(
        "step {}: {} move by more than the sum of their margins in a step of {:.3g} s and could have passed through each other "
        "unseen; reduce the step",
        step, describe(pass.passing.index()), pass.dt);
  }
  if (pass.through.exists()) {
    const std::int32_t k = pass.through.index();
    throw RunInvalid(
        "step {}: {} lie in each other by more than {} times the bounding radius of the smaller: nothing is left for on_overlap = "
        "\"continue\" to continue; {}",
        step, describe(k), kMaxOverlap, cure(k));
  }
  for (std::size_t n = 0; n < which.size() && deepest.too_deep; ++n) {
    const PairResult& r = pass.list.stored_results()[static_cast<std::size_t>(which[n])];
    if (r.active && !(r.overlap_ratio < pass.stop_ratio)) {
      throw RunInvalid("step {}: {} touch to {:.3f} of their {} (limit {}); {}", step, describe(which[n]), r.overlap_ratio,
                       has_margin(which[n]) ? "margin" : "radius, the smaller one", pass.stop_ratio, cure(which[n]));
    }
  }
}

}  // namespace

namespace {

/// What a pass is for, besides forces.
enum class Purpose { forces, examination, rest };

PairPass make_pass(const SolverScene& scene, const ParticleSet& p, const std::vector<WallState>& walls, double dt, double friction_dt,
                   ForceScratch& scratch, PairList& list, PairObservers observers, Purpose purpose) {
  // a barrier makes room for gaps that are otherwise too near to be followed
  const double stop_ratio = scene.source().settings.barrier > 0 ? 1 - kBarrierShare * kMinBarrierGap : kStopOverlapRatio;
  return {scene,
          p,
          walls,
          dt,
          friction_dt,
          scratch,
          list,
          observers,
          pair_force_function(scene.law_choice()),
          scene.ball_laws().kind != LaneLawKind::none ? ball_force_function(scene.law_choice()) : nullptr,
          pair_holds_function(scene.law_choice()),
          stop_ratio,
          !scene.source().bonds.empty(),
          scene.continues(),
          purpose == Purpose::examination,
          purpose == Purpose::rest};
}

/// Computes pairs, and with them those in blocks where the pass has some.
Deepest compute(PairPass& pass, std::span<const std::int32_t> which) {
  const std::size_t threads = pass.scratch.distance.size();
  if (pass.holds != nullptr || pass.scene.law_choice().yields) pass.scratch.released.resize(threads);
  if (pass.continues) pass.scratch.deep.resize(threads);
  Deepest deepest;
  ContactModels::choose(pass.scene.law_choice().gathering, [&]<class Model>() { deepest = evaluate_all<Model>(pass, which); });
  return deepest;
}

/// Ends a pass that makes the run invalid.   in   which   all its pairs
double judged(const PairPass& pass, std::span<const std::int32_t> which, std::int64_t step, const Deepest& deepest) {
  if (deepest.too_deep) pass.list.write_back();
  check_pass(pass, which, step, deepest);
  return deepest.overlap;
}

double evaluate(const SolverScene& scene, const ParticleSet& p, const std::vector<WallState>& walls, std::span<const std::int32_t> which,
                double dt, double friction_dt, std::int64_t step, ForceScratch& scratch, PairList& list, PairObservers observers,
                Purpose purpose) {
  list.write_back();
  PairPass pass = make_pass(scene, p, walls, dt, friction_dt, scratch, list, observers, purpose);
  return judged(pass, which, step, compute(pass, which));
}

class Visitor : public PairObserver {
 public:
  explicit Visitor(const PairVisitor& visit) : visit_(visit) {}
  bool observes(const PairView&) const override { return true; }
  bool needs_outputs() const override { return false; }
  void observe(const PairContact& contact) override { visit_(contact); }

 private:
  const PairVisitor& visit_;
};

class FrameWriter : public PairObserver {
 public:
  explicit FrameWriter(FrameContacts& contacts) : contacts_(contacts) {}
  bool observes(const PairView&) const override { return true; }
  void observe(const PairContact& c) override {
    if (c.counts_here) append_contacts(c.pair, c.view, c.features.list, c.outputs, contacts_);
  }

 private:
  FrameContacts& contacts_;
};

}  // namespace

double evaluate_pairs(const SolverScene& scene, const ParticleSet& p, const std::vector<WallState>& walls,
                      std::span<const std::int32_t> which, double dt, double friction_dt, std::int64_t step, ForceScratch& scratch,
                      PairList& list, PairObservers observers) {
  return evaluate(scene, p, walls, which, dt, friction_dt, step, scratch, list, observers, Purpose::forces);
}

// where bodies sleep, pairs are due that differ from step to step
bool may_use_blocks(const SolverScene& scene, const ParticleSet& p) {
  return scene.ball_laws().kind != LaneLawKind::none && !p.may_sleep && !scene.continues();
}

double evaluate_class(const SolverScene& scene, const ParticleSet& p, const std::vector<WallState>& walls, PairClass which,
                      std::span<const std::int32_t> all, double dt, double friction_dt, std::int64_t step, ForceScratch& scratch,
                      PairList& list, PairObservers observers) {
  // where pairs are timed or shown, each goes for itself
  const bool in_blocks =
      may_use_blocks(scene, p) && friction_dt > 0 && friction_dt == dt && scratch.pair_seconds.empty() && !any_observes_bodies(observers);
  if (!in_blocks) return evaluate_pairs(scene, p, walls, all, dt, friction_dt, step, scratch, list, observers);
  list.fill_blocks(scene, p, which);
  PairPass pass = make_pass(scene, p, walls, dt, friction_dt, scratch, list, observers, Purpose::forces);
  pass.blocks = which;
  return judged(pass, all, step, compute(pass, list.blocks().others(which)));
}

double evaluate_blocks(const SolverScene& scene, const ParticleSet& p, const std::vector<WallState>& walls, PairClass which,
                       const std::vector<std::int32_t>& due, double dt, std::int64_t step, ForceScratch& scratch, PairList& list,
                       const std::function<void()>& write_columns) {
  const std::vector<std::int32_t>& all = which == PairClass::inner   ? list.inner()
                                         : which == PairClass::outer ? list.outer()
                                                                     : list.duplicated();
  PairPass pass = make_pass(scene, p, walls, dt, dt, scratch, list, {}, Purpose::forces);
  pass.blocks = which;
  pass.has_ball_rows = true;
  pass.has_columns = false;
  scratch.left.clear();
  Deepest deepest = compute(pass, due);
  if (!scratch.left.empty()) {
    write_columns();
    std::vector<std::int32_t> left = scratch.left, begun;
    std::sort(left.begin(), left.end());
    pass.blocks.reset();
    pass.has_columns = true;
    const Deepest of_left = compute(pass, left);
    deepest = {std::max(deepest.overlap, of_left.overlap), deepest.too_deep || of_left.too_deep};
    for (const std::int32_t k : left)
      if (list.blocks().place_of(k) == BallBlocks::kWaits && list.stored_results()[static_cast<std::size_t>(k)].active) begun.push_back(k);
    list.take_out_of_blocks(which, begun, {}, p);
  }
  return judged(pass, all, step, deepest);
}

void evaluate_at_rest(const SolverScene& scene, const ParticleSet& p, const std::vector<WallState>& walls,
                      std::span<const std::int32_t> which, double dt, std::int64_t step, ForceScratch& scratch, PairList& list) {
  evaluate(scene, p, walls, which, dt, 0, step, scratch, list, {}, Purpose::rest);
}

void visit_pairs(const SolverScene& scene, const ParticleSet& p, const std::vector<WallState>& walls, std::span<const std::int32_t> which,
                 std::int64_t step, ForceScratch& scratch, PairList& list, const PairVisitor& visit) {
  const std::vector<PairResult> kept = list.results();
  Visitor visitor(visit);
  PairObserver* const observers[] = {&visitor};
  evaluate(scene, p, walls, which, 0, 0, step, scratch, list, observers, Purpose::examination);
  list.results() = kept;
}

void append_frame_contacts(const SolverScene& scene, const ParticleSet& p, const std::vector<WallState>& walls,
                           std::span<const std::int32_t> which, double dt, std::int64_t step, ForceScratch& scratch, PairList& list,
                           FrameContacts& contacts) {
  // what the step computed, with the velocities that bodies had then, stays: loads of walls are read from it
  const std::vector<PairResult> kept = list.results();
  FrameWriter writer(contacts);
  PairObserver* const observers[] = {&writer};
  evaluate(scene, p, walls, which, dt, 0, step, scratch, list, observers, Purpose::examination);
  list.results() = kept;
}

}  // namespace scree
