#include "solver/halo.hpp"

#include <algorithm>

namespace scree {

namespace {

/// A friction spring as it travels with a body.
struct SpringRecord {
  PairKey key;
  FrictionSpring spring;
};

}  // namespace

Halo::Halo(const mpi::Communicator& comm, CutBoxes regions) : comm_(comm), regions_(std::move(regions)) {
  if (comm_.size() == 1) {
    constexpr double kEverywhere = 1e300;
    regions_.lower = {Vec3{-kEverywhere, -kEverywhere, -kEverywhere}};
    regions_.upper = {Vec3{kEverywhere, kEverywhere, kEverywhere}};
  }
}

void Halo::rebalance(const ParticleSet& p) {
  if (comm_.size() == 1) return;
  if (!partitioner_) partitioner_ = std::make_unique<Partitioner>(comm_.get(), comm_.size());
  regions_ = partitioner_->cut(std::span(p.id).first(p.owned), std::span(p.x).first(p.owned), std::span(p.work).first(p.owned));
}

std::int64_t Halo::migrate(const SolverScene& scene, ParticleSet& p, PairList& list) {
  p.resize(p.owned);
  neighbours_.clear();
  if (comm_.size() == 1) return 0;
  const auto ranks = static_cast<std::size_t>(comm_.size());
  std::vector<int> owner(p.owned);
  std::vector<std::vector<ParticleRecord>> bodies(ranks);
  for (std::size_t i = 0; i < p.owned; ++i) {
    owner[i] = regions_.rank_of(p.x[i]);
    if (owner[i] != comm_.rank()) bodies[static_cast<std::size_t>(owner[i])].push_back(record_of(p, i));
  }
  // The springs of every pair of a leaving body go with it; our own copy stays while we own the partner.
  std::vector<std::vector<SpringRecord>> springs(ranks);
  for (const BodyPair& pair : list.pairs()) {
    if (pair.springs.empty()) continue;
    int first = comm_.rank();
    for (const std::int32_t row : {pair.a, pair.b}) {
      if (row < 0 || static_cast<std::size_t>(row) >= p.owned) continue;
      const int to = owner[static_cast<std::size_t>(row)];
      if (to == comm_.rank() || to == first) continue;
      for (const FrictionSpring& s : pair.springs) springs[static_cast<std::size_t>(to)].push_back({pair.key, s});
      first = to;
    }
  }
  std::int64_t left = 0;
  std::size_t kept = 0;
  for (std::size_t i = 0; i < p.owned; ++i) {
    if (owner[i] != comm_.rank()) {
      ++left;
      continue;
    }
    if (kept != i) p.copy_row(i, kept);
    ++kept;
  }
  p.resize(kept);
  for (const auto& block : comm_.exchange(bodies)) {
    for (const ParticleRecord& record : block) append_record(p, record, scene);
  }
  p.owned = p.size();
  for (const auto& block : comm_.exchange(springs)) {
    for (const SpringRecord& record : block) {
      auto& pending = list.pending();
      if (pending.empty() || pending.back().key != record.key) pending.push_back({record.key, {}});
      pending.back().springs.push_back(record.spring);
    }
  }
  return left;
}

void Halo::make_ghosts(const SolverScene& scene, ParticleSet& p, double skin) {
  p.resize(p.owned);
  neighbours_.clear();
  if (comm_.size() == 1) return;
  const auto ranks = static_cast<std::size_t>(comm_.size());

  // the box of everything that each rank owns, bounding spheres and their share of margin and skin included
  const double own_reach = scene.margin() + 0.5 * skin;
  Box3 box;
  for (std::size_t i = 0; i < p.owned; ++i) {
    const double r = p.radius[i] + own_reach;
    box.add(p.x[i] - Vec3{r, r, r});
    box.add(p.x[i] + Vec3{r, r, r});
  }
  std::vector<Box3> boxes(ranks);
  static_assert(sizeof(Box3) == 6 * sizeof(double));
  MPI_Allgather(&box, 6, MPI_DOUBLE, boxes.data(), 6, MPI_DOUBLE, comm_.get());

  std::vector<std::vector<ParticleRecord>> outgoing(ranks);
  std::vector<std::vector<std::int32_t>> rows(ranks);
  for (std::size_t r = 0; r < ranks; ++r) {
    if (static_cast<int>(r) == comm_.rank() || boxes[r].is_empty()) continue;
    for (std::size_t i = 0; i < p.owned; ++i) {
      const double reach = p.radius[i] + own_reach;
      const Vec3 nearest = component_min(component_max(p.x[i], boxes[r].lower), boxes[r].upper);
      if (squared_length(p.x[i] - nearest) >= reach * reach) continue;
      outgoing[r].push_back(record_of(p, i));
      rows[r].push_back(static_cast<std::int32_t>(i));
    }
  }
  const auto incoming = comm_.exchange(outgoing);
  for (std::size_t r = 0; r < ranks; ++r) {
    if (rows[r].empty() && incoming[r].empty()) continue;
    Neighbour neighbour{static_cast<int>(r), std::move(rows[r]), p.size(), incoming[r].size(), {}, {}};
    neighbour.send_buffer.resize(neighbour.send_rows.size());
    neighbour.receive_buffer.resize(neighbour.ghost_count);
    for (const ParticleRecord& record : incoming[r]) append_record(p, record, scene);
    neighbours_.push_back(std::move(neighbour));
  }
}

void Halo::start_refresh(const ParticleSet& p) {
  requests_.clear();
  constexpr int kTag = 23;
  for (Neighbour& n : neighbours_) {
    if (n.ghost_count == 0) continue;
    MPI_Irecv(n.receive_buffer.data(), static_cast<int>(n.ghost_count * sizeof(GhostState)), MPI_BYTE, n.rank, kTag,
              comm_.get(), &requests_.emplace_back());
  }
  for (Neighbour& n : neighbours_) {
    if (n.send_rows.empty()) continue;
    for (std::size_t k = 0; k < n.send_rows.size(); ++k) {
      const auto i = static_cast<std::size_t>(n.send_rows[k]);
      n.send_buffer[k] = {p.x[i], p.v[i], p.w[i], p.q[i]};
    }
    const auto bytes = static_cast<int>(n.send_rows.size() * sizeof(GhostState));
    MPI_Isend(n.send_buffer.data(), bytes, MPI_BYTE, n.rank, kTag, comm_.get(), &requests_.emplace_back());
  }
}

void Halo::finish_refresh(ParticleSet& p) {
  if (requests_.empty()) return;
  MPI_Waitall(static_cast<int>(requests_.size()), requests_.data(), MPI_STATUSES_IGNORE);
  requests_.clear();
  for (const Neighbour& n : neighbours_) {
    for (std::size_t k = 0; k < n.ghost_count; ++k) {
      const std::size_t i = n.first_ghost + k;
      p.x[i] = n.receive_buffer[k].x;
      p.v[i] = n.receive_buffer[k].v;
      p.w[i] = n.receive_buffer[k].w;
      p.q[i] = n.receive_buffer[k].q;
    }
  }
}

}  // namespace scree
