// Pieces of the report's page.
#pragma once

#include <fmt/format.h>

#include <string>
#include <utility>
#include <vector>

#include "core/chart/svg_chart.hpp"

namespace scree {

using FactRows = std::vector<std::pair<std::string, std::string>>;

/// Two columns; values are HTML already.
inline std::string table_of(const FactRows& rows) {
  std::string html = "<table class=\"facts\">\n";
  for (const auto& [name, value] : rows) html += fmt::format("<tr><th scope=\"row\">{}</th><td>{}</td></tr>\n", escaped(name), value);
  return html + "</table>\n";
}

inline std::string section(const std::string& id, const std::string& title, const std::string& content) {
  return fmt::format("<section id=\"{}\">\n<h2>{}</h2>\n{}</section>\n", id, escaped(title), content);
}

}  // namespace scree
