// The tables in a checkpoint, each with its columns declared once: bodies, the state of pairs, inlets and what is in transit to them, what
// effects keep; and what is counted of contacts deeper than their maximum overlap.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include "core/storage/collective_file.hpp"
#include "solver/bodies/particle_set.hpp"
#include "solver/contact/pair_memory.hpp"
#include "solver/pairs/deep_contacts.hpp"
#include "solver/ranks/mpi_session.hpp"
#include "solver/state/effect_record.hpp"
#include "solver/state/inlet_state.hpp"

namespace scree {

/// A row of the state of a pair, as it lies in the file.
template <class Row>
struct PairRow {
  std::int64_t a, b, zone;
  Row row;
  PairKey key() const { return {a, b, static_cast<std::int32_t>(zone)}; }
};

// The columns of a table as visit(action), action(dataset, unit, value_of), for writer, reader and the estimate of space alike.
// value_of(row) refers to the value, of a constant row or of one that is read. The tables themselves are body_columns.hpp and
// pair_memory.hpp.
struct BodyTableColumns {
  using Item = ParticleRecord;
  template <class Action>
  static void visit(Action&& action) {
    for_each_body_column([&](const auto& c) {
      action(
          c.dataset, c.unit, [field = c.field](auto& row) -> auto& { return row.*field; });
    });
  }
  static bool is_later(std::string_view dataset) {
    bool later = false;
    for_each_body_column([&](const auto& c) { later = later || ((c.uses & kLater) != 0 && dataset == c.dataset); });
    return later;
  }
  /// Whether checkpoints of scenes without heat do not have it.
  static bool is_of_heat(std::string_view dataset) {
    bool of_heat = false;
    for_each_body_column([&](const auto& c) { of_heat = of_heat || ((c.uses & kOfHeatState) != 0 && dataset == c.dataset); });
    return of_heat;
  }
};
template <class Row>
struct PairTableColumns {
  using Item = PairRow<Row>;
  template <class Action>
  static void visit(Action&& action) {
    action(
        "a", "", [](auto& row) -> auto& { return row.a; });
    action(
        "b", "", [](auto& row) -> auto& { return row.b; });
    action(
        "zone", "", [](auto& row) -> auto& { return row.zone; });
    PairKind<Row>::visit([&](const char* name, const char* unit, auto field) {
      action(
          name, unit, [field](auto& row) -> auto& { return row.row.*field; });
    });
  }
  static bool is_later(std::string_view dataset) { return is_later_column<PairKind<Row>>(dataset); }
};

/// A body in transit, with the inlet whose queue it is in.
struct TransitRow {
  std::int64_t inlet;
  TransitBody body;
};
struct InletTableColumns {
  using Item = InletState;
  template <class Action>
  static void visit(Action&& action) {
    action(
        "count", "", [](auto& s) -> auto& { return s.count; });
    action(
        "mass", "kg", [](auto& s) -> auto& { return s.mass; });
    action(
        "returned", "", [](auto& s) -> auto& { return s.returned; });
    action(
        "is_blocked", "", [](auto& s) -> auto& { return s.is_blocked; });
    action(
        "blocked_looks", "", [](auto& s) -> auto& { return s.blocked_looks; });
    action(
        "first_blocked", "s", [](auto& s) -> auto& { return s.first_blocked; });
  }
};
struct TransitTableColumns {
  using Item = TransitRow;
  template <class Action>
  static void visit(Action&& action) {
    action(
        "inlet", "", [](auto& r) -> auto& { return r.inlet; });
    action(
        "id", "", [](auto& r) -> auto& { return r.body.id; });
    action(
        "shape", "", [](auto& r) -> auto& { return r.body.shape; });
    action(
        "material", "", [](auto& r) -> auto& { return r.body.material; });
    action(
        "scale", "", [](auto& r) -> auto& { return r.body.scale; });
    action(
        "lock_rotation", "", [](auto& r) -> auto& { return r.body.lock_rotation; });
  }
};

template <class Columns>
std::int64_t bytes_per_row() {
  std::size_t bytes = 0;
  const typename Columns::Item row{};
  Columns::visit([&](const char*, const char*, auto value_of) { bytes += sizeof(value_of(row)); });
  return static_cast<std::int64_t>(bytes);
}

template <class Columns>
void write_columns(CollectiveFile& file, const h5::Group& group, const std::vector<typename Columns::Item>& mine, Rows rows,
                   bool (*leaves_out)(std::string_view dataset) = nullptr) {
  Columns::visit([&](const char* name, const char* unit, auto value_of) {
    if (leaves_out != nullptr && leaves_out(name)) return;
    std::vector<std::decay_t<decltype(value_of(mine[0]))>> values;
    values.reserve(mine.size());
    for (const auto& row : mine) values.push_back(value_of(row));
    file.write(group, name, values, rows, unit);
  });
}

/// Rows [first, last), as they lie in the file.
template <class Columns>
std::vector<typename Columns::Item> read_rows(const h5::Group& group, std::int64_t first, std::int64_t last) {
  std::vector<typename Columns::Item> rows(static_cast<std::size_t>(last - first), typename Columns::Item{});
  Columns::visit([&](const char* name, const char*, auto value_of) {
    using Value = std::decay_t<decltype(value_of(rows[0]))>;
    if (is_later_column<Columns>(name) && !group.has(name)) return;
    const std::vector<Value> values = group.read_rows<Value>(name, first, last - first);
    for (std::size_t i = 0; i < rows.size(); ++i) value_of(rows[i]) = values[i];
  });
  return rows;
}

/// This rank's part of the rows.
template <class Columns>
std::vector<typename Columns::Item> read_columns(const mpi::Communicator& comm, const h5::Group& group, const char* first_column) {
  const std::int64_t total = group.row_count(first_column);
  return read_rows<Columns>(group, total * comm.rank() / comm.size(), total * (comm.rank() + 1) / comm.size());
}

/// What is the same on every rank: rank 0 writes it, and all read it.
inline void write_inlets(const mpi::Communicator& comm, CollectiveFile& file, const h5::Group& root,
                         const std::vector<InletState>& inlets) {
  std::vector<InletState> states;
  std::vector<TransitRow> transit;
  for (std::size_t k = 0; comm.rank() == 0 && k < inlets.size(); ++k) {
    states.push_back(inlets[k]);
    for (const TransitBody& body : inlets[k].queue) transit.push_back({static_cast<std::int64_t>(k), body});
  }
  const auto rows = [&](std::size_t mine) { return distribute(comm.get(), static_cast<std::int64_t>(mine)); };
  write_columns<InletTableColumns>(file, root.create_group("inlets"), states, rows(states.size()));
  write_columns<TransitTableColumns>(file, root.create_group("transit"), transit, rows(transit.size()));
}
inline std::vector<InletState> read_inlets(const h5::Group& root) {
  const h5::Group group = root.open_group("inlets"), transit = root.open_group("transit");
  std::vector<InletState> inlets = read_rows<InletTableColumns>(group, 0, group.row_count("count"));
  for (const TransitRow& row : read_rows<TransitTableColumns>(transit, 0, transit.row_count("id"))) {
    if (row.inlet < 0 || row.inlet >= static_cast<std::int64_t>(inlets.size())) {
      throw InputError("{}: inlet {} found, but there are {}", transit.path(), row.inlet, inlets.size());
    }
    inlets[static_cast<std::size_t>(row.inlet)].queue.push_back(row.body);
  }
  return inlets;
}

/// What an effect keeps, the same on every rank: rank 0 writes it, and all read it. A scene without the effect has none of it.
inline void write_effect(const mpi::Communicator& comm, CollectiveFile& file, const h5::Group& root, const EffectFormat& format,
                         const EffectRecord& record) {
  if (record.empty()) return;
  const std::optional<h5::Group> group = *format.group != 0 ? std::optional(root.create_group(format.group)) : std::nullopt;
  for (std::size_t k = 0; k < record.size(); ++k) {
    const ArrayFormat& array = format.arrays[k];
    const std::size_t numbers = array.is_real ? record[k].reals.size() : record[k].integers.size();
    if (array.is_later && numbers == 0) continue;  // read as empty
    const auto rows = static_cast<std::int64_t>(numbers) / array.width;
    const void* data = array.is_real ? static_cast<const void*>(record[k].reals.data()) : record[k].integers.data();
    file.write(group ? *group : root, array.name, data, comm.rank() == 0 ? Rows{rows, 0, rows} : Rows{0, rows, rows}, array.width,
               array.is_real ? H5T_NATIVE_DOUBLE : H5T_NATIVE_INT64, array.unit);
  }
}
inline EffectRecord read_effect(const h5::Group& root, const EffectFormat& format) {
  EffectRecord record;
  if (format.arrays.empty()) return record;
  const bool is_there = *format.group != 0 ? root.has(format.group) : root.has(format.arrays.front().name);
  if (!is_there) return record;
  const std::optional<h5::Group> group = *format.group != 0 ? std::optional(root.open_group(format.group)) : std::nullopt;
  for (const ArrayFormat& array : format.arrays) {
    const h5::Group& in = group ? *group : root;
    if (array.is_later && !in.has(array.name))
      record.emplace_back();
    else if (array.is_real)
      record.push_back({.reals = in.read_array<double>(array.name, array.width)});
    else
      record.push_back({.integers = in.read_array<std::int64_t>(array.name, array.width)});
  }
  return record;
}

/// A number of a record, as write_attribute has written it.
template <class Value>
void read_number(const h5::Group& group, const std::string& name, Value& value) {
  if constexpr (std::is_floating_point_v<Value>)
    value = group.read_double_attribute(name);
  else
    value = static_cast<Value>(group.read_integer_attribute(name));
}

/// The numbers of what is counted of contacts deeper than their maximum overlap, with their names, for writer and reader alike.
template <class Totals, class Action>
void for_each_deep_number(Totals& t, Action&& action) {
  action("contacts", t.contacts);
  action("contact_steps", t.contact_steps);
  action("first_step", t.first_step);
  action("last_step", t.last_step);
  action("overlap", t.overlap);
  action("excess", t.excess);
  action("a", t.key.a);
  action("b", t.key.b);
  action("zone", t.key.zone);
  action("step", t.step);
  action("x", t.place.x);
  action("y", t.place.y);
  action("z", t.place.z);
}

inline void write_deep_contacts(const h5::Group& group, const DeepTotals& totals) {
  for_each_deep_number(totals, [&](const char* name, const auto& value) { group.write_attribute(name, value); });
}
inline void read_deep_contacts(const h5::Group& group, DeepTotals& totals) {
  for_each_deep_number(totals, [&](const char* name, auto& value) { read_number(group, name, value); });
}

}  // namespace scree
