// inserted.csv and removed.csv: a row for each body that came in or went out.
#pragma once

#include <string>
#include <vector>

#include "core/base/csv.hpp"

namespace scree {

/// A table of events, its columns found by name. Rows that a killed run left without an end are left out.
class EventTable {
 public:
  /// in   numbers, texts   names of the columns that are read
  /// in   optional         names of further texts, which follow those and are empty where the table has no such column
  /// Fails: InputError (missing, damaged: file and line).
  EventTable(const std::string& path, const std::vector<std::string>& numbers, const std::vector<std::string>& texts,
             const std::vector<std::string>& optional = {});
  std::size_t rows() const { return table_.rows.size(); }
  bool is_whole(std::size_t row) const;
  /// Of the columns as they were named.
  double number(std::size_t row, std::size_t column) const;
  const std::string& text(std::size_t row, std::size_t column = 0) const;
  [[noreturn]] void refuse(std::size_t row, const std::string& what) const;

 private:
  std::size_t find(const std::string& name) const;

  std::string path_;
  CsvTable table_;
  std::vector<std::size_t> columns_, texts_;
};

}  // namespace scree
