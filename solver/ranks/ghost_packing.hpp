// How ghosts lie in a message: one array for each field, one after the other. Against one record for each body it takes 3 to 12 %
// less time to pack and unpack, for the same bytes (scree-bench-halo-packing). The fields are those of body_columns.hpp with kGhost.
#pragma once

#include <cstdint>
#include <cstring>
#include <span>
#include <vector>

#include "solver/bodies/particle_set.hpp"

namespace scree {

/// What travels of a ghost in every step [bytes].
inline constexpr std::size_t kGhostBytes = [] {
  std::size_t bytes = 0;
  for_each_body_column([&bytes](const auto& c) {
    if (c.uses & kGhost) bytes += sizeof(typename std::decay_t<decltype(c)>::Value);
  });
  return bytes;
}();

template <class T>
char* pack_field(const std::vector<T>& field, std::span<const std::int32_t> rows, char* buffer) {
  T* out = reinterpret_cast<T*>(buffer);
  for (const std::int32_t row : rows) *out++ = field[static_cast<std::size_t>(row)];
  return reinterpret_cast<char*>(out);
}

template <class T>
const char* unpack_field(std::vector<T>& field, std::size_t first, std::size_t count, const char* buffer) {
  if (count > 0) std::memcpy(&field[first], buffer, count * sizeof(T));
  return buffer + count * sizeof(T);
}

/// out  buffer   kGhostBytes for each row
inline void pack_ghosts(const ParticleSet& p, std::span<const std::int32_t> rows, char* buffer) {
  for_each_body_column([&](const auto& c) {
    if (c.uses & kGhost) buffer = pack_field(p.*c.column, rows, buffer);
  });
}

/// Into rows [first, first + count).
inline void unpack_ghosts(ParticleSet& p, std::size_t first, std::size_t count, const char* buffer) {
  for_each_body_column([&](const auto& c) {
    if (c.uses & kGhost) buffer = unpack_field(p.*c.column, first, count, buffer);
  });
}

}  // namespace scree
