// The section of the page with the 3D view, which plays the frames of the run.
#pragma once

#include <string>
#include <vector>

#include "core/base/json_record.hpp"
#include "post/report/player_code.hpp"
#include "post/run/frame_pool.hpp"
#include "post/run/run_folder.hpp"

namespace scree {

struct ViewSection {
  std::string html;
  std::vector<std::string> skipped;  ///< messages of damaged frames that are not played
  JsonRecord numbers;                ///< what the section says of frames and of rounding
};

/// in   frame    index of the frame of the pictures, which the view shows first
/// in   within   see Within::named
/// in   limit    bytes of the frames that are played, packed
/// Fails: InputError (a damaged frame, named), unless the pool leaves such frames out.   Cost: every played frame is read once.
ViewSection view_section(const Run& run, std::size_t frame, const std::string& within, const FramePool& pool,
                         std::size_t limit = kPlayerLimit);

}  // namespace scree
