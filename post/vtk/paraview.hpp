// What ParaView opens: a script that shows true shapes as glyphs, walls and the contact network, and expanded surfaces.
#pragma once

#include <string>

#include "post/run/run_bodies.hpp"
#include "post/vtk/vtk_export.hpp"

namespace scree {

/// Triangles in all frames together that `auto` expands: some 4 GB of files (15 to 40 bytes a triangle). The glyphs of the script show the
/// same with one copy of each mesh, so that nothing is hidden beyond it.
constexpr double kExpandedTriangles = 2e8;

struct ParaviewOptions {
  std::string folder;  ///< empty: RUN/paraview
  /// auto | all | last | none: frames for which every body's triangles are written; auto: as many of these as stay below kExpandedTriangles
  std::string surfaces = "auto";
  FramePool pool{};
};

struct ParaviewResult {
  std::string folder;
  std::size_t surface_frames = 0;
  double triangles_per_frame = 0;    ///< of every body, expanded or not
  std::string surfaces;              ///< all | last | none: what was written
  std::vector<std::string> skipped;  ///< see FramePoolResult
};

/// Writes open_in_paraview.py, shape_K.vtp (K as in the frames' array `shape`), and of write_vtk_files: surfaces as asked
/// for, the contact network when the frames have contacts, and the walls: of all frames when one moves, else once, as
/// walls.vtp.
/// Fails: InputError, SystemError, UsageError.   Cost: one frame and its triangles in memory per process.
ParaviewResult write_paraview_files(const Run& run, const ParaviewOptions& options);

/// What `auto` stands for: all, last or none.
std::string expanded_frames(double triangles_per_frame, std::size_t frames);

/// The script's text; `run_from_script` is the run folder relative to the script's own folder, `extent` that of all frames.
std::string paraview_script(const Run& run, const std::string& run_from_script, const std::string& script_folder, const BodyExtent& extent);

}  // namespace scree
