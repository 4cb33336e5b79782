// The frames that report.html plays, packed (player_code.hpp) into base64.
#pragma once

#include <cstddef>

#include "core/base/json_record.hpp"
#include "post/report/played_frames.hpp"

namespace scree {

/// How far bodies are drawn from where they are.
struct PlayerError {
  double distance = 0;           ///< largest of the centres, float32 of the graphics included [m]
  double angle = 0;              ///< largest [rad]
  double smallest_diameter = 0;  ///< of a body, ball of equal volume [m]
};

struct PlayerData {
  JsonRecord json;
  PlayerError error;      ///< of all bodies in all frames that are played
  std::size_t bytes = 0;  ///< of the packed frames
};

/// in   centre   the middle of the view, which the page draws relative to [m]
PlayerData player_data(const Scene& scene, const PlayedRun& played, const Vec3& centre);

}  // namespace scree
