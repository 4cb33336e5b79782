#include "solver/effects/outer_forces/wrench_table.hpp"

#include <algorithm>
#include <utility>

#include "core/base/error.hpp"

namespace scree {

WrenchTable table_of(const WrenchById& of) {
  WrenchTable table;
  for (const auto& [id, wrench] : of) table.push_back({id, wrench});
  std::sort(table.begin(), table.end(), has_lower_id);
  return table;
}

std::vector<std::int32_t> checked_rows(const RunState& s, const std::vector<WrenchOnBody>& all, const std::vector<std::int32_t>& by_id) {
  NamedBodies found = find_named(s, all, by_id);
  mpi::on_root(s.comm, [&] {
    for (std::size_t k = 0; k < all.size(); ++k) {
      if (k > 0 && all[k].id == all[k - 1].id)
        throw UsageError("set_wrench: body {} is named twice in one call; add up its forces, and name it once", all[k].id);
      if (!is_finite(all[k].wrench.force) || !is_finite(all[k].wrench.torque))
        throw UsageError("set_wrench: body {} gets a force or torque that is not a finite number; check what it is computed from",
                         all[k].id);
      if (found.kinds[k] == NamedBodies::unknown)
        throw UsageError("set_wrench: no body of the run has the id {}; it is a wall, has left, or was never there: take ids from bodies",
                         all[k].id);
      if (found.kinds[k] == NamedBodies::is_fixed)
        throw UsageError("set_wrench: body {} is fixed, and no force moves it; leave it out", all[k].id);
    }
  });
  return std::move(found.row);
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
