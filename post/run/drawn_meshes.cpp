#include "post/run/drawn_meshes.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

#include "core/geometry/closed_mesh.hpp"

namespace scree {

TriangleMesh icosphere(int level) {
  const double g = std::numbers::phi;
  TriangleMesh mesh;
  mesh.vertices = {{-1, g, 0},  {1, g, 0},  {-1, -g, 0}, {1, -g, 0}, {0, -1, g},  {0, 1, g},
                   {0, -1, -g}, {0, 1, -g}, {g, 0, -1},  {g, 0, 1},  {-g, 0, -1}, {-g, 0, 1}};
  mesh.triangles = {{0, 11, 5}, {0, 5, 1}, {0, 1, 7}, {0, 7, 10}, {0, 10, 11}, {1, 5, 9}, {5, 11, 4}, {11, 10, 2}, {10, 7, 6}, {7, 1, 8},
                    {3, 9, 4},  {3, 4, 2}, {3, 2, 6}, {3, 6, 8},  {3, 8, 9},   {4, 9, 5}, {2, 4, 11}, {6, 2, 10},  {8, 6, 7},  {9, 8, 1}};
  for (int l = 0; l < level; ++l) {
    std::map<std::pair<std::int32_t, std::int32_t>, std::int32_t> middle;
    const auto between = [&](std::int32_t a, std::int32_t b) {
      const auto [it, inserted] = middle.try_emplace({std::min(a, b), std::max(a, b)}, mesh.vertex_count());
      if (inserted)
        mesh.vertices.push_back(0.5 * (mesh.vertices[static_cast<std::size_t>(a)] + mesh.vertices[static_cast<std::size_t>(b)]));
      return it->second;
    };
    std::vector<Triangle> finer;
    for (const Triangle& t : mesh.triangles) {
      const std::int32_t a = between(t[0], t[1]), b = between(t[1], t[2]), c = between(t[2], t[0]);
      finer.insert(finer.end(), {Triangle{t[0], a, c}, Triangle{t[1], b, a}, Triangle{t[2], c, b}, Triangle{a, b, c}});
    }
    mesh.triangles = std::move(finer);
    for (Vec3& p : mesh.vertices) p = normalised(p);
  }
  for (Vec3& p : mesh.vertices) p = normalised(p);
  return mesh;
}

namespace {

void any_perpendicular(const Vec3& axis, Vec3& u, Vec3& v) {
  const Vec3 helper = std::abs(axis.z) < 0.9 ? Vec3{0, 0, 1} : Vec3{1, 0, 0};
  u = normalised(cross(helper, axis));
  v = cross(axis, u);
}

/// Sides of a regular polygon in a circle that come within `deviation` of it; those of a picture for 0.
int sides_of_circle(double radius, double deviation) {
  constexpr double kSides = 64, kMostSides = 4096;
  if (!(deviation > 0)) return static_cast<int>(kSides);
  return static_cast<int>(std::clamp(std::ceil(std::numbers::pi / std::acos(1 - std::min(deviation / radius, 1.0))), kSides, kMostSides));
}

/// Tube with lids, seen from inside.
TriangleMesh inner_cylinder(const Vec3& start, const Vec3& end, double radius, int sides) {
  Vec3 u, v;
  any_perpendicular(normalised(end - start), u, v);
  TriangleMesh mesh;
  mesh.vertices = {start, end};
  for (int i = 0; i < sides; ++i) {
    const double angle = 2 * std::numbers::pi * i / sides;
    const Vec3 r = radius * (std::cos(angle) * u + std::sin(angle) * v);
    mesh.vertices.push_back(start + r);
    mesh.vertices.push_back(end + r);
  }
  for (int i = 0; i < sides; ++i) {
    const std::int32_t a = 2 + 2 * i, b = a + 1, c = 2 + 2 * ((i + 1) % sides), d = c + 1;
    mesh.triangles.insert(mesh.triangles.end(), {Triangle{a, b, c}, Triangle{c, b, d}, Triangle{0, a, c}, Triangle{1, d, b}});
  }
  return mesh;
}

/// A wall that lies across a periodic axis, a drum of which a slice is simulated, ends at the cell. Walls may only turn about such an axis.
void cut_to_cell(const Wall& wall, const Domain& domain, TriangleMesh& mesh) {
  constexpr double kAlong = 1e-9;  // rounding of an axis that is turned onto itself
  for (int k = 0; k < 3; ++k) {
    if (!domain.periodic[static_cast<std::size_t>(k)]) continue;
    Vec3 axis;
    axis[k] = 1;
    if (std::abs(rotate(wall.orientation, axis)[k] - 1) > kAlong) continue;
    for (Vec3& p : mesh.vertices) p[k] = std::clamp(p[k], domain.lower[k] - wall.position[k], domain.upper[k] - wall.position[k]);
  }
}

TriangleMesh whole_wall(const Wall& wall, const Scene& scene, const Box3& room, const Frame* frame);

}  // namespace

DrawnMesh drawn_shape(const Shape& shape) {
  if (shape.kind != ShapeKind::sphere) return {shape.mesh, {}};
  DrawnMesh ball{icosphere(2), {}};
  ball.normals = ball.mesh.vertices;
  for (Vec3& p : ball.mesh.vertices) p *= shape.sphere_radius;
  return ball;
}

TriangleMesh coarse_mesh(const TriangleMesh& mesh, std::size_t most) {
  const Box3 box = bounding_box(mesh);
  const double size = length(box.extent());
  TriangleMesh coarse = mesh;
  for (double cells = 24; coarse.triangles.size() > most && cells >= 1.5; cells *= 0.8) {
    std::map<std::array<int, 3>, std::int32_t> found;
    std::vector<std::int32_t> merged;
    std::vector<double> count;
    coarse = {};
    for (const Vec3& v : mesh.vertices) {
      const Vec3 place = (cells / size) * (v - box.lower);
      const auto [it, is_new] =
          found.try_emplace({static_cast<int>(place.x), static_cast<int>(place.y), static_cast<int>(place.z)}, coarse.vertex_count());
      if (is_new) {
        coarse.vertices.push_back({});
        count.push_back(0);
      }
      const auto k = static_cast<std::size_t>(it->second);
      coarse.vertices[k] += v;
      count[k] += 1;
      merged.push_back(it->second);
    }
    for (std::size_t k = 0; k < count.size(); ++k) coarse.vertices[k] *= 1 / count[k];
    for (const Triangle& t : mesh.triangles) {
      const Triangle m{merged[static_cast<std::size_t>(t[0])], merged[static_cast<std::size_t>(t[1])],
                       merged[static_cast<std::size_t>(t[2])]};
      if (m[0] != m[1] && m[1] != m[2] && m[2] != m[0]) coarse.triangles.push_back(m);
    }
  }
  return coarse;
}

std::vector<Vec3> worn_vertices_of(const Wall& wall, const Frame& frame) {
  std::vector<Vec3> vertices;
  for (std::size_t v = 0; v < frame.wear.size(); ++v) {
    if (frame.wear.wall[v] == wall.id) vertices.push_back(frame.wear.vertex[v]);
  }
  return vertices;
}

TriangleMesh drawn_wall(const Wall& wall, const Scene& scene, const Box3& room, const Frame* frame) {
  TriangleMesh mesh = whole_wall(wall, scene, room, frame);
  cut_to_cell(wall, scene.settings.domain, mesh);
  return mesh;
}

namespace {

/// Subdivisions of an icosphere whose facets come within `deviation` of the sphere; those of a picture for 0.
int level_of_sphere(double radius, double deviation) {
  constexpr int kLevel = 3, kMostLevel = 7;
  constexpr double kFirst = 0.2054;  // 1 less the inscribed radius of the icosahedron; each level divides it by four
  int level = kLevel;
  while (deviation > 0 && level < kMostLevel && radius * kFirst / std::pow(4.0, level) > deviation) ++level;
  return level;
}

/// The mesh of a wall from a file, worn as it is in a frame.
TriangleMesh wall_mesh(const Wall& wall, const Scene& scene, const Frame* frame) {
  TriangleMesh mesh = scene.shapes.at(static_cast<std::size_t>(wall.shape)).mesh;
  if (frame != nullptr && wall.wear > 0) {
    std::vector<Vec3> worn = worn_vertices_of(wall, *frame);
    if (worn.size() == mesh.vertices.size()) mesh.vertices = std::move(worn);
  }
  for (Vec3& p : mesh.vertices) p *= wall.scale;
  return mesh;
}

TriangleMesh whole_wall(const Wall& wall, const Scene& scene, const Box3& room, const Frame* frame) {
  const Vec3 extent = room.extent();
  const double size = std::max({extent.x, extent.y, extent.z});
  switch (wall.kind) {
    case WallKind::plane: {
      Vec3 u, v;
      any_perpendicular(wall.normal, u, v);
      const Vec3 middle = room.centre() - dot(room.centre() - wall.point, wall.normal) * wall.normal;
      TriangleMesh square;
      for (const auto& [a, b] : {std::pair{-1, -1}, {1, -1}, {1, 1}, {-1, 1}})
        square.vertices.push_back(middle + 0.75 * size * (a * u + b * v));
      square.triangles = {{0, 1, 2}, {0, 2, 3}};
      return square;
    }
    case WallKind::box_inside: {
      // a side that is far from the room is drawn nearer
      const double reach = 0.3 * size;
      const Vec3 far{reach, reach, reach};
      const Vec3 lower = component_max(wall.lower, room.lower - far), upper = component_min(wall.upper, room.upper + far);
      TriangleMesh box = box_mesh(upper - lower);
      for (Vec3& p : box.vertices) p += 0.5 * (lower + upper);
      turn_inside_out(box);
      return box;
    }
    case WallKind::cylinder_inside:
      return inner_cylinder(wall.axis_start, wall.axis_end, wall.radius, sides_of_circle(wall.radius, 0));
    case WallKind::sphere_inside: {
      TriangleMesh ball = icosphere(level_of_sphere(wall.radius, 0));
      for (Vec3& p : ball.vertices) p = wall.point + wall.radius * p;
      turn_inside_out(ball);
      return ball;
    }
    case WallKind::mesh:
      break;
  }
  return wall_mesh(wall, scene, frame);
}

}  // namespace

TriangleMesh wall_surface_in(const Frame& frame, const Wall& wall, const Scene& scene, const WallPlace& place, const Box3& room,
                             double deviation) {
  TriangleMesh mesh;
  switch (wall.kind) {
    case WallKind::plane: {
      Vec3 u, v;
      any_perpendicular(wall.normal, u, v);
      const Vec3 centre = rotate_inverse(place.orientation, room.centre() - place.position);
      const Vec3 middle = centre - dot(centre - wall.point, wall.normal) * wall.normal;
      for (const auto& [a, b] : {std::pair{-1, -1}, {1, -1}, {1, 1}, {-1, 1}})
        mesh.vertices.push_back(middle + length(room.extent()) * (a * u + b * v));
      mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
      break;
    }
    case WallKind::box_inside:
      mesh = box_mesh(wall.upper - wall.lower);
      for (Vec3& p : mesh.vertices) p += 0.5 * (wall.lower + wall.upper);
      turn_inside_out(mesh);
      break;
    case WallKind::cylinder_inside:
      mesh = inner_cylinder(wall.axis_start, wall.axis_end, wall.radius, sides_of_circle(wall.radius, deviation));
      break;
    case WallKind::sphere_inside:
      mesh = icosphere(level_of_sphere(wall.radius, deviation));
      for (Vec3& p : mesh.vertices) p = wall.point + wall.radius * p;
      turn_inside_out(mesh);
      break;
    case WallKind::mesh:
      mesh = wall_mesh(wall, scene, &frame);
      break;
  }
  for (Vec3& p : mesh.vertices) p = place.position + rotate(place.orientation, p);
  if (wall.kind == WallKind::box_inside || wall.kind == WallKind::cylinder_inside) {
    constexpr double kAcross = 1e-9;  // rounding of a face that is turned onto itself
    for (int k = 0; k < 3; ++k) {
      if (!scene.settings.domain.periodic[static_cast<std::size_t>(k)]) continue;
      std::erase_if(mesh.triangles, [&](const Triangle& t) {
        const Vec3& o = mesh.vertices[static_cast<std::size_t>(t[0])];
        const Vec3 normal = cross(mesh.vertices[static_cast<std::size_t>(t[1])] - o, mesh.vertices[static_cast<std::size_t>(t[2])] - o);
        return std::abs(normal[k]) > (1 - kAcross) * length(normal);
      });
    }
  }
  return mesh;
}

std::vector<double> bounding_radii(const Scene& scene) {
  std::vector<double> radii;
  for (const Shape& shape : scene.shapes) radii.push_back(shape.bounding_radius());
  return radii;
}

Box3 room_of(const FrameBodies& bodies, const Scene& scene) {
  const std::vector<double> radius = bounding_radii(scene);
  Box3 room;
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    const double r = bodies.scale[i] * radius[static_cast<std::size_t>(bodies.shape[i])];
    room.add(bodies.position[i] - Vec3{r, r, r});
    room.add(bodies.position[i] + Vec3{r, r, r});
  }
  if (room.is_empty()) {
    for (const Wall& wall : scene.walls) {
      if (const auto extent = wall_extent(wall, scene, {wall.position, wall.orientation})) room.add(*extent);
    }
    for (const Inlet& inlet : scene.inlets) {
      if (const auto extent = wall_extent(inlet.region, scene, {inlet.region.position, inlet.region.orientation})) room.add(*extent);
    }
  }
  if (room.is_empty()) {
    room.add(Vec3{-1, -1, -1});
    room.add(Vec3{1, 1, 1});
  }
  return room;
}

