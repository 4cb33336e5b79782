#include "post/vtk/vtk_export.hpp"

#include <algorithm>
#include <filesystem>
#include <map>

#include "core/base/error.hpp"
#include "core/storage/h5.hpp"
#include "post/run/contact_network.hpp"
#include "post/run/drawn_meshes.hpp"
#include "post/run/output_file.hpp"
#include "post/run/run_bodies.hpp"
#include "post/vtk/vtk_files.hpp"
#include "post/vtk/vtk_threads.hpp"

namespace scree {

namespace {

namespace fs = std::filesystem;

/// ParaView's list of files and times.
std::string pvd_of(const std::vector<std::pair<std::string, double>>& files) {
  std::string text = "<?xml version=\"1.0\"?>\n<VTKFile type=\"Collection\" version=\"0.1\">\n  <Collection>\n";
  for (const auto& [name, time] : files) text += fmt::format("    <DataSet timestep=\"{}\" part=\"0\" file=\"{}\"/>\n", time, name);
  return text + "  </Collection>\n</VTKFile>\n";
}

}  // namespace

VtkResult write_vtk_files(const Run& run, const VtkOptions& options) {
  keep_vtk_to_one_thread();
  const auto wants = [&](const char* kind) { return std::find(options.kinds.begin(), options.kinds.end(), kind) != options.kinds.end(); };
  if ((wants("contacts") || wants("network")) && !run.scene.settings.output_contacts) {
    throw UsageError(
        "{}: the run kept no contacts; leave 'contacts' and 'network' away, or set contacts = true in [output] of the case and run "
        "it again",
        run.folder);
  }
  if (wants("cell") && !run.scene.settings.cell)
    throw UsageError("{}: the domain of the scene is no cell that deforms ([cell] of the case); leave 'cell' away", run.folder);
  if (wants("bonds") && run.scene.bonds.empty()) throw UsageError("{}: the scene has no bonds; leave 'bonds' away", run.folder);
  const ChosenBodies chosen(options.bodies, run.scene);
  make_folder(options.folder);
  const fs::path folder(options.folder);

  // what all frames share
  std::vector<DrawnMesh> shapes;
  if (wants("surfaces")) {
    for (const Shape& shape : run.scene.shapes) shapes.push_back(drawn_shape(shape));
  }
  std::vector<TriangleMesh> walls;
  Box3 room;
  if (wants("walls")) {
    room = extent_of_bodies(run, options.frames, Within::equipment(run), options.pool).box;
    if (room.is_empty()) room = room_of({}, run.scene);
    for (const Wall& wall : run.scene.walls) walls.push_back(drawn_wall(wall, run.scene, room));
  }

  const auto number_of = [&](std::size_t f) {  // "000012" of frame_000012.hdf
    const std::string stem = fs::path(run.frames[f].path).stem().string();
    return stem.substr(stem.find('_') + 1);
  };
  const auto name_of = [&](const std::string& kind, std::size_t f) {
    return (kind == "surfaces" ? "frame" : kind) + "_" + number_of(f) + ".vtp";
  };
  const auto task = [&](std::size_t f) {
    const Frame whole = load_frame(run, f), frame = chosen.part_of(whole, run.boundary_ids);
    const auto path = [&](const char* kind) { return (folder / name_of(kind, f)).string(); };
    if (wants("surfaces")) write_surfaces_vtp(path("surfaces"), frame, run.scene, shapes);
    if (wants("bodies")) write_bodies_vtp(path("bodies"), frame.bodies);
    if (wants("contacts")) write_contacts_vtp(path("contacts"), frame.contacts);
    if (wants("bonds")) write_bonds_vtp(path("bonds"), frame, run.scene);
    if (wants("network")) write_network_vtp(path("network"), frame, periodicity_of(run.scene, whole));
    if (wants("cell") && whole.cell.size() > 0) write_cell_vtp(path("cell"), whole.cell, periodicity_of(run.scene, whole));
    if (!walls.empty()) {
      for (std::size_t w = 0; w < walls.size(); ++w) {
        if (run.scene.walls[w].wear > 0) walls[w] = drawn_wall(run.scene.walls[w], run.scene, room, &whole);
      }
      // means since the frame before, of all that the run has
      const std::vector<WallLoads> loads =
          has_load_maps(run.scene) ? wall_loads(run.scene, f > 0 ? load_frame(run, f - 1) : Frame{}, whole) : std::vector<WallLoads>{};
      write_walls_vtp(path("walls"), run.scene, walls, wall_places(frame, run.scene), loads);
    }
    return std::string();
  };

  VtkResult result;
  std::map<std::string, std::vector<std::pair<std::string, double>>> lists;
  result.skipped = for_each_frame(options.frames, options.pool, task, [&](std::size_t f, const std::string&) {
                     ++result.frames;
                     for (const std::string& kind : options.kinds) {
                       if (kind == "walls" && walls.empty()) continue;
                       lists[kind].emplace_back(name_of(kind, f), run.frames[f].time);
                     }
                   }).skipped;
  for (const auto& [kind, files] : lists) {
    const std::string name = (kind == "surfaces" ? run.name : kind) + ".pvd";
    h5::write_text_file((folder / name).string(), pvd_of(files));
    result.lists.push_back(name);
  }
  return result;
}

}  // namespace scree
