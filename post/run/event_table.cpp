#include "post/run/event_table.hpp"

#include <optional>

#include "core/base/error.hpp"

namespace scree {

EventTable::EventTable(const std::string& path, const std::vector<std::string>& numbers, const std::vector<std::string>& texts,
                       const std::vector<std::string>& optional)
    : path_(path) {
  const std::optional<CsvTable> read = read_csv(path);
  if (!read) throw InputError("{}: cannot be read", path);
  table_ = *read;
  for (const std::string& name : numbers) columns_.push_back(find(name));
  for (const std::string& name : texts) texts_.push_back(find(name));
  for (const std::string& name : optional) texts_.push_back(table_.column(name));
}

const std::string& EventTable::text(std::size_t row, std::size_t column) const {
  static const std::string kNone;
  const std::size_t at = texts_[column];
  return at < table_.names.size() ? table_.rows[row].cells[at] : kNone;
}

bool EventTable::is_whole(std::size_t row) const {
  const CsvTable::Row& r = table_.rows[row];
  if (r.cells.size() == table_.names.size()) return r.is_ended;
  if (row + 1 == rows()) return false;
  throw InputError("{}:{}: {} cells, expected {}; the table is damaged", path_, r.line, r.cells.size(), table_.names.size());
}

double EventTable::number(std::size_t row, std::size_t column) const {
  const std::string& text = table_.rows[row].cells[columns_[column]];
  std::size_t used = 0;
  double value = 0;
  try {
    value = std::stod(text, &used);
  } catch (const std::exception&) {
    used = 0;
  }
  if (used == 0 || used != text.size())
    throw InputError("{}:{}: {} = '{}' is no number; the table is damaged", path_, table_.rows[row].line, table_.names[columns_[column]],
                     text);
  return value;
}

void EventTable::refuse(std::size_t row, const std::string& what) const {
  throw InputError("{}:{}: {}, which the scene of the run does not have", path_, table_.rows[row].line, what);
}

std::size_t EventTable::find(const std::string& name) const {
  const std::size_t column = table_.column(name);
  if (column == table_.names.size()) throw InputError("{}: has no column '{}'", path_, name);
  return column;
}

}  // namespace scree
