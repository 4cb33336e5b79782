// Pieces of the report's page.
#pragma once

#include <fmt/format.h>

#include <cctype>
#include <string>
#include <utility>
#include <vector>

#include "core/chart/svg_chart.hpp"
#include "post/vtk/view_data.hpp"

namespace scree {

using FactRows = std::vector<std::pair<std::string, std::string>>;

/// Two columns; values are HTML already.
inline std::string table_of(const FactRows& rows) {
  std::string html = "<table class=\"facts\">\n";
  for (const auto& [name, value] : rows) html += fmt::format("<tr><th scope=\"row\">{}</th><td>{}</td></tr>\n", escaped(name), value);
  return html + "</table>\n";
}

/// A chart with a link to its numbers, which stand in the page too.
template <class Chart>
std::string figure(const Chart& chart) {
  std::string name;
  for (const char c : chart.title) name += std::isalnum(static_cast<unsigned char>(c)) != 0 ? static_cast<char>(std::tolower(c)) : '-';
  return fmt::format(
      "<figure class=\"chart\">{}<figcaption><a download=\"{}.csv\" href=\"data:text/csv;base64,{}\">numbers as "
      "CSV</a></figcaption></figure>\n",
      svg_of(chart), name, base64(csv_of(chart)));
}

inline std::string section(const std::string& id, const std::string& title, const std::string& content) {
  return fmt::format("<section id=\"{}\">\n<h2>{}</h2>\n{}</section>\n", id, escaped(title), content);
}

}  // namespace scree
