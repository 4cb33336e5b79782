// A film of a run: its frames drawn one after the other, made into one file by ffmpeg. Present only in builds with VTK.
#pragma once

#include <string>
#include <vector>

#include "post/vtk/vtk_or_not.hpp"

namespace scree {

/// Draws frames into NAME.mp4 (H.264), .webm (VP9) or .gif.
///
/// How: the frames are read once for what all pictures have in common, the camera and one scale of colours, then drawn by several
/// processes and handed to ffmpeg in order of time, so that no picture is kept. The camera turns about its `up` by the same angle from each
/// frame to the next; after a full turn the film continues with its first picture.
/// out  skipped   messages of damaged frames that were left out
/// Returns how long the film is and how fast it shows the run.
/// Fails: SystemError when there is no X display, when ffmpeg is missing or fails, or when the file cannot be written; UsageError when the
/// options do not fit each other or the format.   Memory: a picture in each process.
std::string write_film(const Run& run, const std::string& path, const FilmOptions& options, std::vector<std::string>& skipped);

}  // namespace scree
