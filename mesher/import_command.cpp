#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <iterator>

#include "core/base/error.hpp"
#include "core/base/provenance.hpp"
#include "core/base/units.hpp"
#include "core/storage/shape_file.hpp"
#include "mesher/commands.hpp"
#include "mesher/mesh_check.hpp"
#include "mesher/mesh_file.hpp"
#include "mesher/mesh_repair.hpp"

namespace scree {

namespace {

/// Metres in one unit of the file.
double length_factor(const std::string& unit, double scale) {
  if (!(scale > 0) || !std::isfinite(scale))
    throw UsageError("--scale {}: expected a number > 0, for instance 0.001", scale);
  return parse_quantity("1 " + unit, Dimension::length, "--unit") * scale;
}

void scale_mesh(TriangleMesh& mesh, double factor) {
  if (factor == 1) return;
  for (Vec3& p : mesh.vertices) p *= factor;
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

nlohmann::json json_of(const RepairCounts& r) {
  return {{"vertices_welded", r.vertices_welded},
          {"slivers_flipped", r.slivers_flipped},
          {"degenerate_dropped", r.degenerate_dropped},
          {"duplicates_dropped", r.duplicates_dropped},
          {"vertices_unreferenced", r.vertices_unreferenced},
          {"triangles_turned", r.triangles_turned}};
}

/// A shape's name is a key in case files: what a key can be without quotes.
std::string name_from(const std::string& path) {
  std::string name = std::filesystem::path(path).stem().string();
  for (char& c : name) {
    const bool is_plain =
        (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' || c == '-';
    if (!is_plain) c = '_';
  }
  return name.empty() ? "shape" : name;
}

std::vector<std::string> names_for(const ImportOptions& options) {
  std::vector<std::string> names = options.names;
  if (names.empty()) {
    std::transform(options.files.begin(), options.files.end(), std::back_inserter(names), name_from);
  }
  if (names.size() != options.files.size()) {
    throw UsageError("--name: {} names for {} files; give one --name for each file, or none", names.size(),
                     options.files.size());
  }
  for (std::size_t i = 0; i < names.size(); ++i) {
    if (names[i].empty()) throw UsageError("--name: an empty name; give the shape a word, for instance rock");
    for (std::size_t j = 0; j < i; ++j) {
      if (names[i] == names[j]) {
        throw UsageError("two shapes would be called '{}' ({} and {}); give one --name for each file",
                         names[i], options.files[j], options.files[i]);
      }
    }
  }
  return names;
}

Shape import_one(const std::string& path, const std::string& name, double factor,
                 const ImportOptions& options, CommandResult& result) {
  MeshFile file = read_mesh_file(path);
  const std::int32_t stored_vertices = file.mesh.vertex_count(),
                     stored_triangles = file.mesh.triangle_count();
  if (stored_triangles == 0) {
    throw InputError(
        "{}: {} vertices but no triangle was found in it; is it really a {} file? Export the model again",
        path, stored_vertices, extension_of(path));
  }
  scale_mesh(file.mesh, factor);
  RepairCounts repairs = clean_mesh(file.mesh, options.surface);
  MeshCheck check = check_mesh(file.mesh);
  if (options.flip && check.nonfinite_vertices == 0) {
    if (!options.surface) {
      const std::int32_t turned = turn_outward(file.mesh);
      if (turned < 0)
        throw InputError("{}: --flip: the surface is one-sided (a Moebius strip); it has no outside", path);
      repairs.triangles_turned = turned;
      if (turned == 0)
        result.notices.push_back(
            fmt::format("{}: --flip: nothing to turn, all triangles face outward already", path));
    } else {
      for (Triangle& t : file.mesh.triangles) std::swap(t[1], t[2]);
      repairs.triangles_turned = file.mesh.triangle_count();
    }
    check = check_mesh(file.mesh);
  }
  for (const std::string& note : file.notes) result.notices.push_back(fmt::format("{}: {}", path, note));
  for (const std::string& sentence : repairs.sentences())
    result.notices.push_back(fmt::format("{}: {}", path, sentence));

  if (check.nonfinite_vertices > 0 || (!options.surface && !check.is_solid()))
    throw InputError(refusal_of(path, check));
  if (file.mesh.triangle_count() == 0)
    throw InputError("{}: all {} triangles have zero area", path, stored_triangles);
  for (const std::string& remark : check.remarks) {
    if (!options.surface) result.notices.push_back(fmt::format("{}: {}", path, remark));
  }
  if (options.surface) {  // what would refuse a solid is only a remark for a wall
    for (const std::string& problem : check.problems)
      result.notices.push_back(fmt::format("{}: as a surface: {}", path, problem));
  }

  Shape shape =
      options.surface ? make_surface(name, std::move(file.mesh)) : make_solid(name, std::move(file.mesh));
  shape.verdict = json_of(check);
  shape.verdict["reader"] = file.reader;
  shape.verdict["file"] = path;
  shape.verdict["metres_per_file_unit"] = factor;
  shape.verdict["stored"] = {{"vertices", stored_vertices}, {"triangles", stored_triangles}};
  shape.verdict["repairs"] = json_of(repairs);
  return shape;
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

}  // namespace

CommandResult check_command(const CheckOptions& options) {
  const double factor = length_factor(options.unit, options.scale);
  MeshFile file = read_mesh_file(options.file);
  const std::int32_t stored_vertices = file.mesh.vertex_count(),
                     stored_triangles = file.mesh.triangle_count();
  scale_mesh(file.mesh, factor);
  // The check reports what is in the file, so zero-area and duplicate triangles are counted before they are
  // dropped, and topology is judged as import would see it.
  TriangleMesh welded = file.mesh;
  weld_equal_positions(welded);
  const MeshCheck stored = check_mesh(welded);
  const RepairCounts repairs = clean_mesh(file.mesh, false);
  MeshCheck check = check_mesh(file.mesh);
  if (stored_triangles == 0) {
    check.problems = {fmt::format("{} vertices but no triangle was found; is it really a {} file?",
                                  stored_vertices, extension_of(options.file))};
  }

  CommandResult result;
  for (const std::string& note : file.notes)
    result.notices.push_back(fmt::format("{}: {}", options.file, note));
  if (options.json) {
    nlohmann::json json = json_of(check);
    json["file"] = options.file;
    json["reader"] = file.reader;
    json["sha256"] = sha256_of_file(options.file);
    json["stored"] = {{"vertices", stored_vertices},
                      {"triangles", stored_triangles},
                      {"degenerate_triangles", stored.degenerate_triangles},
                      {"duplicate_triangles", stored.duplicate_triangles}};
    json["repairs"] = json_of(repairs);
    result.output = json.dump(2, ' ', false, nlohmann::json::error_handler_t::replace) + "\n";
  } else {
    result.output = fmt::format("{} ({})\n", options.file, file.reader);
    result.output +=
        fmt::format("  {:<24} {} vertices, {} triangles\n", "in the file", stored_vertices, stored_triangles);
    result.output += fmt::format("  {:<24} {}\n", "equal positions welded", repairs.vertices_welded);
    for (const std::string& sentence : repairs.sentences())
      result.output += fmt::format("  {:<24} {}\n", "import would report", sentence);
    result.output += table_of(check);
    for (const std::string& remark : check.remarks)
      result.output += fmt::format("  {:<24} {}\n", "remark", remark);
    result.output += fmt::format("  {:<24} {}\n", "rigid body",
                                 check.is_solid() ? "yes" : "no: " + joined(check.problems, "; "));
  }
  if (!check.is_solid()) result.refusal = refusal_of(options.file, check);
  return result;
}

CommandResult import_command(const ImportOptions& options, const std::vector<std::string>& command) {
  const double factor = length_factor(options.unit, options.scale);
  const std::vector<std::string> names = names_for(options);
  if (!options.output.ends_with(".shape.h5")) {
    throw UsageError("-o {}: a shape file is called NAME.shape.h5; write -o {}.shape.h5", options.output,
                     name_from(options.output));
  }
  CommandResult result;
  Provenance provenance;
  provenance.format = kShapeFormat;
  provenance.format_version = kShapeFormatVersion;
  provenance.tool = "scree-mesher";
  provenance.command = command;
  provenance.configuration = fmt::format("import unit={} scale={} surface={} flip={}", options.unit,
                                         options.scale, options.surface, options.flip);
  provenance.instruction_set = "scalar";
  std::vector<Shape> shapes;
  for (std::size_t i = 0; i < options.files.size(); ++i) {
    shapes.push_back(import_one(options.files[i], names[i], factor, options, result));
    provenance.inputs.push_back({options.files[i], sha256_of_file(options.files[i]), nullptr});
    result.output += summary_of(shapes.back(), options.files[i]);
  }
  write_shape_file(options.output, shapes, provenance_record(provenance));
  result.output += fmt::format("wrote {} ({} {})\n", options.output, shapes.size(),
                               shapes.size() == 1 ? "shape" : "shapes");
  return result;
}

}  // namespace scree
