#include "core/storage/seam_meshes.hpp"

#include <algorithm>
#include <cmath>

#include "core/base/error.hpp"

namespace scree {

namespace {

constexpr double kAligned = 1e-12;  // of a unit vector: rounding of the case file

struct Interval {
  double lower = 1e300, upper = -1e300;
  void add(double value) {
    lower = std::min(lower, value);
    upper = std::max(upper, value);
  }
};

/// Along one axis: what a wall takes up where it is placed, and how far it goes from there during a run [m].
struct SweptWall {
  Interval place, shift;
  bool turns = false;  ///< about another axis: `place` is that of full turns
};

SweptWall sweep(const Wall& wall, const TriangleMesh& mesh, int axis, double duration) {
  SweptWall swept;
  std::vector<Vec3> placed;
  for (const Vec3& vertex : mesh.vertices) {
    placed.push_back(wall.position + wall.scale * rotate(wall.orientation, vertex));
    swept.place.add(placed.back()[axis]);
  }
  // of several that turn it about other axes, each takes what those before it have swept
  for (const WallMotion& part : wall.motion.parts()) {
    const std::optional<TurnAxis> turning = part.turn_axis();
    if (!turning || !part.moves() || !(duration > part.start) || !(1 - std::abs(turning->direction[axis]) > kAligned)) continue;
    double farthest = 0;
    for (const Vec3& x : placed) farthest = std::max(farthest, length(x - turning->point));
    swept.place = {turning->point[axis] - farthest, turning->point[axis] + farthest};
    swept.turns = true;
    if (wall.motion.parts().size() == 1) break;
    for (const Vec3& way : wall.motion.displacements(duration)) farthest = std::max(farthest, farthest + length(way));
    placed.clear();
    for (int corner = 0; corner < 8; ++corner)
      placed.push_back(turning->point + farthest * Vec3{corner & 1 ? 1.0 : -1.0, corner & 2 ? 1.0 : -1.0, corner & 4 ? 1.0 : -1.0});
  }
  swept.shift.add(0);
  for (const Vec3& way : wall.motion.displacements(duration)) swept.shift.add(way[axis]);
  return swept;
}

}  // namespace

std::vector<std::string> check_meshes_at_seams(const std::vector<Wall>& walls, const std::vector<Shape>& shapes, const Domain& domain,
                                               double reach, double duration) {
  // of the period: coordinates of files in single precision
  constexpr double kRounding = 1e-6;
  std::vector<std::string> gaps;
  for (const Wall& wall : walls) {
    if (wall.kind != WallKind::mesh) continue;
    for (int axis = 0; axis < 3; ++axis) {
      if (!domain.periodic[static_cast<std::size_t>(axis)]) continue;
      const SweptWall swept = sweep(wall, shapes[static_cast<std::size_t>(wall.shape)].mesh, axis, duration);
      const double lower = domain.lower[axis], upper = domain.upper[axis], rounding = kRounding * (upper - lower);
      const double low = swept.place.lower + swept.shift.lower, high = swept.place.upper + swept.shift.upper;
      const bool moves = swept.turns || swept.shift.upper - swept.shift.lower > rounding;
      const bool stays_inside = low >= lower + reach - rounding && high <= upper - reach + rounding;
      const bool goes_on = !swept.turns && swept.place.lower + swept.shift.upper <= lower - reach + rounding &&
                           swept.place.upper + swept.shift.lower >= upper + reach - rounding;
      if (stays_inside) continue;
      if (const auto around = wall.surface.motion.turn_axis(); around && 1 - std::abs(around->direction[axis]) > kAligned) {
        throw UsageError(
            "wall {} ('{}'), a mesh, reaches the end of the cell along the periodic axis {}, and its surface turns about another axis: it "
            "is "
            "not the same all along; let it turn about {}, or keep the wall {:.3g} m (the reach of a body) away from both ends",
            wall.id, wall.name, "xyz"[axis], "xyz"[axis], reach);
      }
      if (goes_on) continue;
      const std::string where =
          fmt::format("wall {} ('{}'), a mesh, {} {:g} to {:g} m along the periodic axis {}, whose cell is {:g} to {:g} m", wall.id,
                      wall.name, moves ? "takes up, as it moves," : "takes up", low, high, "xyz"[axis], lower, upper);
      const std::string cure =
          fmt::format("keep it {:.3g} m (the reach of a body) away from both ends, or let it go on as far beyond both", reach);
      if (moves) {
        throw UsageError(
            "{}: meshes are not repeated, so bodies would lose it at the seam; {} all the time, or use a plane or cylinder, which has no "
            "end",
            where, cure);
      }
      if ((low < lower - rounding) != (high > upper + rounding)) {
        throw UsageError("{}: meshes are not repeated, so what lies beyond one end is not met from the other; {}", where, cure);
      }
      gaps.push_back(fmt::format("{}: bodies at the seam meet it on one side of the seam only; {}", where, cure));
    }
  }
  return gaps;
}

}  // namespace scree
