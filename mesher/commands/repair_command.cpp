#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/base/counted.hpp"
#include "core/base/error.hpp"
#include "mesher/commands/certificate.hpp"
#include "mesher/commands/edit_command.hpp"
#include "mesher/repair/heal_mesh.hpp"

namespace scree {

namespace {

/// A part that stands alone faces outward, whatever it was inside another one.
void turn_alone(TriangleMesh& part, std::vector<std::string>& steps) {
  if (const std::int32_t turned = turn_outward(part); turned > 0)
    steps.push_back(counted(turned, "triangle of a part that now stands alone turned outward",
                            "triangles of a part that now stands alone turned outward"));
}

/// The component that stays by --largest or --component.
TriangleMesh picked(const TriangleMesh& mesh, const RepairOptions& options, std::vector<std::string>& steps) {
  std::vector<TriangleMesh> parts = components_of(mesh);
  if (options.component > static_cast<int>(parts.size()))
    throw UsageError("--component {}: there are {} components", options.component, parts.size());
  std::size_t keep = static_cast<std::size_t>(std::max(0, options.component - 1));
  if (options.keep_largest) {
    const auto size = [](const TriangleMesh& part) { return std::abs(mass_properties(part).volume); };
    keep = static_cast<std::size_t>(
        std::max_element(parts.begin(), parts.end(), [&](const auto& a, const auto& b) { return size(a) < size(b); }) - parts.begin());
  }
  if (parts.size() > 1) {
    steps.push_back(fmt::format("component {} of {} kept, {} triangles", keep + 1, parts.size(), parts[keep].triangle_count()));
  }
  turn_alone(parts[keep], steps);
  return parts[keep];
}

}  // namespace

CommandResult repair_command(const RepairOptions& options, const std::vector<std::string>& command) {
  if (!(options.weld >= 0 && options.weld < 0.1)) throw UsageError("--weld {}: expected a part of the extent from 0 to 0.1", options.weld);
  if (!(options.largest_fill >= 0))
    throw UsageError("--largest-fill {}: expected a part of the area, for instance 0.2", options.largest_fill);
  if (options.component < 0) throw UsageError("--component {}: they are counted from 1", options.component);
  if ((options.component > 0) + options.keep_largest + options.separate > 1)
    throw UsageError("--component, --largest and --separate exclude each other");
  CommandResult result;
  const EditSource source = read_edit_source(options, result);
  std::vector<EditedMesh> results;
  for (EditedMesh edited : source.meshes) {
    const double needed_fill = heal_mesh(edited.mesh, {options.weld, options.largest_fill}, edited.steps);
    if (needed_fill > 0) {
      edited.advice.push_back(fmt::format("close the holes that are left with --largest-fill {:.2g} (the limit was {:g} of the area)",
                                          std::ceil(100 * needed_fill) / 100, options.largest_fill));
    }
    if (options.component > 0 || options.keep_largest) edited.mesh = picked(edited.mesh, options, edited.steps);
    if (edited.steps.empty()) edited.steps.push_back("nothing to repair");
    edited.record["steps"] = edited.steps;
    if (!options.separate) {
      results.push_back(std::move(edited));
      continue;
    }
    std::vector<TriangleMesh> parts = components_of(edited.mesh);
    for (std::size_t i = 0; i < parts.size(); ++i) {
      std::vector<std::string> steps = i == 0 ? edited.steps : std::vector<std::string>{};
      turn_alone(parts[i], steps);
      results.push_back({fmt::format("{}_{}", edited.name, i + 1), std::move(parts[i]), std::move(steps), edited.record, edited.advice});
    }
  }
  write_edit_results("repaired", options, source, results, command, result);
  return result;
}

}  // namespace scree
