// What the loop over pairs does with one of them: is it idle, are its candidates still good, which features does it have, what is their
// force. A template of the scene's contact model (contact/contact_model.hpp).
#pragma once

#include <algorithm>
#include <span>
#include <utility>
#include <vector>

#include "solver/built_with.hpp"
#include "solver/contact/contact_models.hpp"
#include "solver/features/pass_through.hpp"
#include "solver/pairs/deep_pairs.hpp"
#include "solver/pairs/law_of_pair.hpp"
#include "solver/pairs/mesh_evaluation.hpp"
#include "solver/pairs/pair_clock.hpp"
#include "solver/pairs/pair_pass.hpp"
#include "solver/pairs/pairs_ahead.hpp"
#include "solver/pairs/pending_pairs.hpp"
#include "solver/pairs/posed_pairs.hpp"

namespace scree {

/// Length of the lists that a pair gets [m].
double candidate_skin(const PairView& view, const PairVelocities& m, double dt);
/// First look of may_have_passed_through, without its frames: false only where it says false.
bool is_fast(const PairView& view, double squared_speed, double dt);
/// No point of the smaller body is faster than this against the larger one [m^2/s^2].
double squared_speed_of(const PairView& view, const PairVelocities& m);
/// Appends the contacts of a pair as they stand in frames.
void append_contacts(const BodyPair& pair, const PairView& view, const std::vector<ContactFeature>& features,
                     const std::vector<ContactOutput>& outputs, FrameContacts& out);

/// Shifts overlaps by what the pair counts them from, until it has parted. Returns that [m].
double count_from_rest(const std::vector<FrictionSpring>& springs, PairFeatures& features);

/// What the features of a pair did, and what a ball contact did.
void set_result(const PairView& view, const PairForce& f, std::size_t features, const Mat3& a_to_world, PairResult& result);
void set_result(const PairView& view, const BallForce& force, PairResult& result);

/// One thread's part of a pass.
template <ContactModel Model>
class PairEvaluation {
 public:
  /// in   lanes   take the pairs that they can; null: none
  PairEvaluation(PairPass& pass, int thread, MeshEvaluation* lanes = nullptr)
      : pass_(pass),
        lanes_(lanes),
        posed_(pass),
        pending_(PendingPairs::of_thread()),
        distance_(*pass.scratch.distance[static_cast<std::size_t>(thread)]),
        thread_(static_cast<std::size_t>(thread)),
        laws_(pass) {
    pending_.clear();  // a pass that failed may have left some
  }

  void evaluate(std::int32_t k) {
    IdlePair& idle = pass_.list.idle()[static_cast<std::size_t>(k)];
    if (pass_.way_of(idle) < idle.way) return;  // its result says so already
    const PairClock clock(pass_.scratch.pair_seconds, k);
    BodyPair& pair = pass_.list.stored_pairs()[static_cast<std::size_t>(k)];
    PairResult& result = pass_.list.stored_results()[static_cast<std::size_t>(k)];
    result.active = false;
    result.contact_count = 0;
    if constexpr (Model::kHasEdgeLanes) {
      if (lanes_ != nullptr && posed_.may_take(pair)) {
        posed_.add(k, pair);
        if (posed_.is_full()) finish_posed();
        return;
      }
    }
    prefetch_pair(pair, result);
    const PairView view = view_of(pass_.scene, pass_.p, pass_.walls, pair.a, pair.b, pair.key.zone);
    CandidateLists& lists = lists_of(pair);
    if (pass_.continues) {
      const Vec3 shift = view.pose.rotation * remembered<DeepShift>(pair.state.springs).shift;
      if (squared_length(shift) > 0) return evaluate_shifted(k, view, shift, lists, pair, result, idle);
    }
    double moved = motion_of_pair(view, lists);
    if (keep_candidates(k, view, pair, lists, moved)) return evaluate_near(k, view, moved, lists, pair, result, idle);
    if (pass_.continues) evaluate_crossing(k, view, Vec3{}, lists, pair, result, idle);
  }

  /// The same without lanes, of a pair that they have left.
  void evaluate_alone(std::int32_t k) {
    lanes_ = nullptr;
    evaluate(k);
  }

  /// Completes the pairs that have waited for others.
  void finish() {
    finish_posed();
    finish_pending();
  }

