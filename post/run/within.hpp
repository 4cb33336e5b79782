// Where bodies count: everywhere, in a region, in a wall, or in the equipment that the bodies of the run began in.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "post/run/drawn_meshes.hpp"
#include "post/run/region.hpp"
#include "post/run/run_folder.hpp"

namespace scree {

/// Which bodies of a frame have not left.
///
/// The equipment is the box around all walls with an end and all fixed bodies, as they were at the first frame of the run and as they are:
/// open along periodic axes, and upwards, such that a heaped trough and what is thrown up in it count. A body has left it when its bounding
/// sphere is wholly outside. That is judged only where gravity pulls bodies away, where no plane ends the room, and where all bodies
/// begin, and come in through inlets, inside; where some begin outside, only what is below the equipment has left it.
class Within {
 public:
  /// Everywhere.
  Within() = default;
  /// The equipment of a run, see above; everywhere, where nothing can be judged to have left.
  static Within equipment(const Run& run);
  /// What a text names: "all", a region (see parse_region), or a wall by name or id: what is in front of a plane; inside a box, cylinder or
  /// sphere; in the box around a mesh or above that. An empty text: the equipment.
  /// Fails: UsageError where it names nothing; the walls of the scene are listed.
  static Within named(const Run& run, const std::string& text);

  bool is_everywhere() const { return kind_ == Kind::everywhere; }
  bool is_equipment() const { return kind_ == Kind::equipment || kind_ == Kind::above_bottom; }
  /// By row of the frame's bodies; walls (Run::boundary_ids) never leave.
  std::vector<std::uint8_t> rows(const Run& run, const Frame& frame) const;
  /// The frame without bodies that have left, and without their contacts.
  Frame part_of(const Run& run, Frame frame) const;
  /// "have left the equipment", "are outside of 'trough'": for messages.
  const std::string& words() const { return words_; }

 private:
  enum class Kind { everywhere, region, wall, equipment, above_bottom };
  Kind kind_ = Kind::everywhere;
  Region region_;
  std::size_t wall_ = 0;
  Box3 start_;  ///< of the equipment at the first frame
  std::string words_;
};

/// The axis along which gravity pulls most (0 x, 1 y, 2 z), and the direction of up along it; z and +1 without gravity.
struct UpAxis {
  int axis = 2;
  double sign = 1;
};
UpAxis up_axis(const Vec3& gravity);

}  // namespace scree
