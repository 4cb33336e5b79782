// Fewer triangles for the same shape.
#pragma once

#include <cstdint>

#include "core/geometry/triangle_mesh.hpp"

namespace scree {

struct SimplifyCounts {
  std::int32_t collapses = 0;
  std::int32_t handles_cut = 0;  ///< handles opened and necks severed
  bool reached_target = false;   ///< false: no edge could be collapsed any more without changing the topology
};

/// Collapses edges until at most `triangle_count` triangles are left.
///
/// How: the edge whose collapse moves the surface least goes first, by quadric error; its new vertex minimises that
/// error on the plane on which the enclosed volume does not change. Where that place folds a triangle, the edge takes its turn
/// among the others at the error of the place that it can have. A collapse that would change the topology, turn a
/// triangle over or make a needle waits for a change around it, so a closed manifold mesh stays one, handles and cavities included. Only a
/// handle or neck around which three edges shorter than a triangle of the result run is cut and capped there: scans
/// have dozens that are too small to see, and each would keep a dozen triangles.
/// Source: M. Garland, P. Heckbert, Surface simplification using quadric error metrics, SIGGRAPH 1997;
/// P. Lindstrom, G. Turk, Fast and memory efficient polygonal simplification, Visualization 1998 (volume);
/// T. Dey, H. Edelsbrunner, S. Guha, D. Nekhayev, Topology preserving edge contraction, 1999 (link condition).
/// in   mesh              welded, finite, without zero-area triangles; vertices on non-manifold edges stay put
/// in   may_cut_handles   false: the topology never changes
/// Fails: never.   Cost: O(T log T), about 7 microseconds a triangle.   Limits: surfaces may come to touch or
/// cross themselves, which the caller checks (see find_crossing_pairs).
SimplifyCounts simplify_mesh(TriangleMesh& mesh, std::int32_t triangle_count, bool may_cut_handles);

}  // namespace scree
