// Frames as VTK files for any reader: surfaces, bodies, contacts, network, walls, bonds, cell. Present only in builds with VTK.
#pragma once

#include <string>
#include <vector>

#include "post/run/choice.hpp"
#include "post/run/frame_pool.hpp"

namespace scree {

struct VtkOptions {
  std::string folder;
  std::vector<std::string> kinds;   ///< of kVtkKinds
  std::vector<std::size_t> frames;  ///< indices
  BodyChoice bodies;
  FramePool pool{};
};

struct VtkResult {
  std::vector<std::string> lists;  ///< names of the .pvd files
  std::size_t frames = 0;
  std::vector<std::string> skipped;  ///< see FramePoolResult
};

/// Writes KIND_%06d.vtp for each frame and KIND.pvd, which lists them with their times (surfaces: frame_%06d.vtp and
/// NAME.pvd). What is in them is told in vtk_files.hpp. Numbers are those of the frames.
/// Fails: UsageError (a kind that needs contacts in a run without), InputError, SystemError.
/// Cost: one frame and its triangles in memory per process.
VtkResult write_vtk_files(const Run& run, const VtkOptions& options);

}  // namespace scree
