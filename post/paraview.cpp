#include "post/paraview.hpp"

#include <filesystem>

#include "core/base/error.hpp"
#include "core/storage/h5.hpp"
#include "post/drawn_meshes.hpp"
#include "post/output_file.hpp"
#include "post/vtk_files.hpp"

namespace scree {

namespace {

namespace fs = std::filesystem;

/// ParaView's list of files and times.
std::string pvd_of(const std::vector<std::pair<std::string, double>>& files) {
  std::string text = "<?xml version=\"1.0\"?>\n<VTKFile type=\"Collection\" version=\"0.1\">\n  <Collection>\n";
  for (const auto& [name, time] : files) text += fmt::format("    <DataSet timestep=\"{}\" part=\"0\" file=\"{}\"/>\n", time, name);
  return text + "  </Collection>\n</VTKFile>\n";
}

bool any_wall_moves(const Scene& scene) {
  for (const Wall& wall : scene.walls) {
    if (wall.motion.kind != WallMotion::Kind::none) return true;
  }
  return false;
}

}  // namespace

ParaviewResult write_paraview_files(const Run& run, const ParaviewOptions& options) {
  ParaviewResult result;
  result.folder = options.folder.empty() ? (fs::path(run.folder) / "paraview").string() : options.folder;
  make_folder(result.folder);
  const fs::path folder(result.folder);

  // shapes and walls
  std::vector<DrawnMesh> shapes;
  for (const Shape& shape : run.scene.shapes) {
    shapes.push_back(drawn_shape(shape));
    write_mesh_vtp((folder / fmt::format("shape_{}.vtp", shapes.size() - 1)).string(), shapes.back());
  }
  const Frame first = load_frame(run, 0);
  const Box3 room = room_of(first.bodies, run.scene);
  std::vector<TriangleMesh> walls;
  for (const Wall& wall : run.scene.walls) walls.push_back(drawn_wall(wall, run.scene, room));
  if (!walls.empty()) write_walls_vtp((folder / "walls.vtp").string(), run.scene, walls, wall_places(first, run.scene));
  for (std::size_t i = 0; i < first.bodies.size(); ++i) {
    result.triangles_per_frame += static_cast<double>(shapes[static_cast<std::size_t>(first.bodies.shape[i])].mesh.triangles.size());
  }

  // frames
  const bool moving = any_wall_moves(run.scene);
  std::vector<std::pair<std::string, double>> surface_files, wall_files;
  for (std::size_t f = 0; f < run.frames.size(); ++f) {
    const bool wanted = options.surfaces == "all" || (options.surfaces == "last" && f + 1 == run.frames.size());
    const std::string stem = fs::path(run.frames[f].path).stem().string();  // frame_000012
    const Frame frame = load_frame(run, f);
    if (wanted) {
      write_surfaces_vtp((folder / (stem + ".vtp")).string(), frame.bodies, shapes);
      surface_files.emplace_back(stem + ".vtp", run.frames[f].time);
    }
    if (moving) {
      const std::string name = "walls" + stem.substr(stem.find('_')) + ".vtp";
      write_walls_vtp((folder / name).string(), run.scene, walls, wall_places(frame, run.scene));
      wall_files.emplace_back(name, run.frames[f].time);
    }
  }
  result.surface_frames = surface_files.size();
  if (!surface_files.empty()) h5::write_text_file((folder / (run.name + ".pvd")).string(), pvd_of(surface_files));
  if (moving) h5::write_text_file((folder / "walls.pvd").string(), pvd_of(wall_files));
  const std::string here = fs::absolute(folder).lexically_normal().string();
  const std::string back = fs::relative(fs::absolute(run.folder), fs::absolute(folder)).string();
  h5::write_text_file((folder / "open_in_paraview.py").string(), paraview_script(run, back, here));
  return result;
}

}  // namespace scree
