#include "decomposer/packing/separation.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace scree {

namespace {

// Of the smaller radius: a gap this wide has a normal that is exact to 1e-8; below, its direction is noise of rounding.
constexpr double kClear = 1e-7;

/// Length that leads out of an overlap along a direction, or `most` when no shorter one does. is_free(length): out at that length.
template <class IsFree>
double way_out(double most, double stride, IsFree&& is_free) {
  double before = 0, way = stride;
  while (way < most && !is_free(way)) {
    before = way;
    way += stride;
  }
  if (way >= most) return most;
  constexpr int kHalvings = 50;  // to the last bits of a stride
  for (int i = 0; i < kHalvings; ++i) {
    const double middle = 0.5 * (before + way);
    (is_free(middle) ? way : before) = middle;
  }
  return way;
}

/// The shortest way out among directions; the first among equals.
template <class IsFreeAt>
Vec3 shortest(const std::vector<Vec3>& directions, double most, double stride, IsFreeAt&& is_free_at) {
  Vec3 best;
  double least = most;
  for (const Vec3& d : directions) {
    // what is longer than the best by less than rounding does not take its place
    constexpr double kShorter = 1 - 1e-9;
    const double way = way_out(least, stride, [&](double t) { return is_free_at(t * d); });
    if (way < kShorter * least) {
      least = way;
      best = d;
    }
  }
  return least * best;
}

double stride_of(double size, double most) { return std::max(0.05 * size, most / 64); }

void add_axes(const Quat& q, std::vector<Vec3>& directions) {
  for (int k = 0; k < 3; ++k) {
    Vec3 axis;
    axis[k] = 1;
    for (const Vec3& d : {rotate(q, axis), -rotate(q, axis)}) {
      constexpr double kSame = 1 - 1e-12;
      if (std::none_of(directions.begin(), directions.end(), [&](const Vec3& known) { return dot(known, d) > kSame; }))
        directions.push_back(d);
    }
  }
}

MeshView view_of(const PlacedBody& b) { return {&b.shape->shape.mesh, &b.shape->bvh}; }

}  // namespace

Vec3 Separation::common_normal(const PlacedBody& a, const PlacedBody& b, double reach) {
  if (a.is_sphere() || b.is_sphere()) {
    const PlacedBody &sphere = a.is_sphere() ? a : b, &mesh = a.is_sphere() ? b : a;
    const Vec3 centre = (1 / mesh.scale) * rotate_inverse(mesh.orientation, sphere.position - mesh.position);
    Vec3 foot;
    std::int32_t triangle = -1;
    point_mesh_distance(view_of(mesh), centre, (reach + sphere.rounding()) / mesh.scale, foot, triangle);
    if (triangle < 0 || !(length(centre - foot) > 0)) return {};
    const Vec3 away = rotate(mesh.orientation, normalised(centre - foot));
    return a.is_sphere() ? away : -away;
  }
  const Placement placement = relative_placement(a.position, a.orientation, a.scale, b.position, b.orientation, b.scale);
  TrianglePair nearest{-1, -1};
  mesh_distance(view_of(a), view_of(b), placement, reach / a.scale, *scratch_, &nearest);
  if (nearest.a < 0) return {};
  std::array<Vec3, 3> of_a, of_b;
  const TriangleMesh &mesh_a = a.shape->shape.mesh, &mesh_b = b.shape->shape.mesh;
  for (std::size_t k = 0; k < 3; ++k) {
    of_a[k] = mesh_a.vertices[static_cast<std::size_t>(mesh_a.triangles[static_cast<std::size_t>(nearest.a)][k])];
    const Vec3& p = mesh_b.vertices[static_cast<std::size_t>(mesh_b.triangles[static_cast<std::size_t>(nearest.b)][k])];
    of_b[k] = placement.translation + placement.scale * (placement.rotation * p);
  }
  return rotate(a.orientation, triangle_distance(of_a.data(), of_b.data()).normal);
}

