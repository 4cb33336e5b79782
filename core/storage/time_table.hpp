// A quantity that changes over time by a table.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

namespace scree {

class JsonObject;

/// Changes linearly between the rows, and stays as it is before the first and after the last. One row: a constant.
struct TimeTable {
  std::vector<double> time{};   ///< [s], ascending
  std::vector<double> value{};  ///< in the unit of the quantity
  static TimeTable constant(double value) { return {{0}, {value}}; }

  bool is_constant() const { return value.size() == 1; }
  /// 0 without rows.
  double at(double when) const;
  /// Over a time [unit of the quantity times s]; 0 where `to` is not after `from`, or without rows. Exact but for rounding.
  double integral(double from, double to) const;
  /// Of a time from `from` to `to` > `from`; a constant as it is.
  double mean(double from, double to) const { return is_constant() ? value.front() : integral(from, to) / (to - from); }
  double least() const;    ///< 0 without rows
  double largest() const;  ///< the same
  /// What is wrong with it, if anything; words that follow the name of the table.   in   values   what the values are, such as "rates"
  std::optional<std::string> fault(const char* values) const;

  /// A number where it is constant, else { time, value }.
  nlohmann::json json() const;
  /// Throws InputError for what json() cannot have written.
  static TimeTable read(const JsonObject& o, const char* key, const char* values);
};

}  // namespace scree
