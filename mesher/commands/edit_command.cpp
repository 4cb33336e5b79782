#include "mesher/commands/edit_command.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>

#include "core/base/command_line.hpp"
#include "core/base/error.hpp"
#include "core/base/expect_ending.hpp"
#include "core/base/units.hpp"
#include "core/geometry/mesh_refine.hpp"
#include "mesher/check/mesh_deviation.hpp"
#include "mesher/commands/certificate.hpp"
#include "mesher/edit/convex_hull.hpp"
#include "mesher/edit/mesh_picture.hpp"
#include "mesher/edit/mesh_simplify.hpp"
#include "mesher/io/mesh_file.hpp"

namespace scree {

namespace {

constexpr std::int64_t kMaxTriangles = 20'000'000;

/// Rounding to single precision, about 6e-8 of a coordinate, is reported from this part of the extent on: the gaps that repair closes
/// and check takes for none are smaller.
constexpr double kReportedRounding = 1e-6;

/// What an STL file, which holds single precision, loses of a mesh far from its origin; "" when that is nothing to speak of.
std::string stl_loss(const TriangleMesh& mesh) {
  double largest = 0;
  for (const Vec3& p : mesh.vertices) {
    for (int k = 0; k < 3; ++k) largest = std::max(largest, std::abs(p[k] - static_cast<double>(static_cast<float>(p[k]))));
  }
  const double part = largest / longest_extent(mesh);
  if (!(part > kReportedRounding)) return "";
  return fmt::format(
      "STL holds single precision, so that vertices of this mesh far from its origin moved by up to {:.2g} of its extent "
      "and can coincide; write PLY, OBJ, OFF or .shape.h5, which keep all digits",
      part);
}

/// What pieces of a cut are no longer once their meshes are made anew.
std::string loss_of_pieces(const std::string& path, const ShapeFile& file) {
  std::string text = fmt::format(
      "{}: holds pieces of a cut; the result has no table of shared faces, so that pieces of it cannot be bonded by faces: edit the body "
      "before 'scree-mesher fracture' cuts it",
      path);
  if (!(file.pieces->inset > 0)) return text;
  double whole = 0, inset = 0;
  for (const Shape& shape : file.shapes) {
    whole += shape.mass.volume;
    inset += mass_properties(shape.mesh).volume;
  }
  return text +
         fmt::format(". Volume and moments become those of the meshes, whose shared faces lie back by {}: {:.4g} m^3 in all, {:.4g} before",
                     metres(file.pieces->inset), inset, whole);
}

/// The check of a result without advice to do again what was just done, and with what the command itself advises.
MeshCheck with_advice_after(const std::string& what, const EditedMesh& edited) {
  MeshCheck check = check_mesh(edited.mesh);
  const std::string repair = "'scree-mesher repair'", remesh = "'scree-mesher remesh'";
  const std::string own = what == "repaired" ? repair : what == "remeshed" ? remesh : "", other = own == repair ? remesh : repair;
  if (what == "simplified") check.advice.clear();  // the result is at fault, not its source: turning or uniting it helps nothing
  if (!own.empty()) {
    for (std::string& text : check.advice) {
      if (text.find(own) != std::string::npos) text = own == repair ? "make a new closed surface with " + other : "";
    }
    std::erase(check.advice, "");
  }
  check.advice.insert(check.advice.begin(), edited.advice.begin(), edited.advice.end());
  if (check.advice.empty()) check.advice.push_back("repair it in a mesh editor");
  return check;
}

/// Change of the largest component of the inertia tensor about the centre of mass, as part of the old one.
double inertia_change(const MassProperties& before, const MassProperties& after) {
  double difference = 0, size = 0;
  for (int i = 0; i < 3; ++i) {
    difference = std::max(difference, length(after.inertia[i] - before.inertia[i]));
    size = std::max(size, length(before.inertia[i]));
  }
  return size > 0 ? difference / size : 0;
}

}  // namespace

EditSource read_edit_source(const EditOptions& options, CommandResult& result) {
  // known before the work is done
  if (!is_writable_format(options.output))
    expect_ending("-o", options.output, "a shape file or a mesh", {".shape.h5", ".stl", ".ply", ".obj", ".off"});
  if (!options.picture.empty()) expect_ending("--picture", options.picture, "a picture", {".png"});
  EditSource source;
  if (options.file.ends_with(".shape.h5")) {
    if (!options.unit.empty() || options.scale != 1)
      throw UsageError("--unit, --scale: a shape file is in metres; they have no meaning for {}", options.file);
    ShapeFile file = read_shape_file(options.file);
    source.reader = "shape file";
    source.history = file.provenance;
    if (file.pieces) result.notices.push_back(loss_of_pieces(options.file, file));
    for (Shape& shape : file.shapes) {
      if (shape.kind == ShapeKind::sphere) {
        throw InputError("{}: shape '{}' is an analytic sphere and has no triangles to work on", options.file, shape.name);
      }
      for (Vec3& p : shape.mesh.vertices) p += shape.origin_shift;
      source.meshes.push_back({shape.name, std::move(shape.mesh), {}, {}, {}});
    }
    return source;
  }
  expect_unit(options.unit, options.scale);
  MeshFile file = read_mesh_file(options.file);
  if (file.mesh.triangle_count() == 0)
    throw InputError("{}: {} vertices but no triangle was found in it", options.file, file.mesh.vertex_count());
  const auto bad = std::find_if_not(file.mesh.vertices.begin(), file.mesh.vertices.end(), is_finite);
  if (bad != file.mesh.vertices.end()) {
    throw InputError("{}: vertex {} is not a finite number (NaN or infinite); export the model again", options.file,
                     bad - file.mesh.vertices.begin());
  }
  source.factor = metres_per_unit(file, options.file, options.unit, options.scale, result);
  source.reader = file.reader;
  scale_mesh(file.mesh, source.factor);
  EditedMesh edited{shape_name_from(options.file), std::move(file.mesh), {}, {}, {}};
  const RepairCounts repairs = clean_mesh(edited.mesh, options.surface);
  if (repairs.vertices_welded > 0)
    edited.steps.push_back(fmt::format("{} vertices welded to others of exactly equal position", repairs.vertices_welded));
  for (const std::string& sentence : repairs.sentences()) edited.steps.push_back(sentence);
  edited.record["cleaned"] = json_of(repairs);
  for (const std::string& note : file.notes) result.notices.push_back(fmt::format("{}: {}", options.file, note));
  if (edited.mesh.triangle_count() == 0) throw InputError("{}: all triangles have zero area", options.file);
  source.meshes.push_back(std::move(edited));
  return source;
}

void write_edit_results(const std::string& what, const EditOptions& options, const EditSource& source,
                        const std::vector<EditedMesh>& results, const std::vector<std::string>& command, CommandResult& result) {
  const bool to_shape = options.output.ends_with(".shape.h5");
  if (!to_shape && results.size() != 1) {
    throw UsageError("-o {}: {} meshes cannot go into one mesh file; write them to NAME.shape.h5", options.output, results.size());
  }
  std::vector<Shape> shapes;
  for (const EditedMesh& edited : results) {
    for (const std::string& step : edited.steps) result.output += fmt::format("{}: {}\n", edited.name, step);
    try {
      shapes.push_back(certified_shape(edited.name, edited.mesh, options.surface, options.file, result));
    } catch (const InputError&) {  // what was done is reported all the same
      result.refusal =
          fmt::format("{} (after it was {}; nothing is written)", refusal_of(options.file, with_advice_after(what, edited)), what);
      return;
    }
    (*shapes.back().verdict)["file"] = options.file;
    (*shapes.back().verdict)["reader"] = source.reader;
    (*shapes.back().verdict)["metres_per_file_unit"] = source.factor;
    (*shapes.back().verdict)[what] = edited.record;
  }
  if (extension_of(options.output) == ".stl") {
    const std::string loss = stl_loss(results.front().mesh);
    if (!loss.empty()) result.notices.push_back(fmt::format("{}: {}", options.output, loss));
  }
  if (to_shape) {
    Provenance provenance = shape_provenance(command, what + " " + options.file);
    provenance.inputs.push_back({options.file, sha256_of_file(options.file), source.history});
    write_shape_file(options.output, shapes, provenance_record(provenance));
  } else {
    TriangleMesh mesh = results.front().mesh;
    scale_mesh(mesh, 1 / source.factor);
    write_mesh_file(options.output, mesh);
  }
  for (const Shape& shape : shapes) result.output += summary_of(shape, options.file);
  result.output += fmt::format("wrote {}\n", options.output);
  if (options.picture.empty()) return;
  // the mesh is there: where nothing can be drawn, only the picture is missing
  if (const std::string reason = picture_obstacle(); !reason.empty()) {
    result.notices.push_back(fmt::format("no {}: {}", options.picture, reason));
    return;
  }
  draw_meshes({{"before", &source.meshes.front().mesh}, {results.front().name, &results.front().mesh}}, options.picture);
  result.output += fmt::format("wrote {}\n", options.picture);
}

double report_change(const TriangleMesh& before, bool surface, EditedMesh& edited, double enclosed) {
  const HausdorffDistance h = hausdorff_distance(before, edited.mesh);
  const double extent = longest_extent(before);
  edited.steps.push_back(
      fmt::format("Hausdorff distance from the original between {} and {} ({:.3g} % of its extent), largest near ({:.4g}, {:.4g}, "
                  "{:.4g})",
                  metres(h.lower()), metres(h.upper()), 100 * h.upper() / extent, (h.forth.lower > h.back.lower ? h.forth : h.back).place.x,
                  (h.forth.lower > h.back.lower ? h.forth : h.back).place.y, (h.forth.lower > h.back.lower ? h.forth : h.back).place.z));
  edited.record["hausdorff_lower"] = h.lower();
  edited.record["hausdorff_upper"] = h.upper();
  const double area = surface_area(edited.mesh) / surface_area(before) - 1;
  edited.steps.push_back(fmt::format("area changed by {:+.3g} %", 100 * area));
  edited.record["area_change"] = area;
  if (surface) return 0;
  const MassProperties b = mass_properties(edited.mesh);
  if (enclosed > 0) {
    const double volume = b.volume / enclosed - 1;
    edited.steps.push_back(
        fmt::format("volume changed by {:+.3g} % of what the original, which is not a solid, encloses (sampled)", 100 * volume));
    edited.record["volume_change"] = volume;
    return volume;
  }
  const MassProperties a = mass_properties(before);
  if (!(std::abs(a.volume) > 0)) return 0;
  const double volume = b.volume / a.volume - 1, inertia = inertia_change(a, b);
  edited.steps.push_back(fmt::format("volume changed by {:+.3g} %, inertia by {:.3g} %, centre of mass by {}", 100 * volume, 100 * inertia,
                                     metres(length(b.centre - a.centre))));
  edited.record["volume_change"] = volume;
  edited.record["inertia_change"] = inertia;
  return volume;
}

CommandResult simplify_command(const SimplifyOptions& options, const std::vector<std::string>& command) {
  CommandResult result;
  if (options.triangles.empty()) throw UsageError("simplify: --triangles is missing; give a number, for instance 1000");
  std::vector<std::int32_t> targets = options.triangles;
  std::sort(targets.rbegin(), targets.rend());  // the finest first: each level starts from the one before
  if (targets.back() < 4) throw UsageError("--triangles {}: a solid has at least 4", targets.back());
  const EditSource source = read_edit_source(options, result);
  std::vector<EditedMesh> levels;
  for (const EditedMesh& original : source.meshes) {
    const MeshCheck check = check_mesh(original.mesh);
    if (!options.surface && !check.is_solid()) throw InputError(refusal_of(options.file, check));
    EditedMesh level = original;
    for (std::int32_t target : targets) {
      const std::int32_t from = level.mesh.triangle_count();
      const SimplifyCounts counts = simplify_mesh(level.mesh, target, !options.keep_topology);
      EditedMesh done = level;
      if (targets.size() > 1) done.name = fmt::format("{}_{}", original.name, target);
      done.steps.push_back(
          fmt::format("{} of {} triangles left after {} edge collapses", done.mesh.triangle_count(), from, counts.collapses));
      if (counts.handles_cut > 0) {
        done.steps.push_back(fmt::format("{} handles or necks cut that are smaller than its triangles", counts.handles_cut));
      }
      if (!counts.reached_target) {
        result.notices.push_back(
            fmt::format("{}: {} triangles were requested; with fewer than {} the surface would change "
                        "its topology or fold",
                        done.name, target, done.mesh.triangle_count()));
      }
      const double change = report_change(original.mesh, options.surface, done);
      if (std::abs(change) > kNoticedChange) {
        result.notices.push_back(
            fmt::format("{}: the volume changed by {:+.3g} %; more triangles keep more of the shape", done.name, 100 * change));
      }
      done.advice.push_back(
          fmt::format("give more --triangles than {}: with so few its thin parts pass through each other or turn over", target));
      if (check.crossing_pairs > 0 || check.components.size() > 1) {
        done.advice.push_back(
            fmt::format("or look at what was simplified, which has {} components and {} pairs of triangles that cross: if 'scree-mesher "
                        "remesh' made it, "
                        "make it again from the original with a smaller --edge-length",
                        check.components.size(), check.crossing_pairs));
      }
      done.record["handles_cut"] = counts.handles_cut;
      done.record["original"] = original.name;
      levels.push_back(std::move(done));
    }
  }
  write_edit_results("simplified", options, source, levels, command, result);
  return result;
}

CommandResult refine_command(const RefineOptions& options, const std::vector<std::string>& command) {
  CommandResult result;
  if (options.edge_length.empty() == (options.times == 0))
    throw UsageError("refine: give either --edge-length, for instance \"1 mm\", or --times, for instance 2");
  if (options.times < 0) throw UsageError("--times {}: expected a number > 0", options.times);
  const EditSource source = read_edit_source(options, result);
  std::vector<EditedMesh> results = source.meshes;
  for (EditedMesh& edited : results) {
    const std::int32_t from = edited.mesh.triangle_count();
    if (options.times > 0) {
      for (int i = 0; i < options.times; ++i) {
        if (4 * static_cast<std::int64_t>(edited.mesh.triangles.size()) > kMaxTriangles)
          throw UsageError("--times {}: more than {} triangles would arise", options.times, kMaxTriangles);
        split_in_four(edited.mesh);
      }
    } else {
      const double longest = parse_quantity(options.edge_length, Dimension::length, "--edge-length");
      if (!(longest > 0)) throw UsageError("--edge-length {}: expected a length > 0", options.edge_length);
      refine_mesh(edited.mesh, longest, kMaxTriangles);
    }
    edited.steps.push_back(fmt::format("{} triangles became {}; the surface is the same", from, edited.mesh.triangle_count()));
  }
  write_edit_results("refined", options, source, results, command, result);
  return result;
}

CommandResult hull_command(const HullOptions& options, const std::vector<std::string>& command) {
  CommandResult result;
  const EditSource source = read_edit_source(options, result);
  std::vector<EditedMesh> results = source.meshes;
  for (EditedMesh& edited : results) {
    const TriangleMesh before = edited.mesh;
    edited.mesh = convex_hull(before.vertices);
    if (edited.mesh.triangle_count() == 0)
      throw InputError("{}: all vertices of '{}' lie in one plane; a flat mesh has no hull", options.file, edited.name);
    edited.steps.push_back(fmt::format("the hull of {} triangles has {}, on {} of {} vertices", before.triangle_count(),
                                       edited.mesh.triangle_count(), edited.mesh.vertex_count(), before.vertex_count()));
    report_change(before, options.surface, edited);
  }
  write_edit_results("hulled", options, source, results, command, result);
  return result;
}

}  // namespace scree
