#include "solver/ranks/halo.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <unordered_map>

namespace scree {

namespace {

/// Distance along one axis between two intervals, in a domain of that period (0: not periodic).
double gap_along(double lower_a, double upper_a, double lower_b, double upper_b, double period) {
  // the nearest image of a; positions may have left the domain by any number of periods
  const double shift = period > 0 ? period * std::round(0.5 * (lower_b + upper_b - lower_a - upper_a) / period) : 0;
  return std::max({0.0, lower_a + shift - upper_b, lower_b - upper_a - shift});
}

/// The same of boxes in a cell that is sheared: along x as above, of all images across y and z that may be the nearest. Boxes lie in the
/// box of the three lengths, or reach a quarter of a length out of it.
double squared_gap_in_sheared(const Vec3& lower_a, const Vec3& upper_a, const Box3& b, const Periodicity& cell) {
  const Vec3& period = cell.period();
  const double back = -std::round(cell.shear().x / period.y);
  double least = std::numeric_limits<double>::infinity();
  for (int z = -1; z <= 1; ++z) {
    const double gap_z = std::max({0.0, lower_a.z + z * period.z - b.upper.z, b.lower.z - upper_a.z - z * period.z});
    if (gap_z * gap_z >= least) continue;
    for (int y = -2; y <= 2; ++y) {
      const Vec3 shift = cell.shift({0, z * back + y, static_cast<double>(z)});
      const double gap_y = std::max({0.0, lower_a.y + shift.y - b.upper.y, b.lower.y - upper_a.y - shift.y});
      const double gap_x = gap_along(lower_a.x + shift.x, upper_a.x + shift.x, b.lower.x, b.upper.x, period.x);
      least = std::min(least, gap_x * gap_x + gap_y * gap_y + gap_z * gap_z);
    }
  }
  return least;
}

double squared_gap(const Vec3& lower_a, const Vec3& upper_a, const Box3& b, const Periodicity& cell) {
  if (cell.is_sheared()) return squared_gap_in_sheared(lower_a, upper_a, b, cell);
  const Vec3& period = cell.period();
  double squared = 0;
  for (int k = 0; k < 3; ++k) {
    const double gap = gap_along(lower_a[k], upper_a[k], b.lower[k], b.upper[k], period[k]);
    squared += gap * gap;
  }
  return squared;
}

/// Whether the boxes of two ranks touch. Both ranks ask, and one that waited for the other in vain would wait indefinitely: the box
/// of the lower rank comes first on either side, so that both round alike.
bool are_neighbours(int rank_a, const Box3& a, int rank_b, const Box3& b, const Periodicity& cell) {
  if (a.is_empty() || b.is_empty()) return false;
  const Box3 &low = rank_a < rank_b ? a : b, &high = rank_a < rank_b ? b : a;
  return squared_gap(low.lower, low.upper, high, cell) <= 0;
}

}  // namespace

Halo::Halo(const mpi::Communicator& comm, const SolverScene& scene, const ParallelOptions& options, CutBoxes first_cut)
    : comm_(comm), options_(options), first_cell_(scene.periodicity()) {
  if (options.cut == CutMethod::rcb) first_cut_ = std::move(first_cut);
  if (comm_.size() == 1) first_cut_ = whole_space_first(1);
  regions_ = first_cut_;
}

double Halo::rebalance(const ParticleSet& p, std::span<const double> work) {
  if (comm_.size() == 1) return 1;
  if (!partitioner_) partitioner_ = std::make_unique<Partitioner>(comm_.get(), comm_.size(), options_.cut);
  std::vector<Vec3> x(p.x.begin(), p.x.begin() + static_cast<std::ptrdiff_t>(p.owned));
  for (Vec3& point : x) point = inside_domain(p.cell.periodicity(), point);
  regions_ = partitioner_->cut(std::span(p.id).first(p.owned), x, work);
  std::vector<double> of_rank(static_cast<std::size_t>(comm_.size()));
  for (std::size_t i = 0; i < p.owned; ++i) of_rank[static_cast<std::size_t>(owner_of(p.cell.periodicity(), p.id[i], p.x[i]))] += work[i];
  comm_.sum(of_rank);
  return imbalance(of_rank);
}

Vec3 Halo::inside_domain(const Periodicity& now, const Vec3& x) const {
  Vec3 inside = x;
  for (int k = 0; k < 3; ++k) {
    const double period = now.period()[k], lower = now.lower()[k], first = first_cell_.period()[k];
    if (!(period > 0)) continue;
    inside[k] -= period * std::floor((x[k] - lower) / period);
    if (period != first) inside[k] = first_cell_.lower()[k] + (inside[k] - lower) * (first / period);
  }
  return inside;
}

int Halo::owner_of(const Periodicity& now, std::int64_t id, const Vec3& x) const {
  const Vec3 inside = inside_domain(now, x);
  return partitioner_ ? partitioner_->part_of(id, inside) : first_cut_.rank_of(inside);
}

std::int64_t Halo::migrate(const SolverScene& scene, ParticleSet& p, PairList& list) {
  p.resize(p.owned);
  neighbours_.clear();
  if (comm_.size() == 1) return 0;
  const auto ranks = static_cast<std::size_t>(comm_.size());
  std::vector<int> owner(p.owned);
  std::vector<std::vector<ParticleRecord>> bodies(ranks);
  for (std::size_t i = 0; i < p.owned; ++i) {
    owner[i] = owner_of(p.cell.periodicity(), p.id[i], p.x[i]);
    if (owner[i] != comm_.rank()) bodies[static_cast<std::size_t>(owner[i])].push_back(record_of(p, i));
  }
  // The state of every pair of a leaving body goes with it; our own copy stays while we own the partner.
  std::vector<std::vector<WaitingState>> states(ranks);
  for (const BodyPair& pair : list.pairs()) {
    if (pair.state.empty()) continue;
    int first = comm_.rank();
    for (const std::int32_t row : {pair.a, pair.b}) {
      if (row < 0 || static_cast<std::size_t>(row) >= p.owned) continue;
      const int to = owner[static_cast<std::size_t>(row)];
      if (to == comm_.rank() || to == first) continue;
      states[static_cast<std::size_t>(to)].push_back({pair.key, pair.state});
      first = to;
    }
  }
  // State that waits for its pair is at every rank that has a body of it, and goes the same way.
  std::vector<WaitingState> waiting;
  waiting.swap(list.waiting());
  std::unordered_map<std::int64_t, int> owner_of_id;
  for (std::size_t i = 0; !waiting.empty() && i < p.owned; ++i) owner_of_id.emplace(p.id[i], owner[i]);
  for (WaitingState& pair : waiting) {
    bool stays = false;
    int first = comm_.rank();
    for (const std::int64_t id : {pair.key.a, pair.key.b}) {
      const auto found = owner_of_id.find(id);
      if (found == owner_of_id.end()) continue;
      const int to = found->second;
      if (to == comm_.rank()) stays = true;
      if (to == comm_.rank() || to == first) continue;
      states[static_cast<std::size_t>(to)].push_back({pair.key, pair.state});
      first = to;
    }
    if (stays) list.waiting().push_back(std::move(pair));
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
  const auto count_sent = [&](const auto& blocks) {
    for (const auto& block : blocks) traffic_.rebuild_bytes += static_cast<std::int64_t>(block.size() * sizeof(block[0]));
  };
  count_sent(bodies);
  for (const auto& block : comm_.exchange(bodies)) {
    for (const ParticleRecord& record : block) append_record(p, record, scene);
  }
  p.owned = p.size();
  for_each_kind(PairState{}, [&](const auto& kind) {
    using Row = typename std::decay_t<decltype(kind)>::value_type;
    std::vector<std::vector<KeyedRow<Row>>> rows(ranks);
    for (std::size_t r = 0; r < ranks; ++r) rows[r] = keyed_rows<Row>(states[r]);
    count_sent(rows);
    for (const auto& block : comm_.exchange(rows)) add_rows(block, list.waiting());
  });
  return left;
}

std::vector<ParticleRecord> Halo::deliver(const Periodicity& now, const std::vector<ParticleRecord>& records) const {
  std::vector<std::vector<ParticleRecord>> outgoing(static_cast<std::size_t>(comm_.size()));
  for (const ParticleRecord& r : records) outgoing[comm_.size() == 1 ? 0 : static_cast<std::size_t>(owner_of(now, r.id, r.x))].push_back(r);
  std::vector<ParticleRecord> mine;
  for (const auto& block : comm_.exchange(outgoing)) mine.insert(mine.end(), block.begin(), block.end());
  return mine;
}

std::vector<int> Halo::possible_neighbours(double reach) const {
  // A periodic domain joins its outer parts, which have no outer side: there every rank asks every other, as it does when the
  // parts are no boxes.
  const bool by_boxes = !regions_.lower.empty() && !first_cell_.any();
  std::vector<int> ranks;
  for (int r = 0; r < comm_.size(); ++r) {
    if (r == comm_.rank()) continue;
    if (!by_boxes || regions_.are_within(static_cast<std::size_t>(comm_.rank()), static_cast<std::size_t>(r), reach)) ranks.push_back(r);
  }
  return ranks;
}

void Halo::make_ghosts(const SolverScene& scene, ParticleSet& p, double largest_radius, double skin) {
  p.resize(p.owned);
  neighbours_.clear();
  if (comm_.size() == 1) return;

  const Periodicity& cell = p.cell.periodicity();
  // the box of everything that this rank owns, bounding spheres and their share of margin, reach and skin included
  const double own_reach = scene.contact_range() + 0.5 * skin;
  Box3 box;
  for (std::size_t i = 0; i < p.owned; ++i) {
    const double r = p.radius[i] + own_reach;
    box.add(p.x[i] - Vec3{r, r, r});
    box.add(p.x[i] + Vec3{r, r, r});
  }
  // Both sides of a pair of ranks must take each other for possible neighbours: the reach is that of the largest body anywhere.
  const std::vector<int> possible = possible_neighbours(2 * (largest_radius + own_reach));
  const auto boxes = comm_.exchange(std::span<const int>(possible), std::vector<std::vector<Box3>>(possible.size(), {box}));

  std::vector<int> ranks;
  std::vector<std::vector<ParticleRecord>> outgoing;
  std::vector<std::vector<std::int32_t>> rows;
  for (std::size_t n = 0; n < possible.size(); ++n) {
    const Box3& theirs = boxes[n][0];
    if (!are_neighbours(comm_.rank(), box, possible[n], theirs, cell)) continue;
    ranks.push_back(possible[n]);
    auto& records = outgoing.emplace_back();
    auto& own_rows = rows.emplace_back();
    for (std::size_t i = 0; i < p.owned; ++i) {
      const double reach = p.radius[i] + own_reach;
      if (options_.selection == HaloSelection::selected && squared_gap(p.x[i], p.x[i], theirs, cell) >= reach * reach) continue;
      records.push_back(record_of(p, i));
      own_rows.push_back(static_cast<std::int32_t>(i));
    }
    traffic_.rebuild_bytes += static_cast<std::int64_t>(records.size() * sizeof(ParticleRecord));
  }
  const auto incoming = comm_.exchange(std::span<const int>(ranks), outgoing);
  for (std::size_t n = 0; n < ranks.size(); ++n) {
    if (rows[n].empty() && incoming[n].empty()) continue;
    Neighbour neighbour{ranks[n], std::move(rows[n]), p.size(), incoming[n].size(), {}, {}};
    neighbour.send_buffer.resize(neighbour.send_rows.size() * kGhostBytes);
    neighbour.receive_buffer.resize(neighbour.ghost_count * kGhostBytes);
    for (const ParticleRecord& record : incoming[n]) append_record(p, record, scene);
    neighbours_.push_back(std::move(neighbour));
  }
}

void Halo::start_refresh(const ParticleSet& p, PhaseTimes& times) {
  if (neighbours_.empty()) return;
  const PhaseTimer timer(times, Phase::halo);
  requests_.clear();
  constexpr int kTag = 23;
  for (Neighbour& n : neighbours_) {
    if (n.ghost_count == 0) continue;
    MPI_Irecv(n.receive_buffer.data(), static_cast<int>(n.receive_buffer.size()), MPI_BYTE, n.rank, kTag, comm_.get(),
              &requests_.emplace_back());
  }
  for (Neighbour& n : neighbours_) {
    if (n.send_rows.empty()) continue;
    pack_ghosts(p, n.send_rows, n.send_buffer.data());
    const auto bytes = static_cast<int>(n.send_buffer.size());
    MPI_Isend(n.send_buffer.data(), bytes, MPI_BYTE, n.rank, kTag, comm_.get(), &requests_.emplace_back());
    ++traffic_.messages;
    traffic_.bytes += bytes;
  }
}

void Halo::finish_refresh(ParticleSet& p, PhaseTimes& times) {
  if (requests_.empty()) return;
  {
    const PhaseTimer timer(times, Phase::wait);
    MPI_Waitall(static_cast<int>(requests_.size()), requests_.data(), MPI_STATUSES_IGNORE);
  }
  requests_.clear();
  const PhaseTimer timer(times, Phase::halo);
  for (const Neighbour& n : neighbours_) unpack_ghosts(p, n.first_ghost, n.ghost_count, n.receive_buffer.data());
}

void Halo::refresh_column(std::vector<double>& column, PhaseTimes& times) {
  if (neighbours_.empty()) return;
  const PhaseTimer timer(times, Phase::halo);
  requests_.clear();
  constexpr int kTag = 24;
  for (Neighbour& n : neighbours_) {
    if (n.ghost_count == 0) continue;
    MPI_Irecv(&column[n.first_ghost], static_cast<int>(n.ghost_count), MPI_DOUBLE, n.rank, kTag, comm_.get(), &requests_.emplace_back());
  }
  for (Neighbour& n : neighbours_) {
    if (n.send_rows.empty()) continue;
    pack_field(column, n.send_rows, n.send_buffer.data());
    MPI_Isend(n.send_buffer.data(), static_cast<int>(n.send_rows.size()), MPI_DOUBLE, n.rank, kTag, comm_.get(), &requests_.emplace_back());
    ++traffic_.messages;
    traffic_.bytes += static_cast<std::int64_t>(n.send_rows.size() * sizeof(double));
  }
  {
    const PhaseTimer waiting(times, Phase::wait);
    MPI_Waitall(static_cast<int>(requests_.size()), requests_.data(), MPI_STATUSES_IGNORE);
  }
  requests_.clear();
}

}  // namespace scree
