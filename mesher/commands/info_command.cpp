#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "core/base/command_line.hpp"
#include "core/base/error.hpp"
#include "core/base/expect_ending.hpp"
#include "core/base/units.hpp"
#include "core/geometry/features.hpp"
#include "core/storage/shape_file.hpp"
#include "mesher/commands/commands.hpp"
#include "mesher/edit/mesh_picture.hpp"

namespace scree {

namespace {

const char* kind_name(ShapeKind kind) { return kind == ShapeKind::solid ? "solid" : (kind == ShapeKind::surface ? "surface" : "sphere"); }

std::string verdict_text(const Shape& shape) {
  const nlohmann::json& v = shape.verdict;
  if (!v.is_object()) return shape.kind == ShapeKind::sphere ? "analytic" : "not checked";
  const bool is_solid = v.value("solid", false);
  std::string text = is_solid ? "watertight, outward" : "";
  for (const auto& found : v.value(is_solid ? "remarks" : "problems", nlohmann::json::array())) {
    if (found.is_string()) text += (text.empty() ? "" : "; ") + found.get<std::string>();
  }
  return text.empty() ? "not a solid" : text;
}

/// The record of a file and, indented, those of the files that it was made from. Missing keys read as "?".
void add_history(const nlohmann::json& record, int indent, std::string& text) {
  if (!record.is_object()) return;
  const auto word = [&](const char* key) {
    return record.contains(key) && record[key].is_string() ? record[key].get<std::string>() : std::string("?");
  };
  const std::string margin(static_cast<std::size_t>(indent), ' ');
  text += fmt::format("{}{} {} (git {}{}), {}\n", margin, word("tool"), word("tool_version"), word("git").substr(0, 10),
                      record.value("git_dirty", false) ? ", changed" : "", word("utc"));
  if (record.contains("command") && record["command"].is_array()) {
    std::string command;
    for (const auto& part : record["command"]) {
      if (!part.is_string()) continue;
      const std::string w = part.get<std::string>();
      const bool needs_quotes = w.empty() || w.find_first_of(" \t;,&|<>()$'\\*?") != std::string::npos;
      command += (command.empty() ? "" : " ") + (needs_quotes ? "\"" + w + "\"" : w);
    }
    text += fmt::format("{}  {}\n", margin, command);
  }
  if (!record.contains("inputs") || !record["inputs"].is_array()) return;
  for (const auto& input : record["inputs"]) {
    if (!input.is_object()) continue;
    const auto input_word = [&](const char* key) {
      return input.contains(key) && input[key].is_string() ? input[key].get<std::string>() : std::string("?");
    };
    text += fmt::format("{}  from {} sha256 {}\n", margin, input_word("path"), input_word("sha256"));
    if (input.contains("history")) add_history(input["history"], indent + 4, text);
  }
}

}  // namespace

CommandResult info_command(const InfoOptions& options) {
  if (!options.picture.empty()) expect_ending("--picture", options.picture, "a picture", {".png"});
  const ShapeFile file = read_shape_file(options.file);
  CommandResult result;
  std::string& text = result.output;
  text = fmt::format("{}: {} {}\n", options.file, file.shapes.size(), file.shapes.size() == 1 ? "shape" : "shapes");
  std::size_t widest = 4;
  for (const Shape& shape : file.shapes) widest = std::max(widest, shape.name.size());
  text += fmt::format("{:<{}}  {:<7} {:>8} {:>9} {:>8} {:>8} {:>13} {:>10} {:>10} {:>13}  {}\n", "name", widest, "kind", "vertices",
                      "triangles", "corners", "edges", "volume [m^3]", "eq. diam.", "b. radius", "area [m^2]",
                      "principal moments at density 1 [m^5]");
  for (const Shape& shape : file.shapes) {
    const FeatureTable features = find_features(shape.mesh);
    const bool has_mass = shape.kind != ShapeKind::surface;
    const Vec3& p = shape.mass.principal_moments;
    text +=
        fmt::format("{:<{}}  {:<7} {:>8} {:>9} {:>8} {:>8} {:>13} {:>10} {:>10} {:>13.6g}  {}\n", shape.name, widest, kind_name(shape.kind),
                    shape.mesh.vertex_count(), shape.mesh.triangle_count(), features.corners.size(), features.edges.size(),
                    has_mass ? fmt::format("{:.6g}", shape.mass.volume) : "-", has_mass ? metres(shape.equivalent_diameter()) : "-",
                    metres(shape.bounding_radius()), shape.area, has_mass ? fmt::format("{:.6g} {:.6g} {:.6g}", p.x, p.y, p.z) : "-");
  }
  text += "check\n";
  for (const Shape& shape : file.shapes) text += fmt::format("  {:<{}}  {}\n", shape.name, widest, verdict_text(shape));
  text += "made by\n";
  add_history(file.provenance, 2, text);
  if (options.picture.empty()) return result;
  constexpr std::size_t kMaxPanes = 8;  // side by side; more would be too small to be seen
  std::vector<std::pair<std::string, const TriangleMesh*>> meshes;
  for (const Shape& shape : file.shapes) {
    if (shape.mesh.triangle_count() > 0 && meshes.size() < kMaxPanes) meshes.emplace_back(shape.name, &shape.mesh);
  }
  if (meshes.empty()) throw InputError("{}: has no shape with triangles to draw; leave --picture out", options.file);
  if (meshes.size() < file.shapes.size())
    result.notices.push_back(fmt::format("{}: {} of {} shapes are drawn", options.picture, meshes.size(), file.shapes.size()));
  draw_meshes(meshes, options.picture);
  text += fmt::format("wrote {}\n", options.picture);
  return result;
}

}  // namespace scree