  double largest_overlap() const { return largest_overlap_; }  ///< over the maximum overlap of its pair
  bool too_deep() const { return too_deep_; }

 private:
  /// Pairs whose poses have waited for others.
  void finish_posed() {
    posed_.finish([&](std::int32_t k, const RelativePose& pose, double moved, double squared_speed) {
      const auto at = static_cast<std::size_t>(k);
      BodyPair& pair = pass_.list.stored_pairs()[at];
      CandidateLists& lists = *pair.lists;
      PairView& view = pending_.next_view();
      view_two_meshes(pass_.scene, pass_.p, pair.a, pair.b, pose, view);
      if (moved > lists.first_slack && is_fast(view, squared_speed, pass_.dt)) see_passing(k, view, pair, moved, lists);
      if (moved > lists.skin && !list_again(k, view, pair, lists, moved)) return;
      evaluate_near(k, view, moved, lists, pair, pass_.list.stored_results()[at], pass_.list.idle()[at]);
    });
  }

  /// A pair whose candidates are good.
  void evaluate_near(std::int32_t k, const PairView& view, double moved, CandidateLists& lists, BodyPair& pair, PairResult& result,
                     IdlePair& idle) {
    if (moved < lists.first_slack) return rest(view, lists.first_slack - moved, pair, idle);
    idle.way = kNeverIdle;
    if (!find_features(k, view, moved, lists)) return;
    finish_features(k, view, moved, lists, pair, result, idle);
  }

  void finish_pending() {
    pending_.finish(pass_.list.stored_pairs(), [&](PendingPair& pending) {
      const auto k = static_cast<std::size_t>(pending.k);
      BodyPair& pair = pass_.list.stored_pairs()[k];
      std::swap(features_.list, pending.features);
      share_among_cells(pending.view, features_);
      finish_features(pending.k, pending.view, pending.moved, *pair.lists, pair, pass_.list.stored_results()[k], pass_.list.idle()[k]);
      std::swap(features_.list, pending.features);
    });
  }

  /// Returns false where the pair is left to finish(), since its candidates are looked at with those of others.
  bool find_features(std::int32_t k, const PairView& view, double moved, CandidateLists& lists) {
    if constexpr (Model::kHasEdgeLanes) {
      if (lanes_ != nullptr && PendingPairs::may_take(view)) return begin(k, view, moved, lists);
    }
    Model::find_features(view, moved, lists, features_);
    return true;
  }

  bool begin(std::int32_t k, const PairView& view, double moved, CandidateLists& lists) {
    find_due_candidates(lists, due_);
    if (!due_.indices.empty() && PendingPairs::could_have_room(due_)) {
      if (!pending_.has_room(due_)) finish_pending();
      pending_.add(k, moved, view, lists, due_);
      return false;
    }
    due_mesh_features(view.a, view.b, view.pose, view.reach, sharing_of_vertices(view), std::min(view.radius_a, view.radius_b), due_, lists,
                      features_.list);
    share_among_cells(view, features_);
    return true;
  }

  /// A pair whose surfaces may cross: its features are those that it has where A is moved out.
  [[gnu::noinline]] void evaluate_shifted(std::int32_t k, const PairView& view, const Vec3& shift, CandidateLists& lists, BodyPair& pair,
                                          PairResult& result, IdlePair& idle) {
    const PairView shifted = shifted_view(view, shift);
    double moved = motion_of_pair(shifted, lists);
    if (!keep_candidates(k, shifted, pair, lists, moved)) return evaluate_crossing(k, view, shift, lists, pair, result, idle);
    shift_ = shift;
    finish_shifted(k, view, shifted, moved, lists, pair, result, idle);
  }

  /// A pair whose surfaces cross at the shift that it has, which may be none.
  [[gnu::noinline]] void evaluate_crossing(std::int32_t k, const PairView& view, Vec3 shift, CandidateLists& lists, BodyPair& pair,
                                           PairResult& result, IdlePair& idle) {
    const PairVelocities now = velocities(pair, view);
    if (!list_shifted<Model>(view, now, candidate_skin(view, now, pass_.dt), distance_, lists, shift)) {
      lists.skin = -1;
      return pass_.intersecting.add(k);
    }
    shift_ = shift;
    has_other_shift_ = true;
    finish_shifted(k, view, shifted_view(view, shift), 0, lists, pair, result, idle);
    has_other_shift_ = false;
    lists.skin = -1;
  }

