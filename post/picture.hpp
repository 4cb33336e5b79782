// A picture of a frame, drawn without a window. Present only in builds with VTK.
#pragma once

#include <string>

#include "post/vtk_or_not.hpp"

namespace scree {

/// Why a picture cannot be drawn here and what to do, or "" when it can. Debian's VTK draws through X only.
std::string why_no_picture();

/// Draws the true shapes of one frame inside translucent walls into a PNG.
/// Fails: SystemError when there is no X display (see why_no_picture) or the file cannot be written.
void draw_picture(const Run& run, std::size_t frame_index, const std::string& path, const PictureOptions& options);

}  // namespace scree
