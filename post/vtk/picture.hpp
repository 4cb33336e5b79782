// A picture of a frame, drawn without a window. Present only in builds with VTK.
#pragma once

#include <string>

#include "post/vtk/vtk_or_not.hpp"

namespace scree {

/// Draws the true shapes of one frame inside translucent walls into a PNG.
/// Fails: SystemError when there is no X display (see why_no_picture) or the file cannot be written.
void draw_picture(const Run& run, std::size_t frame_index, const std::string& path, const PictureOptions& options);

}  // namespace scree
