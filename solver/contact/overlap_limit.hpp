// Contacts deeper than their maximum overlap, which contact.on_overlap = "continue" lets a run go on with: a wall that moves leaves a body
// no place, and no stiffness holds against that.
//
// The force. Up to kStopOverlapRatio of the maximum overlap of a pair (PairView::max_overlap), where a run ends otherwise, nothing differs.
// Beyond, the potential goes on along its tangent: U(l + y) = U(l) + F(l) y + F'(l) y^2 / 2. A linear law does so by itself; HertzLaw has
// its limit l from PairLaw.
//
// The overlap. Balls, and any body at an analytic wall, have a gap with a sign: nothing is to be done. Of triangles nothing is known once
// surfaces cross. So a pair with a mesh on both sides, or a ball and a mesh, keeps a shift s of A against B, from a place where they nearly
// meet on: features are found with A moved out by s, where the surfaces are apart, and each has the overlap of the shifted pose and s . n
// besides. Where the faces that touch are plane this is the signed distance itself, whatever s is: the overlap does not depend on the
// shift, and the energy is exact. Where a normal turns as the bodies slide along each other (a corner of one around an edge of the other)
// the work of the turning s . n is left out, and the balance of energies does not close: by at most what the contact holds.
//
// A shift is kept by the pair, in the frame of B, as a DeepShift (contact/pair_memory.hpp), so that it travels, and lies in checkpoints.
#pragma once

#include <vector>

#include "solver/contact/pair_force.hpp"

namespace scree {

/// A pair is shifted where what is left of its maximum overlap, after one more step at the present speed, is less than 1 - kShiftFrom of
/// it; to kShiftTo. It is shifted back by as much as it comes out below kShiftBack. Far enough from each other that a shift lasts many
/// steps, and from 1 that no step crosses what is left.
inline constexpr double kShiftFrom = 0.8, kShiftTo = 0.5, kShiftBack = 0.3;
/// Lanes leave pairs from this share of their maximum overlap on to the general path, which looks after shifts.
inline constexpr double kLookFrom = 0.3;
/// Below it a contact that was beyond its maximum overlap has ended: the next time it passes the limit counts as another one.
inline constexpr double kForgetRatio = 0.8;
/// Overlap over the bounding radius of the smaller body at which a run is stopped all the same: a body is nearly through by then.
inline constexpr double kMaxOverlap = 1.5;
/// A shift that leaves surfaces crossed grows by this share of the maximum overlap and twice that, again and again, up to kMaxOverlap.
inline constexpr double kShiftMore = 0.5;
/// Least cosine between a shift and a normal by which the shift can be taken back.
inline constexpr double kMinCosine = 0.1;

/// Notes it; nothing takes the row away.
inline void set_deep_shift(std::vector<FrictionSpring>& springs, const DeepShift& contact) {
  if (contact.passed != 0 || squared_length(contact.shift) > 0)
    remember(springs, contact);
  else
    forget<DeepShift>(springs);
}

/// The pair with A moved out by a shift (frame of A), as features are found: all that overlap at the true pose are within its reach.
PairView shifted_view(const PairView& view, const Vec3& shift);
/// Makes features of the shifted pose those of the true one.
void take_shift_back(const Vec3& shift, std::vector<ContactFeature>& features);
/// The shift for the next step (frame of A).   in   features   of the true pose, at least one     in   shift   they were found with
Vec3 next_shift(const PairView& view, const PairMotion& motion, const std::vector<ContactFeature>& features, const Vec3& shift, double dt);

}  // namespace scree
