// Cells of comma-separated tables: names of walls, materials and runs may hold commas, quotes and line breaks.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

namespace scree {

/// A text as a cell: as it is where that is safe, else in quotes with inner quotes doubled.
///
/// How: RFC 4180, section 2. A cell that begins with '#' is quoted too: such a line is a comment here. Bytes that are no UTF-8 are kept.
std::string csv_cell(const std::string& text);

/// The cells of one line, without quotes. A carriage return at its end is dropped.
/// Limits: a cell with a line break spans lines, which the caller would have to join.
std::vector<std::string> csv_cells(const std::string& line);

/// A table with one header line. Empty lines and comments, which begin with '#', are left out.
struct CsvTable {
  struct Row {
    std::size_t line = 0;  ///< its number in the file, from 1
    bool is_ended = true;  ///< false for a last line that its writer has not ended, or was killed before it did
    std::vector<std::string> cells;
  };
  std::string header;              ///< the line as it is
  std::vector<std::string> names;  ///< its cells
  std::vector<Row> rows;

  std::size_t column(const std::string& name) const;  ///< names.size() when there is none
};

/// Reads a table; nothing when the file cannot be opened. Rows are not checked: whether one of another length than the header is an
/// error or only torn is for the caller to say.   Cost: the whole table in memory.
std::optional<CsvTable> read_csv(const std::string& path);

}  // namespace scree
