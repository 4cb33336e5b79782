// What needs VTK, behind functions that every build has: a build without VTK says so instead.
#pragma once

#include <optional>
#include <string>

#include "post/run/run_folder.hpp"
#include "post/vtk/paraview.hpp"
#include "post/vtk/vtk_export.hpp"

namespace scree {

struct PictureOptions {
  int width = 1280, height = 960;  ///< [pixels]
  bool walls = true;
  bool time = false;                       ///< written into the corner
  bool network = false;                    ///< contact forces as tubes, bodies as ghosts
  std::string colour = "shape";            ///< of bodies: shape | material | rank | velocity
  std::optional<Vec3> from{}, at{}, up{};  ///< direction to the camera, point it looks at [m], up; else chosen to show all
  double zoom = 1;                         ///< 2: twice as near
};

/// "VTK 9.1.0" or "no VTK".
std::string vtk_version();
/// Throws UsageError with what to do when this build has no VTK.
void require_vtk();
/// Why no picture can be drawn (no VTK, no X display) and what to do, or "".
std::string picture_obstacle();
void make_picture(const Run& run, std::size_t frame_index, const std::string& path, const PictureOptions& options);
/// Returns what to tell the user: what was written and how to open it.
std::string make_paraview_files(const Run& run, const ParaviewOptions& options, std::vector<std::string>& skipped);
std::string make_vtk_files(const Run& run, const VtkOptions& options, std::vector<std::string>& skipped);

}  // namespace scree
