#include "decomposer/case/case_table.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <sstream>

#include "core/base/nearest_name.hpp"
#include "core/base/numbers.hpp"
#include "core/base/one_line.hpp"

namespace scree {

namespace {

/// A text of the user's in a message: its beginning, with control characters as escapes of TOML.
std::string shown(const std::string& text, std::size_t most) {
  std::string result;
  for (const char c : text.substr(0, most)) {
    const auto byte = static_cast<unsigned char>(c);
    result += byte < 0x20 || byte == 0x7F ? fmt::format("\\u{:04X}", byte) : std::string(1, c);
  }
  return text.size() > most ? result + "..." : result;
}

std::string value_text(const toml::node& node) {
  std::ostringstream text;
  node.visit([&](const auto& value) { text << value; });
  std::string result = text.str();
  if (node.is_table() || node.is_array()) std::replace(result.begin(), result.end(), '\n', ' ');  // toml++ writes tables in lines
  if (node.is_string()) {
    result = node.value_or(std::string{});
    result = "\"" + result + "\"";
  }
  // as short as it reads back: 0.1, where toml++ writes 0.10000000000000001
  if (const toml::value<double>* number = node.as_floating_point()) result = fmt::format("{}", number->get());
  constexpr std::size_t kLongest = 60;
  return shown(result, kLongest);
}

std::string type_text(const toml::node& node) {
  switch (node.type()) {
    case toml::node_type::table:
      return "a table";
    case toml::node_type::array:
      return "a list";
    case toml::node_type::string:
      return "a text";
    case toml::node_type::integer:
    case toml::node_type::floating_point:
      return "a number";
    case toml::node_type::boolean:
      return "true or false";
    default:
      return "a date or time";
  }
}

std::string list_of(const std::vector<std::string>& words) {
  std::string text;
  for (std::size_t i = 0; i < words.size(); ++i) text += (i == 0 ? "" : ", ") + words[i];
  return text;
}

/// What a text with a unit is, when a plain number was expected: "a length".
std::string dimension_of(const std::string& text) {
  for (const Dimension d : {Dimension::length,
                            Dimension::time,
                            Dimension::mass,
                            Dimension::velocity,
                            Dimension::acceleration,
                            Dimension::angular_velocity,
                            Dimension::angle,
                            Dimension::frequency,
                            Dimension::density,
                            Dimension::stiffness,
                            Dimension::pressure,
                            Dimension::force,
                            Dimension::stress_per_length,
                            Dimension::viscosity,
                            Dimension::energy,
                            Dimension::surface_energy,
                            Dimension::area,
                            Dimension::volume,
                            Dimension::moment_of_inertia,
                            Dimension::damping,
                            Dimension::rotational_damping}) {
    try {
      parse_quantity(text, d, "");
      std::string name = dimension_name(d);
      return name.substr(0, name.find(" ["));
    } catch (const UsageError&) {
      continue;
    }
  }
  return "";
}

}  // namespace

CaseTable::CaseTable(const toml::table& table, std::string file, std::string path, const std::vector<std::string>& keys)
    : table_(&table), file_(std::move(file)), path_(std::move(path)) {
  if (keys.empty()) return;
  for (const std::string& key : this->keys()) {
    if (std::find(keys.begin(), keys.end(), key) != keys.end()) continue;
    const std::string near = nearest_name(key, keys);
    throw UsageError("{}: unknown key{}", where(key),
                     near.empty() ? "; expected one of: " + list_of(keys) : ", did you mean '" + near + "'?");
  }
}

std::vector<std::string> CaseTable::keys() const {
  std::vector<std::string> keys;
  for (const auto& [name, value] : *table_) keys.emplace_back(name.str());
  return keys;
}

std::string CaseTable::where(const std::string& key) const {
  const toml::node* found = table_->get(key);
  const auto line = found != nullptr ? found->source().begin.line : table_->source().begin.line;
  std::string place = line > 0 ? fmt::format("{}:{}", file_, line) : file_;
  const std::string dot = path_.empty() || key.empty() ? "" : ".";
  const std::string full = path_ + dot + key;
  constexpr std::size_t kLongest = 200;
  return full.empty() ? place : place + ": " + shown(full, kLongest);
}

UsageError CaseTable::error(const std::string& key, const std::string& text) const {
  const toml::node* found = table_->get(key);
  return found == nullptr ? UsageError("{}: {}", where(key), text) : UsageError("{} = {}: {}", where(key), value_text(*found), text);
}

UsageError CaseTable::wrong_type(const std::string& key, const std::string& expected) const {
  return error(key, type_text(node(key)) + " found, expected " + expected);
}

const toml::node& CaseTable::node(const std::string& key) const {
  const toml::node* found = table_->get(key);
  if (found == nullptr) throw UsageError("{}: is missing", where(key));
  return *found;
}

void CaseTable::require(const std::string& key, std::string_view expected) const {
  if (!has(key)) throw UsageError("{}: is missing; expected {}", where(key), expected);
}

void CaseTable::check_range(const std::string& key, double value, Range range) const {
  if (range == Range::positive && !(value > 0)) throw error(key, "expected a value > 0");
  if (range == Range::not_negative && !(value >= 0)) throw error(key, "expected a value >= 0");
  if (range == Range::unit_interval && !(value >= 0 && value <= 1)) throw error(key, "expected a value of at least 0 and at most 1");
  if (range == Range::fraction && !(value > 0 && value < 1)) throw error(key, "expected a value between 0 and 1");
}

double CaseTable::number_of(const toml::node& value, const std::string& key, Dimension dimension) const {
  double result = 0;
  if (const auto number = value.is_boolean() ? std::optional<double>{} : value.value<double>(); number && !value.is_string()) {
    result = *number;
  } else if (const auto text = value.value<std::string>()) {
    if (dimension == Dimension::none) {
      // a number in quotes, or one with a unit where none belongs
      double bare = 0;
      const char* last = text->data() + text->size();
      const auto [end, fault] = std::from_chars(text->data(), last, bare);
      if (fault == std::errc{} && end != last) {
        const std::string kind = dimension_of(*text);
        if (!kind.empty() && key.find("friction") != std::string::npos && text->find("deg") != std::string::npos)
          throw error(key, bare >= 0 && bare < 90
                               ? fmt::format("{}, but {} is the tangent of the angle; write {:.6g}", kind, key, std::tan(bare * kPi / 180))
                               : fmt::format("{}, but {} is the tangent of an angle from 0 to below 90 degrees", kind, key));
        if (!kind.empty()) throw error(key, fmt::format("{}, but {} has no unit; write {:g}", kind, key, bare));
      }
    }
    result = parse_quantity(*text, dimension, where(key));
  } else {
    throw error(key, type_text(value) + " found, expected " + dimension_name(dimension));
  }
  if (!std::isfinite(result)) throw error(key, "expected a finite number");
  constexpr double kLargest = 1e100;  // squares and cubes of it can still be computed with
  if (std::abs(result) > kLargest) throw error(key, fmt::format("is too large to compute with; expected a number up to {:g}", kLargest));
  return result;
}

double CaseTable::number(const std::string& key, Dimension dimension, Range range) const {
  if (!has(key)) throw UsageError("{}: is missing; expected {}", where(key), dimension_name(dimension));
  const double value = number_of(node(key), key, dimension);
  check_range(key, value, range);
  return value;
}

std::int64_t CaseTable::integer(const std::string& key, std::int64_t smallest) const {
  require(key, "a whole number");
  const toml::node& value = node(key);
  const auto number = value.is_integer() ? value.value<std::int64_t>() : std::optional<std::int64_t>{};
  if (!number) throw wrong_type(key, "a whole number");
  if (*number < smallest) throw error(key, fmt::format("expected a whole number of at least {}", smallest));
  return *number;
}

bool CaseTable::boolean(const std::string& key) const {
  require(key, "true or false");
  if (!node(key).is_boolean()) throw wrong_type(key, "true or false");
  return *node(key).value<bool>();
}

std::string CaseTable::text_of(const toml::node& value, const std::string& key) const {
  std::string text = *value.value<std::string>();
  if (const std::string fault = fault_of_name(text); !fault.empty()) throw error(key, fault);
  return text;
}

std::string CaseTable::text(const std::string& key) const {
  require(key, "a text in quotes");
  if (!node(key).is_string()) throw wrong_type(key, "a text in quotes");
  return text_of(node(key), key);
}

std::string CaseTable::path(const std::string& key) const {
  require(key, "a path in quotes");
  if (!node(key).is_string()) throw wrong_type(key, "a path in quotes");
  std::string path = *node(key).value<std::string>();
  if (path.find('\0') != std::string::npos) throw error(key, "holds U+0000, which no path can have");
  return path;
}

const toml::array& CaseTable::array(const std::string& key, std::size_t size, const std::string& expected) const {
  require(key, expected);
  const toml::array* list = node(key).as_array();
  if (list == nullptr || (size > 0 && list->size() != size)) throw error(key, "expected " + expected);
  return *list;
}

Vec3 CaseTable::vector_of(const toml::node& value, const std::string& key, Dimension dimension) const {
  const toml::array* list = value.as_array();
  if (list == nullptr || list->size() != 3) throw error(key, "expected three numbers [x, y, z], each " + dimension_name(dimension));
  return {number_of(*list->get(0), key, dimension), number_of(*list->get(1), key, dimension), number_of(*list->get(2), key, dimension)};
}

Vec3 CaseTable::vector(const std::string& key, Dimension dimension) const {
  if (!has(key)) require(key, "three numbers [x, y, z], each " + dimension_name(dimension));
  return vector_of(node(key), key, dimension);
}

Vec3 CaseTable::direction(const std::string& key) const {
  const Vec3 v = vector(key, Dimension::none);
  if (!(length(v) > 0)) throw error(key, "a direction must not be zero");
  return normalised(v);
}

std::vector<double> CaseTable::numbers(const std::string& key, Dimension dimension) const {
  std::vector<double> values;
  for (const toml::node& value : array(key, 0, "a list of numbers")) values.push_back(number_of(value, key, dimension));
  return values;
}

std::vector<Vec3> CaseTable::vectors(const std::string& key, Dimension dimension) const {
  std::vector<Vec3> values;
  for (const toml::node& value : array(key, 0, "a list of vectors [x, y, z]")) values.push_back(vector_of(value, key, dimension));
  return values;
}

std::vector<std::string> CaseTable::texts(const std::string& key) const {
  std::vector<std::string> values;
  for (const toml::node& value : array(key, 0, "a list of texts")) {
    if (!value.is_string()) throw error(key, "expected a list of texts in quotes");
    values.push_back(text_of(value, key));
  }
  return values;
}

std::pair<Vec3, Vec3> CaseTable::corners(const std::string& key) const {
  const toml::array& list = array(key, 2, "two opposite corners [[x, y, z], [x, y, z]]");
  const Vec3 lower = vector_of(*list.get(0), key, Dimension::length), upper = vector_of(*list.get(1), key, Dimension::length);
  for (int k = 0; k < 3; ++k) {
    if (!(lower[k] < upper[k])) throw error(key, "the first corner must be below the second in x, y and z");
  }
  return {lower, upper};
}

std::size_t CaseTable::word(const std::string& key, const std::vector<std::string>& words) const {
  if (!has(key)) require(key, "one of: " + list_of(words));
  const std::string found = text(key);
  const auto at = std::find(words.begin(), words.end(), found);
  if (at != words.end()) return static_cast<std::size_t>(at - words.begin());
  const std::string near = nearest_name(found, words);
  throw error(key, near.empty() ? "unknown; expected one of: " + list_of(words) : "unknown, did you mean '" + near + "'?");
}

std::int32_t CaseTable::find_name(const std::string& key, const std::string& name, const std::vector<std::string>& names,
                                  const std::string& kind) const {
  const auto it = std::find(names.begin(), names.end(), name);
  if (it != names.end()) return static_cast<std::int32_t>(it - names.begin());
  const std::string near = nearest_name(name, names);
  throw error(key, fmt::format("there is no {} '{}'{}", kind, name,
                               names.empty()  ? "; the case defines none"
                               : near.empty() ? "; defined are: " + list_of(names)
                                              : ", did you mean '" + near + "'?"));
}

std::int32_t CaseTable::reference(const std::string& key, const std::vector<std::string>& names, const std::string& kind) const {
  return find_name(key, text(key), names, kind);
}

CaseTable CaseTable::table(const std::string& key, const std::vector<std::string>& keys) const {
  const toml::table* found = node(key).as_table();
  if (found == nullptr) throw wrong_type(key, "a table, for instance { " + (keys.empty() ? "name" : keys.front()) + " = ... }");
  const std::string dot = path_.empty() ? "" : ".";
  return {*found, file_, path_ + dot + key, keys};
}

void CaseTable::check_name(const std::string& name) const {
  constexpr std::size_t kLongest = 60;
  if (const std::string fault = fault_of_name(name); !fault.empty())
    throw UsageError("{}: the name \"{}\" {}", where(), shown(name, kLongest), fault);
}

std::vector<CaseTable> CaseTable::tables(const std::string& key, const std::vector<std::string>& keys) const {
  std::vector<CaseTable> result;
  if (!has(key)) return result;
  const toml::array* list = node(key).as_array();
  if (list == nullptr) throw wrong_type(key, "[[" + key + "]] sections");
  for (std::size_t i = 0; i < list->size(); ++i) {
    const toml::table* found = list->get(i)->as_table();
    if (found == nullptr) throw wrong_type(key, "[[" + key + "]] sections");
    result.push_back({*found, file_, fmt::format("{}[{}]", key, i), keys});
  }
  return result;
}

std::vector<std::pair<std::string, CaseTable>> CaseTable::named_tables(const std::string& key, const std::vector<std::string>& keys) const {
  std::vector<std::pair<std::string, CaseTable>> result;
  if (!has(key)) return result;
  const CaseTable all = table(key, {});
  for (const auto& [name, value] : *all.table_) {
    const std::string word(name.str());
    const toml::table* found = value.as_table();
    all.check_name(word);
    if (found == nullptr) throw all.wrong_type(word, "a section [" + key + "." + word + "]");
    result.emplace_back(word, CaseTable(*found, file_, key + "." + word, keys));
  }
  return result;
}

std::vector<std::pair<std::string, double>> CaseTable::named_numbers(const std::string& key, Range range) const {
  const CaseTable all = table(key, {});
  std::vector<std::pair<std::string, double>> result;
  for (const auto& [name, value] : *all.table_) {
    const std::string word(name.str());
    result.emplace_back(word, all.number(word, Dimension::none, range));
  }
  if (result.empty()) throw error(key, "is empty");
  return result;
}

std::vector<std::pair<std::string, std::string>> CaseTable::named_texts(const std::string& key) const {
  const CaseTable all = table(key, {});
  std::vector<std::pair<std::string, std::string>> result;
  for (const std::string& name : all.keys()) {
    all.check_name(name);
    result.emplace_back(name, all.text(name));
  }
  if (result.empty()) throw error(key, "is empty");
  return result;
}

std::string CaseTable::only_one_of(const std::vector<const char*>& keys) const {
  std::string found, list;
  for (const char* key : keys) {
    list += (list.empty() ? "" : ", ") + std::string(key);
    if (!has(key)) continue;
    if (!found.empty()) throw UsageError("{}: gives both '{}' and '{}'; give one of them", where(), found, key);
    found = key;
  }
  if (found.empty()) throw UsageError("{}: expected one of: {}", where(), list);
  return found;
}

}  // namespace scree
