#include "core/storage/shape_file.hpp"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>

#include "core/base/utf8.hpp"
#include "core/base/version.hpp"
#include "core/geometry/features.hpp"
#include "core/storage/json_object.hpp"

namespace scree {

namespace {

// Padded to four digits for people; from the 10 001st shape on the names sort otherwise as text than as numbers.
std::string group_of_shape(std::int64_t number) { return fmt::format("shape_{:04}", number); }

double sphere_area(double radius) { return 4 * std::numbers::pi * radius * radius; }

// The same sum of the same numbers: another compiler may round it otherwise, a relative 1e-16 for each triangle.
constexpr double kAreaTolerance = 1e-9;

/// A vertex or a radius that was changed shows in the area, which the file holds too.
void check_area(const std::string& path, const Shape& shape) {
  const double area = shape.kind == ShapeKind::sphere ? sphere_area(shape.sphere_radius) : surface_area(shape.mesh);
  if (std::isfinite(area) && std::abs(area - shape.area) <= kAreaTolerance * area) return;
  throw InputError("{}: its attribute 'area' is {:.12g} m^2, but its surface has {:.12g} m^2; the file is damaged", path, shape.area, area);
}

/// Of a sphere one vertex and a radius, of all others none: a radius that is wrong would pass for the size of the body.
void check_radius(const std::string& path, const Shape& shape) {
  const bool is_sphere = shape.kind == ShapeKind::sphere;
  if (is_sphere ? !(shape.sphere_radius > 0) : shape.sphere_radius != 0)
    throw InputError("{}: its attribute 'sphere_radius' is {:g} m, {} expected; the file is damaged", path, shape.sphere_radius,
                     is_sphere ? "a value > 0" : "0 of a shape that is no sphere");
  if (is_sphere && (shape.mesh.vertices.size() != 1 || !(shape.mesh.vertices[0] == Vec3{}) || !shape.mesh.triangles.empty()))
    throw InputError("{}: a sphere of {} vertices and {} triangles, one vertex at the origin expected; the file is damaged", path,
                     shape.mesh.vertices.size(), shape.mesh.triangles.size());
  if (!(shape.cell_size >= 0) || !std::isfinite(shape.cell_size))
    throw InputError("{}: its attribute 'cell_size' is {:g} m, a value >= 0 expected; the file is damaged", path, shape.cell_size);
}

/// A body holds what its surface holds, or more: a piece of a body that breaks has the mass of what was cut, its surface lies further in.
/// It turns by its moments.
void check_mass(const std::string& path, const Shape& shape) {
  const MassProperties& mass = shape.mass;
  const double held =
      shape.kind == ShapeKind::sphere ? sphere_mass_properties(shape.sphere_radius).volume : mass_properties(shape.mesh).volume;
  if (!(mass.volume >= held - kAreaTolerance * shape.area * shape.bounding_radius()))
    throw InputError("{}: its attribute 'volume' is {:.12g} m^3, but its surface holds {:.12g} m^3; the file is damaged", path, mass.volume,
                     held);
  const Vec3& moments = mass.principal_moments;
  if (!is_finite(moments) || !(std::min({moments.x, moments.y, moments.z}) > 0))
    throw InputError("{}/principal_moments: {:g}, {:g}, {:g} m^5 found, values > 0 expected; the file is damaged", path, moments.x,
                     moments.y, moments.z);
  for (const Vec3& row : {mass.inertia[0], mass.inertia[1], mass.inertia[2]})
    if (!is_finite(row)) throw InputError("{}/inertia: a value that is not a finite number; the file is damaged", path);
  if (!(std::abs(norm(mass.body_from_principal) - 1) <= kUnitTolerance))
    throw InputError("{}/body_from_principal: a quaternion of norm {:.9g}, 1 expected; the file is damaged", path,
                     norm(mass.body_from_principal));
}

}  // namespace

double Shape::bounding_radius() const { return scree::bounding_radius(mesh) + sphere_radius; }

double Shape::equivalent_diameter() const { return mass.volume > 0 ? std::cbrt(6 * mass.volume / std::numbers::pi) : 0.0; }

Shape make_solid(const std::string& name, TriangleMesh mesh) {
  Shape shape;
  shape.name = name;
  shape.mass = mass_properties(mesh);
  if (!(shape.mass.volume > 0)) {
    throw InputError(
        "shape '{}': the signed volume is {:g}, a solid needs a volume > 0; the mesh is inverted, flat or open "
        "(see scree-mesher check)",
        name, shape.mass.volume);
  }
  shape.origin_shift = shape.mass.centre;
  for (Vec3& p : mesh.vertices) p -= shape.origin_shift;
  shape.mass.centre = {};
  shape.mesh = std::move(mesh);
  shape.area = surface_area(shape.mesh);
  return shape;
}

Shape make_surface(const std::string& name, TriangleMesh mesh) {
  Shape shape;
  shape.name = name;
  shape.kind = ShapeKind::surface;
  shape.mesh = std::move(mesh);
  shape.area = surface_area(shape.mesh);
  return shape;
}

Shape make_sphere(const std::string& name, double radius) {
  Shape shape;
  shape.name = name;
  shape.kind = ShapeKind::sphere;
  shape.mesh.vertices = {Vec3{}};
  shape.sphere_radius = radius;
  shape.mass = sphere_mass_properties(radius);
  shape.area = sphere_area(radius);
  return shape;
}

void check_format(const h5::Group& root, const std::string& format, std::int64_t newest_version) {
  if (!root.has_attribute("format")) throw InputError("{} is not a Scree file: it has no 'format'; expected {}", root.path(), format);
  const std::string found = root.read_text_attribute("format");
  if (found != format) throw InputError("{} is a {} file, expected {}", root.path(), found, format);
  const std::int64_t version = root.read_integer_attribute("format_version");
  if (version > newest_version || version < 1) {
    throw InputError("{}: version {} of {}, this Scree ({}) reads up to version {}; use a newer Scree", root.path(), version, format,
                     kVersion, newest_version);
  }
}

void write_shapes(const h5::Group& group, const std::vector<Shape>& shapes) {
  for (std::size_t i = 0; i < shapes.size(); ++i) {
    const Shape& shape = shapes[i];
    const h5::Group g = group.create_group(group_of_shape(static_cast<std::int64_t>(i)));
    g.write_attribute("name", shape.name);
    g.write_attribute("kind", static_cast<std::int32_t>(shape.kind));
    g.write_attribute("sphere_radius", shape.sphere_radius);
    if (shape.cell_size > 0) g.write_attribute("cell_size", shape.cell_size);
    g.write_attribute("volume", shape.mass.volume);
    g.write_attribute("area", shape.area);
    g.write_array("vertices", shape.mesh.vertices, "m");
    std::vector<std::int32_t> indices;
    indices.reserve(3 * shape.mesh.triangles.size());
    for (const Triangle& t : shape.mesh.triangles) indices.insert(indices.end(), t.begin(), t.end());
    g.write_array("triangles", indices, 3, "");
    g.write_array("origin_shift", std::vector<Vec3>{shape.origin_shift}, "m");
    const Mat3& inertia = shape.mass.inertia;
    g.write_array("inertia", std::vector<Vec3>{inertia[0], inertia[1], inertia[2]}, "m^5");
    g.write_array("principal_moments", std::vector<Vec3>{shape.mass.principal_moments}, "m^5");
    g.write_array("body_from_principal", std::vector<Quat>{shape.mass.body_from_principal}, "");
    const FeatureTable features = find_features(shape.mesh);
    std::vector<std::uint8_t> corner(shape.mesh.vertices.size(), 0), edge_kind;
    for (std::int32_t v : features.corners) corner[static_cast<std::size_t>(v)] = 1;
    for (std::size_t t = 0; t < shape.mesh.triangles.size(); ++t) {
      for (std::size_t k = 0; k < 3; ++k) edge_kind.push_back(static_cast<std::uint8_t>(features.edge_kind(t, k)));
    }
    g.write_array("vertex_is_corner", corner, 1, "");
    g.write_array("edge_kind", edge_kind, 3, "");
    g.write_text("verdict", json_text(shape.verdict));
  }
}

std::vector<Shape> read_shapes(const h5::Group& group) {
  std::vector<Shape> shapes;
  const std::int64_t count = group.child_count();
  for (std::int64_t number = 0; number < count; ++number) {
    const h5::Group g = group.open_group(group_of_shape(number));
    Shape shape;
    shape.name = g.read_text_attribute("name");
    const std::int64_t kind = g.read_integer_attribute("kind");
    if (kind < 0 || kind > 2) throw InputError("{}: kind {} is unknown; expected 0 (solid), 1 (surface) or 2 (sphere)", g.path(), kind);
    shape.kind = static_cast<ShapeKind>(kind);
    shape.sphere_radius = g.read_double_attribute("sphere_radius");
    if (g.has_attribute("cell_size")) shape.cell_size = g.read_double_attribute("cell_size");
    shape.area = g.read_double_attribute("area");
    shape.mesh.vertices = g.read_vectors("vertices");
    const std::vector<std::int32_t> indices = g.read_array<std::int32_t>("triangles", 3);
    for (std::size_t i = 0; i + 2 < indices.size(); i += 3) {
      for (std::size_t k = 0; k < 3; ++k) {
        if (indices[i + k] < 0 || indices[i + k] >= shape.mesh.vertex_count()) {
          throw InputError("{}: triangle {} names vertex {}, but there are {} vertices", g.path(), i / 3, indices[i + k],
                           shape.mesh.vertex_count());
        }
      }
      shape.mesh.triangles.push_back({indices[i], indices[i + 1], indices[i + 2]});
    }
    for (std::size_t v = 0; v < shape.mesh.vertices.size(); ++v) {
      if (!is_finite(shape.mesh.vertices[v])) throw InputError("{}: vertex {} is not a finite number", g.path(), v);
    }
    const auto one = [&](const char* dataset) {
      const std::vector<Vec3> rows = g.read_vectors(dataset);
      if (rows.size() != 1) throw InputError("{}/{}: {} rows found, 1 expected", g.path(), dataset, rows.size());
      return rows[0];
    };
    shape.origin_shift = one("origin_shift");
    shape.mass.volume = g.read_double_attribute("volume");
    shape.mass.principal_moments = one("principal_moments");
    const std::vector<Vec3> inertia = g.read_vectors("inertia");
    const std::vector<Quat> principal = g.read_quaternions("body_from_principal");
    if (inertia.size() != 3 || principal.size() != 1) throw InputError("{}: inertia is incomplete", g.path());
    for (int i = 0; i < 3; ++i) shape.mass.inertia[i] = inertia[static_cast<std::size_t>(i)];
    shape.mass.body_from_principal = principal[0];
    shape.verdict = nlohmann::json::parse(g.read_text("verdict"), nullptr, false);
    if (shape.kind != ShapeKind::surface && (!(shape.mass.volume > 0) || !std::isfinite(shape.mass.volume))) {
      throw InputError("{}: volume {:g}; a body needs a volume > 0", g.path(), shape.mass.volume);
    }
    if (!is_finite(shape.origin_shift)) throw InputError("{}/origin_shift: not finite numbers; the file is damaged", g.path());
    check_radius(g.path(), shape);
    check_area(g.path(), shape);
    if (shape.kind != ShapeKind::surface) check_mass(g.path(), shape);
    shapes.push_back(std::move(shape));
  }
  return shapes;
}

void write_shape_file(const std::string& path, const std::vector<Shape>& shapes, const nlohmann::json& provenance,
                      const PieceTable* pieces) {
  h5::NewFile file(path);
  file.root().write_attribute("format", kShapeFormat);
  file.root().write_attribute("format_version", kShapeFormatVersion);
  file.root().write_text("provenance", json_text(provenance));
  write_shapes(file.root().create_group("shapes"), shapes);
  if (pieces != nullptr) write_piece_table(file.root().create_group("pieces"), *pieces);
  file.commit();
}

ShapeFile read_shape_file(const std::string& path) {
  const h5::File file(path);
  check_format(file.root(), kShapeFormat, kShapeFormatVersion);
  ShapeFile result;
  result.shapes = read_shapes(file.root().open_group("shapes"));
  if (result.shapes.empty()) throw InputError("{}: holds no shape", path);
  result.provenance = nlohmann::json::parse(file.root().read_text("provenance"), nullptr, false);
  if (file.root().has("pieces"))
    result.pieces = read_piece_table(file.root().open_group("pieces"), static_cast<std::int64_t>(result.shapes.size()));
  return result;
}

}  // namespace scree
