#include "solver/effects/outer_forces/wrench_table.hpp"

#include <algorithm>
#include <numeric>

#include "core/base/error.hpp"

namespace scree {

WrenchTable table_of(const WrenchById& of) {
  WrenchTable table;
  for (const auto& [id, wrench] : of) table.push_back({id, wrench});
  std::sort(table.begin(), table.end(), has_lower_id);
  return table;
}

std::vector<std::int32_t> rows_by_id(const ParticleSet& p) {
  std::vector<std::int32_t> rows(p.owned);
  std::iota(rows.begin(), rows.end(), 0);
  std::sort(rows.begin(), rows.end(),
            [&p](std::int32_t l, std::int32_t r) { return p.id[static_cast<std::size_t>(l)] < p.id[static_cast<std::size_t>(r)]; });
  return rows;
}

std::vector<WrenchOnBody> of_all_ranks(const RunState& s, const std::vector<WrenchOnBody>& mine) {
  std::vector<WrenchOnBody> all = s.comm.of_all(mine);
  if (!std::is_sorted(all.begin(), all.end(), has_lower_id)) std::sort(all.begin(), all.end(), has_lower_id);
  return all;
}

std::vector<std::int32_t> checked_rows(const RunState& s, const std::vector<WrenchOnBody>& all, const std::vector<std::int32_t>& by_id) {
  std::vector<std::int32_t> rows;
  std::vector<std::uint8_t> state, of_any(all.size(), 0);  // 0: not here, 1: here, 2: here and fixed
  rows.reserve(all.size());
  state.reserve(all.size());
  join_rows(s.particles, all, by_id, [&](const WrenchOnBody&, std::int32_t row) {
    rows.push_back(row);
    state.push_back(row < 0 ? 0 : s.particles.fixed[static_cast<std::size_t>(row)] ? 2 : 1);
  });
  MPI_Allreduce(state.data(), of_any.data(), static_cast<int>(state.size()), MPI_UINT8_T, MPI_MAX, s.comm.get());
  mpi::on_root(s.comm, [&] {
    for (std::size_t k = 0; k < all.size(); ++k) {
      if (k > 0 && all[k].id == all[k - 1].id)
        throw UsageError("outer force: body {} is named twice in one call; add up its forces, and name it once", all[k].id);
      if (!is_finite(all[k].wrench.force) || !is_finite(all[k].wrench.torque))
        throw UsageError("outer force: body {} gets a force or torque that is not a finite number; check what it is computed from",
                         all[k].id);
      if (of_any[k] == 0)
        throw UsageError("outer force: no body of the run has the id {}; it is a wall, has left, or was never there: take ids from bodies",
                         all[k].id);
      if (of_any[k] == 2) throw UsageError("outer force: body {} is fixed, and no force moves it; leave it out", all[k].id);
    }
  });
  return rows;
}

void travel(const RunState& s, WrenchTable& of, const std::vector<std::int32_t>& by_id) {
  const auto is_same_body = [](const WrenchOnBody& l, const WrenchOnBody& r) { return l.id == r.id; };
  WrenchTable stay;
  std::vector<WrenchOnBody> lost;
  join_rows(s.particles, of, by_id, [&](const WrenchOnBody& entry, std::int32_t row) { (row < 0 ? lost : stay).push_back(entry); });
  const std::size_t mine = stay.size();
  std::vector<WrenchOnBody> all = of_all_ranks(s, lost);
  // a restart gives everything to every rank
  all.erase(std::unique(all.begin(), all.end(), is_same_body), all.end());
  join_rows(s.particles, all, by_id, [&](const WrenchOnBody& entry, std::int32_t row) {
    if (row >= 0) stay.push_back(entry);
  });
  std::inplace_merge(stay.begin(), stay.begin() + static_cast<std::ptrdiff_t>(mine), stay.end(), has_lower_id);
  stay.erase(std::unique(stay.begin(), stay.end(), is_same_body), stay.end());
  of = std::move(stay);
}

void travel(const RunState& s, WrenchById& of, const std::vector<std::int32_t>& by_id) {
  WrenchTable table = table_of(of);
  travel(s, table, by_id);
  of.clear();
  for (const WrenchOnBody& entry : table) of[entry.id] = entry.wrench;
}

StateArray ids_of(const std::vector<WrenchOnBody>& rows) {
  StateArray array;
  for (const WrenchOnBody& r : rows) array.integers.push_back(r.id);
  return array;
}
StateArray numbers_of(const std::vector<WrenchOnBody>& rows) {
  StateArray array;
  for (const WrenchOnBody& r : rows) {
    for (const Vec3* v : {&r.wrench.force, &r.wrench.torque}) array.reals.insert(array.reals.end(), {v->x, v->y, v->z});
  }
  return array;
}
WrenchTable wrenches_of(const StateArray& ids, const StateArray& numbers) {
  if (numbers.reals.size() != static_cast<std::size_t>(kNumbersOfWrench) * ids.integers.size())
    throw InputError("outer forces: {} numbers for {} bodies; the file is damaged", numbers.reals.size(), ids.integers.size());
  WrenchTable all;
  for (std::size_t k = 0; k < ids.integers.size(); ++k) {
    const double* n = numbers.reals.data() + static_cast<std::size_t>(kNumbersOfWrench) * k;
    all.push_back({ids.integers[k], {{n[0], n[1], n[2]}, {n[3], n[4], n[5]}}});
  }
  std::sort(all.begin(), all.end(), has_lower_id);
  return all;
}

}  // namespace scree
