#include "decomposer/case/parse_toml.hpp"

#include <algorithm>
#include <string_view>

#include "core/base/error.hpp"

namespace scree {

namespace {

/// Where the string that begins at `at` ends: the place after its closing quotes, or the end of the text.
std::size_t end_of_string(std::string_view text, std::size_t at) {
  const char quote = text[at];
  const std::string_view three = text.substr(at, 3);
  const bool has_lines = three.size() == 3 && three[1] == quote && three[2] == quote;
  const std::size_t width = has_lines ? 3 : 1;
  for (std::size_t i = at + width; i < text.size(); ++i) {
    if (text[i] == '\\' && quote == '"')
      ++i;
    else if (text[i] == '\n' && !has_lines)
      return i;  // not closed: the parser says so
    else if (text.substr(i, width) == text.substr(at, width))
      return i + width;
  }
  return text.size();
}

void check_key_lengths(std::string_view text, const std::string& path) {
  std::size_t dots = 0, line = 1;
  for (std::size_t i = 0; i < text.size();) {
    const char c = text[i];
    if (c == '"' || c == '\'') {
      const std::size_t end = end_of_string(text, i);
      line += static_cast<std::size_t>(
          std::count(text.begin() + static_cast<std::ptrdiff_t>(i), text.begin() + static_cast<std::ptrdiff_t>(end), '\n'));
      i = end;
      continue;
    }
    if (c == '#') {
      i = std::min(text.find('\n', i), text.size());
      continue;
    }
    if (c == '.' && ++dots >= kMaxKeyParts)
      throw UsageError("{}:{}: a key of more than {} parts; the longest of a case has fewer, see CASE.md", path, line, kMaxKeyParts);
    if (c == '\n') ++line;
    if (std::string_view("\n=,{}[]").find(c) != std::string_view::npos) dots = 0;
    ++i;
  }
}

}  // namespace

toml::table parse_toml(const std::string& text, const std::string& path) {
  check_key_lengths(text, path);
  return toml::parse(text, path);
}

}  // namespace scree
