#include "solver/neighbours/pair_list.hpp"

#include <omp.h>

#include <algorithm>
#include <utility>

#include "solver/contact/ball_contact.hpp"
#include "solver/neighbours/sheared_images.hpp"

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
      const SolverShape& shape = scene.wall_shape(zone.wall);
      Vec3 nearest;
      std::int32_t triangle = -1;
      const double bound = reach / wall.scale;
      return point_mesh_distance({&shape.mesh, &shape.bvh}, (1 / wall.scale) * p, bound, nearest, triangle) < bound;
    }
  }
  return false;
}

/// Each thread sorts a part; then neighbouring parts are merged, half as many each time. Keys differ: the order is unique.
template <class Item, class Less>
void sort_in_parallel(std::vector<Item>& items, const Less& less) {
  constexpr std::size_t kWorthAThread = 4096;
  const std::size_t parts = std::clamp<std::size_t>(items.size() / kWorthAThread, 1, static_cast<std::size_t>(omp_get_max_threads()));
  const auto at = [&](std::size_t part) {
    return items.begin() + static_cast<std::ptrdiff_t>(std::min(part, parts) * items.size() / parts);
  };
#pragma omp parallel for schedule(static, 1)
  for (std::size_t part = 0; part < parts; ++part) std::sort(at(part), at(part + 1), less);
  for (std::size_t width = 1; width < parts; width *= 2) {
#pragma omp parallel for schedule(static, 1)
    for (std::size_t part = 0; part < parts; part += 2 * width) std::inplace_merge(at(part), at(part + width), at(part + 2 * width), less);
  }
}

}  // namespace

std::size_t memory_of_candidates(const BodyPair& pair) {
  if (pair.lists == nullptr) return 0;
  const CandidateLists& lists = *pair.lists;
  return (lists.corners_a.capacity() + lists.corners_b.capacity()) * sizeof(CornerCandidate) +
         lists.edges.capacity() * sizeof(EdgeCandidate) + lists.slacks.capacity() * sizeof(float);
}

std::size_t memory_of(const BodyPair& pair) {
  return sizeof(BodyPair) + sizeof(PairResult) + sizeof(IdlePair) + (pair.lists == nullptr ? 0 : sizeof(CandidateLists)) +
         memory_of_candidates(pair) + pair.state.memory();
}

std::vector<NearPair> find_near_pairs(const SolverScene& scene, const ParticleSet& p, const std::vector<WallState>& walls, double range,
                                      double skin, MultilevelGrid& grid, PhaseTimes& times) {
  std::vector<double> reach(p.size());
  for (std::size_t i = 0; i < p.size(); ++i) reach[i] = p.radius[i] + range + 0.5 * skin;
  const Periodicity& cell = p.cell.periodicity();
  grid.build(p.x, reach, cell.is_sheared() ? Vec3{cell.period().x, 0, 0} : cell.period());
  const double farthest = cell.is_sheared() && !reach.empty() ? *std::max_element(reach.begin(), reach.end()) : 0;
  const auto count = static_cast<std::int32_t>(p.size());
  std::vector<std::vector<NearPair>> of_thread(static_cast<std::size_t>(omp_get_max_threads()));
#pragma omp parallel
  {
    std::vector<NearPair> mine;
#pragma omp for schedule(dynamic, 64) nowait
    for (std::int32_t place = 0; place < count; ++place) {
      const std::int32_t i = grid.order()[static_cast<std::size_t>(place)];
      const auto row = static_cast<std::size_t>(i);
      const auto keep = [&](std::int32_t j) {
        const auto other = static_cast<std::size_t>(j);
        if (row >= p.owned && other >= p.owned) return;
        if (p.fixed[row] && p.fixed[other]) return;
        const bool in_order = p.id[row] < p.id[other];
        const std::int32_t a = in_order ? i : j, b = in_order ? j : i;
        mine.push_back({{p.id[static_cast<std::size_t>(a)], p.id[static_cast<std::size_t>(b)], -1}, a, b});
      };
      grid.for_each_partner_at(place, keep);
      if (cell.is_sheared()) for_each_across_sheared(grid, cell, p.x[row], reach[row], farthest, keep);
      if (row >= p.owned || (p.fixed[row] && !scene.has_answering_walls())) continue;
      for (std::size_t z = 0; z < scene.zones().size(); ++z) {
        const WallZone& zone = scene.zones()[z];
        if (p.fixed[row] && scene.drive(static_cast<std::size_t>(zone.wall)) == nullptr) continue;
        const WallState& state = walls[static_cast<std::size_t>(zone.wall)];
        if (!near_zone(scene, zone, state, p.x[row], p.radius[row] + 2 * range + skin)) continue;
        mine.push_back({{p.id[row], scene.source().walls[static_cast<std::size_t>(zone.wall)].id, static_cast<std::int32_t>(z)}, i, -1});
      }
    }
    of_thread[static_cast<std::size_t>(omp_get_thread_num())] = std::move(mine);
  }
  std::vector<NearPair> found = std::move(of_thread[0]);
  for (std::size_t t = 1; t < of_thread.size(); ++t) found.insert(found.end(), of_thread[t].begin(), of_thread[t].end());
  const PhaseTimer timer(times, Phase::sort);
  sort_in_parallel(found, [](const NearPair& l, const NearPair& r) { return l.key < r.key; });
  return found;
}

