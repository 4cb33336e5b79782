#include <fmt/format.h>
#include <vtkVersion.h>

#include "core/picture/display.hpp"
#include "core/picture/picture.hpp"
#include "post/vtk/film.hpp"
#include "post/vtk/paraview.hpp"
#include "post/vtk/picture.hpp"
#include "post/vtk/vtk_or_not.hpp"

namespace scree {

std::string vtk_version() { return std::string("VTK ") + vtkVersion::GetVTKVersion(); }
void require_vtk() {}
std::string picture_obstacle() { return display_obstacle(); }
std::string make_picture(const Run& run, std::size_t frame_index, const std::string& path, const PictureOptions& options) {
  return draw_picture(run, frame_index, path, options);
}

std::string make_film(const Run& run, const std::string& path, const FilmOptions& options, std::vector<std::string>& skipped) {
  return write_film(run, path, options, skipped);
}

std::string make_paraview_files(const Run& run, const ParaviewOptions& options, std::vector<std::string>& skipped) {
  const ParaviewResult result = write_paraview_files(run, options);
  skipped = result.skipped;
  return fmt::format(
      "{0}: {1} frames, surfaces of {2} of them with {3:.0f} triangles each{4}\n"
      "open with: paraview --script={0}/open_in_paraview.py",
      result.folder, run.frames.size(), result.surface_frames, result.triangles_per_frame,
      options.surfaces == "auto" && result.surfaces != "all"
          ? fmt::format(" (all would be {:.2g} triangles; the script shows all frames with glyphs; --surfaces all writes them)",
                        result.triangles_per_frame * static_cast<double>(run.frames.size()))
          : "");
}

std::string make_vtk_files(const Run& run, const VtkOptions& options, std::vector<std::string>& skipped) {
  const VtkResult result = write_vtk_files(run, options);
  skipped = result.skipped;
  std::string lists;
  for (const std::string& name : result.lists) lists += " " + name;
  return fmt::format("{}: {} frames; open one of:{}", options.folder, result.frames, lists);
}

}  // namespace scree
