// The tables of a run folder: they grow row by row, and a restart continues them. The first column is the step.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/base/csv.hpp"
#include "solver/state/column.hpp"

namespace scree {

/// Names, and the units as a comment.
std::string header_of(const std::vector<Column>& columns);
std::string row_of(const std::vector<Column>& columns);

/// A table as it was read: only rows that are complete, which end their line, begin with a step and have a cell for each column. What a
/// killed writer left of its last row is not.
struct StepTable {
  std::vector<std::string> names;
  std::vector<std::vector<std::string>> rows;
  std::size_t column(const std::string& name) const;  ///< names.size() when there is none
  std::int64_t step(std::size_t row) const { return std::stoll(rows[row][0]); }
};
/// Nothing when there is no such file.
StepTable read_table(const std::string& path);

/// Begins a table again with this header, and with the rows up to a step of the one that is there; a negative step keeps none.
void start_table(const std::string& path, const std::string& header, std::int64_t keep_up_to_step);
/// Adds rows and flushes them: all of them or, on a full disk, none. Throws SystemError (disk full).
void append_to_table(const std::string& path, const std::string& rows);
/// Waits until a table is on the disk: before a checkpoint that relies on its rows. Throws SystemError.
void sync_table(const std::string& path);

}  // namespace scree
