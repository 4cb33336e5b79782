#include "core/base/utf8.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cstdint>

namespace scree {

namespace {

constexpr std::uint32_t kPrivate = 0xF700;  // of the private use area: U+F780 to U+F7FF stand for bytes

/// Length of the character of valid UTF-8 that begins at `at` and its number; 0 when none does.
std::size_t character_at(const std::string& text, std::size_t at, std::uint32_t& number) {
  const auto byte = [&](std::size_t k) { return static_cast<std::uint32_t>(static_cast<unsigned char>(text[k])); };
  const std::uint32_t first = byte(at);
  const std::size_t size = first < 0x80                    ? 1
                           : first >= 0xC2 && first < 0xE0 ? 2
                           : first >= 0xE0 && first < 0xF0 ? 3
                           : first >= 0xF0 && first < 0xF5 ? 4
                                                           : 0;
  if (size == 0 || at + size > text.size()) return 0;
  number = size == 1 ? first : first & (0x7FU >> size);
  for (std::size_t k = 1; k < size; ++k) {
    if ((byte(at + k) & 0xC0U) != 0x80U) return 0;
    number = (number << 6) | (byte(at + k) & 0x3FU);
  }
  // no longer form than needed, no surrogates, nothing beyond the last plane
  constexpr std::uint32_t kSmallest[] = {0, 0, 0x80, 0x800, 0x10000};
  return number >= kSmallest[size] && (number < 0xD800 || number > 0xDFFF) && number <= 0x10FFFF ? size : 0;
}

bool stands_for_byte(std::uint32_t number) { return number >= kPrivate + 0x80 && number <= kPrivate + 0xFF; }

std::string private_character(unsigned char byte) {
  const std::uint32_t number = kPrivate + byte;
  return {static_cast<char>(0xE0U | (number >> 12)), static_cast<char>(0x80U | ((number >> 6) & 0x3FU)),
          static_cast<char>(0x80U | (number & 0x3FU))};
}

bool is_utf8(const std::string& text) {
  std::uint32_t number = 0;
  for (std::size_t i = 0; i < text.size();) {
    const std::size_t size = character_at(text, i, number);
    if (size == 0) return false;
    i += size;
  }
  return true;
}

nlohmann::json with_valid_strings(const nlohmann::json& value) {
  const auto valid = [](const std::string& text) { return is_utf8(text) ? text : utf8_from_bytes(text); };
  if (value.is_string()) return valid(value.get_ref<const std::string&>());
  if (!value.is_structured()) return value;
  nlohmann::json copy = value.is_array() ? nlohmann::json::array() : nlohmann::json::object();
  for (const auto& [key, item] : value.items()) {
    if (value.is_array())
      copy.push_back(with_valid_strings(item));
    else
      copy[valid(key)] = with_valid_strings(item);
  }
  return copy;
}

}  // namespace

std::string utf8_from_bytes(const std::string& bytes) {
  std::string text;
  std::uint32_t number = 0;
  for (std::size_t i = 0; i < bytes.size();) {
    const std::size_t size = character_at(bytes, i, number);
    if (size > 0 && !stands_for_byte(number)) {
      text += bytes.substr(i, size);
      i += size;
    } else {
      text += private_character(static_cast<unsigned char>(bytes[i++]));
    }
  }
  return text;
}

std::string bytes_from_utf8(const std::string& text) {
  std::string bytes;
  std::uint32_t number = 0;
  for (std::size_t i = 0; i < text.size();) {
    const std::size_t size = std::max<std::size_t>(1, character_at(text, i, number));
    if (size == 3 && stands_for_byte(number))
      bytes += static_cast<char>(number - kPrivate);
    else
      bytes += text.substr(i, size);
    i += size;
  }
  return bytes;
}

std::string printable(const std::string& text) {
  std::string shown;
  std::uint32_t number = 0;
  for (std::size_t i = 0; i < text.size();) {
    const std::size_t size = character_at(text, i, number);
    if (size == 0)
      shown += fmt::format("\\x{:02X}", static_cast<unsigned char>(text[i]));
    else if (stands_for_byte(number))
      shown += fmt::format("\\x{:02X}", number - kPrivate);
    else
      shown += text.substr(i, size);
    i += std::max<std::size_t>(1, size);
  }
  return shown;
}

std::string json_text(const nlohmann::json& value, int indent) {
  try {
    return value.dump(indent);
  } catch (const nlohmann::json::type_error&) {  // a string that is no UTF-8
    return with_valid_strings(value).dump(indent);
  }
}

}  // namespace scree
