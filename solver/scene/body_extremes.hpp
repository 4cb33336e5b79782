// The extremes of the bodies of a run, from which the step and its checks follow: of all that were there at the start, and of all that
// joined later.
#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

namespace scree {

struct BodyExtremes {
  static constexpr double kNone = 1e300;

  BodyExtremes(std::size_t materials, std::size_t shapes)
      : mass(materials, 0.0), least_mass(materials, kNone), radius(materials, 0.0), speed(materials, 0.0), smallest_scale(shapes, kNone) {}

  std::vector<double> mass;            ///< of each material: its heaviest moving body [kg]
  std::vector<double> least_mass;      ///< of each material: its lightest moving body [kg]; kNone where none moves
  std::vector<double> radius;          ///< of each material: largest radius of a ball of a body's volume [m]
  std::vector<double> speed;           ///< of each material: its fastest body, as it joins [m/s]
  std::vector<double> smallest_scale;  ///< of each shape; kNone where no body has it
  double bounding_radius = 0;          ///< largest [m]
  // of meshes with a margin of their own, and of analytic spheres [m]; kNone where there are none
  double least_margin = kNone, largest_margin = 0, least_ball = kNone;

  /// Takes in others of the same scene.
  void include(const BodyExtremes& other) {
    const auto each = [](std::vector<double>& mine, const std::vector<double>& theirs, auto&& more) {
      for (std::size_t i = 0; i < mine.size(); ++i) mine[i] = more(mine[i], theirs[i]);
    };
    const auto larger = [](double a, double b) { return std::max(a, b); };
    each(mass, other.mass, larger);
    each(radius, other.radius, larger);
    each(speed, other.speed, larger);
    const auto smaller = [](double a, double b) { return std::min(a, b); };
    each(least_mass, other.least_mass, smaller);
    each(smallest_scale, other.smallest_scale, smaller);
    bounding_radius = std::max(bounding_radius, other.bounding_radius);
    least_margin = smaller(least_margin, other.least_margin);
    largest_margin = larger(largest_margin, other.largest_margin);
    least_ball = smaller(least_ball, other.least_ball);
  }
};

}  // namespace scree
