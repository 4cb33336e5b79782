// Whether a frame belongs to a scene: everything that readers take as an index, a place or a size.
#pragma once

#include <string>

#include "core/storage/frame_file.hpp"
#include "core/storage/scene_file.hpp"

namespace scree {

/// Refuses a frame whose rows name what the scene does not have, or whose bodies and walls are nowhere.
///
/// in   path          of the frame, for messages
/// in   has_program   a program stepped its run and may have inserted bodies; known from the frame itself where its provenance was read
/// Fails: throws InputError with the row.   Cost: O(bodies), and a sort where the ids of the scene are not in order.
void check_frame(const Scene& scene, const Frame& frame, const std::string& path, bool has_program = false);

}  // namespace scree
