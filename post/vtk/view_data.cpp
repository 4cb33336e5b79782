#include "post/vtk/view_data.hpp"

#include <algorithm>
#include <cstring>
#include <map>
#include <nlohmann/json.hpp>
#include <unordered_map>

#include "post/run/contact_network.hpp"
#include "post/run/drawn_meshes.hpp"

namespace scree {

namespace {

constexpr std::size_t kMaxTriangles = 2000000;     // a laptop's graphics still turns these
constexpr std::size_t kMaxWallTriangles = 100000;  // of all walls: 2.4 MB of the page
constexpr std::size_t kMaxLines = 60000;

template <class T>
std::string array(const std::vector<T>& values) {
  std::string bytes(values.size() * sizeof(T), '\0');
  if (!values.empty()) std::memcpy(bytes.data(), values.data(), bytes.size());
  return base64(bytes);
}

void push(std::vector<float>& to, const Vec3& v) {
  for (int k = 0; k < 3; ++k) to.push_back(static_cast<float>(v[k]));
}

/// Ends of the edges that are seen: borders and those between faces that meet at more than 30 degrees.
std::vector<float> edges_of(const TriangleMesh& mesh, const Vec3& middle) {
  std::vector<float> lines;
  std::map<std::pair<std::int32_t, std::int32_t>, std::vector<Vec3>> normals;
  for (std::int32_t t = 0; t < mesh.triangle_count(); ++t) {
    const Vec3 n = cross(mesh.corner(t, 1) - mesh.corner(t, 0), mesh.corner(t, 2) - mesh.corner(t, 0));
    if (!(length(n) > 0)) continue;
    for (std::size_t k = 0; k < 3; ++k) {
      const std::int32_t a = mesh.triangles[static_cast<std::size_t>(t)][k], b = mesh.triangles[static_cast<std::size_t>(t)][(k + 1) % 3];
      normals[{std::min(a, b), std::max(a, b)}].push_back(normalised(n));
    }
  }
  for (const auto& [edge, n] : normals) {
    if (n.size() == 2 && dot(n[0], n[1]) > 0.866) continue;
    for (const std::int32_t v : {edge.first, edge.second}) push(lines, mesh.vertices[static_cast<std::size_t>(v)] - middle);
  }
  return lines;
}

std::string corners_of(const TriangleMesh& mesh) {
  std::vector<std::uint32_t> corners;
  for (const Triangle& t : mesh.triangles) {
    for (const std::int32_t v : t) corners.push_back(static_cast<std::uint32_t>(v));
  }
  return array(corners);
}

/// A wall in its own frame about the middle of its box, so that float32 holds a wall that is drawn far from its origin. It is one-sided
/// where it is analytic: its near sides, which would hide all bodies in it, are not drawn.
nlohmann::json wall_json(const Wall& wall, const TriangleMesh& full, std::size_t share) {
  const bool fits = full.triangles.size() <= share;
  const TriangleMesh mesh = fits ? full : coarse_mesh(full, share);
  const Vec3 middle = bounding_box(full).centre();
  std::vector<float> points;
  for (const Vec3& v : mesh.vertices) push(points, v - middle);
  return {{"name", wall.name},
          {"middle", {middle.x, middle.y, middle.z}},
          {"oneSided", wall.kind != WallKind::mesh},
          {"coarse", !fits},
          {"points", array(points)},
          {"corners", corners_of(mesh)},
          {"edges", array(edges_of(full, middle))}};
}

}  // namespace

std::string base64(const std::string& bytes) {
  static const char* const kLetters = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  text.reserve(4 * (bytes.size() + 2) / 3);
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    std::uint32_t group = 0;
    for (std::size_t k = 0; k < 3; ++k) group = (group << 8) | (i + k < bytes.size() ? static_cast<unsigned char>(bytes[i + k]) : 0U);
    for (std::size_t k = 0; k < 4; ++k) text += i + k <= bytes.size() ? kLetters[(group >> (18 - 6 * k)) & 63U] : '=';
  }
  return text;
}