  void finish_shifted(std::int32_t k, const PairView& view, const PairView& shifted, double moved, CandidateLists& lists, BodyPair& pair,
                      PairResult& result, IdlePair& idle) {
    idle.way = kNeverIdle;
    Model::find_features(shifted, moved, lists, features_);
    take_shift_back(shift_, features_.list);
    share_among_cells(view, features_);
    if (features_.list.empty()) {
      if (!pass_.is_read_only() && pass_.friction_dt > 0)
        part_shifted<Model>(view, candidate_skin(view, velocities(pair, view), pass_.dt), distance_, lists, pair.state);
    } else {
      MeshEvaluation* const lanes = std::exchange(lanes_, nullptr);
      finish_features(k, view, moved, lists, pair, result, idle);
      lanes_ = lanes;
    }
    shift_ = {};
  }

  /// The forces of a pair whose features are found.
  void finish_features(std::int32_t k, const PairView& view, double moved, CandidateLists& lists, BodyPair& pair, PairResult& result,
                       IdlePair& idle) {
    if (features_.list.empty() && lists.next_examination > lists.way) {
      const double left = std::min(lists.next_examination - lists.way, lists.skin - moved);
      return rest(view, left, pair, idle);
    }
    if constexpr (Model::kGathering != Gathering::potential) features_.hands_over = view.geometry != PairGeometry::two_meshes;
    if (view.off_middle != 0)
      for (ContactFeature& f : features_.list) f.x -= view.off_middle * f.n;
    const double rest_overlap = pass_.has_bonds ? count_from_rest(pair.state.springs, features_) : 0;
    const double share = pass_.has_bonds ? remembered<DampingShare>(pair.state.springs).factor : 1;
    if (view.reach > view.margin)
      weigh_beyond_margin(view, moved, lists, pair);
    else
      Model::weigh(view, kNoPull, moved, lists, features_);
    if (features_.list.empty()) {
      if (!pass_.is_read_only()) pair.state.keep_lasting();
    } else if (lanes_ == nullptr || !lanes_->take(k, pair, view, features_)) {
      apply_law(view, lists, pair, result);
    }
    if (share != 1 && result.active && !pass_.is_read_only()) remember(pair.state.springs, DampingShare{share});
    if (rest_overlap > 0 && !pass_.is_read_only()) remember(pair.state.springs, RestOverlap{rest_overlap});
  }

  /// Looks whether the bodies could have passed through each other, and lists candidates again where the pair has used up its skin.
  /// Returns false when its meshes intersect.
  bool keep_candidates(std::int32_t k, const PairView& view, const BodyPair& pair, CandidateLists& lists, double& moved) {
    // a body behind a plane or in a cylinder is still seen
    if (built_with::kMeshes && view.has_mesh() && pass_.dt > 0 && moved > lists.first_slack &&
        is_fast(view, squared_speed_of(view, velocities(pair, view)), pass_.dt))
      see_passing(k, view, pair, moved, lists);
    return !(lists.skin < 0 || moved > lists.skin) || list_again(k, view, pair, lists, moved);
  }
  void see_passing(std::int32_t k, const PairView& view, const BodyPair& pair, double moved, const CandidateLists& lists) {
    const PairMotion motion = motion_of(pass_.p, pair.a, pair.b, view, velocities(pair, view), matrix_of(view.a.q));
    if (may_have_passed_through(view.a, view.b, motion, view.radius_a, view.radius_b, view.margin, pass_.dt, moved, lists, distance_))
      pass_.passing.add(k);
  }
  bool list_again(std::int32_t k, const PairView& view, const BodyPair& pair, CandidateLists& lists, double& moved) {
    moved = 0;
    if (Model::list(view, candidate_skin(view, velocities(pair, view), pass_.dt), distance_, lists)) return true;
    if (!pass_.continues) pass_.intersecting.add(k);
    return false;
  }
  PairVelocities velocities(const BodyPair& pair, const PairView& view) const {
    return velocities_of(pass_.p, pass_.walls, pair.a, pair.b, view, pass_.friction_dt > 0);
  }

