#include "post/studies/error_vs_time.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <map>
#include <optional>
#include <set>

#include "core/base/csv.hpp"
#include "core/base/error.hpp"
#include "post/run/output_file.hpp"
#include "post/studies/chart_files.hpp"

namespace scree {

namespace {

/// Columns that say what was chosen: words make lines, numbers make points along a line.
constexpr std::array<const char*, 8> kWords{"integrator", "law", "ttd", "precision", "isa", "compiler", "ranks", "threads"};
constexpr std::array<const char*, 4> kSettingNumbers{"steps_per_contact", "step", "margin", "triangles"};

struct ErrorColumn {
  const char *name, *unit, *text;
};
constexpr std::array<ErrorColumn, 7> kErrors{{{"error_e", "-", "error of the restitution"},
                                              {"error_t", "-", "relative error of the contact time"},
                                              {"error_traj", "-", "error of the trajectory, over the body's length"},
                                              {"energy_drift_rms", "-", "rms error of the energy, relative"},
                                              {"energy_drift_slope", "1/s", "drift of the energy, relative"},
                                              {"angular_momentum_drift", "-", "drift of the angular momentum, relative"},
                                              {"momentum_drift", "-", "drift of the momentum, relative"}}};

using Row = std::map<std::string, std::string>;

std::vector<Row> read_rows(const std::string& path) {
  const std::optional<CsvTable> csv = read_csv(path);
  if (!csv) throw InputError("{}: no such file, or it cannot be read", path);
  const std::vector<std::string>& names = csv->names;
  if (names.empty() || names[0] != "case")
    throw InputError("{}:1: '{}' is no header of a study; 'case,...' expected (validation plan 4.5)", path, csv->header.substr(0, 40));
  std::vector<Row> rows;
  for (const CsvTable::Row& from : csv->rows) {
    if (from.cells.size() != names.size())
      throw InputError("{}:{}: {} values found, {} expected", path, from.line, from.cells.size(), names.size());
    Row row;
    for (std::size_t c = 0; c < names.size(); ++c) row[names[c]] = from.cells[c];
    row["\nwhere"] = fmt::format("{}:{}", path, from.line);
    rows.push_back(std::move(row));
  }
  return rows;
}

/// A number of a row; none when the cell is empty or the column is not there.
std::optional<double> number_of(const Row& row, const std::string& column) {
  const auto it = row.find(column);
  if (it == row.end() || it->second.empty()) return std::nullopt;
  char* end = nullptr;
  const double value = std::strtod(it->second.c_str(), &end);
  if (*end != '\0') throw InputError("{}: {} = '{}' is no number", row.at("\nwhere"), column, it->second);
  return value;
}

/// The first `count` words of a text, and what follows.
std::pair<std::string, std::string> split_words(const std::string& text, int count) {
  std::size_t end = 0;
  for (int w = 0; w < count && end != std::string::npos; ++w) end = text.find(' ', w == 0 ? 0 : end + 1);
  return {text.substr(0, end), end == std::string::npos ? "" : text.substr(end + 1)};
}

/// Names that say what was chosen are cut to what they have in common: "R1 kdk-dlm 0.02" is a row of "R1".
int words_of_a_case(const std::vector<Row>& rows) {
  std::set<std::string> names;
  for (const Row& row : rows) names.insert(row.at("case"));
  return rows.size() > 1 && names.size() == rows.size() ? 2 : 1000;
}

std::string file_name_of(const std::string& text) {
  std::string name;
  for (const char c : text) name += std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_' ? c : '-';
  return name;
}

}  // namespace

void mark_front(std::vector<StudyRow>& rows) {
  std::vector<std::size_t> order(rows.size());
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return rows[a].time != rows[b].time ? rows[a].time < rows[b].time : rows[a].error < rows[b].error;
  });
  double least = std::numeric_limits<double>::infinity();
  for (const std::size_t i : order) {
    rows[i].on_front = rows[i].error < least;
    least = std::min(least, rows[i].error);
  }
}

int best_for(const std::vector<StudyRow>& rows, double target) {
  int best = -1;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    if (rows[i].error <= target && (best < 0 || rows[i].time < rows[static_cast<std::size_t>(best)].time)) best = static_cast<int>(i);
  }
  return best;
}

