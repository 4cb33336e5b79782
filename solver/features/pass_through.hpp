// Whether two surfaces may have passed through each other between two steps, unseen by the looks at either end.
#pragma once

#include "solver/features/pair_view.hpp"

namespace scree {

/// Distance of two surfaces, or from the centre of a sphere to the surface of its partner; at most `reach` [m]. One of them has a mesh.
double surface_distance(const PairBody& a, const PairBody& b, double reach, MeshDistanceScratch& scratch, TrianglePair& nearest);

/// Whether a pair with at least one mesh may have crossed in the last step. Never false for a pair that did; what moves along a
/// surface or away from it is cleared.
///
/// How: a pair that moves by less than its margin sum in a step, or by less than the slack of its nearest candidate, cannot
/// cross unseen. All others are followed back to where they were, both bodies with the velocities of the step: over a motion
/// shorter than their distance nothing crosses, so each look at the distance says how far back the next one may be
/// (conservative advancement). A sphere crosses with its centre.
/// Source: Mirtich, Impulse-based Dynamic Simulation of Rigid Body Systems (1996), section 2.3, without its time ordering.
/// in   motion    motion_since_listed [m]     in  radius_a, radius_b  bounding; a wall's at least twice that of its body [m]
/// Cost: a few operations for slow pairs; a fast one that touches takes (motion in the step / gap) distance queries, and counts
/// as crossed when that is more than kMaxLooks.
/// Limits: an accelerated wall is followed back with its present velocity.
bool may_have_passed_through(const PairBody& a, const PairBody& b, const PairMotion& m, double radius_a, double radius_b, double margin,
                             double dt, double motion, const CandidateLists& lists, MeshDistanceScratch& scratch);

/// Distance queries after which a pair counts as crossed: a body that slides at a gap of half the margin may go 50 margins a step.
inline constexpr int kMaxLooks = 100;

}  // namespace scree
