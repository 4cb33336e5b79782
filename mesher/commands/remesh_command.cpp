#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/base/error.hpp"
#include "core/base/units.hpp"
#include "mesher/check/mesh_check.hpp"
#include "mesher/commands/edit_command.hpp"
#include "mesher/edit/mesh_simplify.hpp"
#include "mesher/repair/mesh_repair.hpp"
#include "mesher/repair/remesh.hpp"

namespace scree {

CommandResult remesh_command(const RemeshOptions& options, const std::vector<std::string>& command) {
  CommandResult result;
  if (options.surface) throw UsageError("remesh: the result is always closed; --surface has no meaning");
  if (options.edge_length.empty() == (options.triangles == 0))
    throw UsageError("remesh: give either --edge-length, for instance \"1 mm\", or --triangles, for instance 2000");
  if (options.triangles < 0 || (options.triangles > 0 && options.triangles < 20))
    throw UsageError("--triangles {}: expected at least 20", options.triangles);
  if (!(options.largest_change >= 0))
    throw UsageError("--largest-change {}: expected a part of the volume, for instance 0.2", options.largest_change);
  const EditSource source = read_edit_source(options, result);
  std::vector<EditedMesh> results = source.meshes;
  for (EditedMesh& edited : results) {
    const TriangleMesh before = edited.mesh;
    if (!(surface_area(before) > 0)) throw InputError("{}: all its triangles have zero area", options.file);
    const double edge_length = options.triangles > 0 ? std::sqrt(surface_area(before) / options.triangles / 0.4330127018922193)
                                                     : parse_quantity(options.edge_length, Dimension::length, "--edge-length");
    turn_outward(edited.mesh);
    const MeshCheck check = check_mesh(before);
    const double enclosed = check.is_solid() ? 0 : enclosed_volume(edited.mesh);
    edited.mesh = remesh(edited.mesh, edge_length);
    if (edited.mesh.triangles.empty()) {
      throw InputError("{}: nothing that it encloses is as thick as {:.3g} m; give a smaller --edge-length, or close it first",
                       options.file, edge_length);
    }
    // the lattice makes about twice as many triangles as asked; the smallest go
    const double wanted =
        options.triangles > 0 ? options.triangles : surface_area(before) / (0.4330127018922193 * edge_length * edge_length);
    const std::int32_t made = edited.mesh.triangle_count();
    simplify_mesh(edited.mesh, std::max(20, static_cast<std::int32_t>(wanted)), false);
    edited.steps.push_back(
        fmt::format("{} triangles became {}, after {} of the lattice", before.triangle_count(), edited.mesh.triangle_count(), made));
    const double change = report_change(before, false, edited, enclosed);
    std::int32_t pieces = 0;
    find_components(edited.mesh, pieces);
    if (check.is_solid() && static_cast<std::size_t>(pieces) != check.components.size()) {
      result.notices.push_back(
          fmt::format("{}: {} of '{}' became {}: necks and gaps narrower than an edge of {} break or close; give more --triangles or a "
                      "smaller --edge-length",
                      options.file, check.components.size() == 1 ? "1 component" : fmt::format("{} components", check.components.size()),
                      edited.name, pieces, format_quantity(edge_length, Dimension::length)));
    }
    if (std::abs(change) <= kNoticedChange) continue;
    const std::string loss = fmt::format(
        "{}: the volume of '{}' changed by {:+.3g} %: what is thinner than an edge of {} can vanish, and gaps narrower than it can close",
        options.file, edited.name, 100 * change, format_quantity(edge_length, Dimension::length));
    if (std::abs(change) > options.largest_change) {
      for (const std::string& step : edited.steps) result.output += fmt::format("{}: {}\n", edited.name, step);
      result.refusal = fmt::format(
          "{}; that is above the limit of {:g} % and nothing is written: give more --triangles or a smaller "
          "--edge-length, or allow it with --largest-change {:.2g}",
          loss, 100 * options.largest_change, std::ceil(100 * std::abs(change)) / 100);
      return result;
    }
    result.notices.push_back(loss + "; give more --triangles or a smaller --edge-length");
  }
  write_edit_results("remeshed", options, source, results, command, result);
  return result;
}

}  // namespace scree
