#include "solver/effects/bonds/shared_impact.hpp"

#include <algorithm>
#include <map>
#include <tuple>

namespace scree {

BegunOnFragment begun_on_fragment(const ParticleSet& p, const PairContact& c, const Beginning& begins) {
  const auto a = at(c.pair.a);
  const Vec3 force = c.a_to_world * begins.force, torque = c.a_to_world * begins.torque, place = c.a_to_world * begins.place,
             slip = c.a_to_world * begins.slip, centre_b = c.a_to_world * c.motion.centre_b;
  BegunOnFragment begun;
  begun.first = side_of(p, a, force, torque);
  begun.on_first = place + begins.overlaps * begun.first.from_centre;
  if (c.view.zone == nullptr) {
    begun.second = side_of(p, at(c.pair.b), -force, cross(centre_b, force) - torque);
    begun.on_second = place - begins.overlaps * centre_b + begins.overlaps * begun.second.from_centre;
  } else {
    begun.second = side_of_wall(c.pair.key.b, -force);
  }
  begun.key = c.pair.key;
  begun.overlaps = begins.overlaps;
  begun.speed = begins.speed;
  begun.slip = slip;
  if (begun.second.name() < begun.first.name()) {
    std::swap(begun.first, begun.second);
    std::swap(begun.on_first, begun.on_second);
    begun.slip = -slip;
  }
  return begun;
}

namespace {

/// Of all that begin together between the same two.
std::array<double, kImpactParts> energy_of(const BegunOnFragment* begin, const BegunOnFragment* end) {
  double overlaps = 0, speed = 0;
  Vec3 force[2], torque[2], place[2], slip;
  for (const BegunOnFragment* c = begin; c != end; ++c) {
    overlaps += c->overlaps;
    speed += c->speed;
    slip += c->slip;
    int n = 0;
    for (const FragmentSide* side : {&c->first, &c->second}) {
      force[n] += side->force;
      torque[n++] += side->torque;
    }
    place[0] += c->on_first;
    place[1] += c->on_second;
  }
  std::array<double, kImpactParts> energy{};
  const double mobility = mobility_of(begin->first, force[0], torque[0]) + mobility_of(begin->second, force[1], torque[1]);
  if (mobility > 0) energy[kNormalImpact] = 0.5 * speed * speed / mobility;
  // as in beginning_of(): the mean slip, at the mean place
  const double slides = squared_length(slip);
  if (!(slides > 0)) return energy;
  const double along = mobility_of(begin->first, slip, cross((1 / overlaps) * place[0], slip)) +
                       mobility_of(begin->second, -slip, cross((1 / overlaps) * place[1], -slip));
  const double power = slides / overlaps;
  if (along > 0) energy[kShearImpact] = 0.5 * power * power / along;
  return energy;
}

}  // namespace

std::vector<ShareOfImpact> share_impacts(const RunState& s, const std::vector<BegunOnFragment>& mine) {
  std::vector<BegunOnFragment> all = s.comm.of_all(mine);
  std::sort(all.begin(), all.end(), [](const BegunOnFragment& l, const BegunOnFragment& r) {
    return std::tuple(l.first.name(), l.second.name(), l.key) < std::tuple(r.first.name(), r.second.name(), r.key);
  });
  std::map<PairKey, ShareOfImpact> found;
  for (std::size_t begin = 0, end = 0; begin < all.size(); begin = end) {
    double speed = 0;
    for (; end < all.size() && all[end].first.name() == all[begin].first.name() && all[end].second.name() == all[begin].second.name();
         ++end)
      speed += all[end].speed;
    const std::array<double, kImpactParts> energy = energy_of(&all[begin], &all[begin] + (end - begin));
    for (std::size_t n = begin; n < end; ++n)
      found[all[n].key] = {speed != 0 ? all[n].speed / speed : 1 / static_cast<double>(end - begin), n == begin, energy};
  }
  std::vector<ShareOfImpact> shares;
  shares.reserve(mine.size());
  for (const BegunOnFragment& c : mine) shares.push_back(found.at(c.key));
  return shares;
}

}  // namespace scree
