#include "core/storage/start_state.hpp"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <set>
#include <tuple>

#include "core/base/error.hpp"
#include "core/storage/json_object.hpp"

namespace scree {

namespace {

constexpr const char *kA = "a", *kB = "b", *kZone = "zone";

/// Names in a group, in their order as text.
std::vector<std::string> names_in(const h5::Group& group) {
  std::vector<std::string> names;
  const std::int64_t count = group.child_count();
  for (std::int64_t n = 0; n < count; ++n) {
    const auto place = static_cast<hsize_t>(n);
    const ssize_t size = H5Lget_name_by_idx(group.id(), ".", H5_INDEX_NAME, H5_ITER_INC, place, nullptr, 0, H5P_DEFAULT);
    if (size < 0) throw InputError("{}: the names in it cannot be read; the file is damaged", group.path());
    std::string name(static_cast<std::size_t>(size) + 1, '\0');
    H5Lget_name_by_idx(group.id(), ".", H5_INDEX_NAME, H5_ITER_INC, place, name.data(), name.size(), H5P_DEFAULT);
    name.pop_back();
    names.push_back(std::move(name));
  }
  return names;
}

bool is_group(const h5::Group& group, const std::string& name) {
  const hid_t id = H5Oopen(group.id(), name.c_str(), H5P_DEFAULT);
  if (id < 0) throw InputError("{}/{} cannot be opened: {}; the file is damaged", group.path(), name, h5::library_error());
  const h5::Handle object(id, H5Oclose, group.path() + "/" + name);
  return H5Iget_type(object.id()) == H5I_GROUP;
}

PairColumn read_column(const h5::Group& group, const std::string& name) {
  const std::string what = group.path() + "/" + name;
  PairColumn column{name, "", {}};
  const hid_t id = H5Dopen2(group.id(), name.c_str(), H5P_DEFAULT);
  if (id < 0) throw InputError("{} cannot be opened: {}; the file is damaged", what, h5::library_error());
  h5::Handle dataset(id, H5Dclose, what);
  const h5::Handle type(H5Dget_type(dataset.id()), H5Tclose, what), space(H5Dget_space(dataset.id()), H5Sclose, what);
  const bool is_integer = H5Tget_class(type.id()) == H5T_INTEGER, is_vector = H5Sget_simple_extent_ndims(space.id()) == 2;
  const h5::Group described(std::move(dataset), what);
  if (described.has_attribute("unit")) column.unit = described.read_text_attribute("unit");
  if (is_integer)
    column.values = group.read_array<std::int64_t>(name, 1);
  else if (is_vector)
    column.values = group.read_vectors(name);
  else
    column.values = group.read_array<double>(name, 1);
  return column;
}

template <class Value>
void check_numbers(const h5::Group& group, const std::string& name, const std::vector<Value>& values) {
  if constexpr (!std::is_same_v<Value, std::int64_t>) {
    const auto wrong = std::find_if(values.begin(), values.end(), [](const Value& value) {
      if constexpr (std::is_same_v<Value, double>)
        return !std::isfinite(value);
      else
        return !is_finite(value);
    });
    if (wrong != values.end())
      throw InputError("{}/{}: row {} is not a finite number; the file is damaged", group.path(), name, wrong - values.begin());
  }
}

PairTable read_pair_table(const h5::Group& group, const std::string& kind) {
  PairTable table{
      kind, group.read_array<std::int64_t>(kA, 1), group.read_array<std::int64_t>(kB, 1), group.read_array<std::int64_t>(kZone, 1), {}};
  const auto check = [&](const std::string& name, std::size_t rows) {
    if (rows != table.size()) throw InputError("{}/{}: {} rows found, {} expected", group.path(), name, rows, table.size());
  };
  check(kB, table.b.size());
  check(kZone, table.zone.size());
  for (const std::string& name : names_in(group)) {
    if (name == kA || name == kB || name == kZone) continue;
    table.columns.push_back(read_column(group, name));
    std::visit([&](const auto& values) { check_numbers(group, name, values); }, table.columns.back().values);
    check(name, std::visit([](const auto& values) { return values.size(); }, table.columns.back().values));
  }
  return table;
}

}  // namespace

void PairTable::take(const std::vector<std::size_t>& rows) {
  const auto taken = [&](auto& values) {
    std::decay_t<decltype(values)> left;
    left.reserve(rows.size());
    for (const std::size_t i : rows) left.push_back(values[i]);
    values = std::move(left);
  };
  taken(a);
  taken(b);
  taken(zone);
  for (PairColumn& column : columns) std::visit(taken, column.values);
}

std::vector<PairTable> read_pair_tables(const h5::Group& group) {
  std::vector<PairTable> tables;
  for (const std::string& name : names_in(group)) {
    if (!is_group(group, name)) continue;
    const h5::Group inner = group.open_group(name);
    if (inner.has(kA) && inner.has(kB) && inner.has(kZone)) tables.push_back(read_pair_table(inner, name));
  }
  return tables;
}

void write_pair_tables(const h5::Group& group, const std::vector<PairTable>& tables) {
  for (const PairTable& table : tables) {
    const h5::Group inner = group.create_group(table.kind);
    inner.write_array(kA, table.a, 1, "");
    inner.write_array(kB, table.b, 1, "");
    inner.write_array(kZone, table.zone, 1, "");
    for (const PairColumn& column : table.columns) {
      std::visit(
          [&](const auto& values) {
            if constexpr (std::is_same_v<std::decay_t<decltype(values)>, std::vector<Vec3>>)
              inner.write_array(column.name, values, column.unit);
            else
              inner.write_array(column.name, values, 1, column.unit);
          },
          column.values);
    }
  }
}

std::int64_t StartState::pair_count() const {
  std::set<std::tuple<std::int64_t, std::int64_t, std::int64_t>> keys;
  for (const PairTable& table : pairs) {
    for (std::size_t n = 0; n < table.size(); ++n) keys.emplace(table.a[n], table.b[n], table.zone[n]);
  }
  return static_cast<std::int64_t>(keys.size());
}

void write_start_state(const h5::Group& group, const StartState& start) {
  group.write_attribute("run", start.run);
  group.write_attribute("file", start.file);
  group.write_attribute("time", start.time);
  group.write_attribute("bodies", start.bodies);
  group.write_attribute("left", start.left);
  if (start.left_out > 0) group.write_attribute("left_out", start.left_out);
  if (start.clock > 0) group.write_attribute("clock", start.clock);
  if (!start.q_principal.empty()) {
    const h5::Group bodies = group.create_group("bodies");
    bodies.write_array("x_remainder", start.x_remainder, "m");
    bodies.write_array("q_principal", start.q_principal, "");
    bodies.write_array("q_remainder", start.q_remainder, "");
  }
  write_pair_tables(group.create_group("pairs"), start.pairs);
}

std::optional<StartState> read_start_state(const std::string& scene_path, std::size_t body_count) {
  const h5::File file(scene_path);
  if (!file.root().has("start")) return {};
  const h5::Group group = file.root().open_group("start");
  StartState start;
  start.run = group.read_text_attribute("run");
  start.file = group.read_text_attribute("file");
  start.time = group.read_double_attribute("time");
  start.bodies = group.read_integer_attribute("bodies");
  start.left = group.read_integer_attribute("left");
  if (group.has_attribute("left_out")) start.left_out = group.read_integer_attribute("left_out");
  if (start.left_out < 0) throw InputError("{}@left_out: {} found, a number of bodies expected", group.path(), start.left_out);
  if (group.has_attribute("clock")) start.clock = group.read_double_attribute("clock");
  if (!(start.clock >= 0) || !std::isfinite(start.clock))
    throw InputError("{}@clock: {:g} s found, at least 0 expected", group.path(), start.clock);
  if (start.bodies < 0 || start.bodies > static_cast<std::int64_t>(body_count))
    throw InputError("{}@bodies: {} found, but the scene has {} bodies", group.path(), start.bodies, body_count);
  if (group.has("bodies")) {
    const h5::Group bodies = group.open_group("bodies");
    start.x_remainder = bodies.read_vectors("x_remainder");
    start.q_principal = bodies.read_quaternions("q_principal");
    start.q_remainder = bodies.read_quaternions("q_remainder");
    const auto wanted = static_cast<std::size_t>(start.bodies);
    if (start.x_remainder.size() != wanted || start.q_principal.size() != wanted || start.q_remainder.size() != wanted)
      throw InputError("{}: {} rows expected in every dataset, as many as @bodies of the group above", bodies.path(), wanted);
    for (std::size_t i = 0; i < wanted; ++i) {
      const Quat& r = start.q_remainder[i];
      if (!is_finite(start.x_remainder[i]) || !std::isfinite(norm(r)) || !(std::abs(norm(start.q_principal[i]) - 1) <= kUnitTolerance))
        throw InputError("{}: row {} is not a unit quaternion with finite remainders", bodies.path(), i);
    }
  }
  start.pairs = read_pair_tables(group.open_group("pairs"));
  return start;
}

nlohmann::json start_json(const StartState& start) {
  nlohmann::json j{{"run", start.run},       {"file", start.file},          {"time", start.time},
                   {"bodies", start.bodies}, {"pairs", start.pair_count()}, {"pairs_left", start.left}};
  if (start.left_out > 0) j["left_out"] = start.left_out;
  if (start.clock > 0) j["clock"] = start.clock;
  return j;
}

}  // namespace scree
