// The contact network of a frame: one line for each pair of bodies that press on one another or pull, and one from a body to each
// point at which a wall does (a box wall is one wall: its floor and its sides press in different places).
#pragma once

#include <cstdint>
#include <vector>

#include "core/geometry/periodic.hpp"
#include "core/storage/frame_file.hpp"
#include "core/storage/scene_file.hpp"

namespace scree {

/// Whether a contact point carries anything: one that damping has let go of for the moment does not. Below 0 it pulls.
inline bool carries(double normal_force) { return normal_force > 0 || normal_force < 0; }

struct NetworkLine {
  std::int64_t body_a = 0, body_b = 0;      ///< a < b
  std::int32_t index_a = -1, index_b = -1;  ///< rows of the frame's bodies; -1: a wall
  Vec3 from, to;                            ///< centre of a, centre of b; of a wall the contact point [m]
  Vec3 force;                               ///< on a, sum over the contact points [N]
  double normal_force = 0;                  ///< sum over the contact points [N]; below 0 where they pull
  double tangential_force = 0;              ///< size of the sum of the tangential forces [N]
  std::int32_t points = 0;                  ///< contact points that carry force
};

/// Lines by (a, b). Contact points that carry a normal force count. Where a periodic side lies between two bodies, `to` is the
/// image next to `from`.
/// in   frame   as read: bodies by ascending id, contacts by (a, b)
std::vector<NetworkLine> network_of(const Frame& frame, const Periodicity& period);

/// Lines of each body, by row of the frame.
std::vector<std::int32_t> line_counts(const std::vector<NetworkLine>& lines, std::size_t bodies);

/// The periodic axes of a frame: those of the scene, or of a cell that deforms.
Periodicity periodicity_of(const Scene& scene, const Frame& frame);

/// Row of a body in a frame, -1 when there is none of that id (a wall, or a body that was taken out).
class BodyRows {
 public:
  explicit BodyRows(const FrameBodies& bodies) : id_(bodies.id) {}
  std::int32_t operator()(std::int64_t id) const;

 private:
  const std::vector<std::int64_t>& id_;
};

}  // namespace scree
