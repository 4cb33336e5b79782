// Text that need not be UTF-8: a path is any bytes, while JSON and pages are UTF-8.
//
// A byte that is not part of valid UTF-8 stands in JSON as one character of a private range, U+F700 + byte, and comes back from it as it
// was. What stands in that range already is written byte by byte in the same way, so that nothing is lost. (The idea is that of
// Python's surrogateescape, PEP 383; JSON allows no lone surrogates.)
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

namespace scree {

/// Any bytes as valid UTF-8, and back. Valid UTF-8 without characters of the private range stays as it is.
std::string utf8_from_bytes(const std::string& bytes);
std::string bytes_from_utf8(const std::string& text);

/// Any bytes for people to read: what is no UTF-8 (or was written by utf8_from_bytes) as "\xE4".
std::string printable(const std::string& text);

/// JSON as text. Strings that are no UTF-8 are written by utf8_from_bytes, where json::dump would throw.
std::string json_text(const nlohmann::json& value, int indent = -1);

}  // namespace scree
