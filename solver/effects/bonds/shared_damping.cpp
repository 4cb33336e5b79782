#include "solver/effects/bonds/shared_damping.hpp"

#include <algorithm>
#include <map>
#include <tuple>

#include "core/base/index.hpp"
#include "solver/effects/bonds/fragment_side.hpp"

namespace scree {

namespace {

/// A pair that presses, with a fragment on one side at least.
struct Pressing {
  FragmentSide first, second;  ///< by name
  PairKey key;
  double energy;  ///< [J]
};

/// What several contacts of the same two make together.
struct Together {
  double energy = 0, size = 0;  ///< [J]; sum of the sizes of forces [N]
  Vec3 force[2], torque[2];
  void add(const Pressing& c) {
    energy += c.energy;
    size += length(c.first.force);
    int n = 0;
    for (const FragmentSide* side : {&c.first, &c.second}) {
      force[n] += side->force;
      torque[n++] += side->torque;
    }
  }
  /// Energy times mobility; sides are those of any of the contacts.
  double product(const Pressing& like) const {
    const double moved = mobility_of(like.first, force[0], torque[0]) + mobility_of(like.second, force[1], torque[1]);
    return energy * std::max(like.first.inverse_mass + like.second.inverse_mass, moved / (size * size));
  }
};

std::vector<Pressing> pressing_here(const RunState& s) {
  const ParticleSet& p = s.particles;
  std::vector<Pressing> all;
  for (std::size_t k = 0; k < s.pairs.pairs().size(); ++k) {
    const BodyPair& pair = s.pairs.pairs()[k];
    const PairResult& r = s.pairs.results()[k];
    if (!r.active || !(r.elastic > 0) || !counts_here(pair, p)) continue;
    const std::size_t a = at(pair.a);
    const BondedMass *of_a = p.bonded[a], *of_b = pair.b >= 0 ? p.bonded[at(pair.b)] : nullptr;
    if ((of_a == nullptr && of_b == nullptr) || (of_a != nullptr && of_b != nullptr && of_a->fragment == of_b->fragment)) continue;
    const Vec3 force = r.force_a - r.dissipative_force_a;
    if (!(squared_length(force) > 0)) continue;
    Pressing c{side_of(p, a, force, r.torque_a - r.dissipative_torque_a), {}, pair.key, r.elastic};
    if (pair.b >= 0) {
      c.second = side_of(p, at(pair.b), -force, r.torque_b - r.dissipative_torque_b);
    } else {
      c.second = side_of_wall(pair.key.b, -force);
    }
    if (c.second.name() < c.first.name()) std::swap(c.first, c.second);
    all.push_back(c);
  }
  return all;
}

}  // namespace

void share_damping(RunState& s) {
  if (!s.fragments || s.clock.substep != 0 || s.clock.step % kReviewSteps != 0) return;
  std::vector<Pressing> all = s.comm.of_all(pressing_here(s));
  std::sort(all.begin(), all.end(), [](const Pressing& l, const Pressing& r) {
    return std::tuple(l.first.name(), l.second.name(), l.key) < std::tuple(r.first.name(), r.second.name(), r.key);
  });
  std::map<PairKey, double> shares;
  for (std::size_t begin = 0, end = 0; begin < all.size(); begin = end) {
    Together together;
    for (; end < all.size() && all[end].first.name() == all[begin].first.name() && all[end].second.name() == all[begin].second.name();
         ++end)
      together.add(all[end]);
    if (end - begin < 2) continue;
    // the mean over the pieces: bonds give way, so that each knows the moments of its fragment a little otherwise, and which is first
    // depends on the order of bodies
    double product = 0;
    for (std::size_t n = begin; n < end; ++n) product += together.product(all[n]);
    product /= static_cast<double>(end - begin);
    for (std::size_t n = begin; n < end; ++n) {
      Together alone;
      alone.add(all[n]);
      shares[all[n].key] = product / alone.product(all[n]);
    }
  }
  for (BodyPair& pair : s.pairs.pairs()) {
    const auto found = shares.find(pair.key);
    if (found != shares.end() && found->second != 1)
      remember(pair.state.springs, DampingShare{found->second});
    else
      forget<DampingShare>(pair.state.springs);
  }
}

}  // namespace scree
