// What a loop over pairs does with those that may be deeper than their maximum overlap (contact/overlap_limit.hpp).
#pragma once

#include <algorithm>
#include <vector>

#include "solver/contact/contact_model.hpp"
#include "solver/contact/overlap_limit.hpp"
#include "solver/pairs/pair_pass.hpp"

namespace scree {

/// Lists the candidates of a pair whose surfaces cross, at a shift of A further back on the way that it came.
/// in, out   shift   of A, frame of A     Returns whether there is one.
template <ContactModel Model>
bool list_shifted(const PairView& view, const PairVelocities& velocities, double skin, MeshDistanceScratch& scratch, CandidateLists& lists,
                  Vec3& shift) {
  Vec3 way = shift;
  if (!(squared_length(way) > 0))
    way = rotate_inverse(view.a.q, velocities.v_b + cross(velocities.w_b, view.a.x - view.b.x) - velocities.v_a);
  const double most = kMaxOverlap * std::min(view.radius_a, view.radius_b), size = length(way), begin = length(shift);
  if (!(size > 0)) return false;
  for (double further = kShiftMore * view.max_overlap; begin + further < most; further *= 2) {
    shift = ((begin + further) / size) * way;
    if (Model::list(shifted_view(view, shift), skin, scratch, lists)) return true;
  }
  return false;
}

/// A pair with a shift that does not touch: the shift goes, unless the surfaces cross where the bodies are.
template <ContactModel Model>
void part_shifted(const PairView& view, double skin, MeshDistanceScratch& scratch, CandidateLists& lists, PairState& state) {
  DeepShift left = remembered<DeepShift>(state.springs);
  left.passed = 0;
  if (Model::list(view, skin, scratch, lists)) left = {};
  lists.skin = -1;
  state.keep_lasting();
  set_deep_shift(state.springs, left);
}

/// A pair in contact, as its force was found.
struct DeepPair {
  const PairView& view;
  const PairMotion& motion;
  const std::vector<ContactFeature>& features;
  const PairForce& force;
  const Vec3& shift;     ///< of A, frame of A, that its features were found with
  bool has_other_shift;  ///< than the one that the pair keeps
};

/// Counts a pair that is beyond its maximum overlap, and notes how far it is to be moved out in the next step.
/// in    before     what the pair kept before its springs were replaced
/// out   too_deep   set where the overlap is not a number
void go_on(PairPass& pass, std::size_t thread, const DeepPair& at, const DeepShift& before, CandidateLists& lists, BodyPair& pair,
           bool& too_deep);

}  // namespace scree
