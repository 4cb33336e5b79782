#include "mesher/fracture/fracture.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <charconv>
#include <cmath>

#include "core/base/command_line.hpp"
#include "core/base/csv.hpp"
#include "core/base/error.hpp"
#include "core/base/expect_ending.hpp"
#include "core/base/units.hpp"
#include "core/storage/checksum.hpp"
#include "mesher/check/mesh_check.hpp"
#include "mesher/commands/certificate.hpp"
#include "mesher/edit/mesh_picture.hpp"

namespace scree {

namespace {

/// Generators are compared each with each, and every cell becomes a shape.
constexpr std::int32_t kMaxCells = 20'000;
/// What the volumes of the pieces may lack, as part of the body's: far above the rounding of the coordinates of some 10^5 vertices.
constexpr double kVolumeRounding = 1e-9;

const Shape& chosen_shape(const ShapeFile& file, const FractureOptions& options) {
  std::string names;
  std::vector<const Shape*> fits;
  for (const Shape& shape : file.shapes) {
    names += (names.empty() ? "" : ", ") + shape.name;
    if (options.shape.empty() || shape.name == options.shape) fits.push_back(&shape);
  }
  if (fits.empty()) throw InputError("{}: has no shape '{}'; it has {}", options.file, options.shape, names);
  if (fits.size() > 1) throw InputError("{}: has {} shapes; say which one to cut, --shape NAME: {}", options.file, fits.size(), names);
  return *fits[0];
}

/// A body that can be cut: a solid that does not pass through itself.
void expect_solid(const Shape& body, const std::string& path) {
  if (body.kind == ShapeKind::sphere)
    throw InputError("{}: '{}' is an analytic sphere and has no triangles to cut; generate it without --analytic", path, body.name);
  const MeshCheck check = check_mesh(body.mesh);
  if (body.kind == ShapeKind::surface || !check.is_solid()) {
    throw InputError("{}: '{}' is no solid and has no inside to cut{}{}; see scree-mesher repair", path, body.name,
                     check.problems.empty() ? "" : ": ", check.problems.empty() ? "" : check.problems.front());
  }
  if (check.crossing_pairs > 0) {
    const Vec3& p = check.places.self_intersections.front();
    throw InputError(
        "{}: '{}': {} pairs of triangles pass through each other, one at ({:.6g}, {:.6g}, {:.6g}) m: inside and outside have no meaning "
        "there; "
        "make a new surface with scree-mesher remesh",
        path, body.name, check.crossing_pairs, p.x, p.y, p.z);
  }
}

std::vector<Vec3> read_points(const std::string& path, const Shape& body) {
  const auto table = read_csv(path);
  if (!table) throw InputError("{}: cannot be read", path);
  std::array<std::size_t, 3> column{};
  for (std::size_t k = 0; k < 3; ++k) {
    const std::string name(1, static_cast<char>('x' + k));
    column[k] = table->column(name);
    if (column[k] == table->names.size()) throw InputError("{}: has no column '{}'; expected x,y,z", path, name);
  }
  std::vector<Vec3> points;
  for (const CsvTable::Row& row : table->rows) {
    Vec3 p;
    for (std::size_t k = 0; k < 3; ++k) {
      const std::string cell = column[k] < row.cells.size() ? row.cells[column[k]] : "";
      double value = 0;
      const auto [end, error] = std::from_chars(cell.data(), cell.data() + cell.size(), value);
      if (error != std::errc() || end != cell.data() + cell.size() || !std::isfinite(value))
        throw InputError("{}:{}: '{}' is no coordinate; expected a number in metres", path, row.line, cell);
      p[static_cast<int>(k)] = value;
    }
    std::vector<std::int32_t> all;
    for (std::int32_t t = 0; t < body.mesh.triangle_count(); ++t) all.push_back(t);
    if (winding_number(body.mesh, all, p) < 0.5)
      throw InputError(
          "{}:{}: ({:g}, {:g}, {:g}) m does not lie in '{}'; points are in its coordinates, with the origin at its centre of mass", path,
          row.line, p.x, p.y, p.z, body.name);
    const auto same = std::find(points.begin(), points.end(), p);
    if (same != points.end()) throw InputError("{}:{}: the same point as number {}", path, row.line, same - points.begin() + 1);
    points.push_back(p);
  }
  return points;
}

std::string report_of(const Shape& body, const Fracture& cut) {
  std::vector<double> volumes;
  double sum = 0;
  std::int64_t triangles = 0;
  for (const Shape& piece : cut.pieces) {
    volumes.push_back(piece.mass.volume);
    sum += piece.mass.volume;
    triangles += piece.mesh.triangle_count();
  }
  std::sort(volumes.begin(), volumes.end());
  double area = 0;
  for (const SharedFace& face : cut.table.faces) area += face.area;
  const auto diameter = [](double volume) { return format_quantity(std::cbrt(6 * volume / 3.14159265358979323846), Dimension::length); };
  if (!(std::abs(sum - body.mass.volume) <= kVolumeRounding * body.mass.volume)) {
    throw InputError("'{}': the volumes of the pieces add up to {:.12g} m^3 and not to {:.12g} m^3; try another --seed", body.name, sum,
                     body.mass.volume);
  }
  std::string text = fmt::format("{}: {} cells, {} pieces of {} triangles, {} shared faces of {:.6g} m^2\n", body.name,
                                 cut.generators.size(), cut.pieces.size(), triangles, cut.table.faces.size(), area);
  text += fmt::format("diameters of balls of equal volume: {} to {}, median {}\n", diameter(volumes.front()), diameter(volumes.back()),
                      diameter(volumes[volumes.size() / 2]));
  text += fmt::format("volume {:.9g} m^3, that of the body within {:.1e}\n", sum, std::abs(sum - body.mass.volume) / body.mass.volume);
  return text;
}

}  // namespace

CommandResult fracture_command(const FractureOptions& options, const std::vector<std::string>& command) {
  expect_shape_path(options.output);
  if (!options.picture.empty()) expect_ending("--picture", options.picture, "a picture", {".png"});
  if (options.points.empty() == (options.cells == 0)) throw UsageError("fracture: give either --cells N or --points FILE");
  if (options.points.empty() && (options.cells < 2 || options.cells > kMaxCells))
    throw UsageError("--cells {}: expected from 2 to {}", options.cells, kMaxCells);
  if (!options.points.empty() && options.evenly)
    throw UsageError("--evenly moves points that are drawn by --cells; those of --points {} stay where they are: leave one of both out",
                     options.points);
  const ShapeFile file = read_shape_file(options.file);
  const Shape& body = chosen_shape(file, options);
  expect_solid(body, options.file);
  FractureForm form;
  form.cells = options.cells;
  form.seed = options.seed;
  form.evenly = options.evenly;
  if (!options.inset.empty()) {
    form.inset = parse_quantity(options.inset, Dimension::length, "--inset");
    if (!(form.inset > 0)) throw UsageError("--inset \"{}\": expected a length > 0", options.inset);
  }
  if (!options.points.empty()) {
    form.generators = read_points(options.points, body);
    form.cells = static_cast<std::int32_t>(form.generators.size());
    if (form.cells < 2) throw InputError("{}: {} points; a cut needs at least 2", options.points, form.cells);
  }
  const Fracture cut = fracture(body, form);

  CommandResult result;
  result.output = report_of(body, cut);
  if (cut.redrawn > 0)
    result.notices.push_back(
        fmt::format("{} points were drawn again, since their cells had less than {:g} of the mean volume", cut.redrawn, kSliverCell));
  if (cut.attempts > 1)
    result.notices.push_back(
        fmt::format("points were moved by parts of {:g} of the extent {} times, since planes of the cut passed through "
                    "vertices",
                    1e-5, cut.attempts - 1));
  Provenance provenance = shape_provenance(command, fmt::format("fracture cells={} seed={} evenly={} inset={} points={}", options.cells,
                                                                options.seed, options.evenly, options.inset, options.points));
  provenance.seed = options.seed;
  provenance.inputs.push_back({options.file, sha256_of_file(options.file), file.provenance});
  if (!options.points.empty()) provenance.inputs.push_back({options.points, sha256_of_file(options.points), nullptr});
  write_shape_file(options.output, cut.pieces, provenance_record(provenance), &cut.table);
  result.output += fmt::format("wrote {}\n", options.output);
  if (!options.picture.empty()) {
    std::vector<std::pair<TriangleMesh, Vec3>> drawn;
    for (const Shape& piece : cut.pieces) {
      drawn.emplace_back(piece.mesh, piece.origin_shift);
      for (Vec3& p : drawn.back().first.vertices) p += piece.origin_shift;
    }
    draw_pieces(body.name, drawn, options.picture);
    result.output += fmt::format("wrote {}\n", options.picture);
  }
  return result;
}

}  // namespace scree
