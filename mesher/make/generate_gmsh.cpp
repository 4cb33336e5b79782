#include <fmt/format.h>
#include <gmsh.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <unordered_map>

#include "core/base/error.hpp"
#include "mesher/io/mesh_file.hpp"
#include "mesher/make/generate.hpp"
#include "mesher/repair/mesh_repair.hpp"

namespace scree {

namespace {

/// gmsh between initialize and finalize. No user configuration is read, one thread: the same mesh each time.
class GmshSession {
 public:
  GmshSession() {
    gmsh::initialize(0, nullptr, false);
    gmsh::option::setNumber("General.Terminal", 0);
    gmsh::option::setNumber("General.NumThreads", 1);
    gmsh::model::add("shape");
  }
  GmshSession(const GmshSession&) = delete;
  GmshSession& operator=(const GmshSession&) = delete;
  ~GmshSession() {
    try {
      gmsh::finalize();
    } catch (...) {  // a destructor does not throw; the session ends with the process anyway
    }
  }
};

/// Triangles on the boundary of the model's volumes, outward.
TriangleMesh boundary_triangles() {
  gmsh::vectorpair volumes, faces;
  gmsh::model::getEntities(volumes, 3);
  gmsh::model::getBoundary(volumes, faces, true, true, false);
  TriangleMesh mesh;
  std::unordered_map<std::size_t, std::int32_t> index;
  for (const auto& [dimension, signed_tag] : faces) {
    const int tag = std::abs(signed_tag);
    std::vector<std::size_t> tags, element_tags, element_nodes;
    std::vector<double> coordinates, parameters;
    gmsh::model::mesh::getNodes(tags, coordinates, parameters, dimension, tag, true, false);
    for (std::size_t i = 0; i < tags.size(); ++i) {
      if (!index.emplace(tags[i], mesh.vertex_count()).second) continue;
      mesh.vertices.push_back({coordinates[3 * i], coordinates[3 * i + 1], coordinates[3 * i + 2]});
    }
    constexpr int kTriangle = 2;  // gmsh's number of the 3-node triangle
    gmsh::model::mesh::getElementsByType(kTriangle, element_tags, element_nodes, tag);
    for (std::size_t i = 0; i + 2 < element_nodes.size(); i += 3) {
      Triangle t{index.at(element_nodes[i]), index.at(element_nodes[i + 1]), index.at(element_nodes[i + 2])};
      mesh.triangles.push_back(t);
    }
  }
  turn_outward(mesh);
  return mesh;
}

/// The model of a CAD file: its solids, healed when they are none yet.
void import_cad(const std::string& path) {
  gmsh::vectorpair made;
  gmsh::model::occ::importShapes(path, made);
  gmsh::model::occ::synchronize();
  gmsh::vectorpair volumes;
  gmsh::model::getEntities(volumes, 3);
  if (volumes.empty()) {
    gmsh::vectorpair healed;
    gmsh::model::occ::healShapes(healed, made, 1e-8, true, true, true, true, true);
    gmsh::model::occ::synchronize();
    gmsh::model::getEntities(volumes, 3);
  }
  if (volumes.empty()) throw InputError("{}: the file holds no solid, and its faces do not close", path);
}

/// Runs one construction in a session of its own. gmsh throws std::string.
TriangleMesh with_gmsh(const std::string& what, double edge_length, const std::function<void()>& build) {
  try {
    const GmshSession session;
    gmsh::option::setNumber("Mesh.MeshSizeMin", edge_length);
    gmsh::option::setNumber("Mesh.MeshSizeMax", edge_length);
    build();
    gmsh::model::mesh::generate(2);
    return boundary_triangles();
  } catch (const std::string& text) {
    throw InputError("{}: gmsh could not mesh it: {}; try another --edge-length", what, text);
  }
}

}  // namespace

bool has_gmsh() { return true; }

std::string gmsh_version() { return GMSH_API_VERSION; }

// gmsh works with absolute tolerances near 1e-8, so every shape is built at unit size and scaled afterwards.
TriangleMesh generate_sphere(double radius, double edge_length) {
  TriangleMesh mesh = with_gmsh("sphere", edge_length / radius, [] {
    gmsh::model::occ::addSphere(0, 0, 0, 1);
    gmsh::model::occ::synchronize();
  });
  for (Vec3& p : mesh.vertices) p *= radius / length(p);  // on the sphere to the last digit
  return mesh;
}

TriangleMesh generate_box(const Vec3& size, double edge_length) {
  const double unit = std::max({size.x, size.y, size.z});
  const Vec3 s = (1 / unit) * size;
  TriangleMesh mesh = with_gmsh("box", edge_length / unit, [&] {
    gmsh::model::occ::addBox(-0.5 * s.x, -0.5 * s.y, -0.5 * s.z, s.x, s.y, s.z);
    gmsh::model::occ::synchronize();
  });
  // faces to the last digit, so that each is one flat region
  const auto snap = [](double x, double half) { return std::abs(std::abs(x) - half) < 1e-9 ? std::copysign(half, x) : x; };
  for (Vec3& p : mesh.vertices) {
    p = {unit * snap(p.x, 0.5 * s.x), unit * snap(p.y, 0.5 * s.y), unit * snap(p.z, 0.5 * s.z)};
  }
  return mesh;
}

TriangleMesh generate_cylinder(double radius, double height, double edge_length, int layers) {
  const double h = height / radius;
  TriangleMesh mesh = with_gmsh("cylinder", edge_length / radius, [&] {
    const int disk = gmsh::model::occ::addDisk(0, 0, -0.5 * h, 1, 1);
    gmsh::vectorpair made;
    gmsh::model::occ::extrude({{2, disk}}, 0, 0, h, made, {layers});
    gmsh::model::occ::synchronize();
  });
  // the ends exactly plane, the rim exactly round
  for (Vec3& p : mesh.vertices) {
    const double r = std::hypot(p.x, p.y);
    if (std::abs(r - 1) < 1e-9) p.x /= r, p.y /= r;
    if (std::abs(std::abs(p.z) - 0.5 * h) < 1e-9 * h) p.z = std::copysign(0.5 * h, p.z);
    p *= radius;
  }
  return mesh;
}

TriangleMesh read_cad_with_gmsh(const std::string& path) {
  try {
    const GmshSession session;
    import_cad(path);
    double low[3], high[3];
    gmsh::model::getBoundingBox(-1, -1, low[0], low[1], low[2], high[0], high[1], high[2]);
    const double diagonal = std::hypot(high[0] - low[0], high[1] - low[1], high[2] - low[2]);
    constexpr double kElementsAround = 24, kLongest = 0.1;  // per full turn of a curve; of the diagonal
    gmsh::option::setNumber("Mesh.MeshSizeFromCurvature", kElementsAround);
    gmsh::option::setNumber("Mesh.MeshSizeMax", kLongest * diagonal);
    gmsh::model::mesh::generate(2);
    return boundary_triangles();
  } catch (const std::string& text) {
    throw InputError("{}: gmsh could not read or mesh it: {}", path, text);
  }
}

}  // namespace scree
