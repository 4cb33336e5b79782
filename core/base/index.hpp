// Indices of the files and meshes are 32 bits wide and signed; those of containers are neither.
#pragma once

#include <cstddef>
#include <cstdint>

namespace scree {

/// in   i   >= 0
constexpr std::size_t at(std::int32_t i) { return static_cast<std::size_t>(i); }

}  // namespace scree
