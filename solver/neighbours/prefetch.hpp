// Asks for memory before it is read.
#pragma once

#include <cstddef>

namespace scree {

/// The lines of the cache that hold so many bytes from here on.
template <std::size_t kBytes>
void prefetch(const void* begin) {
  constexpr std::size_t kCacheLine = 64;
  for (std::size_t n = 0; n < kBytes; n += kCacheLine) __builtin_prefetch(static_cast<const char*>(begin) + n);
}

}  // namespace scree
