#include "mesher/certificate.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "core/base/error.hpp"
#include "core/base/provenance.hpp"
#include "core/base/units.hpp"

namespace scree {

namespace {

/// Above this size of a body in metres the tool asks whether the unit is right: larger particles are rare.
constexpr double kLargestUsual = 10;

}  // namespace

double length_factor(const std::string& unit, double scale) {
  if (!(scale > 0) || !std::isfinite(scale))
    throw UsageError("--scale {}: expected a number > 0, for instance 0.001", scale);
  return parse_quantity("1 " + (unit.empty() ? "m" : unit), Dimension::length, "--unit") * scale;
}

void scale_mesh(TriangleMesh& mesh, double factor) {
  if (factor == 1) return;
  for (Vec3& p : mesh.vertices) p *= factor;
}

std::string unit_question(const std::string& path, double extent) {
  if (!(extent > kLargestUsual) || !std::isfinite(extent)) return "";
  // the largest unit in which the body is not larger than usual
  const char* guess = "um";
  for (const auto& [name, metres] : {std::pair("cm", 1e-2), std::pair("mm", 1e-3)}) {
    if (extent * metres <= 0.1 * kLargestUsual) {
      guess = name;
      break;
    }
  }
  return fmt::format("{}: no --unit is given, so its numbers are metres and the body is {:.4g} m long; were they {}? "
                     "Then say --unit {}, else --unit m", path, extent, guess, guess);
}

std::string shape_name_from(const std::string& path) {
  std::string name = std::filesystem::path(path).stem().string();
  if (name.ends_with(".shape")) name.resize(name.size() - 6);
  for (char& c : name) {
    const bool is_plain =
        (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' || c == '-';
    if (!is_plain) c = '_';
  }
  return name.empty() ? "shape" : name;
}

void expect_shape_path(const std::string& path) {
  if (path.ends_with(".shape.h5")) return;
  throw UsageError("-o {}: a shape file is called NAME.shape.h5; write -o {}.shape.h5", path, shape_name_from(path));
}

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
  return fmt::format("{}: cannot be a rigid body: {}; what to do: {}", path, joined(check.problems, "; "),
                     joined(advice, ", "));
}

Shape certified_shape(const std::string& name, TriangleMesh mesh, bool surface, const std::string& path,
                      CommandResult& result) {
  const MeshCheck check = check_mesh(mesh);
  if (check.nonfinite_vertices > 0 || (!surface && !check.is_solid())) throw InputError(refusal_of(path, check));
  if (mesh.triangle_count() == 0) throw InputError("{}: all triangles have zero area", path);
  for (const std::string& remark : check.remarks) {
    if (!surface) result.notices.push_back(fmt::format("{}: {}", path, remark));
  }
  if (surface) {  // what would refuse a solid is only a remark for a wall
    for (const std::string& problem : check.problems)
      result.notices.push_back(fmt::format("{}: as a surface: {}", path, problem));
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
  std::string text =
      fmt::format("{}: {} triangles from {}, extent {} x {} x {}", shape.name, shape.mesh.triangle_count(),
                  path, length_text(e.x), length_text(e.y), length_text(e.z));
  if (shape.kind == ShapeKind::surface) return text + ", surface\n";
  return text + fmt::format(", equivalent diameter {}, volume {:.6g} m^3\n",
                            length_text(shape.equivalent_diameter()), shape.mass.volume);
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