namespace {

/// The rows of each case, in the order of the files.
struct Cases {
  std::map<std::string, std::vector<Row>> rows;
  std::vector<std::string> order;
};

Cases read_cases(const ErrorVsTimeOptions& options) {
  Cases result;
  auto& [cases, order] = result;
  for (const std::string& file : options.files) {
    std::vector<Row> table = read_rows(file);
    const int words = options.words > 0 ? options.words : words_of_a_case(table);
    for (Row& row : table) {
      const auto [name, rest] = split_words(row["case"], words);
      row["\nrest"] = rest;
      if (!options.cases.empty() && std::find(options.cases.begin(), options.cases.end(), name) == options.cases.end()) continue;
      if (!cases.contains(name)) order.push_back(name);
      if (!row.contains(options.time))
        throw InputError("{}: no column '{}'; columns of times are wall_median, wall_min and t_...", row.at("\nwhere"), options.time);
      cases[name].push_back(std::move(row));
    }
  }
  for (const std::string& name : options.cases) {
    if (!cases.contains(name)) throw InputError("--case {}: no row of that case in the files", name);
  }
  return result;
}

/// The columns in which the rows of a case differ: those of words, and those of numbers.
struct Varied {
  std::vector<std::string> words, numbers;
};

Varied varied_in(const std::vector<Row>& rows) {
  const auto varies = [&](const char* column) {
    return std::any_of(rows.begin(), rows.end(), [&](const Row& r) {
      return r.contains(column) != rows[0].contains(column) || (r.contains(column) && r.at(column) != rows[0].at(column));
    });
  };
  Varied varied;
  for (const char* column : kWords) {
    if (varies(column)) varied.words.emplace_back(column);
  }
  for (const char* column : kSettingNumbers) {
    if (varies(column)) varied.numbers.emplace_back(column);
  }
  return varied;
}

/// The runs of a case with a time and an error, and what was chosen in each.
std::vector<StudyRow> study_of(const std::vector<Row>& rows, const Varied& varied, const ErrorColumn& column,
                               const std::string& time_column) {
  std::vector<StudyRow> study;
  std::vector<std::string> rests;
  for (const Row& row : rows) {
    const std::optional<double> time = number_of(row, time_column), error = number_of(row, column.name);
    if (!time || !error || !(*time > 0) || *error == 0 || !std::isfinite(*error)) continue;
    StudyRow entry;
    for (const std::string& c : varied.words) entry.series += (entry.series.empty() ? "" : ", ") + row.at(c);
    entry.choice = entry.series;
    for (const std::string& c : varied.numbers) {
      if (row.contains(c) && !row.at(c).empty()) entry.choice += fmt::format("{}{} {}", entry.choice.empty() ? "" : ", ", c, row.at(c));
    }
    if (entry.series.empty()) entry.series = "runs";
    entry.time = *time;
    entry.error = std::abs(*error);
    study.push_back(std::move(entry));
    rests.push_back(row.at("\nrest"));
  }
  // where the columns do not tell the choices apart, the rest of the name does
  std::set<std::string> choices;
  for (const StudyRow& row : study) choices.insert(row.choice);
  for (std::size_t i = 0; choices.size() < study.size() && i < study.size(); ++i) {
    if (!rests[i].empty()) study[i].choice = rests[i];
  }
  return study;
}

/// The errors that are asked for, or powers of ten among those of a study.
std::vector<double> targets_for(const std::vector<StudyRow>& study, std::vector<double> targets) {
  if (!targets.empty()) return targets;
  const auto [smallest, largest] =
      std::minmax_element(study.begin(), study.end(), [](const StudyRow& a, const StudyRow& b) { return a.error < b.error; });
  const auto decade = [](double error) { return static_cast<int>(std::ceil(std::log10(error))); };
  for (int e = decade(smallest->error); e <= decade(largest->error); ++e) targets.push_back(std::pow(10.0, e));
  if (targets.size() > 4) targets.erase(targets.begin(), targets.end() - 4);
  return targets;
}

/// Charts and tables of all cases.
class ErrorStudy {
 public:
  explicit ErrorStudy(const ErrorVsTimeOptions& options) : options_(options) {}
  /// A chart, and the rows of both tables.
  void add(const std::string& name, const ErrorColumn& column, const std::vector<StudyRow>& study);
  ErrorVsTimeResult finish();

 private:
  void add_best(const std::string& name, const ErrorColumn& column, const std::vector<StudyRow>& study, ChartLine& front);
  void write(const std::string& name, const std::string& text) {
    OutputFile file(fmt::format("{}/{}", options_.folder, name));
    file.add(text);
    file.commit();
    result_.files.push_back(name);
  }

