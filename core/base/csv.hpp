// Cells of comma-separated tables: names of walls, materials and runs may hold commas, quotes and line breaks.
#pragma once

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

}  // namespace scree
