// Bodies of a packed bed parted at their contacts, so that a fluid can be meshed around them.
//
// Two surfaces that touch or come closer than a gap meet in a cusp that no mesh generator fills. Both lose a thin cap there. Source: for
// caps in beds of spheres, T. Eppinger, K. Seidler, M. Kraume, DEM-CFD simulations of fixed bed reactors with small tube to particle
// diameter ratios, Chem. Eng. J. 166 (2011) 324. Here the plane of a cap follows from the shapes: any closed meshes.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/geometry/periodic.hpp"
#include "core/geometry/triangle_mesh.hpp"

namespace scree {

/// A contact point of two surfaces.
struct BedContact {
  std::int32_t a = 0, b = 0;  ///< indices of bodies; b < 0: wall -1 - b
  Vec3 point, normal;         ///< [m]; unit, from b to a
};

struct PartingOptions {
  double gap = 0.01;  ///< between two surfaces, over the diameter of the smaller body (of equal volume)
};

struct Parting {
  std::size_t parted = 0;  ///< pairs that touched or were nearer than half a gap, and are not any more
  /// Pairs that are still nearer than half a gap: two surfaces that are hollow or cross deeply. (a, b) as in BedContact.
  std::vector<std::pair<std::int32_t, std::int32_t>> left;
  std::size_t self_crossings = 0;  ///< pairs of triangles of one cut body that pass through or touch each other
  double smallest_gap = 0;         ///< of all pairs [m]; infinite where no two come near
};

/// Cuts caps off bodies until any two of them, and any body and wall, are at least half a gap apart.
///
/// How, for each pair nearer than that: where the run has contact points of the pair, planes through those of one direction; else the plane
/// in the middle between the two nearest points, or, where the surfaces cross, the plane fitted to the curve in which they do (to each
/// piece of it, where the whole would take off more than a fiftieth of a body). Each body loses what lies beyond half a gap from that plane
/// (cut_off). A cap deeper than a tenth of the diameter shows that the surface is hollow there: this body stays whole and the other one
/// loses the whole gap. The step is repeated until the pair is apart, and given up where surfaces still cross after some rounds or where a
/// body has lost a third of its volume. Cuts only take away, so no pair comes nearer again. At last coordinates are rounded to single
/// precision, as STL files have them, and all distances are measured on what is left. in/out  bodies     closed, outward, world coordinates
/// [m] in      diameters  of the bodies [m]     in   walls   world coordinates; never cut     in   contacts   by (a, b) Limits: a body that
/// lies within another and touches nothing is not noticed. Cost: a distance of two meshes for each pair of boxes that meet, and one for
/// each cut.
Parting part_bodies(std::vector<TriangleMesh>& bodies, std::span<const double> diameters, const std::vector<TriangleMesh>& walls,
                    const Periodicity& period, const std::vector<BedContact>& contacts, const PartingOptions& options);

}  // namespace scree
