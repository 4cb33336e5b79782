#include "solver/neighbours/fragment_masses.hpp"

#include <algorithm>
#include <array>

#include "core/base/index.hpp"

namespace scree {

namespace {

/// Inverse of a symmetric matrix with a determinant above 0.
Mat3 inverse_of(const Mat3& m) {
  const Vec3 x = cross(m[1], m[2]), y = cross(m[2], m[0]), z = cross(m[0], m[1]);
  const double determinant = dot(m[0], x);
  const Mat3 columns{{x, y, z}};
  Mat3 inverse = transpose(columns);
  for (int i = 0; i < 3; ++i) inverse[i] *= 1 / determinant;
  return inverse;
}

/// R diag(d) R^T of a rotation.
Mat3 turned(const Mat3& r, const Vec3& d) {
  Mat3 out;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) out[i][j] = r[i].x * d.x * r[j].x + r[i].y * d.y * r[j].y + r[i].z * d.z * r[j].z;
  }
  return out;
}

/// Adds the inertia of a point mass at x.
void add_point(double mass, const Vec3& x, Mat3& inertia) {
  const double square = squared_length(x);
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) inertia[i][j] += mass * ((i == j ? square : 0.0) - x[i] * x[j]);
  }
}

}  // namespace

FragmentMasses::FragmentMasses(const SolverScene& scene) : scene_(scene), is_broken_(scene.source().bonds.size(), 0) {
  const std::vector<Bond>& bonds = scene.source().bonds;
  for (const Bond& bond : bonds) ids_.insert(ids_.end(), {bond.a, bond.b});
  std::sort(ids_.begin(), ids_.end());
  ids_.erase(std::unique(ids_.begin(), ids_.end()), ids_.end());
  const auto index_of = [&](std::int64_t id) {
    return static_cast<std::int32_t>(std::lower_bound(ids_.begin(), ids_.end(), id) - ids_.begin());
  };
  bodies_.resize(ids_.size());
  masses_.resize(ids_.size());
  std::vector<Quat> principal(ids_.size());
  const BodyTable& table = scene.source().bodies;
  for (std::size_t b = 0; b < table.size(); ++b) {
    const auto n = at(index_of(table.id[b]));
    if (n == ids_.size() || ids_[n] != table.id[b]) continue;
    ParticleSet alone;
    append_record(alone, initial_record(scene, b), scene);
    const Vec3& w = alone.inverse_inertia[0];
    principal[n] = scene.shape(table.shape[b]).body_from_principal;
    bodies_[n] = {alone.mass[0], {1 / w.x, 1 / w.y, 1 / w.z}, !alone.fixed[0] && !alone.lock_rotation[0]};
  }

  // neighbours of each body in ascending order of bonds
  std::vector<std::vector<Neighbour>> of_body(ids_.size());
  for (std::size_t k = 0; k < bonds.size(); ++k) {
    const Bond& bond = bonds[k];
    const std::int32_t a = index_of(bond.a), b = index_of(bond.b), number = static_cast<std::int32_t>(k);
    const Vec3 arm_a = rotate_inverse(principal[at(a)], bond.point_a), arm_b = rotate_inverse(principal[at(b)], bond.point_b);
    const Quat frame_a = conjugate(principal[at(a)]) * bond.frame_a, frame_b = conjugate(principal[at(b)]) * bond.frame_b;
    const Quat b_in_a = frame_a * conjugate(frame_b);
    of_body[at(a)].push_back({number, b, arm_a - rotate(b_in_a, arm_b), b_in_a});
    of_body[at(b)].push_back({number, a, arm_b - rotate_inverse(b_in_a, arm_a), conjugate(b_in_a)});
  }
  start_.assign(1, 0);
  for (const std::vector<Neighbour>& list : of_body) {
    neighbours_.insert(neighbours_.end(), list.begin(), list.end());
    start_.push_back(static_cast<std::int32_t>(neighbours_.size()));
  }
  std::vector<std::uint8_t> is_found(ids_.size(), 0);
  for (std::size_t n = 0; n < ids_.size(); ++n) {
    if (is_found[n] == 0) find_fragment(static_cast<std::int32_t>(n), is_found);
  }
}

