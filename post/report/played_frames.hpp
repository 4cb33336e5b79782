// The frames of a run that its page plays: which of them, and what the page draws of each.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "post/run/frame_pool.hpp"
#include "post/run/within.hpp"

namespace scree {

/// A body of a played frame. Plain data: frames are read in other processes.
struct PlayedBody {
  std::int64_t id = 0;
  std::int32_t shape = 0, material = 0;
  double scale = 1;
  Vec3 position, velocity;  ///< [m], [m/s]
  Quat orientation;
  double temperature = 0;     ///< [K]; 0 in scenes without heat
  std::int32_t touching = 0;  ///< lines of the contact network, as in the view of one frame
  bool is_inside = true;      ///< has not left the equipment: counts for scales of colours
};

struct PlayedFrame {
  std::int64_t number = 0;  ///< in the name of the file
  double time = 0;          ///< [s]
  Box3 room;                ///< seen_room() of the bodies inside; empty: there are none
  std::vector<PlayedBody> bodies;
  std::vector<WallPlace> walls;  ///< in the order of the scene
};

/// What a page plays. Without frames the page shows one frame only.
struct PlayedRun {
  std::vector<PlayedFrame> frames;   ///< ascending in time
  std::size_t chosen = 0;            ///< of `frames`: the frame of the pictures
  std::size_t frames_of_run = 0;     ///< those skipped included, those of Run::damaged not
  std::size_t bytes_of_all = 0;      ///< that all frames of the run would take, packed; an estimate from the numbers of bodies
  std::vector<std::string> skipped;  ///< messages of damaged frames that were left out
  Box3 room;                         ///< that the camera shows: of all frames
  std::size_t most = 0;              ///< bodies at one time
};

/// Indices of frames that fit into `limit` bytes: all, else as many as fit, spread evenly, with the first, the last and the chosen one.
/// Empty where not even those three fit, and where there is only one frame.
/// in   bytes   that each frame takes
std::vector<std::size_t> thinned(const std::vector<std::size_t>& bytes, std::size_t chosen, std::size_t limit);

/// Reads the frames that a page plays.
/// in   chosen   index of the frame of the pictures
/// in   within   as for the view of one frame: of a named place only the bodies in it are played
/// in   limit    bytes of the packed frames, see player_code.hpp
/// Fails: InputError (a damaged frame, named), unless the pool leaves such frames out.   Cost: every played frame is read once.
PlayedRun read_played_frames(const Run& run, std::size_t chosen, const Within& within, const FramePool& pool, std::size_t limit);

}  // namespace scree
