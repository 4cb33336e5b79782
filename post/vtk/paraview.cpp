#include "post/vtk/paraview.hpp"

#include <algorithm>
#include <filesystem>

#include "core/base/error.hpp"
#include "core/storage/h5.hpp"
#include "post/run/drawn_meshes.hpp"
#include "post/run/output_file.hpp"
#include "post/vtk/vtk_files.hpp"

namespace scree {

namespace {

namespace fs = std::filesystem;

/// Moves, or has loads that do.
bool any_wall_changes(const Scene& scene) {
  for (const Wall& wall : scene.walls) {
    if (wall.motion.is_prescribed() || wall.load_map) return true;
  }
  return false;
}

}  // namespace

std::string expanded_frames(double triangles_per_frame, std::size_t frames) {
  if (triangles_per_frame * static_cast<double>(frames) <= kExpandedTriangles) return "all";
  return triangles_per_frame <= kExpandedTriangles ? "last" : "none";
}

ParaviewResult write_paraview_files(const Run& run, const ParaviewOptions& options) {
  ParaviewResult result;
  result.folder = options.folder.empty() ? (fs::path(run.folder) / "paraview").string() : options.folder;
  make_folder(result.folder);
  const fs::path folder(result.folder);

  // shapes, and walls that stay as they are
  std::vector<DrawnMesh> shapes;
  for (const Shape& shape : run.scene.shapes) {
    shapes.push_back(drawn_shape(shape));
    write_mesh_vtp((folder / fmt::format("shape_{}.vtp", shapes.size() - 1)).string(), shapes.back());
  }
  const RunBodies bodies(run);
  const BodyExtent extent = extent_of_bodies(run, choose_frames(run, "all"), Within::equipment(run), options.pool);
  for (const RunBody& body : bodies.all)
    result.triangles_per_frame += static_cast<double>(shapes[static_cast<std::size_t>(body.shape)].mesh.triangles.size());
  // of bodies that come and go, as many as there are at one time
  if (run.lets_in() && !bodies.all.empty())
    result.triangles_per_frame *= std::min(1.0, static_cast<double>(extent.most_of_all) / static_cast<double>(bodies.all.size()));
  result.surfaces = options.surfaces == "auto" ? expanded_frames(result.triangles_per_frame, run.frames.size()) : options.surfaces;
  const bool moving = any_wall_changes(run.scene);
  if (!run.scene.walls.empty() && !moving) {
    const Frame first = load_frame(run, 0, FrameParts::bodies);
    const Box3 room = extent.box.is_empty() ? room_of({}, run.scene) : extent.box;
    std::vector<TriangleMesh> walls;
    for (const Wall& wall : run.scene.walls) walls.push_back(drawn_wall(wall, run.scene, room));
    write_walls_vtp((folder / "walls.vtp").string(), run.scene, walls, wall_places(first, run.scene), {});
  }

  // frames
  VtkOptions files;
  files.folder = result.folder;
  files.pool = options.pool;
  files.frames = choose_frames(run, "all");
  if (run.scene.settings.output_contacts) files.kinds.emplace_back("network");
  if (!run.scene.bonds.empty()) files.kinds.emplace_back("bonds");
  if (run.scene.settings.cell) files.kinds.emplace_back("cell");
  if (moving) files.kinds.emplace_back("walls");
  if (result.surfaces == "all") files.kinds.emplace_back("surfaces");
  if (!files.kinds.empty()) {
    const VtkResult written = write_vtk_files(run, files);
    result.skipped = written.skipped;
    if (result.surfaces == "all") result.surface_frames = written.frames;
  }
  if (result.surfaces == "last") {
    files.frames = choose_frames(run, "last");
    files.kinds = {"surfaces"};
    result.surface_frames = write_vtk_files(run, files).frames;
  }
  const std::string here = fs::absolute(folder).lexically_normal().string();
  const std::string back = fs::relative(fs::absolute(run.folder), fs::absolute(folder)).string();
  h5::write_text_file((folder / "open_in_paraview.py").string(), paraview_script(run, back, here, extent));
  return result;
}

}  // namespace scree
