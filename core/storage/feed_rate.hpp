// How much an inlet lets in over time.
#pragma once

#include <optional>
#include <string>
#include <vector>

namespace scree {

/// A rate that changes linearly between the rows of a table, and stays as it is before the first and after the last.
struct FeedRate {
  bool by_number = false;      ///< bodies per time [1/s]; else mass per time [kg/s]
  std::vector<double> time{};  ///< [s] from the start of the inlet, ascending
  std::vector<double> rate{};  ///< >= 0
  /// What has come by a time since the start [kg], or a number of bodies: the integral of the rate.
  double amount(double elapsed) const;
  double largest() const;
  /// What is wrong with the table, if anything: the key and the words behind it.
  std::optional<std::string> fault() const;
};

}  // namespace scree
