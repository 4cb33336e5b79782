// Names and titles: of one line that every table, message, legend and attribute of a file can hold.
#pragma once

#include <cstddef>
#include <string>

namespace scree {

/// An HDF5 object holds 64 kB of attributes in all, and some have two names in them; tables and legends want far less.
inline constexpr std::size_t kLongestName = 1000;  // [bytes]

/// Why a text cannot be a name, for a message after its place and value; empty when it can.
///
/// Refuses more than kLongestName bytes, and what does not show or ends a line: control characters (U+0000 to U+001F, U+007F to U+009F)
/// and the separators U+2028 and U+2029. Bytes that are no UTF-8 are left alone.
std::string fault_of_name(const std::string& text);

}  // namespace scree