JsonRecord view_data(const Run& run, const Frame& given, const Within& within, const ViewExtent& extent) {
  const Scene& scene = run.scene;
  // what has left the equipment is shown, but the camera does not follow it
  const Frame inside = within.part_of(run, given);
  const Frame& frame = within.is_equipment() ? given : inside;
  const FrameBodies& b = frame.bodies;
  const Box3 room = extent.room.value_or(room_of(inside.bodies, scene));
  const View view = view_of(room, scene.settings.gravity);
  const auto list = [](const Vec3& v) { return nlohmann::json{v.x, v.y, v.z}; };
  nlohmann::json data = {{"time", frame.time},
                         {"centre", list(view.centre)},
                         {"radius", view.radius},
                         {"from", list(view.from)},
                         {"up", list(view.up)},
                         {"room", {list(room.lower), list(room.upper)}},
                         {"number", frame.number},
                         {"count", b.size()},
                         {"keptContacts", scene.settings.output_contacts},
                         {"shapes", nlohmann::json::array()},
                         {"materials", nlohmann::json::array()}};
  for (const Material& m : scene.materials) data["materials"].push_back(m.name);
  for (std::int32_t k = 0; k < kShapeColours; ++k) data["colours"].push_back(list(shape_colour(k)));

  // meshes, coarser when there are very many bodies
  const std::size_t share = std::max<std::size_t>(12, kMaxTriangles / std::max({std::size_t{1}, b.size(), extent.most}));
  for (const Shape& shape : scene.shapes) {
    const DrawnMesh full = drawn_shape(shape);
    const bool fits = full.mesh.triangles.size() <= share;
    const TriangleMesh mesh = fits ? full.mesh : coarse_mesh(full.mesh, share);
    std::vector<float> points;
    for (const Vec3& v : mesh.vertices) push(points, v);
    data["shapes"].push_back({{"name", shape.name},
                              {"ball", shape.kind == ShapeKind::sphere},
                              {"coarse", !fits},
                              {"diameter", shape.equivalent_diameter()},
                              {"points", array(points)},
                              {"corners", corners_of(mesh)}});
  }

  // bodies
  const std::vector<NetworkLine> network = network_of(frame, periodicity_of(scene, frame));
  std::vector<float> position, orientation, scale, velocity;
  std::vector<std::uint16_t> shape, material, touching;
  std::vector<double> id(b.id.begin(), b.id.end());
  for (std::size_t i = 0; i < b.size(); ++i) {
    push(position, b.position[i] - view.centre);
    const Quat& q = b.orientation[i];
    for (const double c : {q.x, q.y, q.z, q.w}) orientation.push_back(static_cast<float>(c));
    scale.push_back(static_cast<float>(b.scale[i]));
    push(velocity, b.velocity[i]);
    shape.push_back(static_cast<std::uint16_t>(b.shape[i]));
    material.push_back(static_cast<std::uint16_t>(b.material[i]));
  }
  for (const std::int32_t count : line_counts(network, b.size())) touching.push_back(static_cast<std::uint16_t>(count));
  if (b.has_temperature) data["temperature"] = array(std::vector<float>(b.temperature.begin(), b.temperature.end()));
  data["position"] = array(position);
  data["orientation"] = array(orientation);
  data["scale"] = array(scale);
  data["velocity"] = array(velocity);
  data["shape"] = array(shape);
  data["material"] = array(material);
  data["id"] = array(id);
  data["touching"] = array(touching);

  // walls with their places, contacts as lines with their normal force
  std::vector<double> places;
  data["walls"] = nlohmann::json::array();
  for (const Wall& wall : scene.walls)
    data["walls"].push_back(
        wall_json(wall, drawn_wall(wall, scene, room, &frame), std::max<std::size_t>(12, kMaxWallTriangles / scene.walls.size())));
  for (const auto& [x, q] : wall_places(frame, scene)) places.insert(places.end(), {x.x, x.y, x.z, q.x, q.y, q.z, q.w});
  data["wallPlaces"] = array(places);
  std::vector<float> lines, forces;
  std::vector<NetworkLine> strongest = network;
  if (strongest.size() > kMaxLines) {
    std::nth_element(strongest.begin(), strongest.begin() + kMaxLines, strongest.end(),
                     [](const auto& p, const auto& q) { return p.normal_force > q.normal_force; });
    strongest.resize(kMaxLines);
  }
  for (const NetworkLine& line : strongest) {
    push(lines, line.from - view.centre);
    push(lines, line.to - view.centre);
    forces.push_back(static_cast<float>(line.normal_force));
  }
  data["lines"] = array(lines);
  data["forces"] = array(forces);
  data["contacts"] = network.size();
  return data;
}

}  // namespace scree
