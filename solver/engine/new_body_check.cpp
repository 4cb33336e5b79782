#include "solver/engine/new_body_check.hpp"

#include <algorithm>
#include <cmath>

#include "core/base/units.hpp"
#include "solver/features/pair_features.hpp"
#include "solver/scene/body_size.hpp"
#include "solver/step/domain.hpp"

namespace scree {

namespace {

std::string place_text(const Vec3& x) { return fmt::format("({:.6g} {:.6g} {:.6g}) m", x.x, x.y, x.z); }

/// Throws for a body whose centre is outside a domain that keeps none there.
void check_place(const SolverScene& scene, const Vec3& x, std::size_t number, const Vec3& origin) {
  const Domain& domain = scene.source().settings.domain;
  if (domain.outside == Outside::keep || !is_outside(scene, x)) return;
  throw UsageError(
      "insert: body {} of this call: position {} is outside the domain of the scene, which reaches from {} to {}; give a place within it, "
      "or "
      "widen domain in the case",
      number, place_text(x + origin), place_text(domain.lower + origin), place_text(domain.upper + origin));
}

}  // namespace

/// A new body, and what it overlaps.
struct NewBodyCheck::Overlap {
  std::int64_t body, other;  ///< ids; other -1: a wall
  std::int32_t wall;
  double depth, radius;  ///< [m]; of the smaller of both
  bool is_within;        ///< deeper than any contact: a contact has no direction there
  Vec3 place;            ///< of the new body

