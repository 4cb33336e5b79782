// What a program gives to bodies, by their ids: lists that ranks gather, join with their rows, and pass on when a body changes its rank.
//
// An entry is plain data with a member `id`. What belongs to a body lies on the rank that owns it, in a list by ascending id; what a rank
// holds of bodies that it does not own any more is gathered on all ranks, and their new owners keep it.
#pragma once

#include <mpi.h>

#include <algorithm>
#include <cstdint>
#include <numeric>
#include <vector>

#include "solver/state/run_state.hpp"

namespace scree {

inline constexpr auto has_lower_id = [](const auto& l, const auto& r) { return l.id < r.id; };

/// The owned rows by ascending id.
inline std::vector<std::int32_t> rows_by_id(const ParticleSet& p) {
  std::vector<std::int32_t> rows(p.owned);
  std::iota(rows.begin(), rows.end(), 0);
  std::sort(rows.begin(), rows.end(),
            [&p](std::int32_t l, std::int32_t r) { return p.id[static_cast<std::size_t>(l)] < p.id[static_cast<std::size_t>(r)]; });
  return rows;
}

/// Calls action(entry, row) for each entry of a list by ascending id; row -1 of one that is not owned here.
/// in   by_id   rows_by_id()
template <class Entry, class Action>
void join_rows(const ParticleSet& p, const std::vector<Entry>& list, const std::vector<std::int32_t>& by_id, const Action& action) {
  auto next = by_id.begin();
  for (const Entry& entry : list) {
    while (next != by_id.end() && p.id[static_cast<std::size_t>(*next)] < entry.id) ++next;
    const bool is_here = next != by_id.end() && p.id[static_cast<std::size_t>(*next)] == entry.id;
    action(entry, is_here ? *next : -1);
  }
}

/// What all ranks give, by ascending id, on every rank. Collective.
template <class Entry>
std::vector<Entry> of_all_ranks(const RunState& s, const std::vector<Entry>& mine) {
  std::vector<Entry> all = s.comm.of_all(mine);
  if (!std::is_sorted(all.begin(), all.end(), has_lower_id)) std::stable_sort(all.begin(), all.end(), has_lower_id);
  return all;
}

/// Bodies that all ranks named (of_all_ranks()).
struct NamedBodies {
  enum Kind : std::uint8_t { unknown, moves, is_fixed };
  std::vector<std::int32_t> row;    ///< the owned row, -1 of a body of another rank
  std::vector<std::uint8_t> kinds;  ///< of each on its rank, the same on every rank
};
template <class Entry>
NamedBodies find_named(const RunState& s, const std::vector<Entry>& all, const std::vector<std::int32_t>& by_id) {
  NamedBodies found;
  std::vector<std::uint8_t> here;
  found.row.reserve(all.size());
  here.reserve(all.size());
  join_rows(s.particles, all, by_id, [&](const Entry&, std::int32_t row) {
    found.row.push_back(row);
    here.push_back(row < 0                                                 ? NamedBodies::unknown
                   : s.particles.fixed[static_cast<std::size_t>(row)] != 0 ? NamedBodies::is_fixed
                                                                           : NamedBodies::moves);
  });
  found.kinds.resize(here.size());
  MPI_Allreduce(here.data(), found.kinds.data(), static_cast<int>(here.size()), MPI_UINT8_T, MPI_MAX, s.comm.get());
  return found;
}

/// What a rank holds of bodies that it does not own any more goes to their owners. Collective.
/// out  gone   null, or the entries of bodies that no rank owns, by ascending id, the same on every rank: they have left the run
/// Cost: where bodies changed their rank, the size of an entry for each of them to every rank.
template <class Entry>
void travel(const RunState& s, std::vector<Entry>& of, const std::vector<std::int32_t>& by_id, std::vector<Entry>* gone = nullptr) {
  const auto is_same_body = [](const Entry& l, const Entry& r) { return l.id == r.id; };
  std::vector<Entry> stay, lost;
  join_rows(s.particles, of, by_id, [&](const Entry& entry, std::int32_t row) { (row < 0 ? lost : stay).push_back(entry); });
  const std::size_t mine = stay.size();
  std::vector<Entry> all = of_all_ranks(s, lost);
  // a restart gives everything to every rank
  all.erase(std::unique(all.begin(), all.end(), is_same_body), all.end());
  if (gone != nullptr) {
    const NamedBodies found = find_named(s, all, by_id);
    gone->clear();
    for (std::size_t k = 0; k < all.size(); ++k)
      if (found.kinds[k] == NamedBodies::unknown) gone->push_back(all[k]);
  }
  join_rows(s.particles, all, by_id, [&](const Entry& entry, std::int32_t row) {
    if (row >= 0) stay.push_back(entry);
  });
  std::inplace_merge(stay.begin(), stay.begin() + static_cast<std::ptrdiff_t>(mine), stay.end(), has_lower_id);
  stay.erase(std::unique(stay.begin(), stay.end(), is_same_body), stay.end());
  of = std::move(stay);
}

}  // namespace scree
