#include "solver/pair_list.hpp"

#include <algorithm>
#include <tuple>

namespace scree {

namespace {

/// Whether a ball may come within `reach` of a wall zone.
bool near_zone(const SolverScene& scene, const WallZone& zone, const WallState& state, const Vec3& centre, double reach) {
  const Wall& wall = scene.source().walls[static_cast<std::size_t>(zone.wall)];
  const Vec3 p = rotate_inverse(state.orientation, centre - state.position);
  switch (zone.kind) {
    case WallZone::Kind::plane:
      return dot(p - zone.point, zone.direction) < reach;
    case WallZone::Kind::cylinder: {
      const Vec3 r = p - zone.point;
      return zone.radius - length(r - dot(r, zone.direction) * zone.direction) < reach;
    }
    case WallZone::Kind::sphere:
      return zone.radius - length(p - zone.point) < reach;
    case WallZone::Kind::mesh: {
      const SolverShape& shape = scene.shape(wall.shape);
      Vec3 nearest;
      std::int32_t triangle = -1;
      const double bound = reach / wall.scale;
      return point_mesh_distance({&shape.mesh, &shape.bvh}, (1 / wall.scale) * p, bound, nearest, triangle) < bound;
    }
  }
  return false;
}

}  // namespace

std::size_t memory_of(const BodyPair& pair) {
  return sizeof(BodyPair) + sizeof(PairResult) + sizeof(PairRest) + (pair.lists.corners_a.capacity() + pair.lists.corners_b.capacity()) * sizeof(CornerCandidate) +
         pair.lists.edges.capacity() * sizeof(EdgeCandidate) + pair.springs.capacity() * sizeof(FrictionSpring);
}

void PairList::rebuild(const SolverScene& scene, const ParticleSet& p, const std::vector<WallState>& walls, double skin,
                       PhaseTimes& times) {
  const double margin = scene.margin();
  std::vector<double> reach(p.size());
  for (std::size_t i = 0; i < p.size(); ++i) reach[i] = p.radius[i] + margin + 0.5 * skin;
  grid_.build(p.x, reach, scene.periodicity().period());

  // candidate pairs of every body, each thread its own list, joined in body order
  const auto count = static_cast<std::int32_t>(p.size());
  std::vector<std::vector<BodyPair>> found(static_cast<std::size_t>(count));
#pragma omp parallel for schedule(dynamic, 64)
  for (std::int32_t i = 0; i < count; ++i) {
    auto& mine = found[static_cast<std::size_t>(i)];
    const auto row = static_cast<std::size_t>(i);
    grid_.for_each_partner(i, [&](std::int32_t j) {
      const auto other = static_cast<std::size_t>(j);
      if (row >= p.owned && other >= p.owned) return;
      if (p.fixed[row] && p.fixed[other]) return;
      BodyPair pair;
      const bool in_order = p.id[row] < p.id[other];
      pair.a = in_order ? i : j;
      pair.b = in_order ? j : i;
      pair.key = {p.id[static_cast<std::size_t>(pair.a)], p.id[static_cast<std::size_t>(pair.b)], -1};
      mine.push_back(std::move(pair));
    });
    if (row >= p.owned || p.fixed[row]) continue;
    for (std::size_t z = 0; z < scene.zones().size(); ++z) {
      const WallZone& zone = scene.zones()[z];
      const WallState& state = walls[static_cast<std::size_t>(zone.wall)];
      if (!near_zone(scene, zone, state, p.x[row], p.radius[row] + 2 * margin + skin)) continue;
      BodyPair pair;
      pair.a = i;
      pair.b = -1;
      pair.key = {p.id[row], scene.source().walls[static_cast<std::size_t>(zone.wall)].id, static_cast<std::int32_t>(z)};
      mine.push_back(std::move(pair));
    }
  }
  std::vector<BodyPair> next;
  for (auto& mine : found) {
    for (BodyPair& pair : mine) next.push_back(std::move(pair));
  }
  {
    const PhaseTimer timer(times, Phase::sort);
    std::sort(next.begin(), next.end(), [](const BodyPair& l, const BodyPair& r) { return l.key < r.key; });
  }

  // keep what known pairs hold
  std::sort(pending_.begin(), pending_.end(), [](const PendingSprings& l, const PendingSprings& r) { return l.key < r.key; });
  std::size_t known = 0, waiting = 0;
  for (BodyPair& pair : next) {
    while (known < pairs_.size() && pairs_[known].key < pair.key) ++known;
    if (known < pairs_.size() && pairs_[known].key == pair.key) {
      pair.lists = std::move(pairs_[known].lists);
      pair.springs = std::move(pairs_[known].springs);
    }
    while (waiting < pending_.size() && pending_[waiting].key < pair.key) ++waiting;
    if (waiting < pending_.size() && pending_[waiting].key == pair.key && pair.springs.empty()) {
      pair.springs = std::move(pending_[waiting].springs);
    }
  }
  pending_.clear();
  pairs_ = std::move(next);
  results_.assign(pairs_.size(), PairResult{});
  ways_.restart(p);
  rests_.clear();
  for (const BodyPair& pair : pairs_) rests_.push_back({pair.a, pair.b, kNoRest});

  inner_.clear();
  outer_.clear();
  twice_.clear();
  std::vector<std::tuple<std::int32_t, PairKey, std::int32_t>> sides;  // row, (partner first) key, entry
  for (std::size_t k = 0; k < pairs_.size(); ++k) {
    const BodyPair& pair = pairs_[k];
    const auto a = static_cast<std::size_t>(pair.a);
    const bool ghost_b = pair.b >= 0 && static_cast<std::size_t>(pair.b) >= p.owned;
    (a >= p.owned ? twice_ : ghost_b ? outer_ : inner_).push_back(static_cast<std::int32_t>(k));
    const auto entry = static_cast<std::int32_t>(2 * k);
    if (a < p.owned) sides.emplace_back(pair.a, PairKey{pair.key.b, pair.key.a, pair.key.zone}, entry);
    if (pair.b >= 0 && static_cast<std::size_t>(pair.b) < p.owned) {
      sides.emplace_back(pair.b, PairKey{pair.key.a, pair.key.b, pair.key.zone}, entry + 1);
    }
  }
  const PhaseTimer timer(times, Phase::sort);
  std::sort(sides.begin(), sides.end());
  start_.assign(p.owned + 1, 0);
  entry_.clear();
  for (const auto& [row, key, entry] : sides) {
    ++start_[static_cast<std::size_t>(row) + 1];
    entry_.push_back(entry);
  }
  for (std::size_t i = 0; i < p.owned; ++i) start_[i + 1] += start_[i];
}

void PairList::gather(const Vec3& gravity, ParticleSet& p) const {
  const auto count = static_cast<std::ptrdiff_t>(p.owned);
#pragma omp parallel for schedule(static)
  for (std::ptrdiff_t n = 0; n < count; ++n) {
    const auto i = static_cast<std::size_t>(n);
    Vec3 force, torque, lossy_force, lossy_torque;
    for (std::int32_t s = start_[i]; s < start_[i + 1]; ++s) {
      const std::int32_t entry = entry_[static_cast<std::size_t>(s)];
      const PairResult& r = results_[static_cast<std::size_t>(entry / 2)];
      if (!r.active) continue;
      if (entry % 2 == 0) {
        force += r.force_a;
        torque += r.torque_a;
        lossy_force += r.lossy_force_a;
        lossy_torque += r.lossy_torque_a;
      } else {
        force -= r.force_a;
        torque += r.torque_b;
        lossy_force -= r.lossy_force_a;
        lossy_torque += r.lossy_torque_b;
      }
    }
    p.force[i] = force + p.mass[i] * gravity;
    p.torque[i] = torque;
    p.lossy_force[i] = lossy_force;
    p.lossy_torque[i] = lossy_torque;
  }
}

void PairList::forget_candidates() {
  for (BodyPair& pair : pairs_) pair.lists = CandidateLists{};
  for (PairRest& rest : rests_) rest.way = kNoRest;
}

}  // namespace scree
