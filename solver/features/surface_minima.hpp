// Local minima of the distance of a point to a triangulated surface, and the weight of each in the contact of the point.
//
// A vertex of a body, or the centre of a ball, that lies in a concave edge of a surface is about as far from several faces. Each of them
// must carry it: with the nearest one alone the potential has a kink exactly where the body wants to lie, and with all of them at weight 1
// it jumps where one of them begins. So all minima have a part, with a weight a_i that is 1 for one that is alone, falls to 0 with zero
// slope before a minimum ends, and that minima whose overlaps hardly differ share.
//
// For a point p:
//   minima   i = feet q_i, gaps g_i, directions n_i = (p - q_i) / g_i: no triangle that contains q_i comes nearer to p
//   screens  t = nearest point of p on each flat region, taken as a closed set (every local minimum within a region that is not convex)
//   xi(n, m) = tan^2 of half the angle between n and m = |n - m|^2 / |n + m|^2;  S(y) = y^2 (3 - 2 y), clamped
//
//   t_it = (g_i - g_t) / ((g_i + g_t) xi_it)              over the screens that are nearer than i
//   v_i  = S(1 - (sum_t t_it^8)^(1/8))                    1 for the nearest; 0 where a t_it >= 1
//   K_ij = (1 - y^2)^2 for y < 1, else 0                  y = (g_i + g_j) xi_ij / sharing
//   C_i  = sum_{j != i} K_ij v_j,   kappa(C) = C (2 - C) for C < 1, else 1
//   a_i  = v_i / (1 + C_i - (1 - v_i) kappa(C_i))
//
// t_it = 1 where g_t = g_i cos(angle): there foot i lies in the tangent plane of t. A minimum ends as its foot meets a region that goes on
// downwards; that region is then a screen with t >= 1, so that v_i has come to 0 with slope 0, whatever the connectivity. Feet on the far
// side of a thin part are hidden by its near side in the same way. Two faces whose overlaps differ by less than `sharing` are one contact,
// by more are two.
// Derivatives: dg = n.dp; dn = B dp / g with B = 0 (foot in a face), I - nn - uu (on an edge along u), I - nn (at a vertex).
//
// Continuity: U is C0, and C1 but for a kink of n_i where a foot passes an edge of its region while 0 < t < 1. Capacity: U is between .86
// and 1.3 times k d_max^2 / 2. Both were measured on grooves, pits, cups, dented bodies and scans (docs/reference/contact-law.md 3.7).
#pragma once

#include <cstdint>
#include <vector>

#include "solver/scene/solver_shape.hpp"

namespace scree {

/// Overlaps of the minima of one vertex that differ by less than this share of the margin sum belong to one contact. Larger: less capacity
/// in wide valleys (sharing by angle alone left .61 of it for balls); smaller: stiffer shallow valleys.
inline constexpr double kSharingOfVertices = 1.0 / 8;
/// The same of the minima of a ball, as a share of its radius.
inline constexpr double kSharingOfBalls = 1.0 / 200;

/// A triangle near a point, and the triangle's nearest point.
struct NearTriangle {
  std::int32_t triangle;
  int place;  ///< of the foot on the triangle: as in NearestOnTriangle
  Vec3 foot;
  double squared;  ///< distance of the point to the foot, squared
};

/// A minimum that counts.
struct SurfaceMinimum {
  std::size_t near;  ///< index of the triangle that holds the foot
  Vec3 foot;
  double squared;      ///< as NearTriangle
  std::int64_t place;  ///< unique among the minima of a point: kind of the place in bits 28 and 29, index in those below
  double weight;       ///< a_i in (0, 1]
  Vec3 gradient;       ///< of the weight by the point [1 / unit of the mesh]
  bool varies;         ///< the gradient is not zero
};

/// Kinds of places, as in SurfaceMinimum::place. A foot on an edge that carries no features, such as a concave edge seen from the other
/// side of a sheet, is named by its triangle.
inline constexpr std::int64_t kPlaceBits = 28;
inline constexpr std::int64_t kPlaceInRegion = 0, kPlaceOnEdge = 1, kPlaceAtVertex = 2, kPlaceInTriangle = 3;
inline std::int64_t make_place(std::int64_t kind, std::int64_t index) { return (kind << kPlaceBits) | index; }

/// The minima of one point within reach that have a weight, in ascending order of their places.
///
/// in   shape    all in its frame and at its scale     in   p   the point
/// in   near     all triangles of the shape that come within reach + sharing of the point, in ascending order; more do no harm
/// in   reach    gap at which something acts           in   sharing   see kSharingOfVertices
/// out  minima   one alone has weight 1; none where no triangle is within reach, or where the point lies on the surface
/// Cost: O(n) for n triangles with one common foot and on convex shapes, else O(n^2); what a weight takes only where there are two minima.
/// Fails: never.   Threads: safe on distinct outputs. Source: docs/reference/contact-law.md section 3.7.
void find_minima(const SolverShape& shape, const Vec3& p, const std::vector<NearTriangle>& near, double reach, double sharing,
                 std::vector<SurfaceMinimum>& minima);

}  // namespace scree