  /// Those of the pair; made from nothing at each look for balls that lanes take in all other steps.
  CandidateLists& lists_of(BodyPair& pair) {
    if (is_of_lanes(pair)) {
      lists_of_balls_.skin = -1;
      return lists_of_balls_;
    }
    if (pair.lists == nullptr) pair.lists = std::make_unique<CandidateLists>();
    prefetch_candidates(*pair.lists);
    return *pair.lists;
  }

  bool is_of_lanes(const BodyPair& pair) const {
    const LaneLaws& laws = pass_.scene.ball_laws();
    if (laws.kind == LaneLawKind::none || !pass_.allows_lanes() || !(pass_.p.ball_radius[static_cast<std::size_t>(pair.a)] > 0))
      return false;
    return pair.b >= 0 ? pass_.p.ball_radius[static_cast<std::size_t>(pair.b)] > 0
                       : laws.row_of_zone[static_cast<std::size_t>(pair.key.zone)] >= 0;
  }

  /// Since the lists were made, if they are.
  static double motion_of_pair(const PairView& view, CandidateLists& lists) {
    if (!(lists.skin >= 0)) return 0;
    return view.geometry == PairGeometry::two_meshes ? follow_motion(lists, view.pose, view.radius_a, view.radius_b)
                                                     : motion_since_listed(lists, view.pose, view.radius_a, view.radius_b);
  }

  /// Nothing can be within the margin before both have gone what is left [m].
  void rest(const PairView& view, double left, BodyPair& pair, IdlePair& idle) {
    if (pass_.is_read_only()) return;
    if (view.zone == nullptr || !pass_.scene.has_driven_walls()) idle.way = pass_.way_of(idle) + left;
    pair.state.keep_lasting();
  }

  /// Features were found as if the margins were as wide as the widest reach of a law: overlaps count from the margins, and what is
  /// beyond the reach of this pair's law is none.
  void weigh_beyond_margin(const PairView& view, double moved, CandidateLists& lists, const BodyPair& pair) {
    const double reach = laws_.law(view, pair).reach;
    for (ContactFeature& f : features_.list) f.overlap -= view.reach - view.margin;
    if (!features_.has_layer)  // patches go with a layer, and have none beyond touch
      std::erase_if(features_.list, [&](const ContactFeature& f) { return !(f.overlap > -reach); });
    if (pass_.scene.law_choice().attraction && !pass_.scene.law_choice().necks)
      Model::weigh(view, pull_view_of(pass_.scene, pass_.p, pair.a, pair.b, view, reach), moved, lists, features_);
    else
      Model::weigh(view, kNoPull, moved, lists, features_);
    if (pass_.holds == nullptr || features_.list.empty()) return;
    const PairLaw& law = laws_.law(view, pair);
    double released = 0;
    if (!pass_.holds(features_, law, radius_of(view, law), pair.state.springs, released)) return features_.list.clear();
    if (released > 0 && pass_.friction_dt > 0 && !pass_.is_read_only() && counts_here(pair, pass_.p))
      pass_.scratch.released[thread_].add(released);
  }

  /// The force of the features that were found, and the pair's result.
  [[gnu::always_inline]] void apply_law(const PairView& view, CandidateLists& lists, BodyPair& pair, PairResult& result) {
    DeepShift deep;
    if (pass_.continues) deep = remembered<DeepShift>(pair.state.springs);
    const PairLaw& law = laws_.limited_law(view, pair);
    if (pass_.force_of_balls != nullptr && is_ball_contact(pass_.scene, pass_.p, pair.a, pair.b, pair.key.zone))
      return apply_ball_law(view, law, deep, lists, pair, result);
    const Mat3 a_to_world = matrix_of(view.a.q);
    PairMotion motion = motion_of(pass_.p, pair.a, pair.b, view, velocities(pair, view), a_to_world);
    if (pass_.scene.law_choice().needs_radius) motion.radius = radius_of(view, law);
    if (view.zone != nullptr && pass_.scene.has_moving_surfaces()) {
      const auto wall = static_cast<std::size_t>(view.zone->wall);
      if (pass_.scene.source().walls[wall].surface.moves()) {
        surface_ = surface_beneath(pass_.walls[wall], view, a_to_world, pass_.friction_dt > 0);
        motion.surface = &surface_;
      }
    }
    if (view.zone != nullptr && pass_.scene.has_answering_walls())
      motion.inverse_mass_b = pass_.scene.wall_mobility(static_cast<std::size_t>(view.zone->wall), view.a.x);
    const PairForce f = pass_.force_of(features_, law, motion, pass_.dt, pass_.friction_dt, springs_of(pair), outputs_of(view));
    if (f.yielded > 0 && !pass_.is_read_only() && counts_here(pair, pass_.p)) pass_.scratch.released[thread_].add(f.yielded);
    set_result(view, f, features_.list.size(), a_to_world, result);
    conclude(view, law, motion, f, a_to_world, deep, lists, pair, result);
  }

