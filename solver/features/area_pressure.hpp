// gather = "area": an elastic layer between facing surfaces. Pressure is kappa times the overlap wherever two triangles that face each
// other lie over one another, so a flat contact carries kappa times its area, however it is meshed.
//
// For every pair of facing triangles both are projected along their mean normal n; over the polygon that they share the gap along
// n is linear, and so is the overlap d = margin - gap where it is positive. The energy is
//     U = kappa/2 sum over pairs of w(-n_A.n_B) int d^2 dA,
// with w a smooth switch: 1 for triangles that face each other to within 60 degrees, 0 from 90 on. U is a continuous function of the
// pose, and its gradient is computed exactly, by carrying the six derivatives along with every number (dual numbers): sliding over
// the rim of a face is in it, and energy is kept by convex and concave bodies alike. An analytic wall meets a triangle with its
// tangent plane at the foot of the triangle's centroid.
// Friction and damping act at the centre of pressure of each triangle of the smaller body, its patches: flat pieces of the larger one can
// change under it without a jump. Of two bodies of one size the triangles of both are patches, each with half of the layer: which of the
// two comes first changes nothing but rounding.
// Best for conforming faces. A corner carries only what its overlap spans, F ~ d^3, and uses up the margin early.
// Source: docs/reference/validation-plan.md section 3.4; elastic layer: Johnson, Contact Mechanics (1985), section 4.3 (Winkler
// foundation).
#pragma once

#include <vector>

#include "solver/features/pair_features.hpp"

namespace scree {

/// What one triangle receives, per unit of kappa.
struct AreaPatch {
  double energy = 0;           ///< [m^4]
  double force = 0;            ///< int d dA [m^3]
  double largest_overlap = 0;  ///< [m]
  Feature6 gradient;           ///< of the energy, for a virtual motion of A against B, A frame
};

/// Where the layer is: weights of a quadrature that is exact for its stiffness.
struct AreaPoint {
  Vec3 x, n;    ///< mid-gap, and the direction of the pressure on A; A frame
  double area;  ///< [m^2]
};

/// Contact of one pair: patches go with the features of the same number.
struct AreaContact {
  std::vector<AreaPatch> patches;
  std::vector<AreaPoint> points;
};

/// Triangles of a body that come within the margin of an analytic zone: kept as corners_a.
void list_area_zone(const PairBody& a, const PairBody& b, const WallZone& zone, double margin, double skin, double radius_a,
                    CandidateLists& lists);

/// Part of the layer of two meshes that goes to patches of A: all for the smaller body, half for bodies of one size.
double layer_share_of_a(double radius_a, double radius_b);

/// Patches of two meshes, from a list of triangle pairs (triangle_contacts.hpp), or of a mesh and an analytic zone. Features come
/// out with the place of their centre of pressure, mean normal and mean overlap; their key has the side of the triangle and its number.
/// in   share_of_a   see layer_share_of_a
void area_features(const PairBody& a, const PairBody& b, double margin, double motion, double share_of_a, const CandidateLists& lists,
                   std::vector<ContactFeature>& features, AreaContact& contact);
void area_zone_features(const PairBody& a, const PairBody& b, const WallZone& zone, double margin, double motion,
                        const CandidateLists& lists, std::vector<ContactFeature>& features, AreaContact& contact);

}  // namespace scree
