// Distances of triangles named by their index in two placed shapes, in single precision: the filter of a narrow phase.
#pragma once

#include <span>
#include <vector>

#include "core/distance/mesh_distance.hpp"
#include "tests/benchmarks/distance/methods/distance_methods.hpp"

namespace scree {

/// The triangles of a shape as rows of twelve floats: nine coordinates in the body frame, three of padding. 48 bytes a
/// triangle, once a shape.
class TriangleRows {
 public:
  explicit TriangleRows(const TriangleMesh& mesh);
  const float* data() const { return values_.data(); }

 private:
  std::vector<float> values_;
};

/// Distance and closest points of each pair by brute force, in A's frame (see Placement) and its unit.
///
/// How: rows of a few pairs at a time are transposed in registers and B's corners placed in A's frame, 128 pairs ahead of
/// the kernel; gather instructions would take longer than the kernel itself, and pairs kept as coordinates more memory
/// bandwidth than there is.
/// out   answers   room for the number of pairs rounded up to a multiple of kBatchPadding
/// Error: that of triangle_distances in single precision, and the rounding of the placed corners, at most 6 roundoffs
/// of the largest coordinate in A's frame.   Cost: a third above the batch of coordinates; no allocation.
void triangle_distances(const TriangleRows& a, const TriangleRows& b, const Placement& b_in_a, std::span<const TrianglePair> pairs,
                        const AnswerBatch<float>& answers);

}  // namespace scree
