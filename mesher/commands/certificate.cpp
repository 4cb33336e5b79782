#include "mesher/commands/certificate.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "core/base/error.hpp"
#include "core/base/expect_ending.hpp"
#include "core/base/provenance.hpp"
#include "core/base/units.hpp"

namespace scree {

namespace {

/// Two units are the same within this part: what formats state comes through single precision.
constexpr double kSameUnit = 1e-5;

double metres_of(const std::string& unit) {
  if (unit.find_first_of("0123456789") != std::string::npos)
    throw UsageError(
        "--unit \"{}\": expected the name of a unit, such as mm, cm or in; a number by which lengths are multiplied is --scale", unit);
  return parse_quantity("1 " + unit, Dimension::length, "--unit");
}

/// Largest side of the bounding box, in the file's own numbers.
double longest_side(const MeshFile& file) {
  const Vec3 e = bounding_box(file.mesh).extent();
  return std::max({e.x, e.y, e.z});
}

}  // namespace

void expect_unit(const std::string& unit, double scale) {
  if (!(scale > 0) || !std::isfinite(scale)) throw UsageError("--scale {}: expected a number > 0, for instance 0.001", scale);
  if (!unit.empty()) metres_of(unit);
}

double metres_per_unit(const MeshFile& file, const std::string& path, const std::string& unit, double scale, CommandResult& result) {
  expect_unit(unit, scale);
  const double stated = file.stated_unit, length = file.mesh.vertices.empty() ? 0 : longest_side(file);
  const double given = unit.empty() ? 0 : metres_of(unit);
  const auto length_text = [](double x) { return format_quantity(x, Dimension::length); };
  const bool has_size = std::isfinite(length) && length > 0;
  if (given > 0 && stated > 0 && std::abs(given - stated) > kSameUnit * stated && has_size) {
    result.notices.push_back(fmt::format("{}: the file states that its longest side is {}; with --unit {} it is {}", path,
                                         length_text(length * stated), unit, length_text(length * given)));
  }
  // a scale answers the question, too: a user who gives one has looked at the size
  if (given == 0 && stated == 0 && scale == 1 && has_size) {
    result.notices.push_back(fmt::format(
        "{}: neither the file nor --unit states a unit: one unit is taken as 1 m, so the longest side is {}; with --unit cm it is {}, "
        "with --unit mm {}, with --unit um {}",
        path, length_text(length), length_text(1e-2 * length), length_text(1e-3 * length), length_text(1e-6 * length)));
  }
  return (given > 0 ? given : stated > 0 ? stated : 1) * scale;
}

void scale_mesh(TriangleMesh& mesh, double factor) {
  if (factor == 1) return;
  for (Vec3& p : mesh.vertices) p *= factor;
}

std::string shape_name_from(const std::string& path) {
  std::string name = std::filesystem::path(path).stem().string();
  if (name.ends_with(".shape")) name.resize(name.size() - 6);
  for (char& c : name) {
    const bool is_plain = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' || c == '-';
    if (!is_plain) c = '_';
  }
  return name.empty() ? "shape" : name;
}

void expect_shape_path(const std::string& path) { expect_ending("-o", path, "a shape file", {".shape.h5"}); }

std::string joined(const std::vector<std::string>& texts, const char* separator) {
  std::string result;
  for (const std::string& text : texts) result += (result.empty() ? "" : separator) + text;
  return result;
}

std::string refusal_of(const std::string& path, const MeshCheck& check) {
  std::vector<std::string> advice;  // each once
  for (const std::string& text : check.advice) {
    if (std::find(advice.begin(), advice.end(), text) == advice.end()) advice.push_back(text);
  }
  return fmt::format("{}: cannot be a rigid body: {}; what to do: {}", path, joined(check.problems, "; "), joined(advice, ", "));
}

Shape certified_shape(const std::string& name, TriangleMesh mesh, bool surface, const std::string& path, CommandResult& result) {
  const MeshCheck check = check_mesh(mesh);
  if (check.nonfinite_vertices > 0 || (!surface && !check.is_solid())) throw InputError(refusal_of(path, check));
  if (mesh.triangle_count() == 0) throw InputError("{}: all triangles have zero area", path);
  for (const std::string& remark : check.remarks) {
    if (!surface) result.notices.push_back(fmt::format("{}: {}", path, remark));
  }
  if (surface) {  // what would refuse a solid is only a remark for a wall
    for (const std::string& problem : check.problems) result.notices.push_back(fmt::format("{}: as a surface: {}", path, problem));
    if (check.inconsistent_edges > 0)
      result.notices.push_back(
          fmt::format("{}: a wall acts on both sides whatever the order of vertices in its triangles; where it is to have an inside "
                      "(inside_wall), import with --flip, which makes them agree",
                      path));
  }
  Shape shape = surface ? make_surface(name, std::move(mesh)) : make_solid(name, std::move(mesh));
  shape.verdict = json_of(check);
  return shape;
}

nlohmann::json json_of(const RepairCounts& r) {
  return {{"vertices_welded", r.vertices_welded},
          {"slivers_flipped", r.slivers_flipped},
          {"degenerate_dropped", r.degenerate_dropped},
          {"duplicates_dropped", r.duplicates_dropped},
          {"vertices_unreferenced", r.vertices_unreferenced},
          {"triangles_turned", r.triangles_turned}};
}

std::string summary_of(const Shape& shape, const std::string& path) {
  const Vec3 e = bounding_box(shape.mesh).extent();
  const auto length_text = [](double x) { return format_quantity(x, Dimension::length); };
  std::string text = fmt::format("{}: {} triangles from {}, extent {} x {} x {}", shape.name, shape.mesh.triangle_count(), path,
                                 length_text(e.x), length_text(e.y), length_text(e.z));
  if (shape.kind == ShapeKind::surface) return text + ", surface\n";
  return text + fmt::format(", equivalent diameter {}, volume {:.6g} m^3\n", length_text(shape.equivalent_diameter()), shape.mass.volume);
}

Provenance shape_provenance(const std::vector<std::string>& command, const std::string& configuration) {
  Provenance provenance;
  provenance.format = kShapeFormat;
  provenance.format_version = kShapeFormatVersion;
  provenance.tool = "scree-mesher";
  provenance.command = command;
  provenance.configuration = configuration;
  provenance.instruction_set = "scalar";
  return provenance;
}

}  // namespace scree
