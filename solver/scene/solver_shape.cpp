#include "solver/scene/solver_shape.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <utility>

#include "core/geometry/half_edges.hpp"
#include "core/surface/touch_surface.hpp"
#include "solver/laws/pair_law.hpp"

namespace scree {

namespace {

/// See SolverShape::turning_arm. At an edge or a corner the normal may point anywhere between those of its faces; |r x n| is
/// largest at one of these unless it passes a right angle on the way: with a normal that points inwards the whole radius counts.
double turning_arm_of(const TriangleMesh& mesh) {
  double arm = 0;
  for (std::int32_t t = 0; t < static_cast<std::int32_t>(mesh.triangles.size()); ++t) {
    const Vec3 doubled = cross(mesh.corner(t, 1) - mesh.corner(t, 0), mesh.corner(t, 2) - mesh.corner(t, 0));
    if (!(squared_length(doubled) > 0)) continue;
    const Vec3 n = normalised(doubled);
    for (int k = 0; k < 3; ++k) {
      const Vec3& r = mesh.corner(t, k);
      arm = std::max(arm, dot(r, n) > 0 ? length(cross(r, n)) : length(r));
    }
  }
  return arm;
}

}  // namespace

/// A vector from an edge into one of its two faces. Of a direction perpendicular to the edge it lies on the same side as the conormal.
Vec3 SolverShape::find_into(std::int32_t e, int side) const {
  const FeatureEdge& ends = features.edges[static_cast<std::size_t>(e)];
  const std::int32_t face = ends.face[side];
  if (face < 0) return {};
  const Vec3& start = mesh.vertices[static_cast<std::size_t>(ends.vertex_a)];
  // two of the three lie on the edge: they add nothing across it
  return (mesh.corner(face, 0) - start) + (mesh.corner(face, 1) - start) + (mesh.corner(face, 2) - start);
}

bool SolverShape::find_height(std::int32_t e, int side) const {
  constexpr double kFlatFace = 1e-6;  // a face that is lower than this over its edge: its side is lost in rounding
  const FeatureEdge& ends = features.edges[static_cast<std::size_t>(e)];
  const std::int32_t face = ends.face[side];
  if (face < 0) return false;
  const Vec3& start = mesh.vertices[static_cast<std::size_t>(ends.vertex_a)];
  const Vec3 across = edge_conormal(e, side);
  double height = 0, width = 0;
  for (int k = 0; k < 3; ++k) {
    const Vec3 arm = mesh.corner(face, k) - start;
    height = std::max(height, dot(arm, across));
    width = std::max(width, length(arm));
  }
  return height > kFlatFace * width;
}

bool is_convex_surface(const TriangleMesh& mesh, const FeatureTable& features) {
  const std::vector<HalfEdge> half = sorted_half_edges(mesh);
  for (const HalfEdge& h : half) {
    const EdgeKind kind = features.edge_kind(static_cast<std::size_t>(h.triangle), static_cast<std::size_t>(h.k));
    if (kind != EdgeKind::flat && kind != EdgeKind::convex) return false;
  }
  // one surface: triangles joined over their edges
  DisjointSets joined(mesh.triangles.size());
  for_each_edge(half, [&](std::size_t first, std::size_t last) {
    for (std::size_t i = first + 1; i < last; ++i) joined.join(half[first].triangle, half[i].triangle);
  });
  for (std::int32_t t = 0; t < mesh.triangle_count(); ++t) {
    if (joined.find(t) != 0) return false;
  }
  return mesh.triangle_count() > 0;
}

namespace {

bool has_sharp_inner_edge(const FeatureTable& features) {
  for (std::size_t t = 0; t < features.marks.size(); ++t) {
    for (std::size_t k = 0; k < 3; ++k) {
      const EdgeKind kind = features.edge_kind(t, k);
      if (kind != EdgeKind::flat && kind != EdgeKind::boundary) return true;
    }
  }
  return false;
}

}  // namespace

SolverShape make_solver_shape(const Shape& source, const Settings& settings) {
  SolverShape shape;
  shape.kind = source.kind;
  shape.rounding = source.sphere_radius;
  shape.cell_size = source.cell_size;
  TouchSurface touch = touch_surface(source, settings);
  shape.mesh = touch.mesh;  // a copy holds what it needs and no more
  shape.margin = touch.margin;
  if (source.kind != ShapeKind::surface) {
    shape.volume = source.mass.volume;
    shape.inertia = source.mass.principal_moments;
    shape.body_from_principal = source.mass.body_from_principal;
    const Quat principal_from_body = conjugate(shape.body_from_principal);
    TriangleMesh drawn = source.mesh;  // contacts lie no further out
    if (!(shape.body_from_principal == Quat{})) {
      for (TriangleMesh* mesh : {&shape.mesh, &drawn})
        for (Vec3& p : mesh->vertices) p = rotate(principal_from_body, p);
    }
    // Moments equal to within the rounding of the mass integrals count as equal.
    constexpr double kIsotropicTolerance = 1e-12;
    const double low = std::min({shape.inertia.x, shape.inertia.y, shape.inertia.z});
    const double high = std::max({shape.inertia.x, shape.inertia.y, shape.inertia.z});
    Eigen::Vector3d inverse(1 / shape.inertia.x, 1 / shape.inertia.y, 1 / shape.inertia.z);
    for (const Vec3& r : drawn.vertices) {
      Eigen::Matrix3d lever;
      lever << 0, -r.z, r.y, r.z, 0, -r.x, -r.y, r.x, 0;
      const Eigen::Matrix3d mobility = lever.transpose() * inverse.asDiagonal() * lever;
      const double largest = Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(mobility, Eigen::EigenvaluesOnly).eigenvalues()(2);
      shape.rotational_mobility = std::max(shape.rotational_mobility, largest);
    }
    // A ball's normal passes its centre: only friction, with its softer spring, turns it.
    shape.rotational_mobility += kTangentialStiffnessRatio * shape.rounding * shape.rounding * inverse(0);
    shape.turning_arm = turning_arm_of(drawn);
    shape.isotropic = high - low <= kIsotropicTolerance * high;
    shape.equivalent_radius = 0.5 * source.equivalent_diameter();
  }
  shape.is_two_sided = source.kind == ShapeKind::surface;
  shape.features = find_features(shape.mesh, shape.is_two_sided ? Sides::both : Sides::outside);
  shape.is_convex = source.kind == ShapeKind::solid && is_convex_surface(shape.mesh, shape.features);
  shape.has_valleys =
      source.kind == ShapeKind::surface ? has_sharp_inner_edge(shape.features) : source.kind == ShapeKind::solid && !shape.is_convex;
  if (shape.mesh.triangles.size() <= SolverShape::kMaxWithRows) {
    std::vector<EdgeRow> rows(shape.features.edges.size());
    for (std::size_t n = 0; n < rows.size(); ++n) {
      const auto e = static_cast<std::int32_t>(n);
      rows[n].ends = shape.edge(e);
      for (int side = 0; side < 2; ++side) {
        rows[n].into[side] = shape.into_face(e, side);
        rows[n].conormal[side] = shape.edge_conormal(e, side);
        rows[n].corners[side] = shape.edge_corner(e, side);
        rows[n].has_height[side] = shape.has_height(e, side);
      }
    }
    shape.edge_rows = std::move(rows);
  }
  shape.bvh = build_bvh(shape.mesh);
  shape.radius = bounding_radius(shape.mesh) + shape.rounding + shape.margin;
  return shape;
}

std::size_t SolverShape::memory() const {
  const auto bytes = [](const auto& v) { return v.capacity() * sizeof(v[0]); };
  return bytes(mesh.vertices) + bytes(mesh.triangles) + bvh.memory() + features.memory() + bytes(edge_rows);
}

}  // namespace scree
