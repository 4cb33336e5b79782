#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/base/error.hpp"
#include "core/base/provenance.hpp"
#include "core/base/units.hpp"
#include "core/storage/shape_file.hpp"
#include "mesher/commands.hpp"
#include "mesher/generate.hpp"
#include "mesher/mesh_check.hpp"
#include "mesher/mesh_repair.hpp"

namespace scree {

namespace {

/// Default edge length of round shapes: about 25 edges around and 550 triangles on a sphere, whose volume is
/// then 2 % short. Finer is asked for, since every triangle costs time in each step.
constexpr double kEdgePerRadius = 0.25;
/// Most triangles that a generated shape may have, by estimate from its area.
constexpr double kMostTriangles = 5e6;

double positive_length(const std::string& text, const char* option) {
  if (text.empty())
    throw UsageError("generate: {} is missing; give a length, for instance {} \"5 mm\"", option, option);
  const double value = parse_quantity(text, Dimension::length, option);
  if (!(value > 0)) throw UsageError("{} = \"{}\": expected a length > 0", option, text);
  return value;
}

Vec3 size_of(const std::string& text) {
  std::vector<std::string> parts{""};
  for (char c : text) {
    if (c == ',') {
      parts.emplace_back();
    } else {
      parts.back() += c;
    }
  }
  if (parts.size() != 3) {
    throw UsageError(
        "--size = \"{}\": {} lengths found, 3 expected, for instance --size \"4 cm, 2 cm, 1 cm\"", text,
        text.empty() ? 0 : parts.size());
  }
  return {positive_length(parts[0], "--size"), positive_length(parts[1], "--size"),
          positive_length(parts[2], "--size")};
}

void refuse_option(const std::string& value, const char* option, const std::string& what) {
  if (!value.empty()) throw UsageError("generate {}: {} has no meaning for it", what, option);
}

void check_triangle_count(double area, double edge_length) {
  const double triangles = area / (0.433 * edge_length * edge_length);  // equilateral triangles
  if (triangles > kMostTriangles) {
    throw UsageError(
        "--edge-length: {:.3g} m would make about {:.2g} triangles, more than {:g}; give a larger one",
        edge_length, triangles, kMostTriangles);
  }
}

}  // namespace

CommandResult generate_command(const GenerateOptions& options, const std::vector<std::string>& command) {
  if (!options.output.ends_with(".shape.h5")) {
    throw UsageError("-o {}: a shape file is called NAME.shape.h5", options.output);
  }
  const std::string name = options.name.empty() ? options.what : options.name;
  const bool has_edge_length = !options.edge_length.empty();
  TriangleMesh mesh;
  Shape shape;
  if (options.what == "sphere") {
    refuse_option(options.size, "--size", "sphere");
    refuse_option(options.height, "--height", "sphere");
    const double radius = positive_length(options.radius, "--radius");
    if (options.analytic) {
      refuse_option(options.edge_length, "--edge-length", "sphere --analytic");
      shape = make_sphere(name, radius);
    } else {
      const double l =
          has_edge_length ? positive_length(options.edge_length, "--edge-length") : kEdgePerRadius * radius;
      check_triangle_count(4 * 3.1416 * radius * radius, l);
      mesh = generate_sphere(radius, l);
    }
  } else if (options.what == "box") {
    refuse_option(options.radius, "--radius", "box");
    refuse_option(options.height, "--height", "box");
    const Vec3 size = size_of(options.size);
    if (has_edge_length) {
      const double l = positive_length(options.edge_length, "--edge-length");
      check_triangle_count(2 * (size.x * size.y + size.y * size.z + size.z * size.x), l);
      mesh = generate_box(size, l);
    } else {
      mesh = box_mesh(size);
    }
  } else {
    refuse_option(options.size, "--size", "cylinder");
    const double radius = positive_length(options.radius, "--radius"),
                 height = positive_length(options.height, "--height");
    const double l =
        has_edge_length ? positive_length(options.edge_length, "--edge-length") : kEdgePerRadius * radius;
    check_triangle_count(2 * 3.1416 * radius * (radius + height), l);
    const int layers = has_edge_length ? std::max(1, static_cast<int>(std::lround(height / l))) : 1;
    mesh = generate_cylinder(radius, height, l, layers);
  }

  if (shape.kind != ShapeKind::sphere) {
    clean_mesh(mesh, false);
    const MeshCheck check = check_mesh(mesh);
    if (!check.is_solid()) {
      throw InputError("generate {}: the mesh that gmsh made is no solid ({}); try another --edge-length",
                       options.what, check.problems.front());
    }
    shape = make_solid(name, std::move(mesh));
    shape.verdict = json_of(check);
  }

  Provenance provenance;
  provenance.format = kShapeFormat;
  provenance.format_version = kShapeFormatVersion;
  provenance.tool = "scree-mesher";
  provenance.command = command;
  provenance.configuration =
      fmt::format("generate {} radius={} height={} size={} edge-length={} analytic={}", options.what,
                  options.radius, options.height, options.size, options.edge_length, options.analytic);
  provenance.instruction_set = "scalar";
  write_shape_file(options.output, {shape}, provenance_record(provenance));

  CommandResult result;
  result.output = shape.kind == ShapeKind::sphere
                      ? fmt::format("{}: analytic sphere of radius {}", name,
                                    format_quantity(shape.sphere_radius, Dimension::length))
                      : fmt::format("{}: {} triangles", name, shape.mesh.triangle_count());
  result.output += fmt::format(", volume {:.9g} m^3\nwrote {}\n", shape.mass.volume, options.output);
  return result;
}

}  // namespace scree
