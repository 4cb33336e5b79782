// The text of a case as a TOML table.
#pragma once

#include <toml++/toml.h>
#include <string>

namespace scree {

/// Parts of a key such as shapes.rock.file. No key of a case has more than seven; --set counts indices of lists too.
inline constexpr std::size_t kMaxKeyParts = 16;

/// Parses a text, whose keys may have kMaxKeyParts parts.
///
/// Tables inside tables are destroyed, and read, by functions that call themselves: a key of some ten thousand parts would overflow the
/// stack. Values inside values are limited by the parser (256).
/// in   path   for messages
/// Fails: throws UsageError for such a key, and toml::parse_error.
toml::table parse_toml(const std::string& text, const std::string& path);

}  // namespace scree
