#include "core/placing/orientation.hpp"

#include <cmath>
#include <numbers>

namespace scree {

namespace {

/// The shortest rotation that takes one unit vector to another.
Quat rotation_between(const Vec3& from, const Vec3& to) {
  const double cosine = dot(from, to);
  constexpr double kOpposite = -1 + 1e-12;  // the axis of half a turn must be chosen
  if (cosine < kOpposite) {
    const Vec3 across = cross(from, std::abs(from.x) < 0.9 ? Vec3{1, 0, 0} : Vec3{0, 1, 0});
    return quaternion_of(normalised(across), std::numbers::pi);
  }
  const Vec3 axis = cross(from, to);
  return normalised(Quat{1 + cosine, axis.x, axis.y, axis.z});
}

}  // namespace

Quat draw_orientation(const BodyOrientation& asked, const Shape& shape, const RandomNumbers& random, std::uint64_t which) {
  if (asked.kind == BodyOrientation::Kind::random) return random.orientation(which);
  if (asked.kind == BodyOrientation::Kind::given) return asked.given;
  constexpr double kTwoPi = 2 * std::numbers::pi;
  Vec3 axis = asked.body_axis;
  // principal moments ascend: the first is about the longest axis
  if (asked.axis == BodyOrientation::Axis::longest) axis = rotate(shape.mass.body_from_principal, {1, 0, 0});
  if (asked.axis == BodyOrientation::Axis::shortest) axis = rotate(shape.mass.body_from_principal, {0, 0, 1});
  const double tilt = asked.scatter * std::sqrt(-2 * std::log1p(-random.uniform(which)));
  const Vec3 any = std::abs(asked.direction.x) < 0.9 ? Vec3{1, 0, 0} : Vec3{0, 1, 0};
  const Vec3 across = normalised(cross(asked.direction, any));
  const Vec3 tilt_axis = rotate(quaternion_of(asked.direction, kTwoPi * random.uniform(which + 1)), across);
  return normalised(quaternion_of(tilt_axis, tilt) *
                    (rotation_between(axis, asked.direction) * quaternion_of(axis, kTwoPi * random.uniform(which + 2))));
}

}  // namespace scree
