#include "core/geometry/vec3.hpp"

namespace scree {

// Shepperd's method: divide by the largest component, so that no root of a small number is taken.
Quat quaternion_of(const Mat3& m) {
  const double trace = m[0].x + m[1].y + m[2].z;
  Quat q;
  if (trace >= m[0].x && trace >= m[1].y && trace >= m[2].z) {
    q.w = 0.5 * std::sqrt(1 + trace);
    const double s = 0.25 / q.w;
    q.x = (m[2].y - m[1].z) * s;
    q.y = (m[0].z - m[2].x) * s;
    q.z = (m[1].x - m[0].y) * s;
  } else if (m[0].x >= m[1].y && m[0].x >= m[2].z) {
    q.x = 0.5 * std::sqrt(1 + m[0].x - m[1].y - m[2].z);
    const double s = 0.25 / q.x;
    q.w = (m[2].y - m[1].z) * s;
    q.y = (m[0].y + m[1].x) * s;
    q.z = (m[0].z + m[2].x) * s;
  } else if (m[1].y >= m[2].z) {
    q.y = 0.5 * std::sqrt(1 - m[0].x + m[1].y - m[2].z);
    const double s = 0.25 / q.y;
    q.w = (m[0].z - m[2].x) * s;
    q.x = (m[0].y + m[1].x) * s;
    q.z = (m[1].z + m[2].y) * s;
  } else {
    q.z = 0.5 * std::sqrt(1 - m[0].x - m[1].y + m[2].z);
    const double s = 0.25 / q.z;
    q.w = (m[1].x - m[0].y) * s;
    q.x = (m[0].z + m[2].x) * s;
    q.y = (m[1].z + m[2].y) * s;
  }
  return normalised(q);
}

}  // namespace scree
