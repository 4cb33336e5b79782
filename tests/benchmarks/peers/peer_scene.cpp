#include "tests/benchmarks/peers/peer_scene.hpp"

#include <filesystem>
#include <fstream>
#include <sstream>

#include "core/base/error.hpp"
#include "core/geometry/mass_properties.hpp"
#include "tests/support/shapes.hpp"

namespace scree {
namespace {

int level_of(int triangles) {
  for (int level = 0; level <= 4; ++level)
    if (20 << (2 * level) == triangles) return level;
  throw UsageError("--triangles: {}: expected 20, 80, 320, 1280 or 5120", triangles);
}

/// The image of a unit icosphere under a random rotation, a stretch along the axes and another rotation.
TriangleMesh convex_rock(unsigned seed, int level) {
  std::mt19937 generator(seed);
  const Mat3 turn = matrix_of(test::random_quaternion(generator));
  TriangleMesh mesh = test::icosphere(level);
  for (Vec3& p : mesh.vertices) {
    const Vec3 q = turn * p;
    p = {q.x, 0.85 * q.y, 0.7 * q.z};
  }
  return mesh;
}

std::string obj_path(const std::string& folder, std::size_t k) { return fmt::format("{}/shape_{}.obj", folder, k); }

TriangleMesh read_obj(const std::string& path) {
  std::ifstream file(path);
  if (!file) throw InputError("{}: cannot be read; make the shapes first", path);
  TriangleMesh mesh;
  std::string line, word;
  while (std::getline(file, line)) {
    std::istringstream words(line);
    words >> word;
    if (word == "v") {
      Vec3 p;
      words >> p.x >> p.y >> p.z;
      mesh.vertices.push_back(p);
    } else if (word == "f") {
      Triangle t{};
      words >> t[0] >> t[1] >> t[2];
      mesh.triangles.push_back({t[0] - 1, t[1] - 1, t[2] - 1});
    }
    if (words.fail()) throw InputError("{}: '{}': expected numbers", path, line);
  }
  return mesh;
}

std::ofstream open_for_writing(const std::string& path) {
  std::ofstream file(path);
  if (!file) throw SystemError("{}: cannot be written", path);
  return file;
}

/// How deep the corners of b lie in a [m].
double depth_of_corners(const PeerShape& a, const PeerBody& body_a, const PeerShape& b, const PeerBody& body_b) {
  const MeshView view{&a.mesh, &a.bvh};
  double deepest = 0;
  for (const Vec3& corner : b.mesh.vertices) {
    const Vec3 world = body_b.position + rotate(body_b.orientation, corner);
    const Vec3 p = rotate_inverse(body_a.orientation, world - body_a.position);
    if (length(p) > a.bounding_radius || !is_inside(a.mesh, p)) continue;
    Vec3 nearest;
    std::int32_t triangle = 0;
    deepest = std::max(deepest, point_mesh_distance(view, p, a.bounding_radius, nearest, triangle));
  }
  return deepest;
}

}  // namespace

std::vector<PeerShape> make_peer_shapes(const std::string& kind, int triangles, int count, double radius) {
  const int level = level_of(triangles);
  if (kind != "rock" && kind != "convex") throw UsageError("--kind: {}: expected rock or convex", kind);
  std::vector<PeerShape> shapes(static_cast<std::size_t>(count));
  unsigned seed = 11;
  for (PeerShape& shape : shapes) {
    shape.mesh = kind == "rock" ? test::rock(seed, level, 0.15) : convex_rock(seed, level);
    ++seed;
    const MassProperties first = mass_properties(shape.mesh);
    const double scale = radius / std::cbrt(first.volume * 3 / (4 * 3.14159265358979323846));
    for (Vec3& p : shape.mesh.vertices) p = scale * rotate_inverse(first.body_from_principal, p - first.centre);
    const MassProperties mass = mass_properties(shape.mesh);
    shape.volume = mass.volume;
    shape.moments = {mass.inertia[0].x, mass.inertia[1].y, mass.inertia[2].z};
    shape.bounding_radius = bounding_radius(shape.mesh);
    shape.bvh = build_bvh(shape.mesh);
  }
  return shapes;
}

Placement placed_near(const PeerShape& a, const PeerShape& b, const Quat& rotation, const Vec3& direction, double gap,
                      MeshDistanceScratch& scratch) {
  // the distance changes by no more than b moves, so stepping by the excess never passes the first contact
  double along = a.bounding_radius + b.bounding_radius + gap;
  Placement placement{matrix_of(rotation), along * direction, 1};
  for (int step = 0; step < 1000; ++step) {
    const double excess = mesh_distance({&a.mesh, &a.bvh}, {&b.mesh, &b.bvh}, placement, 10 * along, scratch) - gap;
    if (excess < 1e-9 * gap) break;
    along -= excess;
    placement.translation = along * direction;
  }
  return placement;
}

void write_peer_shapes(const std::string& folder, const std::vector<PeerShape>& shapes) {
  std::filesystem::create_directories(folder);
  std::ofstream list = open_for_writing(folder + "/shapes.txt");
  for (std::size_t k = 0; k < shapes.size(); ++k) {
    const PeerShape& s = shapes[k];
    list << fmt::format("{:.17g} {:.17g} {:.17g} {:.17g} {:.17g}\n", s.volume, s.moments.x, s.moments.y, s.moments.z, s.bounding_radius);
    std::ofstream obj = open_for_writing(obj_path(folder, k));
    for (const Vec3& p : s.mesh.vertices) obj << fmt::format("v {:.17g} {:.17g} {:.17g}\n", p.x, p.y, p.z);
    for (const Triangle& t : s.mesh.triangles) obj << fmt::format("f {} {} {}\n", t[0] + 1, t[1] + 1, t[2] + 1);
  }
}

std::vector<PeerShape> read_peer_shapes(const std::string& folder) {
  std::ifstream list(folder + "/shapes.txt");
  if (!list) throw InputError("{}/shapes.txt: cannot be read; make the shapes first", folder);
  std::vector<PeerShape> shapes;
  PeerShape s;
  while (list >> s.volume >> s.moments.x >> s.moments.y >> s.moments.z >> s.bounding_radius) {
    s.mesh = read_obj(obj_path(folder, shapes.size()));
    s.bvh = build_bvh(s.mesh);
    shapes.push_back(s);
  }
  if (shapes.empty()) throw InputError("{}/shapes.txt: no shape; expected five numbers a line", folder);
  return shapes;
}

std::vector<PeerBody> read_peer_state(const std::string& path) {
  std::ifstream file(path);
  if (!file) throw InputError("{}: cannot be read", path);
  std::vector<PeerBody> bodies;
  std::string line;
  while (std::getline(file, line)) {
    std::istringstream words(line);
    PeerBody b;
    words >> b.shape;
    for (double* x : {&b.position.x, &b.position.y, &b.position.z, &b.orientation.w, &b.orientation.x, &b.orientation.y, &b.orientation.z,
                      &b.velocity.x, &b.velocity.y, &b.velocity.z, &b.angular_velocity.x, &b.angular_velocity.y, &b.angular_velocity.z})
      words >> *x;
    if (words.fail()) throw InputError("{}:{}: expected a shape and 13 numbers", path, bodies.size() + 1);
    b.orientation = normalised(b.orientation);
    bodies.push_back(b);
  }
  return bodies;
}

void write_peer_state(const std::string& path, const std::vector<PeerBody>& bodies) {
  std::ofstream file = open_for_writing(path);
  for (const PeerBody& b : bodies) {
    const Vec3 &x = b.position, &v = b.velocity, &w = b.angular_velocity;
    const Quat& q = b.orientation;
    file << fmt::format("{} {:.17g} {:.17g} {:.17g} {:.17g} {:.17g} {:.17g} {:.17g} {:.17g} {:.17g} {:.17g} {:.17g} {:.17g} {:.17g}\n",
                        b.shape, x.x, x.y, x.z, q.w, q.x, q.y, q.z, v.x, v.y, v.z, w.x, w.y, w.z);
  }
}

Verdict judge_state(const std::vector<PeerShape>& shapes, const std::vector<PeerBody>& bodies, double box_length, double density,
                    double gravity, double reach) {
  Verdict verdict;
  const auto scratch = make_mesh_distance_scratch();
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    const PeerBody& a = bodies[i];
    const PeerShape& shape_a = shapes.at(static_cast<std::size_t>(a.shape));
    const double mass = density * shape_a.volume;
    const Vec3 spin = rotate_inverse(a.orientation, a.angular_velocity), &m = shape_a.moments;
    verdict.kinetic +=
        0.5 * mass * squared_length(a.velocity) + 0.5 * density * (m.x * spin.x * spin.x + m.y * spin.y * spin.y + m.z * spin.z * spin.z);
    verdict.potential += mass * gravity * a.position.z;
    verdict.largest_speed = std::max(verdict.largest_speed, length(a.velocity));
    for (const Vec3& corner : shape_a.mesh.vertices) {
      const Vec3 p = a.position + rotate(a.orientation, corner);
      verdict.deepest = std::max({verdict.deepest, -p.x, -p.y, -p.z, p.x - box_length, p.y - box_length});
    }
    for (std::size_t j = i + 1; j < bodies.size(); ++j) {
      const PeerBody& b = bodies[j];
      const PeerShape& shape_b = shapes.at(static_cast<std::size_t>(b.shape));
      if (length(b.position - a.position) > shape_a.bounding_radius + shape_b.bounding_radius + reach) continue;
      const Placement b_in_a = relative_placement(a.position, a.orientation, 1, b.position, b.orientation, 1);
      const double gap = mesh_distance({&shape_a.mesh, &shape_a.bvh}, {&shape_b.mesh, &shape_b.bvh}, b_in_a, reach, *scratch);
      const bool nested =
          gap > 0 && (is_inside(shape_a.mesh, b_in_a.rotation * shape_b.mesh.vertices[0] + b_in_a.translation) ||
                      is_inside(shape_b.mesh, transpose_times(b_in_a.rotation, shape_a.mesh.vertices[0] - b_in_a.translation)));
      if (gap < reach || nested) ++verdict.touching_pairs;
      if (gap > 0 && !nested) continue;
      ++verdict.intersecting_pairs;
      verdict.deepest = std::max({verdict.deepest, depth_of_corners(shape_a, a, shape_b, b), depth_of_corners(shape_b, b, shape_a, a)});
    }
  }
  return verdict;
}

}  // namespace scree