bool FragmentMasses::update(const std::vector<std::int64_t>& broken_at, std::int64_t before) {
  const std::vector<Bond>& bonds = scene_.source().bonds;
  std::vector<std::uint8_t> is_found;  // of bodies whose fragment is as it was
  std::vector<std::uint8_t> has_changed(ids_.size(), 0);
  bool any = false;
  for (std::size_t k = 0; k < bonds.size(); ++k) {
    if (is_broken_[k] != 0 || broken_at[k] == kHolds || broken_at[k] >= before) continue;
    is_broken_[k] = 1;
    any = true;
    const auto a = std::lower_bound(ids_.begin(), ids_.end(), bonds[k].a) - ids_.begin();
    has_changed[at(masses_[static_cast<std::size_t>(a)].fragment)] = 1;
  }
  if (!any) return false;
  for (const BondedMass& mass : masses_) is_found.push_back(has_changed[at(mass.fragment)] != 0 ? 0 : 1);
  for (std::size_t n = 0; n < ids_.size(); ++n) {
    if (is_found[n] == 0) find_fragment(static_cast<std::int32_t>(n), is_found);
  }
  return true;
}

/// All bodies that unbroken bonds connect to the first, nearest bonds first: the same order, and so the same bits, for the same bonds.
void FragmentMasses::find_fragment(std::int32_t first, std::vector<std::uint8_t>& is_found) {
  struct Member {
    std::int32_t body;
    Vec3 centre;  // in the axes of the first
    Quat turn;
  };
  std::vector<Member> members{{first, {}, {}}};
  is_found[at(first)] = 1;
  bool moves_freely = true;
  double mass = 0;
  Vec3 moment;
  for (std::size_t n = 0; n < members.size(); ++n) {
    const Member m = members[n];
    const Body& body = bodies_[at(m.body)];
    moves_freely = moves_freely && body.moves_freely;
    mass += body.mass;
    moment += body.mass * m.centre;
    for (std::int32_t k = start_[at(m.body)]; k < start_[at(m.body) + 1]; ++k) {
      const Neighbour& next = neighbours_[at(k)];
      if (is_broken_[at(next.bond)] != 0 || is_found[at(next.body)] != 0) continue;
      is_found[at(next.body)] = 1;
      members.push_back({next.body, m.centre + rotate(m.turn, next.centre), normalised(m.turn * next.turn)});
    }
  }
  const bool counts_alone = !moves_freely || members.size() == 1;
  if (counts_alone) {
    for (const Member& m : members) masses_[at(m.body)] = {0, {}, {}, first};
    return;
  }
  const Vec3 centre = (1 / mass) * moment;
  Mat3 inertia;
  for (const Member& m : members) {
    const Body& body = bodies_[at(m.body)];
    const Mat3 own = turned(matrix_of(m.turn), body.inertia);
    for (int i = 0; i < 3; ++i) inertia[i] += own[i];
    add_point(body.mass, m.centre - centre, inertia);
  }
  const Mat3 inverse = inverse_of(inertia);
  for (const Member& m : members) {
    const Mat3 to_member = transpose(matrix_of(m.turn));
    masses_[at(m.body)] = {1 / mass, to_member * (centre - m.centre), to_member * inverse * transpose(to_member), first};
  }
}

const BondedMass* FragmentMasses::of(std::int64_t id) const {
  const auto found = std::lower_bound(ids_.begin(), ids_.end(), id);
  if (found == ids_.end() || *found != id) return nullptr;
  const BondedMass& mass = masses_[static_cast<std::size_t>(found - ids_.begin())];
  return mass.inverse_mass > 0 ? &mass : nullptr;
}

void FragmentMasses::assign_to(ParticleSet& p) const {
  p.bonded.resize(p.size());
  for (std::size_t i = 0; i < p.size(); ++i) p.bonded[i] = of(p.id[i]);
}

}  // namespace scree
