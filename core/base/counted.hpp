// "1 hole", "3 holes".
#pragma once

#include <fmt/format.h>

#include <cstdint>
#include <string>

namespace scree {

inline std::string counted(std::int64_t count, const char* one, const char* many) {
  return fmt::format("{} {}", count, count == 1 ? one : many);
}

}  // namespace scree
