#include "post/run/contact_network.hpp"

#include <algorithm>
#include <cmath>

namespace scree {

std::int32_t BodyRows::operator()(std::int64_t id) const {
  // ids count up from 0 unless bodies were taken out: then the row lies before the id
  if (id < 0 || id_.empty()) return -1;
  const auto most = std::min(id, static_cast<std::int64_t>(id_.size()) - 1);
  if (id_[static_cast<std::size_t>(most)] == id) return static_cast<std::int32_t>(most);
  const auto it = std::lower_bound(id_.begin(), id_.begin() + most, id);
  return it != id_.begin() + most && *it == id ? static_cast<std::int32_t>(it - id_.begin()) : -1;
}

Periodicity periodicity_of(const Scene& scene, const Frame& frame) {
  const Domain& domain = scene.settings.domain;
  if (frame.cell.size() > 0) {
    Vec3 period = frame.cell.upper[0] - frame.cell.lower[0];
    if (!domain.periodic[2]) period.z = 0;  // between planes
    return Periodicity::at_corner(frame.cell.lower[0], period, frame.cell.shear[0]);
  }
  return domain.bounded ? periodicity_of(domain) : Periodicity();
}

std::vector<NetworkLine> network_of(const Frame& frame, const Periodicity& period) {
  const BodyRows row(frame.bodies);
  const FrameContacts& c = frame.contacts;
  std::vector<NetworkLine> lines;
  for (std::size_t i = 0; i < c.size();) {
    NetworkLine line;
    line.body_a = c.body_a[i];
    line.body_b = c.body_b[i];
    line.index_a = row(line.body_a);
    line.index_b = row(line.body_b);
    // points are averaged about the first, on the same side of the domain
    const Vec3 origin = line.index_a >= 0 ? frame.bodies.position[static_cast<std::size_t>(line.index_a)] : c.point[i];
    Vec3 offset, tangential;
    double size = 0;  // of the normal forces
    const bool with_wall = line.index_a < 0 || line.index_b < 0;
    for (; i < c.size() && c.body_a[i] == line.body_a && c.body_b[i] == line.body_b; ++i) {
      if (with_wall && line.points == 1) break;  // the next point of this pair is a line of its own
      if (!carries(c.normal_force[i])) continue;
      ++line.points;
      line.normal_force += c.normal_force[i];
      tangential += c.tangential_force[i];
      line.force += c.normal_force[i] * c.normal[i] + c.tangential_force[i];
      size += std::abs(c.normal_force[i]);
      offset += std::abs(c.normal_force[i]) * period.nearest(c.point[i] - origin);
    }
    if (line.points == 0) continue;
    line.tangential_force = length(tangential);
    const Vec3 point = origin + (1 / size) * offset;
    line.from = line.index_a >= 0 ? origin : point;
    line.to = point;
    if (line.index_b >= 0) line.to = line.from + period.nearest(frame.bodies.position[static_cast<std::size_t>(line.index_b)] - line.from);
    lines.push_back(line);
  }
  return lines;
}

std::vector<std::int32_t> line_counts(const std::vector<NetworkLine>& lines, std::size_t bodies) {
  std::vector<std::int32_t> counts(bodies);
  for (const NetworkLine& line : lines) {
    for (const std::int32_t row : {line.index_a, line.index_b}) {
      if (row >= 0) ++counts[static_cast<std::size_t>(row)];
    }
  }
  return counts;
}

}  // namespace scree
