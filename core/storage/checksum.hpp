// A checksum of a file's bytes that many readers can share out among themselves.
#pragma once

#include <cstdint>
#include <string>

namespace scree {

/// splitmix64: every bit that goes in reaches every bit that comes out, and no two inputs give the same output.
/// Source: Steele, Lea, Flood, Fast splittable pseudorandom number generators, 2014.
inline std::uint64_t mix(std::uint64_t h) {
  h += 0x9E3779B97F4A7C15ull;
  h = (h ^ (h >> 30)) * 0xBF58476D1CE4E5B9ull;
  h = (h ^ (h >> 27)) * 0x94D049BB133111EBull;
  return h ^ (h >> 31);
}

/// Sum, modulo 2^64, over the 8-byte words of a range of a file, of a one-to-one function of each word that depends on its
/// place. Sums of adjoining ranges add up to that of the whole, so that every rank reads only its part. A change within one
/// word is always found, any other with probability 1 - 2^-64. It guards against accidents, not against forgery.
/// in   first, last   [B], the range; `first` a multiple of 8; what lies behind the end of the file counts as zeros
/// Fails: throws SystemError when the file cannot be read.   Cost: as fast as the file is read.
std::uint64_t checksum_of_range(const std::string& path, std::int64_t first, std::int64_t last);

}  // namespace scree