void PairList::rebuild(const SolverScene& scene, const ParticleSet& p, const std::vector<WallState>& walls, double skin,
                       PhaseTimes& times) {
  const std::vector<NearPair> found = find_near_pairs(scene, p, walls, scene.contact_range(), skin, grid_, times);

  // keep what known pairs hold
  write_back();
  merge(waiting_);
  const auto count = static_cast<std::ptrdiff_t>(found.size());
  std::vector<BodyPair> next(found.size());
  results_.resize(found.size());
  idle_.resize(found.size());
#pragma omp parallel
  {
    // each thread takes a run of keys, and looks up where the known ones begin only once
    std::size_t known = pairs_.size(), waiting = waiting_.size();
    bool begun = false;
#pragma omp for schedule(static)
    for (std::ptrdiff_t n = 0; n < count; ++n) {
      const auto k = static_cast<std::size_t>(n);
      BodyPair& pair = next[k];
      pair.key = found[k].key;
      pair.a = found[k].a;
      pair.b = found[k].b;
      if (!begun) {
        const auto before = [](const auto& item, const PairKey& key) { return item.key < key; };
        known = static_cast<std::size_t>(std::lower_bound(pairs_.begin(), pairs_.end(), pair.key, before) - pairs_.begin());
        waiting = static_cast<std::size_t>(std::lower_bound(waiting_.begin(), waiting_.end(), pair.key, before) - waiting_.begin());
        begun = true;
      }
      while (known < pairs_.size() && pairs_[known].key < pair.key) ++known;
      if (known < pairs_.size() && pairs_[known].key == pair.key) {
        pair.lists = std::move(pairs_[known].lists);
        pair.state = std::exchange(pairs_[known].state, {});
      }
      while (waiting < waiting_.size() && waiting_[waiting].key < pair.key) ++waiting;
      if (waiting < waiting_.size() && waiting_[waiting].key == pair.key && pair.state.empty()) {
        pair.state = std::exchange(waiting_[waiting].state, {});
      }
      results_[k] = PairResult{};
      idle_[k] = {pair.a, pair.b, kNeverIdle};
    }
  }
  // what lasts waits until its bodies are near again; a body asleep is no longer held by one that is not near
  std::erase_if(waiting_, [](WaitingState& w) {
    w.state.kept.clear();
    return !w.state.keep_lasting();
  });
  for (BodyPair& pair : pairs_) {
    pair.state.kept.clear();
    if (pair.state.keep_lasting()) waiting_.push_back({pair.key, std::move(pair.state)});
  }
  pairs_ = std::move(next);
  const double largest = p.radius.empty() ? 0 : *std::max_element(p.radius.begin(), p.radius.end());
  travel_.restart(p, longest_branch(largest, scene.contact_range(), skin));

  inner_.clear();
  outer_.clear();
  duplicated_.clear();
  with_walls_.clear();
  zones_of_walls_.clear();
  for (std::size_t k = 0; k < pairs_.size(); ++k) {
    const BodyPair& pair = pairs_[k];
    if (pair.key.zone >= 0) {
      with_walls_.push_back(static_cast<std::int32_t>(k));
      zones_of_walls_.push_back(pair.key.zone);
    }
    list_of(pair, p).push_back(static_cast<std::int32_t>(k));
  }
  const PhaseTimer timer(times, Phase::sort);
  sort_sides(p);
}

