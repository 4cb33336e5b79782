#include "solver/run/table.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <sstream>

#include "core/base/error.hpp"
#include "core/storage/h5.hpp"

namespace scree {

namespace {

template <class Part>
std::string joined(const std::vector<Column>& columns, Part&& part) {
  std::string line;
  for (const Column& c : columns) line.append(line.empty() ? "" : ",").append(part(c));
  return line + "\n";
}

}  // namespace

std::string header_of(const std::vector<Column>& columns) {
  return joined(columns, [](const Column& c) { return c.name; }) + "# units: " + joined(columns, [](const Column& c) { return c.unit; });
}

std::string row_of(const std::vector<Column>& columns) {
  return joined(columns, [](const Column& c) { return csv_cell(c.cell); });
}

std::size_t StepTable::column(const std::string& name) const {
  return static_cast<std::size_t>(std::find(names.begin(), names.end(), name) - names.begin());
}

StepTable read_table(const std::string& path) {
  constexpr std::size_t kMaxDigits = 18;  // of a step: more would not fit
  const auto is_step = [](const std::string& cell) {
    return !cell.empty() && cell.size() <= kMaxDigits && cell.find_first_not_of("0123456789") == std::string::npos;
  };
  StepTable table;
  const std::optional<CsvTable> all = read_csv(path);
  if (!all) return table;
  table.names = all->names;
  for (const CsvTable::Row& row : all->rows) {
    if (row.is_ended && row.cells.size() == table.names.size() && is_step(row.cells[0])) table.rows.push_back(row.cells);
  }
  return table;
}

void start_table(const std::string& path, const std::string& header, std::int64_t keep_up_to_step) {
  std::string text = header;
  if (keep_up_to_step >= 0) {
    const StepTable old = read_table(path);
    // columns by their names: those that a newer version adds are empty in the rows of an older one
    std::vector<std::size_t> from;
    std::istringstream names(header.substr(0, header.find('\n')));
    for (std::string name; std::getline(names, name, ',');) from.push_back(old.column(name));
    for (std::size_t row = 0; row < old.rows.size(); ++row) {
      if (old.step(row) > keep_up_to_step) continue;
      for (const std::size_t column : from) text.append(column < old.names.size() ? csv_cell(old.rows[row][column]) : "").append(1, ',');
      text.back() = '\n';
    }
  }
  h5::write_text_file(path, text);
}

void append_to_table(const std::string& path, const std::string& rows) {
  std::FILE* file = std::fopen(path.c_str(), "ab");
  if (file == nullptr) throw SystemError("cannot write {}: {}", path, std::strerror(errno));
  const long size = std::ftell(file);
  errno = 0;
  const bool written = std::fwrite(rows.data(), 1, rows.size(), file) == rows.size();
  int reason = errno;
  const bool closed = std::fclose(file) == 0;
  if (written && closed) return;
  if (reason == 0) reason = errno;
  // a row that a full disk cut short must not stay
  std::error_code error;
  if (size >= 0) std::filesystem::resize_file(path, static_cast<std::uintmax_t>(size), error);
  throw SystemError("cannot write {}: {}; free some space and restart from the last checkpoint", path, std::strerror(reason));
}

void sync_table(const std::string& path) {
  const int file = open(path.c_str(), O_RDONLY | O_CLOEXEC);
  const bool synced = file >= 0 && fsync(file) == 0;
  const int reason = errno;
  if (file >= 0) close(file);
  if (!synced) throw SystemError("cannot write {}: {}; free some space and restart from the last checkpoint", path, std::strerror(reason));
}

}  // namespace scree
