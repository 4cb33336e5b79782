#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numbers>

#include "core/base/error.hpp"
#include "core/base/long_work.hpp"
#include "core/base/one_line.hpp"
#include "core/base/units.hpp"
#include "core/base/utf8.hpp"
#include "core/geometry/closed_mesh.hpp"
#include "core/geometry/mass_properties.hpp"
#include "mesher/check/mesh_check.hpp"
#include "mesher/commands/certificate.hpp"
#include "mesher/commands/commands.hpp"
#include "mesher/io/mesh_file.hpp"
#include "mesher/repair/mesh_repair.hpp"

namespace scree {

namespace {

std::vector<std::string> names_for(const ImportOptions& options) {
  std::vector<std::string> names = options.names;
  if (names.empty()) {
    std::transform(options.files.begin(), options.files.end(), std::back_inserter(names), shape_name_from);
  }
  if (names.size() != options.files.size()) {
    throw UsageError("--name: {} names for {} files; give one --name for each file, or none", names.size(), options.files.size());
  }
  for (std::size_t i = 0; i < names.size(); ++i) {
    if (names[i].empty()) throw UsageError("--name: an empty name; give the shape a word, for instance rock");
    if (const std::string fault = fault_of_name(names[i]); !fault.empty())
      throw UsageError("--name: the name of shape {} {}", i + 1, fault);
    for (std::size_t j = 0; j < i; ++j) {
      if (names[i] == names[j]) {
        throw UsageError("two shapes would be called '{}' ({} and {}); give one --name for each file", names[i], options.files[j],
                         options.files[i]);
      }
    }
  }
  return names;
}

void check_diameter(const ImportOptions& options) {
  if (options.diameter.empty()) return;
  if (!(parse_quantity(options.diameter, Dimension::length, "--diameter") > 0))
    throw UsageError("--diameter = \"{}\": expected a length > 0", options.diameter);
  if (!options.unit.empty() || options.scale != 1) {
    throw UsageError("--diameter sets the size, whatever the unit of the file: leave --unit and --scale out, or --diameter");
  }
  if (options.surface)
    throw UsageError("--diameter is that of the ball of equal volume, and a wall (--surface) has none; use --unit or --scale");
}

/// Scale at which the ball of equal volume has this diameter; 1 for a mesh without volume, which is then refused for what it lacks.
double factor_to_diameter(const TriangleMesh& mesh, double diameter) {
  const double volume = std::abs(mass_properties(mesh).volume);
  return volume > 0 ? diameter / std::cbrt(6 * volume / std::numbers::pi) : 1;
}

Shape import_one(const std::string& path, const std::string& name, const ImportOptions& options, CommandResult& result) {
  MeshFile file = read_mesh_file(path);
  const std::int32_t stored_vertices = file.mesh.vertex_count(), stored_triangles = file.mesh.triangle_count();
  if (stored_triangles == 0) {
    throw InputError("{}: {} vertices but no triangle was found in it; is it really a {} file? Export the model again", path,
                     stored_vertices, extension_of(path));
  }
  const bool is_sized = !options.diameter.empty();
  double factor = is_sized ? 1 : metres_per_unit(file, path, options.unit, options.scale, result);
  scale_mesh(file.mesh, factor);
  RepairCounts repairs = clean_mesh(file.mesh, options.surface);
  // a surface that agrees with itself has no outside to turn to: all of it is turned
  if (options.flip && options.surface && check_mesh(file.mesh).inconsistent_edges == 0) {
    turn_inside_out(file.mesh);
    repairs.triangles_turned = file.mesh.triangle_count();
  } else if (options.flip && std::all_of(file.mesh.vertices.begin(), file.mesh.vertices.end(), is_finite)) {
    const std::int32_t turned = turn_outward(file.mesh);
    if (turned < 0) throw InputError("{}: --flip: the surface is one-sided (a Moebius strip); it has no outside", path);
    repairs.triangles_turned = turned;
    if (turned == 0) result.notices.push_back(fmt::format("{}: --flip: nothing to turn, all triangles face outward already", path));
  }
  if (is_sized) {
    factor = factor_to_diameter(file.mesh, parse_quantity(options.diameter, Dimension::length, "--diameter"));
    scale_mesh(file.mesh, factor);
  }
  for (const std::string& note : file.notes) result.notices.push_back(fmt::format("{}: {}", path, note));
  for (const std::string& sentence : repairs.sentences()) result.notices.push_back(fmt::format("{}: {}", path, sentence));
  Shape shape = certified_shape(name, std::move(file.mesh), options.surface, path, result);
  (*shape.verdict)["reader"] = file.reader;
  (*shape.verdict)["file"] = path;
  (*shape.verdict)["metres_per_file_unit"] = factor;
  (*shape.verdict)["stored"] = {{"vertices", stored_vertices}, {"triangles", stored_triangles}};
  (*shape.verdict)["repairs"] = json_of(repairs);
  return shape;
}

}  // namespace

CommandResult check_command(const CheckOptions& options) {
  expect_unit(options.unit, options.scale);
  MeshFile file = read_mesh_file(options.file);
  const std::int32_t stored_vertices = file.mesh.vertex_count(), stored_triangles = file.mesh.triangle_count();
  CommandResult result;
  scale_mesh(file.mesh, metres_per_unit(file, options.file, options.unit, options.scale, result));
  // The check reports what is in the file, so zero-area and duplicate triangles are counted before they are
  // dropped, and topology is judged as import would see it.
  TriangleMesh welded = file.mesh;
  weld_equal_positions(welded);
  const MeshCheck stored = check_mesh(welded);
  const RepairCounts repairs = clean_mesh(file.mesh, false);
  MeshCheck check = repairs.changes_triangles() ? check_mesh(file.mesh) : stored;
  if (stored_triangles == 0) {
    check.problems = {
        fmt::format("{} vertices but no triangle was found; is it really a {} file?", stored_vertices, extension_of(options.file))};
  }

  for (const std::string& note : file.notes) result.notices.push_back(fmt::format("{}: {}", options.file, note));
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
    result.output = json_text(json, 2) + "\n";
  } else {
    result.output = fmt::format("{} ({})\n", options.file, file.reader);
    result.output += fmt::format("  {:<24} {} vertices, {} triangles\n", "in the file", stored_vertices, stored_triangles);
    result.output += fmt::format("  {:<24} {}\n", "equal positions welded", repairs.vertices_welded);
    for (const std::string& sentence : repairs.sentences()) result.output += fmt::format("  {:<24} {}\n", "import would report", sentence);
    result.output += table_of(check);
    for (const std::string& remark : check.remarks) result.output += fmt::format("  {:<24} {}\n", "remark", remark);
    result.output += fmt::format("  {:<24} {}\n", "rigid body", check.is_solid() ? "yes" : "no: " + joined(check.problems, "; "));
  }
  if (!check.is_solid()) result.refusal = refusal_of(options.file, check);
  return result;
}

