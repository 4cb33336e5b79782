// What needs VTK, behind functions that every build has: a build without VTK says so instead.
#pragma once

#include <string>

#include "post/run_folder.hpp"

namespace scree {

/// "VTK 9.1.0" or "no VTK".
std::string vtk_version();
/// Throws UsageError with what to do when this build has no VTK.
void require_vtk();
/// Why no picture can be drawn (no VTK, no X display) and what to do, or "".
std::string picture_obstacle();
void make_picture(const Run& run, std::size_t frame_index, const std::string& path);
/// Returns what to tell the user: what was written and how to open it. Folder empty: RUN/paraview.
std::string make_paraview_files(const Run& run, const std::string& folder, const std::string& surfaces);

}  // namespace scree