  const ErrorVsTimeOptions& options_;
  ErrorVsTimeResult result_;
  std::string fronts_ = "case,error_column,error,unit,time,on_front,choice\n# units: -,-,as unit,-,s,-,-\n";
  std::string best_ = "case,error_column,at_most,unit,error,time,choice\n# units: -,-,as unit,-,as unit,s,-\n";
};

void ErrorStudy::add(const std::string& name, const ErrorColumn& column, const std::vector<StudyRow>& study) {
  LineChart chart{
      fmt::format("{}: {}", name, column.text), "run time", "s", fmt::format("{} [{}]", column.name, column.unit), "", true, false, {}, {}};
  chart.logarithmic_x = true;
  std::map<std::string, ChartLine> lines;
  ChartLine front{"front", {}, {}};
  std::vector<const StudyRow*> sorted;
  for (const StudyRow& row : study) {
    sorted.push_back(&row);
    fronts_ += fmt::format("{},{},{:.6g},{},{:.6g},{},{}\n", csv_cell(name), column.name, row.error, column.unit, row.time,
                           row.on_front ? "yes" : "no", csv_cell(row.choice));
  }
  std::stable_sort(sorted.begin(), sorted.end(), [](const StudyRow* p, const StudyRow* q) { return p->time < q->time; });
  for (const StudyRow* row : sorted) {
    ChartLine& line = lines[row->series];
    line.name = row->series;
    line.style = ChartLine::Style::points;
    line.x.push_back(row->time);
    line.y.push_back(row->error);
    if (!row->on_front) continue;
    front.x.push_back(row->time);
    front.y.push_back(row->error);
  }
  add_best(name, column, study, front);
  chart.lines.push_back(std::move(front));  // the blue solid line; its choices are labelled
  for (auto& [series, line] : lines) chart.lines.push_back(std::move(line));
  for (const std::string& file : write_chart(options_.folder, file_name_of(fmt::format("{}-{}", name, column.name)), chart))
    result_.files.push_back(file);
}

void ErrorStudy::add_best(const std::string& name, const ErrorColumn& column, const std::vector<StudyRow>& study, ChartLine& front) {
  front.labels.resize(front.x.size());
  for (const double target : targets_for(study, options_.targets)) {
    const int index = best_for(study, target);
    if (index < 0) {
      result_.text += fmt::format(
          "{}: {} <= {:g}: no choice reaches it; the least is {:.3g}\n", name, column.name, target,
          std::min_element(study.begin(), study.end(), [](const StudyRow& a, const StudyRow& b) { return a.error < b.error; })->error);
      continue;
    }
    const StudyRow& row = study[static_cast<std::size_t>(index)];
    best_ += fmt::format("{},{},{:g},{},{:.6g},{:.6g},{}\n", csv_cell(name), column.name, target, column.unit, row.error, row.time,
                         csv_cell(row.choice));
    result_.text += fmt::format("{}: {} <= {:g}: {} ({:.3g} s, error {:.3g})\n", name, column.name, target,
                                row.choice.empty() ? "the only choice" : row.choice, row.time, row.error);
    for (std::size_t i = 0; i < front.x.size(); ++i) {
      if (front.x[i] == row.time && front.y[i] == row.error && front.labels[i].empty())
        front.labels[i] = fmt::format("best for {:g}", target);
    }
  }
}

ErrorVsTimeResult ErrorStudy::finish() {
  if (result_.files.empty()) {
    throw InputError("{}: no case has two runs with a time and an error; a front needs at least two", options_.files.front());
  }
  write("fronts.csv", fronts_);
  write("best.csv", best_);
  return std::move(result_);
}

}  // namespace

ErrorVsTimeResult write_error_vs_time(const ErrorVsTimeOptions& options) {
  Cases cases = read_cases(options);
  make_folder(options.folder);
  ErrorStudy all(options);
  for (const std::string& name : cases.order) {
    const std::vector<Row>& rows = cases.rows[name];
    const Varied varied = varied_in(rows);
    for (const ErrorColumn& column : kErrors) {
      if (!options.errors.empty() && std::find(options.errors.begin(), options.errors.end(), column.name) == options.errors.end()) continue;
      std::vector<StudyRow> study = study_of(rows, varied, column, options.time);
      if (study.size() < 2) continue;
      mark_front(study);
      all.add(name, column, study);
    }
  }
  return all.finish();
}

}  // namespace scree
