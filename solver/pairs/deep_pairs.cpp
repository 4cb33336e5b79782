#include "solver/pairs/deep_pairs.hpp"

#include <cmath>

namespace scree {

void go_on(PairPass& pass, std::size_t thread, const DeepPair& at, const DeepShift& before, CandidateLists& lists, BodyPair& pair,
           bool& too_deep) {
  const PairView& view = at.view;
  const double overlap = at.force.largest_overlap, limit = pass.stop_ratio * view.max_overlap;
  if (!std::isfinite(overlap)) too_deep = true;
  if (!(overlap <= kMaxOverlap * std::min(view.radius_a, view.radius_b)))
    pass.through.add(static_cast<std::int32_t>(&pair - pass.list.stored_pairs().data()));
  if (pass.is_read_only()) return;
  DeepShift next = before;
  if (pass.friction_dt > 0) {
    const bool is_beyond = view.max_overlap > 0 && !(overlap / view.max_overlap < pass.stop_ratio);
    if (is_beyond && counts_here(pair, pass.p))
      pass.scratch.deep[thread].push_back({pair.key, overlap, overlap - limit, view.a.x, before.passed == 0});
    next.passed = is_beyond || (before.passed != 0 && overlap > kForgetRatio * view.max_overlap) ? 1 : 0;
    if (view.has_mesh() && view.max_overlap > 0) {
      const Vec3 shift = next_shift(view, at.motion, at.features, at.shift, pass.friction_dt);
      if (at.has_other_shift || !(shift == at.shift)) {
        next.shift = transpose_times(view.pose.rotation, shift);
        lists.skin = -1;
      }
    }
  }
  set_deep_shift(pair.state.springs, next);
}

}  // namespace scree