  bool is_worse_than(const Overlap& o) const {
    if (is_within != o.is_within) return is_within;
    const double mine = depth / radius, theirs = o.depth / o.radius;
    return mine != theirs ? mine > theirs : body != o.body ? body < o.body : other < o.other;
  }
};

NewBodyCheck::NewBodyCheck(const SolverScene& scene) : scene_(scene), scratch_(make_mesh_distance_scratch()) {}

PlacedBody NewBodyCheck::placed(const ParticleRecord& r) const {
  return {&shapes_[static_cast<std::size_t>(r.shape)], r.scale, r.x, mesh_orientation(scene_, r.shape, r.q)};
}

void NewBodyCheck::add_overlap(const ParticleRecord& body, const ParticleRecord& other, std::vector<Overlap>& found) {
  const PlacedBody mine = placed(body);
  PlacedBody theirs = placed(other);
  const Vec3 apart = scene_.periodicity().nearest(theirs.position - mine.position);
  const double reach = mine.radius() + theirs.radius();
  if (squared_length(apart) >= reach * reach) return;
  theirs.position = mine.position + apart;
  const double radius = std::min(mine.radius(), theirs.radius()), least = kTouch * radius;
  const double gap = gap_between(theirs, mine, least, *scratch_);
  const bool is_within = gap == kIntersect;
  if (!is_within && gap > -kOverlapWorthWarning * radius) return;
  found.push_back({body.id, other.id, -1, is_within ? radius : -gap, radius, is_within, body.x});
}

void NewBodyCheck::add_overlap_of_walls(const RunState& s, const ParticleRecord& body, std::vector<Overlap>& found) {
  const PlacedBody mine = placed(body);
  const double radius = mine.radius(), least = kTouch * radius;
  mine.world_vertices(vertices_);
  for (const WallZone& zone : scene_.zones()) {
    const auto w = static_cast<std::size_t>(zone.wall);
    const Wall& wall = scene_.source().walls[w];
    const WallState& state = s.walls[w];
    double gap = least;
    if (zone.kind == WallZone::Kind::mesh) {
      const PlacedBody mesh{&shapes_[static_cast<std::size_t>(wall.shape)], wall.scale, state.position, state.orientation};
      gap = gap_between(mesh, mine, least, *scratch_);
    } else {
      for (const Vec3& p : vertices_) {
        Vec3 normal;
        gap = std::min(gap, zone_gap(zone, rotate_inverse(state.orientation, p - state.position), normal) - mine.rounding());
      }
    }
    if (gap > -kOverlapWorthWarning * radius) continue;
    const bool is_within = gap == kIntersect || gap < -radius;
    found.push_back({body.id, -1, zone.wall, gap == kIntersect ? radius : -gap, radius, is_within, body.x});
  }
}

NewBodyCheck::Warning NewBodyCheck::check(const RunState& s, std::vector<ParticleRecord>& mine, const std::vector<ParticleRecord>& waiting,
                                          const std::unordered_set<std::int64_t>& leaving, const Vec3& origin) {
  // 1. each by itself
  mpi::on_all(s.comm, [&] {
    for (std::size_t k = 0; k < mine.size(); ++k) {
      check_place(scene_, mine[k].x, k, origin);
      Vec3 image;
      scene_.periodicity().wrap(mine[k].x, image);
      const ParticleRecord& r = mine[k];
      if (const std::string fault = size_fault(scene_, r.shape, r.material, r.scale); !fault.empty())
        throw UsageError("insert: body {} of this call: scale {:g} of shape '{}': {}", k, r.scale,
                         scene_.source().shapes[static_cast<std::size_t>(r.shape)].name, fault);
    }
  });

  // 2. against bodies of the run, walls, and each other: each rank has its own bodies, and its share of the rest
  std::vector<ParticleRecord> all = s.comm.of_all(mine);
  const std::vector<ParticleRecord> before = s.comm.of_all(waiting);
  if (all.empty()) return {};
  if (shapes_.empty())
    for (const Shape& shape : scene_.source().shapes) shapes_.push_back(make_pack_shape(shape, scene_.source().settings));
  std::sort(all.begin(), all.end(), [](const ParticleRecord& l, const ParticleRecord& r) { return l.id < r.id; });
  Box3 box;
  double largest = 0;
  for (const ParticleRecord& body : all) {
    const double r = placed(body).radius();
    largest = std::max(largest, r);
    box.add(body.x);
  }
  std::vector<Overlap> found;
  const ParticleSet& p = s.particles;
  const Vec3 centre = box.centre(), half = 0.5 * box.extent();
  for (std::size_t i = 0; i < p.owned; ++i) {
    const Vec3 apart = scene_.periodicity().nearest(p.x[i] - centre);
    const double reach = p.radius[i] + largest;
    if (std::abs(apart.x) > half.x + reach || std::abs(apart.y) > half.y + reach || std::abs(apart.z) > half.z + reach) continue;
    if (leaving.contains(p.id[i])) continue;
    const ParticleRecord there = record_of(p, i);
    for (const ParticleRecord& body : all) add_overlap(body, there, found);
  }
  const auto ranks = static_cast<std::size_t>(s.comm.size()), me = static_cast<std::size_t>(s.comm.rank());
  for (std::size_t k = me; k < all.size(); k += ranks) {
    add_overlap_of_walls(s, all[k], found);
    for (const ParticleRecord& other : before) add_overlap(all[k], other, found);
    for (std::size_t j = 0; j < k; ++j) add_overlap(all[k], all[j], found);
  }

  // 3. the worst of all ranks
  found = s.comm.of_all(found);
  if (found.empty()) return {};
  const Overlap worst =
      *std::min_element(found.begin(), found.end(), [](const Overlap& l, const Overlap& r) { return l.is_worse_than(r); });
  std::unordered_set<std::int64_t> bodies;
  for (const Overlap& o : found) bodies.insert(o.body);
  const std::string number =
      fmt::format("body {} of {} of this call, at {},", worst.body - all.front().id, all.size(), place_text(worst.place + origin));
  const std::string partner = worst.wall >= 0 ? fmt::format("wall '{}'", scene_.source().walls[static_cast<std::size_t>(worst.wall)].name)
                              : worst.other >= all.front().id ? fmt::format("body {} of this call", worst.other - all.front().id)
                                                              : fmt::format("body {}", worst.other);
  if (worst.is_within) {
    mpi::on_root(s.comm, [&] {
      throw UsageError("insert: {} {} {}; give a free place, or remove what is there in the same step", number,
                       worst.wall >= 0 ? "is behind the surface of" : "lies within", partner);
    });
  }
  Warning warning{worst.depth / worst.radius, {}};
  warning.text = fmt::format(
      "insert: {} of {} bodies overlap others or walls by more than {:g} % of a radius; the worst is {} with {}: by {} ({:.0f} % of the "
      "radius of the smaller "
      "one). They begin with the contact force of that overlap; give free places. A further call is reported when its worst overlap is at "
      "least twice as large",
      bodies.size(), all.size(), 100 * kOverlapWorthWarning, number, partner, format_quantity(worst.depth, Dimension::length),
      100 * worst.depth / worst.radius);
  return warning;
}

}  // namespace scree
