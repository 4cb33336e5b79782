// Reads a JSON object out of a file: every value is asked for by its name and checked, and what does not fit is refused with its
// place in the file, as a damaged file.
#pragma once

#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "core/base/error.hpp"
#include "core/base/words.hpp"
#include "core/geometry/vec3.hpp"

namespace scree {

// A quaternion may have lost digits on its way through text or single precision; beyond this it is damage.
inline constexpr double kUnitTolerance = 1e-6;

// What is unit to rounding keeps its bits, so that reading a file and writing it again changes nothing.
inline constexpr double kUnitRounding = 1e-15;

/// One JSON object inside a file, with its place in it for messages.
class JsonObject {
 public:
  JsonObject(const nlohmann::json& value, std::string where) : value_(value), where_(std::move(where)) {
    if (!value_.is_object()) throw InputError("{}: an object was expected, found {}; the file is damaged", where_, value_.type_name());
  }
  const nlohmann::json& at(const char* key) const {
    const auto it = value_.find(key);
    if (it == value_.end()) throw InputError("{}: '{}' is missing; the file is damaged", where_, key);
    return *it;
  }
  bool has(const char* key) const { return value_.contains(key); }
  JsonObject object(const char* key) const { return {at(key), where_ + "." + key}; }
  std::vector<JsonObject> objects(const char* key) const {
    const nlohmann::json& list = list_of(key);
    std::vector<JsonObject> result;
    for (std::size_t i = 0; i < list.size(); ++i) result.emplace_back(list[i], fmt::format("{}.{}[{}]", where_, key, i));
    return result;
  }
  double number(const char* key) const { return number_of(at(key), key); }
  double at_least(const char* key, double smallest) const {
    const double value = number(key);
    if (value < smallest) throw InputError("{}.{}: {:g} found, at least {:g} expected", where_, key, value, smallest);
    return value;
  }
  double positive(const char* key) const {
    const double value = number(key);
    if (!(value > 0)) throw InputError("{}.{}: {:g} found, a value > 0 expected", where_, key, value);
    return value;
  }
  std::int64_t integer(const char* key) const {
    const nlohmann::json& value = at(key);
    if (!value.is_number_integer()) throw wrong(key, "a whole number", value);
    return value.get<std::int64_t>();
  }
  std::int32_t index(const char* key, std::size_t count, const char* of) const {
    const std::int64_t value = integer(key);
    if (value < 0 || value >= static_cast<std::int64_t>(count)) {
      throw InputError("{}.{}: {} found, but there are {} {}", where_, key, value, count, of);
    }
    return static_cast<std::int32_t>(value);
  }
  bool boolean(const char* key) const {
    const nlohmann::json& value = at(key);
    if (!value.is_boolean()) throw wrong(key, "true or false", value);
    return value.get<bool>();
  }
  std::string text(const char* key) const {
    const nlohmann::json& value = at(key);
    if (!value.is_string()) throw wrong(key, "a text", value);
    return value.get<std::string>();
  }
  /// The value of an enum that a word stands for.
  template <class E>
  E word(const char* key) const {
    const std::string found = text(key);
    if (const std::optional<E> value = value_of<E>(found)) return *value;
    throw InputError("{}.{}: '{}' found, expected one of {}", where_, key, found, list_of_words<E>());
  }
  Vec3 vector(const char* key) const { return vector_of(at(key), key); }
  Vec3 unit_vector(const char* key) const {
    const Vec3 v = vector(key);
    if (std::abs(length(v) - 1) > kUnitTolerance) {
      throw InputError("{}.{}: length {:.9g} found, a unit vector expected", where_, key, length(v));
    }
    return std::abs(length(v) - 1) > kUnitRounding ? normalised(v) : v;
  }
  Quat quaternion(const char* key) const {
    const nlohmann::json& list = array_of(at(key), key, 4);
    const Quat q{number_of(list[0], key), number_of(list[1], key), number_of(list[2], key), number_of(list[3], key)};
    if (!(std::abs(norm(q) - 1) <= kUnitTolerance)) {
      throw InputError("{}.{}: norm {:.9g} found, a unit quaternion expected", where_, key, norm(q));
    }
    return std::abs(norm(q) - 1) > kUnitRounding ? normalised(q) : q;
  }
  std::vector<double> numbers(const char* key) const {
    std::vector<double> values;
    for (const nlohmann::json& value : list_of(key)) values.push_back(number_of(value, key));
    return values;
  }
  std::vector<Vec3> vectors(const char* key) const {
    std::vector<Vec3> values;
    for (const nlohmann::json& value : list_of(key)) values.push_back(vector_of(value, key));
    return values;
  }
  const std::string& where() const { return where_; }

 private:
  InputError wrong(const char* key, const char* expected, const nlohmann::json& found) const {
    return InputError("{}.{}: {} found, {} expected; the file is damaged", where_, key, found.dump(), expected);
  }
  const nlohmann::json& list_of(const char* key) const {
    const nlohmann::json& list = at(key);
    if (!list.is_array()) throw wrong(key, "a list", list);
    return list;
  }
  double number_of(const nlohmann::json& value, const char* key) const {
    // JSON has no NaN or infinity: they were written as null
    if (!value.is_number()) throw wrong(key, "a finite number", value);
    return value.get<double>();
  }
  const nlohmann::json& array_of(const nlohmann::json& value, const char* key, std::size_t size) const {
    if (!value.is_array() || value.size() != size) throw wrong(key, size == 3 ? "three numbers" : "four numbers", value);
    return value;
  }
  Vec3 vector_of(const nlohmann::json& value, const char* key) const {
    const nlohmann::json& list = array_of(value, key, 3);
    return {number_of(list[0], key), number_of(list[1], key), number_of(list[2], key)};
  }

  const nlohmann::json& value_;
  std::string where_;
};

}  // namespace scree
