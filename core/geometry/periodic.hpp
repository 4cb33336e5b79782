// Periodic axes: a body that leaves through one side comes in through the other.
//
// Positions are wrapped into the domain in every step, and a pair is computed with the nearest image of its second body.
// Both follow from the present positions alone: nothing about images is kept with pairs, lists or ghosts, so that lists,
// ranks and restarts cannot change a result. The price: of two bodies only one image may be in reach, so a periodic
// domain must be four times as wide as the largest body's reach (two diameters), which is checked at the start.
//
// A periodic cell that is sheared has the edges a = (h_xx, 0, 0), b = (h_xy, h_yy, 0), c = (h_xz, h_yz, h_zz): an upper triangular h. What
// leaves the box of the three lengths h_xx, h_yy, h_zz through a side across y comes in shifted by h_xy along x as well, and so on: that
// box holds one image of each point, however far the cell is sheared. So shears are those since it was a box, of any number of periods, and
// the shift of an image is one expression of them and of whole numbers: a cell that has been sheared by whole periods is the same cell, and
// there is no moment at which it changes to another. Of any two images of a point the distance is at least the least of the three lengths
// (those that differ in n_z are h_zz apart along z, others in n_y h_yy along y, others h_xx), so that the lengths alone bound the reach.
// A cell without period along z has no other shear than xy.
// Walls are not repeated: see core/storage/wall_zones.hpp.
#pragma once

#include <array>
#include <cmath>

#include "core/geometry/upper_matrix.hpp"
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

  /// A periodic domain with these periods [m] from its lower corner on; 0 of an axis that is not periodic.
  /// in   shear   h_yz, h_xz, h_xy since it was a box [m]; those with an axis that is not periodic are 0
  static Periodicity at_corner(const Vec3& lower, const Vec3& period, const Vec3& shear) {
    Periodicity made;
    made.lower_ = lower;
    made.period_ = period;
    made.any_ = !(period == Vec3{});
    made.shear_ = shear;
    made.is_sheared_ = !(shear == Vec3{});
    return made;
  }

  bool any() const { return any_; }
  bool is_periodic(int axis) const { return period_[axis] > 0; }
  const Vec3& lower() const { return lower_; }
  /// Length of each periodic axis [m], 0 for others.
  const Vec3& period() const { return period_; }
  bool is_sheared() const { return is_sheared_; }
  /// h_yz, h_xz, h_xy since it was a box [m].
  const Vec3& shear() const { return shear_; }
  /// The same of the cell of these images that is nearest to a box: each at most half of the length that it lies along.
  Vec3 least_shear() const {
    Vec3 least = shear_;
    if (!is_sheared_) return least;
    const double turns = std::nearbyint(least.x / period_.y);
    least.x -= turns * period_.y;
    least.y -= turns * least.z;
    least.y -= std::nearbyint(least.y / period_.x) * period_.x;
    least.z -= std::nearbyint(least.z / period_.x) * period_.x;
    return least;
  }
  Periodicity with_least_shear() const { return at_corner(lower_, period_, least_shear()); }
  /// From a point to its image n [m].
  Vec3 shift(const Vec3& n) const {
    if (!is_sheared_) return {n.x * period_.x, n.y * period_.y, n.z * period_.z};
    return {n.z * shear_.y + n.y * shear_.z + n.x * period_.x, n.z * shear_.x + n.y * period_.y, n.z * period_.z};
  }

  /// The shortest of all images of a difference of two wrapped positions [m]. Odd: nearest(-d) = -nearest(d).
  /// Of a cell that is sheared: the shortest of those that are shorter than half of each length, and one of the others if there is none.
  Vec3 nearest(Vec3 d) const {
    if (is_sheared_) return nearest_in_sheared(d);
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
    if (is_sheared_) return wrap_into_sheared(x, image);
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
  Vec3 way_of(const Vec3& x, const Vec3& image) const { return x + shift(image); }

 private:
  // The order of operations is that of the lanes (solver/lanes/ball_lanes-inl.hpp): whoever changes one changes both.
  Vec3 nearest_in_sheared(const Vec3& d) const {
    Vec3 n;
    n.z = d.z > 0.5 * period_.z ? 1 : d.z < -0.5 * period_.z ? -1 : 0;
    n.y = std::nearbyint((d.y - n.z * shear_.x) / period_.y);
    n.x = std::nearbyint((d.x - (n.z * shear_.y + n.y * shear_.z)) / period_.x);
    return d - shift(n);
  }
  Vec3 wrap_into_sheared(Vec3& x, Vec3& image) const {
    if (!std::isfinite(x.x) || !std::isfinite(x.y) || !std::isfinite(x.z)) return {};
    const Vec3 in = x - lower_;
    Vec3 n;
    n.z = is_periodic(2) ? std::floor(in.z / period_.z) : 0;
    n.y = std::floor((in.y - n.z * shear_.x) / period_.y);
    n.x = std::floor((in.x - (n.z * shear_.y + n.y * shear_.z)) / period_.x);
    if (n == Vec3{}) return {};
    const Vec3 back = -shift(n);
    x += back;
    image += n;
    return back;
  }

  Vec3 lower_, period_, shear_;
  bool any_ = false, is_sheared_ = false;
};

}  // namespace scree