/// The pairs of every owned body in ascending order of its partner. Pairs lie by (a, b, zone): taken first as B, then as A, a body's
/// partners are in order already, but for walls with an id below its own.
void PairList::sort_sides(const ParticleSet& p) {
  start_.assign(p.owned + 1, 0);
  const auto is_owned = [&p](std::int32_t row) { return row >= 0 && static_cast<std::size_t>(row) < p.owned; };
  for (const IdlePair& pair : idle_) {
    for (const std::int32_t row : {pair.a, pair.b}) {
      if (is_owned(row)) ++start_[static_cast<std::size_t>(row) + 1];
    }
  }
  for (std::size_t i = 0; i < p.owned; ++i) start_[i + 1] += start_[i];
  entry_.resize(static_cast<std::size_t>(start_[p.owned]));
  std::vector<std::int32_t> next(start_.begin(), start_.end() - 1);
  for (const std::int32_t side : {1, 0}) {
    for (std::size_t k = 0; k < idle_.size(); ++k) {
      const std::int32_t row = side == 1 ? idle_[k].b : idle_[k].a;
      if (is_owned(row)) entry_[static_cast<std::size_t>(next[static_cast<std::size_t>(row)]++)] = static_cast<std::int32_t>(2 * k) + side;
    }
  }
  const auto partner_of = [this](std::int32_t entry) {
    const PairKey& key = pairs_[static_cast<std::size_t>(entry / 2)].key;
    return std::pair(entry % 2 == 0 ? key.b : key.a, key.zone);
  };
  const auto count = static_cast<std::ptrdiff_t>(p.owned);
#pragma omp parallel for schedule(static)
  for (std::ptrdiff_t n = 0; n < count; ++n) {
    const auto i = static_cast<std::size_t>(n);
    std::sort(entry_.begin() + start_[i], entry_.begin() + start_[i + 1],
              [&](std::int32_t l, std::int32_t r) { return partner_of(l) < partner_of(r); });
  }
}

void PairList::set_axes_of_springs(const SolverScene& scene, const ParticleSet& p) {
  write_back();
  const auto is_ball = [&p](std::int32_t row) { return p.ball_radius[static_cast<std::size_t>(row)] > 0; };
  for (BodyPair& pair : pairs_) {
    if (!is_ball(pair.a) || (pair.b >= 0 && !is_ball(pair.b))) continue;
    scree::set_axes_of_springs(is_ball_contact(scene, p, pair.a, pair.b, pair.key.zone), p.q[static_cast<std::size_t>(pair.a)],
                               pair.state.springs);
  }
}

