// Two placed meshes and pairs of their triangles.
#pragma once

#include <cstdint>

#include "core/geometry/bvh.hpp"
#include "core/geometry/triangle_mesh.hpp"

namespace scree {

/// A mesh and its tree, both of a shape; not owned.
struct MeshView {
  const TriangleMesh* mesh = nullptr;
  const Bvh* bvh = nullptr;
};

/// Places shape B in the frame of shape A: x_A = scale * rotation * x_B + translation, all in units of A's
/// shape (divide by A's own scale first). See relative_placement.
struct Placement {
  Mat3 rotation = identity3();
  Vec3 translation;
  double scale = 1;
};

struct TrianglePair {
  std::int32_t a, b;
  bool operator==(const TrianglePair&) const = default;
};

}  // namespace scree
