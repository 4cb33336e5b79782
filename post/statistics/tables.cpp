#include "post/statistics/tables.hpp"

#include <fmt/format.h>

#include "core/base/long_work.hpp"
#include "post/run/output_file.hpp"

namespace scree {

namespace {

/// Whether the table has a column: one of heat only where the scene has heat.
template <class Column>
bool is_in_table(const Run& run, const Column& c) {
  return !c.csv.empty() && ((c.uses & kOfHeat) == 0 || run.scene.settings.heat);
}

template <class Table>
std::string header(const Run& run) {
  std::string names = "time";
  Table::visit([&](const auto& c) {
    if (is_in_table(run, c)) names.append(",").append(c.csv);
  });
  return names + "\n";
}

template <class Table>
std::string rows_of(const Run& run, const Table& table, double time) {
  std::string text;
  for (std::size_t i = 0; i < table.size(); ++i) {
    text += fmt::format("{}", time);
    Table::visit([&](const auto& c) {
      if (!is_in_table(run, c)) return;
      const auto& value = (table.*c.column)[i];
      for (int k = 0; k < component_count<std::decay_t<decltype(value)>>; ++k) text += fmt::format(",{}", component(value, k));
    });
    text += "\n";
  }
  return text;
}

/// in   part   the bodies or the contacts of a frame
template <class Table>
void write_table(const Run& run, const std::string& path, Table Frame::*part) {
  OutputFile file(path);
  file.add(header<Table>(run));
  LongWork work("frames", static_cast<double>(run.frames.size()));
  for (std::size_t f = 0; f < run.frames.size(); ++f) {
    work.advance();
    const Frame frame = load_frame(run, f);
    file.add(rows_of(run, frame.*part, frame.time));
  }
  file.commit();
}

}  // namespace

void write_bodies_table(const Run& run, const std::string& path) { write_table(run, path, &Frame::bodies); }

void write_contacts_table(const Run& run, const std::string& path) { write_table(run, path, &Frame::contacts); }

}  // namespace scree
