// How much an inlet lets in over time.
#pragma once

#include <optional>
#include <string>

#include "core/storage/time_table.hpp"

namespace scree {

struct FeedRate {
  bool by_number = false;  ///< bodies per time [1/s]; else mass per time [kg/s]
  TimeTable rate{};        ///< >= 0, from the start of the inlet
  /// What has come by a time since the start [kg], or a number of bodies: the integral of the rate.
  double amount(double elapsed) const { return rate.integral(0, elapsed); }
  double largest() const { return rate.largest(); }
  /// What is wrong with the table, if anything: the key and the words behind it.
  std::optional<std::string> fault() const;
};

}  // namespace scree
