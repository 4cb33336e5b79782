#include "solver/effects/bonds/shared_damping.hpp"

#include <algorithm>
#include <map>
#include <tuple>

#include "core/base/index.hpp"
#include "solver/contact/damping_share.hpp"

namespace scree {

namespace {

/// One side of a contact as a whole: a fragment, a body, or a wall, which does not move. World axes.
struct Side {
  std::int64_t kind = 0, id = 0;  ///< 0 fragment, 1 body, 2 wall
  double inverse_mass = 0;        ///< [1/kg]
  Mat3 inverse_inertia;           ///< about its centre [1/(kg m^2)]
  Vec3 force, torque;             ///< elastic, about its centre
  std::tuple<std::int64_t, std::int64_t> name() const { return {kind, id}; }
};

/// A pair that presses, with a fragment on one side at least.
struct Pressing {
  Side first, second;  ///< by name
  PairKey key;
  double energy;  ///< [J]
};

/// R m R^T.
Mat3 turned(const Mat3& r, const Mat3& m) { return r * m * transpose(r); }

Side side_of(const ParticleSet& p, std::size_t i, const Vec3& force, const Vec3& torque) {
  const Mat3 r = matrix_of(p.q[i]);
  Side side;
  side.force = force;
  if (const BondedMass* bonded = p.bonded[i]; bonded != nullptr) {
    side.id = bonded->fragment;
    side.inverse_mass = bonded->inverse_mass;
    side.inverse_inertia = turned(r, bonded->inverse_inertia);
    side.torque = torque - cross(r * bonded->centre, force);
    return side;
  }
  side.kind = 1;
  side.id = p.id[i];
  side.inverse_mass = p.inverse_mass[i];
  const Vec3& w = p.inverse_inertia[i];
  side.inverse_inertia = turned(r, Mat3{{Vec3{w.x, 0, 0}, Vec3{0, w.y, 0}, Vec3{0, 0, w.z}}});
  side.torque = torque;
  return side;
}

/// Inverse mass that a sum of wrenches moves, over the square of the sum of forces, times that square [N^2/kg].
double mobility_of(const Side& like, const Vec3& force, const Vec3& torque) {
  return like.inverse_mass * squared_length(force) + dot(torque, like.inverse_inertia * torque);
}

/// What several contacts of the same two make together.
struct Together {
  double energy = 0, size = 0;  ///< [J]; sum of the sizes of forces [N]
  Vec3 force[2], torque[2];
  void add(const Pressing& c) {
    energy += c.energy;
    size += length(c.first.force);
    int n = 0;
    for (const Side* side : {&c.first, &c.second}) {
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
      c.second.kind = 2;
      c.second.id = pair.key.b;  // all zones of a wall are one partner
      c.second.force = -force;
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
    for (std::size_t n = begin; n < end; ++n) {
      Together alone;
      alone.add(all[n]);
      shares[all[n].key] = together.product(all[begin]) / alone.product(all[n]);
    }
  }
  for (BodyPair& pair : s.pairs.pairs()) {
    const auto found = shares.find(pair.key);
    set_damping_share(pair.state.springs, found != shares.end() ? found->second : 1);
  }
}

}  // namespace scree
