// The files that ParaView opens: a script that shows true shapes as glyphs, and expanded surfaces.
#pragma once

#include <string>

#include "post/run_folder.hpp"

namespace scree {

struct ParaviewOptions {
  std::string folder;              ///< empty: RUN/paraview
  std::string surfaces = "all";    ///< all | last | none: frames for which every body's triangles are written
};

struct ParaviewResult {
  std::string folder;
  std::size_t surface_frames = 0;
  double triangles_per_frame = 0;
};

/// Writes open_in_paraview.py, shape_K.vtp (K as in the frames' array `shape`), walls.vtp, frame_%06d.vtp,
/// NAME.pvd and, when a wall moves, walls_%06d.vtp and walls.pvd.
/// Fails: InputError, SystemError, UsageError.   Cost: one frame and its triangles in memory.
ParaviewResult write_paraview_files(const Run& run, const ParaviewOptions& options);

/// The script's text; `run_from_script` is the run folder relative to the script's own folder.
std::string paraview_script(const Run& run, const std::string& run_from_script, const std::string& script_folder);

}  // namespace scree
