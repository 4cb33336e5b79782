#include "core/storage/json_keys.hpp"

#include <nlohmann/json.hpp>

namespace scree {

namespace {

using nlohmann::json;

const char* name_of(const Key& key) { return key.in_file.name != nullptr ? key.in_file.name : key.name; }

// A velocity is kept as two members of these names.
constexpr const char* kSpeedName = "rate";
constexpr const char* kDirectionName = "axis";

}  // namespace

json to_json(const Vec3& v) { return json::array({v.x, v.y, v.z}); }
json to_json(const Quat& q) { return json::array({q.w, q.x, q.y, q.z}); }

void JsonKeyWriter::number(const Key& key, double& value, Dimension, Range) { object_[name_of(key)] = value; }
void JsonKeyWriter::count(const Key& key, std::uint64_t& value) { object_[name_of(key)] = value; }
void JsonKeyWriter::boolean(const Key& key, bool& value) { object_[name_of(key)] = value; }
void JsonKeyWriter::text(const Key& key, std::string& value) { object_[name_of(key)] = value; }
void JsonKeyWriter::vector(const Key& key, Vec3& value, Dimension) { object_[name_of(key)] = to_json(value); }
void JsonKeyWriter::direction(const Key& key, Vec3& value) { object_[name_of(key)] = to_json(value); }
void JsonKeyWriter::velocity(const Key&, double& speed, Vec3& direction) {
  object_[kSpeedName] = speed;
  object_[kDirectionName] = to_json(direction);
}
void JsonKeyWriter::numbers(const Key& key, std::vector<double>& values, Dimension) { object_[name_of(key)] = values; }
void JsonKeyWriter::vectors(const Key& key, std::vector<Vec3>& values, Dimension) {
  json& list = object_[name_of(key)] = json::array();
  for (const Vec3& v : values) list.push_back(to_json(v));
}
void JsonKeyWriter::axes(const Key& key, std::array<bool, 3>& value) { object_[name_of(key)] = value; }
void JsonKeyWriter::choose(const Key& key, std::size_t& index, const std::vector<std::string>& words) {
  object_[name_of(key)] = words[index];
}

bool JsonKeyReader::is_there(const Key& key) const { return key.in_file.always || object_.has(name_of(key)); }

void JsonKeyReader::number(const Key& key, double& value, Dimension, Range range) {
  if (!is_there(key)) return;
  const bool has_default = !key.needed && key.otherwise != kRequired;
  const double found = object_.number(name_of(key));
  if (has_default && found == value) return;
  value = found;
  const auto refuse = [&](const char* expected) {
    throw InputError("{}.{}: {:g} found, {} expected", object_.where(), name_of(key), found, expected);
  };
  if (range == Range::positive && !(found > 0)) refuse("a value > 0");
  if (range == Range::not_negative && !(found >= 0)) refuse("at least 0");
  if (range == Range::unit_interval && !(found >= 0 && found <= 1)) refuse("a value from 0 to 1");
  if (range == Range::fraction && !(found > 0 && found < 1)) refuse("a value between 0 and 1");
}

void JsonKeyReader::count(const Key& key, std::uint64_t& value) {
  if (!is_there(key)) return;
  const json& found = object_.at(name_of(key));
  if (!found.is_number_unsigned()) {
    throw InputError("{}.{}: {} found, a whole number >= 0 expected", object_.where(), name_of(key), found.dump());
  }
  value = found.get<std::uint64_t>();
}

void JsonKeyReader::boolean(const Key& key, bool& value) {
  if (is_there(key)) value = object_.boolean(name_of(key));
}

void JsonKeyReader::text(const Key& key, std::string& value) {
  if (is_there(key)) value = object_.text(name_of(key));
}

void JsonKeyReader::vector(const Key& key, Vec3& value, Dimension) {
  if (is_there(key)) value = object_.vector(name_of(key));
}

void JsonKeyReader::direction(const Key& key, Vec3& value) {
  if (is_there(key)) value = object_.unit_vector(name_of(key));
}

void JsonKeyReader::velocity(const Key&, double& speed, Vec3& direction) {
  direction = object_.unit_vector(kDirectionName);
  speed = object_.number(kSpeedName);
}

void JsonKeyReader::numbers(const Key& key, std::vector<double>& values, Dimension) {
  if (is_there(key)) values = object_.numbers(name_of(key));
}

void JsonKeyReader::vectors(const Key& key, std::vector<Vec3>& values, Dimension) {
  if (is_there(key)) values = object_.vectors(name_of(key));
}

void JsonKeyReader::axes(const Key& key, std::array<bool, 3>& value) {
  if (!is_there(key)) return;
  const json& list = object_.at(name_of(key));
  if (!list.is_array() || list.size() != 3) throw InputError("{}.{}: three values expected", object_.where(), name_of(key));
  for (std::size_t k = 0; k < 3; ++k) {
    if (!list[k].is_boolean()) throw InputError("{}.{}: true or false expected", object_.where(), name_of(key));
    value[k] = list[k].get<bool>();
  }
}

void JsonKeyReader::choose(const Key& key, std::size_t& index, const std::vector<std::string>& words) {
  if (!is_there(key)) return;
  const std::string found = object_.text(name_of(key));
  std::string list;
  for (std::size_t i = 0; i < words.size(); ++i) {
    if (found == words[i]) {
      index = i;
      return;
    }
    list += (i == 0 ? "" : ", ") + words[i];
  }
  throw InputError("{}.{}: '{}' found, expected one of {}", object_.where(), name_of(key), found, list);
}

}  // namespace scree
