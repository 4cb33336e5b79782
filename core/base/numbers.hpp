// Numbers that many files name.
#pragma once

#include <limits>
#include <numbers>

namespace scree {

inline constexpr double kPi = std::numbers::pi;
inline constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();  ///< what has no value: an empty cell in tables, null in JSON

}  // namespace scree