  /// A pass that only looks must not change anything: it works on a copy of the springs.
  std::vector<FrictionSpring>& springs_of(BodyPair& pair) {
    if (!pass_.is_read_only()) return pair.state.springs;
    copy_of_springs_ = pair.state.springs;
    return copy_of_springs_;
  }

  /// The same of a ball contact, whose frame of A has the axes of the world.
  [[gnu::noinline]] void apply_ball_law(const PairView& view, const PairLaw& law, const DeepShift& deep, CandidateLists& lists,
                                        BodyPair& pair, PairResult& result) {
    const Mat3 a_to_world = matrix_of(view.a.q);
    const PairVelocities now = velocities(pair, view);
    PairMotion motion = motion_of(pass_.p, pair.a, pair.b, view, now, a_to_world);
    if (pass_.scene.law_choice().needs_radius) motion.radius = radius_of(view, law);
    const BallForce of_ball =
        pass_.force_of_balls({view, now, features_.list.front(), law, motion.radius, motion.inverse_mass_a, motion.inverse_mass_b},
                             pass_.dt, pass_.friction_dt, springs_of(pair), outputs_of(view));
    set_result(view, of_ball, result);
    conclude(view, law, motion, of_ball.force, a_to_world, deep, lists, pair, result);
  }

  /// Looks how deep a contact is, and shows it to those who look.
  [[gnu::always_inline]] void conclude(const PairView& view, const PairLaw& law, const PairMotion& motion, const PairForce& f,
                                       const Mat3& a_to_world, const DeepShift& deep, CandidateLists& lists, BodyPair& pair,
                                       const PairResult& result) {
    largest_overlap_ = std::max(largest_overlap_, result.overlap_ratio);
    if (pass_.continues)
      go_on(pass_, thread_, {view, motion, features_.list, f, shift_, has_other_shift_}, deep, lists, pair, too_deep_);
    else if (!(result.overlap_ratio < pass_.stop_ratio))
      too_deep_ = true;  // or not a number
    if (!pass_.observers.empty()) show(view, law, motion, f, a_to_world, lists, pair);
  }

  std::vector<ContactOutput>* outputs_of(const PairView& view) {
    const auto needs = [&](const PairObserver* o) { return o->needs_outputs() && o->observes(view); };
    return std::any_of(pass_.observers.begin(), pass_.observers.end(), needs) ? &outputs_ : nullptr;
  }

  [[gnu::noinline]] void show(const PairView& view, const PairLaw& law, const PairMotion& motion, const PairForce& force,
                              const Mat3& a_to_world, const CandidateLists& lists, const BodyPair& pair) {
    const PairContact contact{
        pair,      view,   features_, force, motion, law, outputs_, lists, a_to_world, pass_.friction_dt, counts_here(pair, pass_.p),
        distance_, thread_};
    for (PairObserver* observer : pass_.observers) {
      if (observer->observes(view)) observer->observe(contact);
    }
  }

  static inline const PullView kNoPull;

  PairPass& pass_;
  MeshEvaluation* lanes_;
  PosedPairs posed_;
  PendingPairs& pending_;
  DueCandidates due_;
  MeshDistanceScratch& distance_;
  std::size_t thread_;
  CandidateLists lists_of_balls_;
  PairFeatures features_;
  std::vector<ContactOutput> outputs_;
  std::vector<FrictionSpring> copy_of_springs_;
  SurfaceBeneath surface_;
  LawOfPair laws_;
  Vec3 shift_;                    // of A in the pair that is concluded (contact/overlap_limit.hpp), frame of A
  bool has_other_shift_ = false;  // than the one that the pair keeps
  double largest_overlap_ = 0;
  bool too_deep_ = false;
};

}  // namespace scree
