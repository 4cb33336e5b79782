// A picture of a frame, drawn without a window. Present only in builds with VTK.
#pragma once

#include <memory>
#include <string>

#include "core/picture/picture.hpp"
#include "post/run/run_bodies.hpp"
#include "post/vtk/vtk_or_not.hpp"

namespace scree {

/// What a series of pictures has in common.
struct Stage {
  /// in   options   within
  Stage(const Run& run, const PictureOptions& options);
  Within within;
  std::shared_ptr<const RunBodies> bodies;           ///< of the run, for legends
  Box3 room;                                         ///< that the camera shows, and that walls without an end are drawn for
  std::optional<std::pair<double, double>> range{};  ///< of the scale of numbers
  /// Takes in another frame.
  void add(const Run& run, const Frame& frame, const PictureOptions& options);
};

/// Where the camera stands for what the options leave open.
/// Fails: UsageError when they contradict each other.
View camera_of(const Stage& stage, const Vec3& gravity, const PictureOptions& options);

/// The plane of `options.cut`, its normal towards the camera.
/// Fails: UsageError when the camera looks along it.
std::optional<Cut> cut_of(const View& view, const PictureOptions& options);

/// Draws the true shapes of one frame inside translucent walls. Call display_obstacle first.
Image draw_frame(const Run& run, const Frame& frame, const PictureOptions& options, const Stage& stage, const View& view,
                 const std::optional<Cut>& cut);

/// What pictures of these frames do not show, for the user: bodies that have left; empty: nothing.
std::string words_of_unseen(const Run& run, const std::vector<std::size_t>& frames, const Within& within, const FramePool& pool);

/// Draws one frame into a PNG. With `options.at` the camera is the same for all frames of the run: as far away as shows its first and its
/// last frame.
/// Returns what it does not show (words_of_unseen).
/// Fails: SystemError when there is no X display (see display_obstacle) or the file cannot be written.
std::string draw_picture(const Run& run, std::size_t frame_index, const std::string& path, const PictureOptions& options);

}  // namespace scree
