#include "solver/effects/heat/outer_heat.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/base/error.hpp"
#include "solver/bodies/kept_sum.hpp"

namespace scree {

namespace {

constexpr std::int64_t kNumbersOfEntry = 5, kNumbersOfDeparted = 2;

struct Id {
  std::int64_t id;
};
std::vector<Id> ids_of(const std::vector<std::int64_t>& numbers) {
  std::vector<Id> ids;
  ids.reserve(numbers.size());
  for (const std::int64_t number : numbers) ids.push_back({number});
  return ids;
}

}  // namespace

const std::vector<std::int32_t>& OuterHeat::by_id(const RunState& s) {
  if (by_id_.size() != s.particles.owned) by_id_ = rows_by_id(s.particles);
  return by_id_;
}

/// Rows of what all ranks named. Throws UsageError on every rank for a body that is unknown or named twice, and for what
/// `fault_of(entry)` says of its numbers.
template <class Given, class Check>
NamedBodies OuterHeat::checked(const char* call, const RunState& s, const std::vector<Given>& all, const Check& fault_of) {
  NamedBodies found = find_named(s, all, by_id(s));
  mpi::on_root(s.comm, [&] {
    for (std::size_t k = 0; k < all.size(); ++k) {
      if (k > 0 && all[k].id == all[k - 1].id) throw UsageError("{}: body {} is named twice in one call; name it once", call, all[k].id);
      const bool has_left = std::binary_search(departed_.begin(), departed_.end(), all[k], has_lower_id);
      if (const std::string fault = fault_of(all[k], found.kinds[k] != NamedBodies::unknown, has_left); !fault.empty())
        throw UsageError("{}: {}", call, fault);
    }
  });
  return found;
}

/// Changes the entries of bodies of this rank, which are made where there are none.
template <class Given, class Change>
void OuterHeat::change(const RunState& s, const std::vector<Given>& all, const NamedBodies& found, const Change& change_entry) {
  std::vector<Entry> table;
  table.reserve(table_.size() + all.size());
  auto old = table_.begin();
  for (std::size_t k = 0; k < all.size(); ++k) {
    if (found.row[k] < 0) continue;
    for (; old != table_.end() && old->id < all[k].id; ++old) table.push_back(*old);
    table.push_back(old != table_.end() && old->id == all[k].id ? *old++ : Entry{all[k].id});
    change_entry(table.back(), k);
  }
  table.insert(table.end(), old, table_.end());
  table_ = std::move(table);
  drop_unneeded();
  find_rows(s);
}

void OuterHeat::drop_unneeded() {
  std::erase_if(table_, [](const Entry& e) { return !e.is_needed(); });
}

void OuterHeat::find_rows(const RunState& s) {
  auto entry = table_.begin();
  join_rows(s.particles, table_, by_id(s), [&](const Entry&, std::int32_t row) { (entry++)->row = row; });
}

namespace {

std::string unknown_body(std::int64_t id) {
  return fmt::format("no body of the run has the id {}; it is a wall, has left, or was never there: take ids from bodies", id);
}

}  // namespace

void OuterHeat::hold(const RunState& s, const std::vector<SourceOfBody>& mine) {
  const std::vector<SourceOfBody> all = of_all_ranks(s, mine);
  if (all.empty()) return;
  const NamedBodies found = checked("set_heat_source", s, all, [](const SourceOfBody& given, bool is_there, bool) {
    if (!std::isfinite(given.power))
      return fmt::format("body {} gets a source of {:g} W, which is not a finite number; check what it is computed from", given.id,
                         given.power);
    return is_there ? std::string() : unknown_body(given.id);
  });
  change(s, all, found, [&](Entry& entry, std::size_t k) { entry.power = all[k].power; });
}

void OuterHeat::hold(const RunState& s, const std::vector<MediumOfBody>& mine) {
  const std::vector<MediumOfBody> all = of_all_ranks(s, mine);
  if (all.empty()) return;
  const NamedBodies found = checked("set_medium", s, all, [](const MediumOfBody& given, bool is_there, bool) {
    if (!(given.conductance >= 0) || !std::isfinite(given.conductance))
      return fmt::format("body {} gets a medium with a conductance of {:g} W/K; expected a finite number >= 0, h A", given.id,
                         given.conductance);
    if (!(given.temperature > 0) || !std::isfinite(given.temperature))
      return fmt::format("body {} gets a medium with a temperature of {:g} K; expected a finite number > 0, in kelvin", given.id,
                         given.temperature);
    return is_there ? std::string() : unknown_body(given.id);
  });
  change(s, all, found, [&](Entry& entry, std::size_t k) {
    entry.conductance = all[k].conductance;
    entry.medium = all[k].temperature;
  });
}

void OuterHeat::release(const RunState& s, const std::optional<std::vector<std::int64_t>>& mine) {
  const auto end = [](Entry& entry) { entry.power = entry.conductance = entry.medium = 0; };
  if (!mine) {
    std::for_each(table_.begin(), table_.end(), end);
    drop_unneeded();
    find_rows(s);
    return;
  }
  const std::vector<Id> all = of_all_ranks(s, ids_of(*mine));
  const NamedBodies found =
      checked("clear_heat", s, all, [](const Id& given, bool is_there, bool) { return is_there ? std::string() : unknown_body(given.id); });
  change(s, all, found, [&](Entry& entry, std::size_t) { end(entry); });
}

std::vector<double> OuterHeat::take(const RunState& s, const std::vector<std::int64_t>& mine) {
  const std::vector<Id> all = of_all_ranks(s, ids_of(mine));
  const NamedBodies found = checked("take_medium_heat", s, all, [](const Id& given, bool is_there, bool has_left) {
    return is_there || has_left ? std::string()
                                : unknown_body(given.id) + ". Of a body that has left, what passed from its medium can be taken once";
  });
  std::vector<double> passed(all.size(), 0.0);
  change(s, all, found, [&](Entry& entry, std::size_t k) {
    passed[k] = entry.passed + entry.remainder;
    entry.passed = entry.remainder = 0;
  });
  for (std::size_t k = 0; k < all.size() && !departed_.empty(); ++k) {
    const auto at = std::lower_bound(departed_.begin(), departed_.end(), all[k], has_lower_id);
    if (at == departed_.end() || at->id != all[k].id) continue;
    passed[k] += at->passed + at->remainder;  // one that came in again with its id has both
    departed_.erase(at);
  }
  // no other rank adds to the number of a body but its owner, and rank 0 for one that has left
  MPI_Allreduce(MPI_IN_PLACE, passed.data(), static_cast<int>(passed.size()), MPI_DOUBLE, MPI_SUM, s.comm.get());
  std::vector<double> heat;
  heat.reserve(mine.size());
  for (const std::int64_t id : mine)
    heat.push_back(passed[static_cast<std::size_t>(std::lower_bound(all.begin(), all.end(), Id{id}, has_lower_id) - all.begin())]);
  return heat;
}

void OuterHeat::add_sources(double dt, std::vector<double>& given) {
  for (const Entry& e : table_) {
    if (e.power == 0) continue;
    given[static_cast<std::size_t>(e.row)] += dt * e.power;
    from_program_.add(dt * e.power);
  }
}

void OuterHeat::add_power(const std::vector<double>& temperature, std::vector<double>& power) const {
  for (const Entry& e : table_) {
    const auto row = static_cast<std::size_t>(e.row);
    if (e.conductance > 0) power[row] += e.conductance * (e.medium - temperature[row]);
  }
}

void OuterHeat::count_passed(double dt, const std::vector<double>& first, const std::vector<double>& second) {
  for (Entry& e : table_) {
    if (!(e.conductance > 0)) continue;
    const auto row = static_cast<std::size_t>(e.row);
    const double heat = dt * (0.5 * e.conductance * ((e.medium - first[row]) + (e.medium - second[row])));
    from_medium_.add(heat);
    add_keeping_rest(heat, e.passed, e.remainder);
  }
}

void OuterHeat::add_conductance(std::vector<double>& sum) const {
  for (const Entry& e : table_) sum[static_cast<std::size_t>(e.row)] += e.conductance;
}

double OuterHeat::conductance_of(std::size_t row) const {
  const auto at = std::find_if(table_.begin(), table_.end(), [row](const Entry& e) { return e.row == static_cast<std::int64_t>(row); });
  return at == table_.end() ? 0 : at->conductance;
}

std::int64_t OuterHeat::source_count() const {
  return std::count_if(table_.begin(), table_.end(), [](const Entry& e) { return e.power != 0; });
}
std::int64_t OuterHeat::medium_count() const {
  return std::count_if(table_.begin(), table_.end(), [](const Entry& e) { return e.conductance > 0; });
}

void OuterHeat::after_migration(const RunState& s, bool left) {
  by_id_.clear();
  std::vector<Entry> gone;
  travel(s, table_, by_id(s), left ? &gone : nullptr);
  if (s.comm.rank() != 0) return;
  for (const Entry& entry : gone) {
    if (entry.medium == 0 && entry.passed == 0) continue;
    const auto at = std::lower_bound(departed_.begin(), departed_.end(), entry, has_lower_id);
    if (at == departed_.end() || at->id != entry.id) {
      departed_.insert(at, entry);
      continue;
    }
    add_keeping_rest(entry.passed, at->passed, at->remainder);  // it has left before, came in again, and nothing was taken since
    add_keeping_rest(entry.remainder, at->passed, at->remainder);
  }
}

void OuterHeat::on_rebuild(const RunState& s) { find_rows(s); }

std::vector<ArrayFormat> OuterHeat::formats() {
  std::vector<ArrayFormat> all{sum_format("from_program"),    sum_format("from_medium"),
                               {"held_id", "", 1, false},     {"held", "W; W/K; K; J; J", kNumbersOfEntry},
                               {"departed_id", "", 1, false}, {"departed", "J", kNumbersOfDeparted}};
  for (ArrayFormat& array : all) array.is_later = true;
  return all;
}

std::vector<StateArray> OuterHeat::record(const RunState& s) const {
  std::vector<StateArray> arrays(kArrays);
  arrays[0] = array_of(over_ranks(s.comm.get(), from_program_));
  arrays[1] = array_of(over_ranks(s.comm.get(), from_medium_));
  for (const Entry& e : of_all_ranks(s, table_)) {
    arrays[2].integers.push_back(e.id);
    arrays[3].reals.insert(arrays[3].reals.end(), {e.power, e.conductance, e.medium, e.passed, e.remainder});
  }
  for (const Entry& e : of_all_ranks(s, departed_)) {
    arrays[4].integers.push_back(e.id);
    arrays[5].reals.insert(arrays[5].reals.end(), {e.passed, e.remainder});
  }
  return arrays;
}

void OuterHeat::restore(const RunState& s, const std::vector<StateArray>& record) {
  const std::vector<std::int64_t>&ids = record[2].integers, &gone = record[4].integers;
  if (record[3].reals.size() != kNumbersOfEntry * ids.size() || record[5].reals.size() != kNumbersOfDeparted * gone.size())
    throw InputError("heat of a program: {} and {} numbers for {} and {} bodies; the file is damaged", record[3].reals.size(),
                     record[5].reals.size(), ids.size(), gone.size());
  table_.clear();
  departed_.clear();
  for (std::size_t k = 0; k < ids.size(); ++k) {
    const double* n = record[3].reals.data() + kNumbersOfEntry * k;
    table_.push_back({ids[k], n[0], n[1], n[2], n[3], n[4]});
  }
  std::sort(table_.begin(), table_.end(), has_lower_id);
  if (s.comm.rank() != 0) return;
  for (std::size_t k = 0; k < gone.size(); ++k) departed_.push_back({gone[k], 0, 0, 0, record[5].reals[2 * k], record[5].reals[2 * k + 1]});
  std::sort(departed_.begin(), departed_.end(), has_lower_id);
  from_program_ = sum_of(record[0]);
  from_medium_ = sum_of(record[1]);
}

}  // namespace scree