void PairList::fill_blocks(const SolverScene& scene, const ParticleSet& p, PairClass which) {
  const BallScene of_balls{p, p.cell.periodicity(), scene.ball_laws()};
  if (blocks_.are_filled()) {
    std::vector<std::int32_t>& begun = begun_[static_cast<std::size_t>(which)];
    if (begun.empty()) return;
    blocks_.add(which, begun, of_balls, pairs_);
    list_due_of(begun, p);
    begun.clear();
    return;
  }
  blocks_.fill(of_balls, {inner_, outer_, duplicated_}, pairs_, idle_);
  due_.resize(entry_.size() + 1);  // so that there is an address past the last
  due_count_.resize(start_.size() - 1);
  due_others_.resize(start_.size() - 1);
  const auto count = static_cast<std::ptrdiff_t>(due_count_.size());
#pragma omp parallel for schedule(static)
  for (std::ptrdiff_t i = 0; i < count; ++i) list_due(static_cast<std::size_t>(i));
}

const PairResult& PairList::result_of(std::int32_t k, PairResult& room) const {
  const std::int32_t place = blocks_.are_filled() ? blocks_.place_of(k) : BallBlocks::kOther;
  if (place < 0) return results_[static_cast<std::size_t>(k)];
  room.active = blocks_.touches(place);
  if (room.active) blocks_.load_result(place, room);
  return room;
}

void PairList::list_due(std::size_t row) {
  std::int32_t* const due = &due_[static_cast<std::size_t>(start_[row])];
  std::int32_t count = 0;
  due_others_[row] = 0;
  for (std::int32_t s = start_[row]; s < start_[row + 1]; ++s) {
    const std::int32_t entry = entry_[static_cast<std::size_t>(s)], place = blocks_.place_of(entry / 2);
    if (place == BallBlocks::kWaits) continue;
    due[count++] = place >= 0 ? 2 * place + entry % 2 : -1 - entry;
    if (place < 0) due_others_[row] = 1;
  }
  due_count_[row] = count;
}

void PairList::list_due_of(std::span<const std::int32_t> pairs, const ParticleSet& p) {
  for (const std::int32_t k : pairs) {
    for (const std::int32_t row : {idle_[static_cast<std::size_t>(k)].a, idle_[static_cast<std::size_t>(k)].b})
      if (static_cast<std::size_t>(row) < p.owned) list_due(static_cast<std::size_t>(row));
  }
}

void PairList::take_out_of_blocks(PairClass which, std::span<const std::int32_t> begun, std::span<const std::int32_t> left,
                                  const ParticleSet& p) {
  for (const std::span<const std::int32_t> pairs : {begun, left}) {
    blocks_.take_out(which, pairs);
    list_due_of(pairs, p);
  }
  // a pass may be in two parts
  std::vector<std::int32_t>& all = begun_[static_cast<std::size_t>(which)];
  all.insert(all.end(), begun.begin(), begun.end());
  std::sort(all.begin(), all.end());
}

void PairList::hold_apart(const std::function<bool(const PairKey&)>& which) {
  write_back();
  for (std::vector<std::int32_t>* list : {&inner_, &outer_, &duplicated_})
    std::erase_if(*list, [&](std::int32_t k) { return which(pairs_[static_cast<std::size_t>(k)].key); });
}

std::int32_t PairList::let_touch(const PairKey& key, const ParticleSet& p) {
  write_back();
  const auto found =
      std::lower_bound(pairs_.begin(), pairs_.end(), key, [](const BodyPair& pair, const PairKey& k) { return pair.key < k; });
  if (found == pairs_.end() || found->key != key) return -1;
  const auto k = static_cast<std::int32_t>(found - pairs_.begin());
  std::vector<std::int32_t>& list = list_of(*found, p);
  list.insert(std::lower_bound(list.begin(), list.end(), k), k);
  return k;
}

std::vector<std::int32_t>& PairList::list_of(const BodyPair& pair, const ParticleSet& p) {
  const bool ghost_b = pair.b >= 0 && static_cast<std::size_t>(pair.b) >= p.owned;
  return static_cast<std::size_t>(pair.a) >= p.owned ? duplicated_ : ghost_b ? outer_ : inner_;
}

void PairList::forget_candidates() {
  write_back();
  for (BodyPair& pair : pairs_) pair.lists.reset();
  for (IdlePair& rest : idle_) rest.way = kNeverIdle;
}

}  // namespace scree