std::vector<WallPlace> wall_places(const Frame& frame, const Scene& scene) {
  std::map<std::int64_t, WallPlace> found;
  for (std::size_t i = 0; i < frame.walls.id.size(); ++i) found[frame.walls.id[i]] = {frame.walls.position[i], frame.walls.orientation[i]};
  std::vector<WallPlace> places;
  for (const Wall& wall : scene.walls) {
    const auto it = found.find(wall.id);
    places.push_back(it != found.end() ? it->second : WallPlace{wall.position, wall.orientation});
  }
  return places;
}

Box3 seen_room(const Frame& frame, const Scene& scene) {
  constexpr double kWhole = 4;  // times the bodies' room: a wall up to so large is seen as a whole, and the bodies can still be told apart
  constexpr double kBeside =
      0.35;  // times the bodies' room: so much is seen of a wall that has left them, as a gate that opened or a tube that was lifted
  const Box3 bodies = room_of(frame.bodies, scene);
  const Vec3 extent = bodies.extent();
  const double size = std::max({extent.x, extent.y, extent.z});
  const std::vector<WallPlace> places = wall_places(frame, scene);
  Box3 room = bodies;
  for (std::size_t w = 0; w < scene.walls.size(); ++w) {
    const Wall& wall = scene.walls[w];
    if (wall.kind == WallKind::plane || wall.kind == WallKind::box_inside) continue;
    Box3 box;
    for (const Vec3& p : drawn_wall(wall, scene, bodies).vertices) box.add(places[w].position + rotate(places[w].orientation, p));
    if (box.is_empty()) continue;
    bool has_left = false;
    for (int k = 0; k < 3; ++k) has_left = has_left || box.lower[k] > bodies.upper[k] || box.upper[k] < bodies.lower[k];
    has_left = has_left && (wall.motion.is_prescribed() || wall.motion.drive());
    const double beside = has_left ? kBeside * size : size;
    for (int k = 0; k < 3; ++k) {
      const bool is_whole = !has_left && box.upper[k] - box.lower[k] <= kWhole * size;
      const double lower = is_whole ? box.lower[k] : std::max(box.lower[k], bodies.lower[k] - beside);
      const double upper = is_whole ? box.upper[k] : std::min(box.upper[k], bodies.upper[k] + beside);
      if (lower > upper) continue;
      room.lower[k] = std::min(room.lower[k], lower);
      room.upper[k] = std::max(room.upper[k], upper);
    }
  }
  return room;
}

View view_of(const Box3& room, const Vec3& gravity) {
  View view;
  view.centre = room.centre();
  view.radius = 0.5 * length(room.extent());
  view.up = squared_length(gravity) > 0 ? normalised(-gravity) : Vec3{0, 0, 1};
  Vec3 u, v;
  any_perpendicular(view.up, u, v);
  view.from = normalised(u + 0.45 * v + 0.5 * view.up);
  return view;
}

Vec3 shape_colour(std::int32_t shape) {
  static constexpr std::array<Vec3, kShapeColours> kStone{{{0.84, 0.70, 0.50},
                                                           {0.44, 0.55, 0.66},
                                                           {0.72, 0.42, 0.30},
                                                           {0.86, 0.85, 0.81},
                                                           {0.36, 0.36, 0.40},
                                                           {0.58, 0.63, 0.42},
                                                           {0.62, 0.52, 0.62},
                                                           {0.95, 0.80, 0.36}}};
  return kStone[static_cast<std::size_t>(shape) % kStone.size()];
}

}  // namespace scree