CommandResult import_command(const ImportOptions& options, const std::vector<std::string>& command) {
  expect_unit(options.unit, options.scale);
  check_diameter(options);
  const std::vector<std::string> names = names_for(options);
  expect_shape_path(options.output);
  CommandResult result;
  Provenance provenance =
      shape_provenance(command, fmt::format("import unit={} scale={} diameter={} surface={} flip={}",
                                            options.unit.empty() ? "as stated, else m" : options.unit, options.scale,
                                            options.diameter.empty() ? "as it is" : options.diameter, options.surface, options.flip));
  std::vector<Shape> shapes;
  LongWork work("import", static_cast<double>(options.files.size()));
  for (std::size_t i = 0; i < options.files.size(); ++i) {
    if (i > 0) work.update(static_cast<double>(i), options.files[i]);
    shapes.push_back(import_one(options.files[i], names[i], options, result));
    provenance.inputs.push_back({options.files[i], sha256_of_file(options.files[i]), nullptr});
    result.output += summary_of(shapes.back(), options.files[i]);
  }
  write_shape_file(options.output, shapes, provenance_record(provenance));
  result.output += fmt::format("wrote {} ({} {})\n", options.output, shapes.size(), shapes.size() == 1 ? "shape" : "shapes");
  return result;
}

}  // namespace scree
