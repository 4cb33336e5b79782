#include <fmt/format.h>

#include <algorithm>
#include <filesystem>

#include "core/base/command_line.hpp"
#include "core/base/csv.hpp"
#include "core/base/error.hpp"
#include "core/base/expect_ending.hpp"
#include "core/base/long_work.hpp"
#include "core/storage/h5.hpp"
#include "mesher/commands/certificate.hpp"
#include "mesher/edit/descriptors.hpp"
#include "mesher/io/mesh_file.hpp"

namespace scree {

namespace {

/// The files that were given, with folders replaced by the meshes in them, by name.
std::vector<std::string> files_of(const std::vector<std::string>& given) {
  std::vector<std::string> files;
  const std::vector<std::string> known = known_extensions();
  for (const std::string& path : given) {
    if (!std::filesystem::is_directory(path)) {
      files.push_back(path);
      continue;
    }
    const std::size_t before = files.size();
    for (const auto& entry : std::filesystem::directory_iterator(path)) {
      const std::string name = entry.path().string();
      const bool is_mesh = std::find(known.begin(), known.end(), extension_of(name)) != known.end();
      if (entry.is_regular_file() && (is_mesh || name.ends_with(".shape.h5"))) files.push_back(name);
    }
    if (files.size() == before) throw InputError("{}: no mesh file is in this folder", path);
    std::sort(files.begin() + static_cast<std::ptrdiff_t>(before), files.end());
  }
  return files;
}

}  // namespace

CommandResult describe_command(const DescribeOptions& options) {
  if (!options.csv.empty()) expect_ending("--csv", options.csv, "a table", {".csv"});
  CommandResult result;
  expect_unit(options.unit, options.scale);
  std::vector<std::string> names, sources, refused;
  std::vector<Descriptors> all;
  bool unit_was_reported = false;  // one notice for many files
  const std::vector<std::string> paths = files_of(options.files);
  LongWork work("describe", static_cast<double>(paths.size()));
  for (const std::string& path : paths) {
    work.advance();
    try {
      std::vector<Shape> shapes;
      if (path.ends_with(".shape.h5")) {
        shapes = read_shape_file(path).shapes;
      } else {
        MeshFile file = read_mesh_file(path);
        CommandResult ignored;  // remarks of one mesh among many would drown the table
        scale_mesh(file.mesh, metres_per_unit(file, path, options.unit, options.scale, ignored));
        if (!ignored.notices.empty() && !unit_was_reported) result.notices.push_back(ignored.notices.front());
        unit_was_reported = unit_was_reported || !ignored.notices.empty();
        clean_mesh(file.mesh, false);
        shapes.push_back(certified_shape(shape_name_from(path), std::move(file.mesh), false, path, ignored));
      }
      for (const Shape& shape : shapes) {
        if (shape.kind != ShapeKind::solid) {
          refused.push_back(fmt::format("{}: '{}' is {}", path, shape.name,
                                        shape.kind == ShapeKind::sphere ? "an analytic ball, which has no triangles" : "an open surface"));
          continue;
        }
        names.push_back(shape.name);
        sources.push_back(path);
        all.push_back(describe(shape.mesh));
      }
    } catch (const InputError& error) {
      refused.push_back(error.what());
    }
  }
  if (all.empty()) {
    constexpr std::size_t kMostReasons = 10;
    const std::size_t shown = std::min(refused.size(), kMostReasons);
    throw InputError("{} no solid: {}{}", paths.size() == 1 ? "the file holds" : fmt::format("the {} files hold", paths.size()),
                     fmt::join(refused.begin(), refused.begin() + static_cast<std::ptrdiff_t>(shown), "; "),
                     refused.size() > shown ? fmt::format("; and {} more", refused.size() - shown) : "");
  }
  for (const std::string& text : refused) result.notices.push_back("left out: " + text);

  // shapes of one name are told apart by their files
  const std::vector<std::string> given = names;
  for (std::size_t i = 0; i < names.size(); ++i) {
    if (std::count(given.begin(), given.end(), given[i]) > 1) names[i] += fmt::format(" ({})", sources[i]);
  }
  std::size_t widest = 4;
  for (const std::string& name : names) widest = std::max(widest, name.size());
  result.output = fmt::format("{:<{}}  {:>11} {:>11} {:>10} {:>10} {:>10} {:>10} {:>10} {:>6} {:>6} {:>6} {:>6} {:>6} {:>6}\n", "shape",
                              widest, "volume m^3", "surface m^2", "d_V m", "L m", "I m", "S m", "sieve m", "d_V/sv", "spher.", "convex",
                              "I/L", "S/I", "angul.");
  std::string csv = "shape";
  for (const DescriptorColumn& column : descriptor_columns()) {
    csv += fmt::format(",{}{}", column.name, *column.unit == '\0' ? "" : fmt::format(" [{}]", column.unit));
  }
  csv += "\n";
  for (std::size_t i = 0; i < all.size(); ++i) {
    const Descriptors& d = all[i];
    result.output += fmt::format(
        "{:<{}}  {:>11.4g} {:>11.4g} {:>10.4g} {:>10.4g} {:>10.4g} {:>10.4g} {:>10.4g} {:>6.3f} {:>6.3f} {:>6.3f} {:>6.3f} {:>6.3f} "
        "{:>6.3f}\n",
        names[i], widest, d.volume, d.area, d.volume_diameter, d.lengths.x, d.lengths.y, d.lengths.z, d.sieve_opening, d.sieve_ratio,
        d.sphericity, d.convexity, d.elongation, d.flatness, d.angularity);
    csv += csv_cell(names[i]);
    for (const DescriptorColumn& column : descriptor_columns()) csv += fmt::format(",{}", column.value(d));
    csv += "\n";
  }
  if (all.size() > 1) result.output += fmt::format("{} shapes\n{}", all.size(), distribution_of(all));
  if (!options.csv.empty()) {
    h5::write_text_file(options.csv, csv);
    result.output += fmt::format("wrote {}\n", options.csv);
  }
  if (!refused.empty()) result.refusal = fmt::format("{} of the meshes could not be described", refused.size());
  return result;
}

}  // namespace scree
