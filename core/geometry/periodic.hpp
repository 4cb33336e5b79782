// Periodic axes: a body that leaves through one side comes in through the other.
//
// Positions are wrapped into the domain in every step, and a pair is computed with the nearest image of its second body.
// Both follow from the present positions alone: nothing about images is kept with pairs, lists or ghosts, so that lists,
// ranks and restarts cannot change a result. The price: of two bodies only one image may be in reach, so a periodic
// domain must be four times as wide as the largest body's reach (two diameters), which is checked at the start.
// Walls are not repeated: see core/storage/wall_zones.hpp.
#pragma once

#include <array>
#include <cmath>

#include "core/geometry/vec3.hpp"

namespace scree {

class Periodicity {
 public:
  Periodicity() = default;
  Periodicity(const Vec3& lower, const Vec3& upper, const std::array<bool, 3>& periodic) : lower_(lower) {
    for (int k = 0; k < 3; ++k) {
      if (periodic[static_cast<std::size_t>(k)]) period_[k] = upper[k] - lower[k];
      any_ = any_ || period_[k] > 0;
    }
  }

  /// A periodic domain with these periods [m] about a middle; 0 of an axis that is not periodic.
  static Periodicity about(const Vec3& centre, const Vec3& period) {
    Periodicity made;
    made.lower_ = centre - 0.5 * period;
    made.period_ = period;
    made.any_ = !(period == Vec3{});
    return made;
  }

  bool any() const { return any_; }
  bool is_periodic(int axis) const { return period_[axis] > 0; }
  const Vec3& lower() const { return lower_; }
  /// Length of each periodic axis [m], 0 for others.
  const Vec3& period() const { return period_; }

  /// The shortest of all images of a difference of two wrapped positions [m]. Odd: nearest(-d) = -nearest(d).
  Vec3 nearest(Vec3 d) const {
    for (int k = 0; k < 3; ++k) {
      if (d[k] > 0.5 * period_[k])
        d[k] -= period_[k];
      else if (d[k] < -0.5 * period_[k])
        d[k] += period_[k];
    }
    return d;
  }

  /// Wraps a position into the domain; returns the shift that was added [m]. `image` counts the periods that the body has
  /// gone along each axis (whole numbers): its way is way_of(x, image).
  Vec3 wrap(Vec3& x, Vec3& image) const {
    Vec3 shift;
    for (int k = 0; k < 3; ++k) {
      if (!(period_[k] > 0)) continue;
      const double periods = std::floor((x[k] - lower_[k]) / period_[k]);
      if (periods == 0 || !std::isfinite(periods)) continue;
      shift[k] = -periods * period_[k];
      x[k] += shift[k];
      image[k] += periods;
    }
    return shift;
  }
  Vec3 way_of(const Vec3& x, const Vec3& image) const {
    return {x.x + image.x * period_.x, x.y + image.y * period_.y, x.z + image.z * period_.z};
  }

 private:
  Vec3 lower_, period_;
  bool any_ = false;
};

}  // namespace scree
