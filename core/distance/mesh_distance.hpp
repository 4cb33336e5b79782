// Distances between two placed meshes, by simultaneous descent of their hierarchies in the first one's frame.
#pragma once

#include <cstdint>
#include <memory>
#include <utility>
#include <vector>

#include "core/distance/placement.hpp"
#include "core/distance/triangle_distance.hpp"
#include "core/geometry/bvh.hpp"
#include "core/geometry/triangle_mesh.hpp"

namespace scree {

/// Placement of B in A's unscaled frame from world poses. Lengths found with it are in units of A's shape:
/// multiply by scale_a for metres.
Placement relative_placement(const Vec3& x_a, const Quat& q_a, double scale_a, const Vec3& x_b, const Quat& q_b, double scale_b);

/// Reusable scratch memory of the queries; one per thread.
struct MeshDistanceScratch;
struct MeshDistanceScratchDeleter {
  void operator()(MeshDistanceScratch*) const;
};
using MeshDistanceScratchPtr = std::unique_ptr<MeshDistanceScratch, MeshDistanceScratchDeleter>;
MeshDistanceScratchPtr make_mesh_distance_scratch();

/// All triangle pairs whose distance is below `reach` (units of A's shape), sorted by (a, b). No pair is
/// missed and none made up: single precision decides the pairs that it can, errors allowed for, double the others.
/// Returns true when some pair intersects.
bool triangle_pairs_within(const MeshView& a, const MeshView& b, const Placement& b_in_a, double reach, MeshDistanceScratch& scratch,
                           std::vector<TrianglePair>& pairs);

/// Smallest distance between the surfaces, or `upper_bound` when it is not below it (units of A's shape).
/// 0 when they intersect. A body inside a closed shell that touches nothing has a positive distance.
///
/// How: the nearest of a few leaves gives a bound, then all that can be nearer is sought, the bound falling on the way. In
/// single precision, errors allowed for; the few pairs left over are solved exactly.
/// in/out  nearest   where not null: the pair that was nearest before (-1 or another pair will do, it only makes the
///                   first bound); becomes the nearest one, or -1 when the upper bound holds
/// Cost: two rocks of 1280 triangles near contact take about as long as triangle_pairs_within.
double mesh_distance(const MeshView& a, const MeshView& b, const Placement& b_in_a, double upper_bound, MeshDistanceScratch& scratch,
                     TrianglePair* nearest = nullptr);

/// As mesh_distance, with the same bits on every instruction set and from every first bound: the distances of all pairs that may be
/// nearest, rounding allowed for, are computed in plain double precision, and the least of these is taken.
/// Cost: a few pairs more than mesh_distance, one after another.
double reproducible_mesh_distance(const MeshView& a, const MeshView& b, const Placement& b_in_a, double upper_bound,
                                  MeshDistanceScratch& scratch, TrianglePair& nearest);

/// Whether the surfaces intersect anywhere. A body inside a closed shell that touches nothing does not.
/// Cost: stops at the first few triangles that do.
bool meshes_intersect(const MeshView& a, const MeshView& b, const Placement& b_in_a, MeshDistanceScratch& scratch);

/// Smallest distance from a point to the surface, or upper_bound; nearest triangle and point by reference.
double point_mesh_distance(const MeshView& mesh, const Vec3& point, double upper_bound, Vec3& nearest, std::int32_t& triangle);

/// Smallest distance from a point to the surface, or upper_bound, with the same bits on every instruction set.
double reproducible_point_distance(const MeshView& mesh, const Vec3& point, double upper_bound);

/// Whether a point is inside a closed mesh (generalised winding number, exact for points off the surface).
bool is_inside(const TriangleMesh& mesh, const Vec3& point);

}  // namespace scree