Vec3 Separation::from_body(const PlacedBody& a, const PlacedBody& b, const GapWanted& gap) {
  const Vec3 between = a.position - b.position;
  const double distance = length(between), reach = a.radius() + b.radius(), smaller = std::min(a.radius(), b.radius());
  if (distance >= reach + gap.least) return {};
  if (a.is_sphere() && b.is_sphere()) return (reach + gap.reached - distance) * (distance > 0 ? (1 / distance) * between : Vec3{1, 0, 0});
  const double found = gap_between(a, b, gap.least * kJustAbove, *scratch_);
  if (found >= gap.least) return {};
  const double margins = a.rounding() + b.rounding();  // within them meshes have a normal too, and balls as far as their centres
  if (found + margins > kClear * smaller) {
    const Vec3 normal = common_normal(a, b, gap.least * kJustAbove + margins);
    if (length(normal) > 0) return (gap.reached - found) * normal;
  }
  std::vector<Vec3> directions;
  if (distance > 0) directions.push_back((1 / distance) * between);
  add_axes(a.orientation, directions);
  add_axes(b.orientation, directions);
  add_axes({}, directions);
  // beyond both diameters nothing can be in the way
  return shortest(directions, 2 * reach + gap.reached, stride_of(smaller, reach), [&](const Vec3& t) {
    PlacedBody moved = a;
    moved.position += t;
    return gap_between(moved, b, gap.reached * kJustAbove, *scratch_) >= gap.reached;
  });
}

Vec3 Separation::from_analytic_wall(const Wall& wall, const PlacedBody& body, const GapWanted& gap) {
  // of each face: how far the deepest vertex has to go, and where to
  struct Face {
    double way = 0;
    Vec3 inward;
  };
  std::array<Face, 6> faces;
  double margin = body.radius();
  const auto look = [&](std::size_t face, double distance, const Vec3& inward) {
    if (distance >= gap.least + margin) return;
    if (const double way = gap.reached + margin - distance; way > faces[face].way) faces[face] = {way, inward};
  };
  const auto look_from = [&](const Vec3& p) {
    switch (wall.kind) {
      case WallKind::plane:
        look(0, dot(wall.normal, p - wall.point), wall.normal);
        break;
      case WallKind::box_inside:
        for (int k = 0; k < 3; ++k) {
          Vec3 axis;
          axis[k] = 1;
          look(2 * static_cast<std::size_t>(k), p[k] - wall.lower[k], axis);
          look(2 * static_cast<std::size_t>(k) + 1, wall.upper[k] - p[k], -axis);
        }
        break;
      case WallKind::cylinder_inside: {
        const Vec3 axis = normalised(wall.axis_end - wall.axis_start), from = p - wall.axis_start;
        const double z = dot(axis, from), r = length(from - z * axis);
        look(0, z, axis);
        look(1, length(wall.axis_end - wall.axis_start) - z, -axis);
        if (r > 0) look(2, wall.radius - r, (-1 / r) * (from - z * axis));
        break;
      }
      case WallKind::sphere_inside:
        if (const double r = length(wall.point - p); r > 0) look(0, wall.radius - r, (1 / r) * (wall.point - p));
        break;
      case WallKind::mesh:
        break;
    }
  };
  look_from(body.position);
  const auto total = [&] {
    Vec3 sum;
    for (const Face& face : faces) sum += face.way * face.inward;
    return sum;
  };
  // a ball is its centre; nothing of a mesh is close where its bounding ball is not
  if (body.is_sphere() || std::none_of(faces.begin(), faces.end(), [](const Face& face) { return face.way > 0; })) return total();
  faces = {};
  margin = body.rounding();
  body.world_vertices(vertices_);
  for (const Vec3& p : vertices_) look_from(p);
  return total();
}

Vec3 Separation::from_wall(const Wall& wall, const PlacedBody* mesh, bool is_solid, const PlacedBody& body, const GapWanted& gap) {
  if (wall.kind != WallKind::mesh) return from_analytic_wall(wall, body, gap);
  body.world_vertices(vertices_);
  if (wall_allows(wall, mesh, is_solid, body, vertices_, gap.least, *scratch_)) return {};
  const double size = body.radius(), found = gap_between(*mesh, body, gap.least * kJustAbove, *scratch_);
  const auto is_in_solid = [&] {
    const Vec3 corner = (1 / mesh->scale) * rotate_inverse(mesh->orientation, vertices_.front() - mesh->position);
    return is_solid && is_inside(mesh->shape->shape.mesh, corner);
  };
  if (found + body.rounding() > kClear * size && found < gap.least && !is_in_solid()) {
    const Vec3 normal = common_normal(body, *mesh, gap.least * kJustAbove + body.rounding());
    if (length(normal) > 0) return (gap.reached - found) * normal;
  }
  std::vector<Vec3> directions;
  add_axes({}, directions);
  const double most = 4 * size + gap.reached;
  return shortest(directions, most, stride_of(size, most), [&](const Vec3& t) {
    PlacedBody moved = body;
    moved.position += t;
    return wall_allows(wall, mesh, is_solid, moved, moved.world_vertices(), gap.reached, *scratch_);
  });
}

}  // namespace scree
