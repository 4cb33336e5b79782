#include "post/run/bonds_in_frame.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <utility>

#include "core/base/error.hpp"
#include "core/geometry/periodic.hpp"
#include "post/run/contact_network.hpp"

namespace scree {

namespace {

/// The lowest id of what each is connected with.
class Connected {
 public:
  std::int64_t lowest(std::int64_t id) {
    std::int64_t root = id;
    for (auto found = parent_.try_emplace(id, id).first; found->second != root; found = parent_.find(root)) root = found->second;
    while (id != root) id = std::exchange(parent_[id], root);  // a long chain of bonds is walked once
    return root;
  }
  void join(std::int64_t a, std::int64_t b) {
    const std::int64_t low = lowest(a), high = lowest(b);
    parent_[std::max(low, high)] = std::min(low, high);
  }

 private:
  std::map<std::int64_t, std::int64_t> parent_;
};

/// Centre of mass of each group of bodies, through the short way of periodic sides about its first.
std::map<std::int64_t, Vec3> centres(const Scene& scene, const FrameBodies& bodies, const Periodicity& period,
                                     const std::vector<std::int64_t>& group) {
  struct Sum {
    Vec3 first, moment;
    double mass = 0;
  };
  std::map<std::int64_t, Sum> sums;
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    if (group[i] < 0) continue;
    Sum& sum = sums.try_emplace(group[i], Sum{bodies.position[i], {}, 0}).first->second;
    const double mass = scene.mass(bodies.shape[i], bodies.material[i], bodies.scale[i]);
    sum.moment += mass * period.nearest(bodies.position[i] - sum.first);
    sum.mass += mass;
  }
  std::map<std::int64_t, Vec3> centre;
  for (const auto& [id, sum] : sums) centre[id] = sum.first + (1 / sum.mass) * sum.moment;
  return centre;
}

}  // namespace

std::vector<std::int64_t> all_bonds(const Scene& scene) {
  std::vector<std::int64_t> all(scene.bonds.size());
  std::iota(all.begin(), all.end(), 0);
  return all;
}

std::vector<std::int64_t> fragment_ids(const Scene& scene, const FrameBodies& bodies, const std::vector<std::int64_t>& holding) {
  Connected connected;
  std::vector<std::int64_t> bonded;
  for (const Bond& bond : scene.bonds) bonded.insert(bonded.end(), {bond.a, bond.b});
  std::sort(bonded.begin(), bonded.end());
  for (const std::int64_t k : holding) {
    const Bond& bond = scene.bonds[static_cast<std::size_t>(k)];
    connected.join(bond.a, bond.b);
  }
  std::vector<std::int64_t> ids;
  for (const std::int64_t id : bodies.id) ids.push_back(std::binary_search(bonded.begin(), bonded.end(), id) ? connected.lowest(id) : -1);
  return ids;
}

std::vector<Vec3> ways_apart(const Scene& scene, const Frame& frame) {
  const FrameBodies& bodies = frame.bodies;
  const std::vector<std::int64_t> fragment = fragment_ids(scene, bodies, frame.bonds.bond);
  const std::vector<std::int64_t> parent = fragment_ids(scene, bodies, all_bonds(scene));
  const Periodicity period = periodicity_of(scene, frame);
  const std::map<std::int64_t, Vec3> of_fragment = centres(scene, bodies, period, fragment),
                                     of_parent = centres(scene, bodies, period, parent);
  std::vector<Vec3> ways(bodies.size());
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    if (fragment[i] >= 0) ways[i] = period.nearest(of_fragment.at(fragment[i]) - of_parent.at(parent[i]));
  }
  return ways;
}

Frame taken_apart(const Scene& scene, Frame frame, double share) {
  const std::vector<Vec3> ways = ways_apart(scene, frame);
  for (std::size_t i = 0; i < ways.size(); ++i) frame.bodies.position[i] += share * ways[i];
  return frame;
}

std::vector<BondFace> bond_faces(const Scene& scene, const Frame& frame) {
  const FrameBodies& bodies = frame.bodies;
  const BodyRows row_of(bodies);
  const Periodicity period = periodicity_of(scene, frame);
  std::vector<BondFace> faces;
  for (std::size_t k = 0; k < frame.bonds.size(); ++k) {
    const Bond& bond = scene.bonds[static_cast<std::size_t>(frame.bonds.bond[k])];
    const std::int32_t row_a = row_of(bond.a), row_b = row_of(bond.b);
    if (row_a < 0 || row_b < 0) continue;
    const auto a = static_cast<std::size_t>(row_a), b = static_cast<std::size_t>(row_b);
    const Vec3 from_a = bodies.position[a] + rotate(bodies.orientation[a], bond.point_a);
    const Vec3 from_b = bodies.position[b] + rotate(bodies.orientation[b], bond.point_b);
    const Vec3 middle = from_a + 0.5 * period.nearest(from_b - from_a);
    const Quat frame_a = bodies.orientation[a] * bond.frame_a;
    const Vec3 normal = rotate(frame_a, {1, 0, 0});
    // of a rectangle: moment about y = area z^2 / 12
    double y = std::sqrt(12 * bond.moment_2 / bond.area), z = std::sqrt(12 * bond.moment_1 / bond.area);
    const double to_area = std::sqrt(bond.area / (y * z));
    y *= 0.5 * to_area;
    z *= 0.5 * to_area;
    BondFace face;
    face.body_a = bond.a;
    face.body_b = bond.b;
    face.corners = {middle + rotate(frame_a, {0, -y, -z}), middle + rotate(frame_a, {0, y, -z}), middle + rotate(frame_a, {0, y, z}),
                    middle + rotate(frame_a, {0, -y, z})};
    const Vec3& force = frame.bonds.force[k];
    const double along = dot(force, normal);
    face.normal_stress = along / bond.area;
    face.shear_stress = length(force - along * normal) / bond.area;
    face.load = frame.bonds.load[k];
    face.energy = frame.bonds.energy[k];
    faces.push_back(face);
  }
  return faces;
}

std::vector<std::string> bond_quantity_names() {
  std::vector<std::string> names;
  for (const BondQuantity& q : kBondQuantities) names.emplace_back(q.name);
  return names;
}

const BondQuantity& bond_quantity(const std::string& name) {
  for (const BondQuantity& q : kBondQuantities) {
    if (name == q.name) return q;
  }
  throw UsageError("--bonds {}: expected normal_stress, shear_stress or load", name);
}

}  // namespace scree
