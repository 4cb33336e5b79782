#include "core/base/one_line.hpp"

#include <fmt/format.h>

namespace scree {

std::string fault_of_name(const std::string& text) {
  if (text.size() > kLongestName) {
    return fmt::format("has {} bytes; expected at most {}, since it stands in tables, pictures and attributes of files: give a shorter one",
                       text.size(), kLongestName);
  }
  const auto byte = [&](std::size_t i) { return i < text.size() ? static_cast<unsigned char>(text[i]) : 0U; };
  for (std::size_t i = 0; i < text.size(); ++i) {
    unsigned number = 0;
    if (byte(i) < 0x20 || byte(i) == 0x7F)
      number = byte(i);
    else if (byte(i) == 0xC2 && byte(i + 1) >= 0x80 && byte(i + 1) < 0xA0)
      number = byte(i + 1);
    else if (byte(i) == 0xE2 && byte(i + 1) == 0x80 && (byte(i + 2) == 0xA8 || byte(i + 2) == 0xA9))
      number = 0x2000 + byte(i + 2) - 0x80;
    else
      continue;
    const bool ends_line = number == '\n' || number == '\r' || number == 0x85 || number >= 0x2028;
    return fmt::format("has {} (U+{:04X}) as its character {}; expected one line of characters that can be seen",
                       ends_line ? "a line break" : "a control character", number, i + 1);
  }
  return "";
}

}  // namespace scree
