// Numbers from the bytes of a binary mesh file, each checked against the end of the file.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>
#include <string>
#include <string_view>

#include "core/base/error.hpp"

namespace scree {

/// Takes numbers from the front of bytes that the caller keeps alive.   Fails: InputError at the end of the bytes.
class ByteReader {
 public:
  ByteReader(std::string_view bytes, std::string path, std::endian order = std::endian::little, std::size_t start = 0)
      : bytes_(bytes), path_(std::move(path)), order_(order), at_(start) {}
  template <class T>
  T take() {
    need(sizeof(T));
    std::array<char, sizeof(T)> raw;
    std::memcpy(raw.data(), bytes_.data() + at_, sizeof(T));
    if (order_ != std::endian::native) std::reverse(raw.begin(), raw.end());
    at_ += sizeof(T);
    return std::bit_cast<T>(raw);
  }
  void skip(std::size_t count) {
    need(count);
    at_ += count;
  }
  std::size_t at() const { return at_; }
  std::size_t left() const { return bytes_.size() - at_; }
  /// Whether nothing follows but what ends lines: some programs end binary files with it, too.
  bool is_blank_to_end() const { return bytes_.find_first_not_of(" \r\n", at_) == std::string_view::npos; }

 private:
  void need(std::size_t count) const {
    if (left() >= count) return;
    throw InputError(
        "{}: the file ends after {} bytes, in the middle of its data; it is truncated or damaged: export the "
        "model again",
        path_, bytes_.size());
  }
  std::string_view bytes_;
  std::string path_;
  std::endian order_;
  std::size_t at_ = 0;
};

}  // namespace scree
