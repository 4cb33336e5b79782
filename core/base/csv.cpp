#include "core/base/csv.hpp"

#include <algorithm>
#include <fstream>

namespace scree {

std::string csv_cell(const std::string& text) {
  if (text.find_first_of(",\"\r\n") == std::string::npos && !text.starts_with('#')) return text;
  std::string cell = "\"";
  for (const char c : text) cell += c == '"' ? std::string("\"\"") : std::string(1, c);
  return cell + "\"";
}

std::vector<std::string> csv_cells(const std::string& line) {
  std::vector<std::string> cells(1);
  bool inside = false;
  for (std::size_t i = 0; i < line.size(); ++i) {
    const char c = line[i];
    if (c == '"' && inside && i + 1 < line.size() && line[i + 1] == '"')
      cells.back() += line[i++];
    else if (c == '"')
      inside = !inside;
    else if (c == ',' && !inside)
      cells.emplace_back();
    else if (c != '\r' || i + 1 < line.size())
      cells.back() += c;
  }
  return cells;
}

std::size_t CsvTable::column(const std::string& name) const {
  return static_cast<std::size_t>(std::find(names.begin(), names.end(), name) - names.begin());
}

std::optional<CsvTable> read_csv(const std::string& path) {
  std::ifstream file(path);
  if (!file) return std::nullopt;
  CsvTable table;
  std::string line;
  for (std::size_t number = 1; std::getline(file, line); ++number) {
    if (line.empty() || line.starts_with('#')) continue;
    if (table.names.empty()) {
      table.header = line;
      table.names = csv_cells(line);
    } else {
      table.rows.push_back({number, !file.eof(), csv_cells(line)});
    }
  }
  return table;
}

}  // namespace scree
