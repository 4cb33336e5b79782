#include "solver/neighbours/bond_list.hpp"

#include <algorithm>
#include <cmath>
#include <unordered_map>

#include "core/base/error.hpp"
#include "core/base/index.hpp"

namespace scree {

namespace {

/// What two bodies meet in a motion with respect to each other: their masses or moments in series; 0 has the other infinite.
double in_series(double inverse_a, double inverse_b) { return inverse_a + inverse_b > 0 ? 1 / (inverse_a + inverse_b) : 0; }

/// Mean of the three principal inverse moments.
double mean(const Vec3& v) { return (v.x + v.y + v.z) / 3; }

}  // namespace

BondList::BondList(const SolverScene& scene) : scene_(scene), broken_at_(scene.source().bonds.size(), kHolds) {
  for (const Bond& bond : scene.source().bonds) bodies_.insert(bodies_.end(), {bond.a, bond.b});
  std::sort(bodies_.begin(), bodies_.end());
  bodies_.erase(std::unique(bodies_.begin(), bodies_.end()), bodies_.end());
  count_holding();
}

void BondList::count_holding() {
  holding_.clear();
  const std::vector<Bond>& bonds = scene_.source().bonds;
  for (std::size_t k = 0; k < bonds.size(); ++k) {
    if (broken_at_[k] == kHolds) ++holding_[{bonds[k].a, bonds[k].b}];
  }
}

void BondList::set_broken_at(std::vector<std::int64_t> steps) {
  broken_at_ = std::move(steps);
  count_holding();
}

void BondList::mark_broken(std::int32_t bond, std::int64_t step) {
  std::int64_t& broken = broken_at_[at(bond)];
  if (broken != kHolds) return;
  broken = step;
  news_.push_back(bond);
  const Bond& of = scene_.source().bonds[at(bond)];
  const auto found = holding_.find({of.a, of.b});
  if (--found->second == 0) holding_.erase(found);
}

BondLaw BondList::law_of(const ParticleSet& p, const Bond& bond, std::size_t a, std::size_t b) const {
  const Quat &principal_a = scene_.shape(p.shape[a]).body_from_principal, &principal_b = scene_.shape(p.shape[b]).body_from_principal;
  BondLaw law;
  law.arm_a = rotate_inverse(principal_a, bond.point_a);
  law.arm_b = rotate_inverse(principal_b, bond.point_b);
  law.frame_a = conjugate(principal_a) * bond.frame_a;
  law.frame_b = conjugate(principal_b) * bond.frame_b;
  const double kn = bond.normal_stiffness, kt = bond.tangential_stiffness;
  law.push = bond.area * Vec3{kn, kt, kt};
  law.turn = {kt * (bond.moment_1 + bond.moment_2), kn * bond.moment_1, kn * bond.moment_2};
  const double mass = in_series(p.inverse_mass[a], p.inverse_mass[b]);
  const double moment = in_series(mean(p.inverse_inertia[a]), mean(p.inverse_inertia[b]));
  for (int k = 0; k < 3; ++k) {
    law.push_damping[k] = 2 * bond.damping * std::sqrt(law.push[k] * mass);
    law.turn_damping[k] = 2 * bond.damping * std::sqrt(law.turn[k] * moment);
  }
  return law;
}

void BondList::list(const ParticleSet& p) {
  listed_.clear();
  const std::vector<Bond>& bonds = scene_.source().bonds;
  std::unordered_map<std::int64_t, std::int32_t> row_of;
  for (std::size_t i = 0; i < p.size(); ++i) {
    if (std::binary_search(bodies_.begin(), bodies_.end(), p.id[i])) row_of.emplace(p.id[i], static_cast<std::int32_t>(i));
  }
  for (std::size_t k = 0; k < bonds.size(); ++k) {
    if (broken_at_[k] != kHolds) continue;
    const auto a = row_of.find(bonds[k].a), b = row_of.find(bonds[k].b);
    const bool owns_a = a != row_of.end() && at(a->second) < p.owned, owns_b = b != row_of.end() && at(b->second) < p.owned;
    if (!owns_a && !owns_b) continue;
    if (a == row_of.end() || b == row_of.end()) {
      throw RunInvalid("bond {} of bodies {} and {}: body {} is out of reach of the rank that owns the other", k, bonds[k].a, bonds[k].b,
                       a == row_of.end() ? bonds[k].a : bonds[k].b);
    }
    listed_.push_back({static_cast<std::int32_t>(k), a->second, b->second, law_of(p, bonds[k], at(a->second), at(b->second))});
  }
  forces_.assign(listed_.size(), {});
  counted_.clear();
  for (const ListedBond& bond : listed_) counted_.push_back(counts_here(bond, p) ? 1 : 0);

  // which body gets which force, in ascending order of bonds
  std::map<std::int32_t, std::vector<std::int32_t>> of_row;
  for (std::size_t k = 0; k < listed_.size(); ++k) {
    if (at(listed_[k].a) < p.owned) of_row[listed_[k].a].push_back(static_cast<std::int32_t>(2 * k));
    if (at(listed_[k].b) < p.owned) of_row[listed_[k].b].push_back(static_cast<std::int32_t>(2 * k + 1));
  }
  rows_.clear();
  entry_.clear();
  start_.assign(1, 0);
  for (const auto& [row, entries] : of_row) {
    rows_.push_back(row);
    entry_.insert(entry_.end(), entries.begin(), entries.end());
    start_.push_back(static_cast<std::int32_t>(entry_.size()));
  }
}

BondMotion BondList::motion_of(const ParticleSet& p, const ListedBond& bond) const {
  const std::size_t a = at(bond.a), b = at(bond.b);
  const Vec3 branch = p.x[b] - p.x[a];
  return {scene_.periodicity().any() ? scene_.periodicity().nearest(branch) : branch, p.q[a], p.q[b], p.v[a], p.v[b], p.w[a], p.w[b]};
}

void BondList::compute(const ParticleSet& p) {
  const auto count = static_cast<std::ptrdiff_t>(listed_.size());
#pragma omp parallel for schedule(static)
  for (std::ptrdiff_t k = 0; k < count; ++k) {
    const ListedBond& bond = listed_[static_cast<std::size_t>(k)];
    forces_[static_cast<std::size_t>(k)] = is_broken(bond) ? BondForce{} : bond_force(bond.law, motion_of(p, bond));
  }
}

void BondList::forget(const std::vector<std::size_t>& listed) {
  for (const std::size_t k : listed) forces_[k] = {};
}

void BondList::sum_onto_bodies(ParticleSet& p) const {
  const auto count = static_cast<std::ptrdiff_t>(rows_.size());
#pragma omp parallel for schedule(static)
  for (std::ptrdiff_t n = 0; n < count; ++n) {
    const std::size_t i = at(rows_[static_cast<std::size_t>(n)]);
    for (std::int32_t s = start_[static_cast<std::size_t>(n)]; s < start_[static_cast<std::size_t>(n) + 1]; ++s) {
      const std::int32_t entry = entry_[at(s)];
      const BondForce& f = forces_[at(entry / 2)];
      const bool is_a = entry % 2 == 0;
      const double side = is_a ? 1 : -1;
      p.force[i] += side * f.force_a;
      p.torque[i] += is_a ? f.torque_a : f.torque_b;
      p.dissipative_force[i] += side * f.dissipative_force_a;
      p.dissipative_torque[i] += is_a ? f.dissipative_torque_a : f.dissipative_torque_b;
    }
  }
}

std::vector<std::size_t> BondList::overloaded() const {
  std::vector<std::size_t> broken;
  for (std::size_t k = 0; k < listed_.size(); ++k) {
    // not a number breaks nothing: the guard of the bodies tells where it comes from
    if (!is_broken(listed_[k]) && bond_load(scene_.source().bonds[at(listed_[k].bond)], forces_[k]) >= 1) broken.push_back(k);
  }
  return broken;
}

double BondList::farthest_gap(const ParticleSet& p) const {
  double farthest = 0;
  for (const ListedBond& bond : listed_) {
    if (is_broken(bond)) continue;
    const double distance = length(motion_of(p, bond).branch);
    farthest = std::max(farthest, distance - p.radius[at(bond.a)] - p.radius[at(bond.b)]);
  }
  return farthest;
}

double BondList::farthest_gap(const std::map<std::int64_t, Vec3>& places, const std::map<std::int64_t, double>& radii) const {
  double farthest = 0;
  const std::vector<Bond>& bonds = scene_.source().bonds;
  for (std::size_t k = 0; k < bonds.size(); ++k) {
    if (broken_at_[k] != kHolds) continue;
    const auto a = places.find(bonds[k].a), b = places.find(bonds[k].b);
    if (a == places.end() || b == places.end()) continue;
    const double distance = length(scene_.periodicity().nearest(b->second - a->second));
    farthest = std::max(farthest, distance - radii.at(bonds[k].a) - radii.at(bonds[k].b));
  }
  return farthest;
}

}  // namespace scree
