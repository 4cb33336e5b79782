#include "core/geometry/polygon_moments.hpp"

#include <algorithm>
#include <cmath>

namespace scree {

PlaneAxes::PlaneAxes(const Vec3& normal, const Vec3& o) : origin(o) {
  int least = 0;
  for (int k = 1; k < 3; ++k) {
    if (std::abs(normal[k]) < std::abs(normal[least])) least = k;
  }
  Vec3 axis;
  axis[least] = 1;
  u = normalised(cross(normal, axis));
  v = cross(normal, u);
}

PolygonMoments polygon_moments(std::span<const std::vector<Vec3>> loops, const Vec3& normal) {
  const PlaneAxes axes(normal, loops[0][0]);
  double a = 0, sx = 0, sy = 0, xx = 0, xy = 0, yy = 0;
  for (const std::vector<Vec3>& loop : loops) {
    for (std::size_t k = 0; k < loop.size(); ++k) {
      const Vec3 from = loop[k] - axes.origin, to = loop[(k + 1) % loop.size()] - axes.origin;
      const double px = dot(axes.u, from), py = dot(axes.v, from), qx = dot(axes.u, to), qy = dot(axes.v, to), c = px * qy - qx * py;
      a += c / 2;
      sx += c * (px + qx) / 6;
      sy += c * (py + qy) / 6;
      xx += c * (px * px + px * qx + qx * qx) / 12;
      yy += c * (py * py + py * qy + qy * qy) / 12;
      xy += c * (2 * px * py + px * qy + qx * py + 2 * qx * qy) / 24;
    }
  }
  PolygonMoments m;
  m.area = a;
  const double x = sx / a, y = sy / a;
  m.centroid = axes.origin + x * axes.u + y * axes.v;
  xx -= a * x * x, yy -= a * y * y, xy -= a * x * y;
  // the squared distance from a principal axis is least for the axis of the largest spread
  const double angle = 0.5 * std::atan2(2 * xy, xx - yy), mean = 0.5 * (xx + yy), half = std::hypot(0.5 * (xx - yy), xy);
  m.axis = std::cos(angle) * axes.u + std::sin(angle) * axes.v;
  m.moment_1 = mean - half;
  m.moment_2 = mean + half;
  for (const std::vector<Vec3>& loop : loops) {
    for (const Vec3& p : loop) m.rim_radius = std::max(m.rim_radius, length(p - m.centroid));
  }
  return m;
}

}  // namespace scree
