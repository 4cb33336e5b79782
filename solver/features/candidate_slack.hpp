// What the parts of two meshes lack before they can be a feature. Most corners and edges that are near each other are none: they are
// further apart than the margin, another triangle is nearer to the corner, the nearest points of two edges lie beyond an end, or the normal
// between them leans out of the wedge of an edge. Each such "no" holds for a while, and the candidate waits for as much motion as that
// takes (its slack); one that waits longer than the lists last is not listed. The features that come out are the same, to the bit.
//
// Slacks count on the way of a pair, which adds up its motion from step to step and so is never less than the motion from any step to any
// other: a slack may begin in any step. A candidate that lacks ten steps' motion is looked at every tenth step, and not in every step once
// the pair has moved by its distance in whatever direction.
//
// Motion m is that of motion_since_listed(): in the frame of the larger body no point of the smaller one (radius R) has gone further, and
// since m >= 4 R sin(angle / 4), no unit vector in it has changed by more than m / R. Letters as in edge_features.cpp: edges u, v at
// pa, pb with the angle phi between them, w = u x v, n = +-w / |w| from B to A. Primes are a later pose at which the two are a feature,
// that is with xa' and xb' on both edges, xa' - xb' = g n', n' perpendicular to u' and v', g < margin.
//
// Ends. Take the same points of the bodies at the pose of the lists: xa, and xb no further than m from xb'. With d = xa - xb,
//   |d.u| <= m |u|    and    |d.v| <= (m + margin m / R) |v|,    or the other way round, whichever of the two edges moves.
// The point where d.u = d.v = 0 is at the parameters s, t; in lengths along the edges xa and xb are from it by at most
//   (1 + |cos phi|) (1 + margin / R) m / sin^2 phi = (1 + margin / R) m / (1 - |cos phi|),
// so both parameters are within this of their edges, or there is no feature.
//
// Wedge. |w' - w| <= |u| |v| m / R, so the normal turns by an angle of a sine at most m / (R sin phi): its ends are no further apart than
// c = m / (kChord R sin phi), while that is below 1. The lean -n.(conormal of A) or n.(conormal of B) changes by c + m / R at most, and is
// still no less than kFadeWedge when it was so by more.
// The normal has two signs. The one that w has not now needs lines that have passed each other: with h the distance of the lines,
//   0 > (xa' - xb').n >= h - (margin + m) c - m.
//
// Side. An edge of a wall is touched from the side on which its fold is convex (edge_features.hpp). Let r point to that side, half way
// between its faces: where n' leans over neither face by kFadeWedge, and the fold is no knife edge (kFoldSeen), n'.r > 0, so that the
// nearest point of the other edge lies beyond the plane through the edge with the normal r. That point is no further beyond it than an end
// of its edge, and neither end comes nearer to that plane than by m: the wall is the larger body, and r is fixed in it.
//
// A pair without a feature rests until its first slack is used up, and until then costs two additions a step. That takes no other bound
// than the distance of the surfaces less the margin, which nothing here passes: were the bodies pushed together by it, along the shortest
// line between them, the ends of that line would be a feature.
#pragma once

#include <algorithm>
#include <cmath>

#include "solver/features/pair_features.hpp"

namespace scree {

/// Slack of a candidate that lacks so much [m], counted on the way of its pair: rounded down, with room for the rounding of what it lacks
/// relative to `size` [m].
inline float slack_on_way(double way, double lacks, double size) {
  constexpr double kDistanceRounding = 1e-12;  // as in slack_below
  constexpr double kRoundedDown = 1 - 0x1p-22;
  return static_cast<float>(kRoundedDown * (way + std::max(0.0, lacks - kDistanceRounding * size)));
}

/// What a vertex and a triangle lack before the triangle must be looked at [m].
/// On a convex surface it must come within the margin and be the nearest: distances change by no more than the motion, so that a triangle
/// that is further away than another by more than twice the motion is not. On another surface every triangle within margin + sharing of a
/// vertex that touches may hold a minimum of the distance or hide one (features/surface_minima.hpp).
/// in   own       distance of the triangle [m]
/// in   nearest   on a convex surface the distance of another triangle, better of a near one; else no triangle of the vertex may be
///                nearer, of those that wait neither: distance_of_waiting() [m]
inline double lack_of(const SolverShape& surface, double own, double nearest, double margin, double sharing) {
  return surface.is_convex ? std::max(own - margin, 0.5 * (own - nearest)) : std::max(own - margin - sharing, nearest - margin);
}

/// No triangle that waits is nearer than this [m]: whatever it waits for, it is not within the margin before. Triangles that are not listed
/// do not come within the margin while the lists last.
/// in   slack   not used up yet [m]
inline double distance_of_waiting(double slack, double way, double margin) { return margin + (slack - way); }

/// Two edges of a candidate, A frame, and where the lines through them are nearest to each other.
/// Letters of docs/reference/contact-law.md section 3.2: edge vectors u, v at pa, pb, parameters s, t, r0 = pa - pb.
struct EdgeLines {
  Vec3 pa, u, pb, v, r0;
  double uu, uv, vv, ur, vr, det;
  double sine2;  ///< of the angle between them
  EdgeLines(const PairBody& a, const PairBody& b, const RelativePose& pose, std::int32_t edge_a, std::int32_t edge_b) {
    const ShapeEdge ea = a.shape->edge(edge_a);
    const ShapeEdge eb = b.shape->edge(edge_b);
    pa = a.scale * ea.start;
    u = a.scale * ea.along;
    pb = pose.a_from_b(b.scale * eb.start);
    v = pose.rotation * (b.scale * eb.along);
    r0 = pa - pb;
    uu = dot(u, u);
    uv = dot(u, v);
    vv = dot(v, v);
    ur = dot(u, r0);
    vr = dot(v, r0);
    det = uu * vv - uv * uv;
    sine2 = det / (uu * vv);
  }
  double s() const { return (uv * vr - vv * ur) / det; }
  double t() const { return (uu * vr - uv * ur) / det; }
  /// Distance of the two edges from end to end [m].   Source: Ericson, Real-Time Collision Detection (2005), section 5.1.9.
  double distance() const {
    double at_a = det > 0 ? std::clamp((uv * vr - ur * vv) / det, 0.0, 1.0) : 0.0;
    const double at_b = vv > 0 ? std::clamp((uv * at_a + vr) / vv, 0.0, 1.0) : 0.0;
    at_a = uu > 0 ? std::clamp((uv * at_b - ur) / uu, 0.0, 1.0) : 0.0;
    return length(r0 + at_a * u - at_b * v);
  }
};

/// Motion before which two edges are no feature since their nearest points are beyond an end [m]; 0 where nothing is known.
/// in   size   bounding radius of the smaller body [m]
double slack_of_ends(const EdgeLines& e, double s, double t, double margin, double size);

/// The same, since one of the edges is a fold of a wall and the other one is on the side on which it is concave.
double slack_of_side(const PairBody& a, const PairBody& b, const RelativePose& pose, std::int32_t edge_a, std::int32_t edge_b,
                     const EdgeLines& e);

/// The same, since the normal leans out of the wedge of an edge.
/// in   enough  slack at which the answer does not matter any more [m]
double slack_of_wedge(const PairBody& a, const PairBody& b, const RelativePose& pose, std::int32_t edge_a, std::int32_t edge_b,
                      const EdgeLines& e, double margin, double size, double enough);

}  // namespace scree
