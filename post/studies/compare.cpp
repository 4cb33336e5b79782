#include "post/studies/compare.hpp"

#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <fstream>
#include <limits>
#include <map>

#include "core/base/csv.hpp"
#include "core/base/error.hpp"
#include "core/base/numbers.hpp"
#include "core/base/utf8.hpp"
#include "core/storage/h5.hpp"
#include "post/run/choice.hpp"
#include "post/run/contact_network.hpp"
#include "post/run/output_file.hpp"
#include "post/run/run_bodies.hpp"
#include "post/studies/chart_files.hpp"

namespace scree {

namespace {

constexpr double kSameTime = 0.01;    // of the interval between frames
constexpr double kStillSmall = 1e-2;  // rms over the diameter: beyond it bodies meet others, and growth is no longer exponential

/// Everything of a scene that can differ, by key.
std::map<std::string, std::string> settings_of(const Run& run) {
  std::map<std::string, std::string> all;
  const nlohmann::json flat = settings_json(run.scene).flatten();
  for (const auto& [key, value] : flat.items()) all[key.substr(1)] = value.is_string() ? value.get<std::string>() : json_text(value);
  double mass = 0;
  for (std::size_t i = 0; i < run.scene.bodies.size(); ++i) mass += run.scene.mass(i);
  all["bodies"] = fmt::format("{}", run.scene.bodies.size());
  all["mass of the bodies [kg]"] = fmt::format("{:.6g}", mass);
  for (std::size_t k = 0; k < run.scene.shapes.size(); ++k) {
    const Shape& s = run.scene.shapes[k];
    all[fmt::format("shapes/{}", s.name)] =
        fmt::format("{} triangles, equivalent diameter {:.6g} m", s.mesh.triangle_count(), s.equivalent_diameter());
  }
  for (const char* key : {"ranks", "threads", "step_size", "outcome", "inserted_bodies", "removed_bodies"}) {
    if (run.outcome->contains(key))
      all[fmt::format("run/{}", key)] =
          (*run.outcome)[key].is_string() ? (*run.outcome)[key].get<std::string>() : (*run.outcome)[key].dump();
  }
  return all;
}

/// Pairs of frames of the same time.
std::vector<std::pair<std::size_t, std::size_t>> common_frames(const Run& a, const Run& b) {
  double interval = std::numeric_limits<double>::infinity();
  for (const Run* run : {&a, &b}) {
    for (std::size_t i = 1; i < run->frames.size(); ++i) interval = std::min(interval, run->frames[i].time - run->frames[i - 1].time);
  }
  std::vector<std::pair<std::size_t, std::size_t>> pairs;
  for (std::size_t i = 0, j = 0; i < a.frames.size() && j < b.frames.size();) {
    const double apart = a.frames[i].time - b.frames[j].time;
    if (std::abs(apart) <= (std::isfinite(interval) ? kSameTime * interval : 0)) {
      pairs.emplace_back(i++, j++);
    } else {
      (apart < 0 ? i : j) += 1;
    }
  }
  return pairs;
}

}  // namespace

std::vector<SettingDifference> setting_differences(const std::vector<Run>& runs) {
  std::map<std::string, std::vector<std::string>> table;
  for (std::size_t r = 0; r < runs.size(); ++r) {
    for (const auto& [key, value] : settings_of(runs[r])) {
      std::vector<std::string>& row = table.try_emplace(key, runs.size(), "-").first->second;
      row[r] = value;
    }
  }
  std::vector<SettingDifference> differences;
  for (auto& [key, values] : table) {
    if (std::any_of(values.begin(), values.end(), [&v = values](const std::string& value) { return value != v.front(); }))
      differences.push_back({key, values});
  }
  return differences;
}

namespace {

/// What is compared bit by bit of two frames.
constexpr std::array<const char*, 7> kParts{"the times",
                                            "the bodies there are",
                                            "the motion of the bodies",
                                            "the contacts",
                                            "the walls",
                                            "the bonds",
                                            "the loads, the wear, the energies"};

template <class T>
bool same_bits(const std::vector<T>& a, const std::vector<T>& b) {
  return a.size() == b.size() && (a.empty() || std::memcmp(a.data(), b.data(), a.size() * sizeof(T)) == 0);
}

/// Whether any column differs; `but` is left out: which rank had a body is no part of its state.
template <class Table>
bool rows_differ(const Table& a, const Table& b, std::string_view but = "") {
  bool differ = false;
  Table::visit([&](const auto& c) { differ = differ || (c.name != but && !same_bits(a.*c.column, b.*c.column)); });
  return differ;
}

std::array<bool, kParts.size()> differences_of(const Frame& a, const Frame& b) {
  bool energies = false;
  std::vector<double> ours, theirs;
  FrameScalars::visit(a, [&](const char* name, const auto& value) {
    if (std::string_view(name) != "number") ours.push_back(static_cast<double>(value));
  });
  FrameScalars::visit(b, [&](const char* name, const auto& value) {
    if (std::string_view(name) != "number") theirs.push_back(static_cast<double>(value));
  });
  energies = !same_bits(ours, theirs);
  return {a.time != b.time,
          a.bodies.id != b.bodies.id || a.bodies.shape != b.bodies.shape || a.bodies.material != b.bodies.material ||
              !same_bits(a.bodies.scale, b.bodies.scale),
          rows_differ(a.bodies, b.bodies, "rank"),
          rows_differ(a.contacts, b.contacts),
          rows_differ(a.walls, b.walls),
          a.has_bonds != b.has_bonds || rows_differ(a.bonds, b.bonds),
          energies || rows_differ(a.loads, b.loads) || rows_differ(a.wear, b.wear) || rows_differ(a.cell, b.cell) ||
              rows_differ(a.losses, b.losses) || rows_differ(a.impacts, b.impacts)};
}

/// Whether two tables of events differ in the columns that both have; a table without rows is as none.
bool events_differ(const std::string& path_a, const std::string& path_b) {
  const CsvTable a = read_csv(path_a).value_or(CsvTable{}), b = read_csv(path_b).value_or(CsvTable{});
  if (a.rows.size() != b.rows.size()) return true;
  for (std::size_t column = 0; column < a.names.size(); ++column) {
    const std::size_t other = b.column(a.names[column]);
    for (std::size_t row = 0; other < b.names.size() && row < a.rows.size(); ++row) {
      const auto &one = a.rows[row].cells, &two = b.rows[row].cells;
      if (column >= one.size() || other >= two.size() || one[column] != two[other]) return true;
    }
  }
  return false;
}

/// What differs beside the frames.
std::vector<std::string> differences_of_tables(const Run& a, const Run& b, std::size_t common) {
  std::vector<std::string> differences;
  if (a.frames.size() != common || b.frames.size() != common)
    differences.push_back(fmt::format("the frames: {} and {}, {} of one time", a.frames.size(), b.frames.size(), common));
  for (const char* table : {"inserted.csv", "removed.csv"}) {
    if (events_differ(a.folder + "/" + table, b.folder + "/" + table)) differences.emplace_back(table);
  }
  const std::optional<CsvTable> ours = read_csv(a.folder + "/log.csv"), theirs = read_csv(b.folder + "/log.csv");
  if (!ours || !theirs) return differences;
  const std::size_t step[2] = {ours->column("step"), theirs->column("step")};
  const std::size_t hash[2] = {ours->column("state_hash"), theirs->column("state_hash")};
  if (hash[0] == ours->names.size() || hash[1] == theirs->names.size()) return differences;
  const auto hashes = [](const CsvTable& table, std::size_t at_step, std::size_t at_hash) {
    std::map<std::string, std::string> found;
    for (const CsvTable::Row& row : table.rows) {
      if (row.cells.size() == table.names.size() && !row.cells[at_hash].empty()) found[row.cells[at_step]] = row.cells[at_hash];
    }
    return found;
  };
  const auto one = hashes(*ours, step[0], hash[0]), two = hashes(*theirs, step[1], hash[1]);
  for (const auto& [at, value] : one) {
    const auto other = two.find(at);
    if (other == two.end() || other->second == value) continue;
    differences.push_back("the hash of the state in log.csv");
    break;
  }
  return differences;
}

}  // namespace

TrajectoryComparison compare_trajectories(const Run& a, const Run& b, const FramePool& pool) {
  TrajectoryComparison result;
  const auto pairs = common_frames(a, b);
  if (pairs.empty()) {
    throw InputError("{} and {}: no frames of the same time; their frames begin at {} s and {} s, write them with the same [output] every",
                     a.folder, b.folder, a.frames.front().time, b.frames.front().time);
  }
  const RunBodies bodies(a);
  for (const RunBody& body : bodies.all) {
    result.diameter +=
        body.scale * a.scene.shapes[static_cast<std::size_t>(body.shape)].equivalent_diameter() / static_cast<double>(bodies.all.size());
  }
  std::vector<std::size_t> index(pairs.size());
  for (std::size_t i = 0; i < index.size(); ++i) index[i] = i;
  const auto task = [&](std::size_t p) {
    const Frame one = load_frame(a, pairs[p].first), two = load_frame(b, pairs[p].second);
    const BodyRows row(two.bodies);
    const Periodicity period = periodicity_of(a.scene, one);
    double sum = 0, largest = 0, angle = 0;
    std::size_t count = 0, common = 0;
    std::int64_t furthest = -1;
    for (std::size_t i = 0; i < one.bodies.size(); ++i) {
      const std::int32_t j = row(one.bodies.id[i]);
      common += j >= 0 ? 1 : 0;
      if (j < 0 || a.boundary_ids.contains(one.bodies.id[i])) continue;
      const auto k = static_cast<std::size_t>(j);
      const double square = squared_length(period.nearest(one.bodies.position[i] - two.bodies.position[k]));
      const Quat turn = conjugate(one.bodies.orientation[i]) * two.bodies.orientation[k];
      angle = std::max(angle, 2 * std::atan2(length(Vec3{turn.x, turn.y, turn.z}), std::abs(turn.w)));
      sum += square;
      ++count;
      if (furthest < 0 || square > largest) {
        largest = square;
        furthest = one.bodies.id[i];
      }
    }
    std::vector<double> numbers{one.time,
                                static_cast<double>(count),
                                count > 0 ? std::sqrt(sum / static_cast<double>(count)) : 0,
                                std::sqrt(largest),
                                angle,
                                static_cast<double>(furthest),
                                static_cast<double>(one.bodies.size() - common),
                                static_cast<double>(two.bodies.size() - common)};
    for (const bool differs : differences_of(one, two)) numbers.push_back(differs ? 1 : 0);
    return bytes_of(numbers);
  };
  std::array<std::size_t, kParts.size()> differing{};
  for_each_frame(index, pool, task, [&](std::size_t, const std::string& bytes) {
    const std::vector<double> v = doubles_of(bytes);
    result.frames.push_back({v[0], static_cast<std::size_t>(v[1]), static_cast<std::size_t>(v[6]), static_cast<std::size_t>(v[7]), v[2],
                             v[3], v[4], static_cast<std::int64_t>(v[5])});
    for (std::size_t k = 0; k < kParts.size(); ++k) differing[k] += v[8 + k] != 0 ? 1 : 0;
  });
  for (std::size_t k = 0; k < kParts.size(); ++k) {
    if (differing[k] > 0) result.differences.push_back(fmt::format("{} in {} of {} frames", kParts[k], differing[k], pairs.size()));
  }
  for (std::string& difference : differences_of_tables(a, b, pairs.size())) result.differences.push_back(std::move(difference));

  // growth while small
  double n = 0, st = 0, sl = 0, stt = 0, stl = 0;
  for (const Divergence& d : result.frames) {
    if (!(d.rms > 0)) continue;
    if (d.rms > kStillSmall * result.diameter) break;
    const double l = std::log(d.rms);
    n += 1;
    st += d.time;
    sl += l;
    stt += d.time * d.time;
    stl += d.time * l;
  }
  const double spread = n * stt - st * st;
  const double rate = n >= 3 && spread > 0 ? (n * stl - st * sl) / spread : kNaN;
  result.growth_rate = rate > 0 ? rate : kNaN;
  return result;
}

namespace {

/// Compares part by part.
class RunComparer {
 public:
  RunComparer(const std::vector<Run>& runs, const std::string& folder, const FramePool& pool) : runs_(runs), folder_(folder), pool_(pool) {
    // runs of the same name are told apart by their number
    for (const Run& run : runs) {
      const bool again = std::count_if(runs.begin(), runs.end(), [&](const Run& other) { return other.name == run.name; }) > 1;
      names_.push_back(again ? fmt::format("{} ({})", run.name, names_.size() + 1) : run.name);
    }
    json_ = {{"format", "scree-comparison"}, {"format_version", 1}, {"runs", names_}};
    for (const Run& run : runs) json_["folders"].push_back(run.folder);
  }

  Comparison compare() {
    compare_settings();
    compare_statistics();
    compare_with_first();
    write("comparison.json", json_text(json_, 1) + "\n");
    return std::move(result_);
  }

 private:
  void write(const std::string& name, const std::string& text) {
    OutputFile file(fmt::format("{}/{}", folder_, name));
    file.add(text);
    file.commit();
    result_.files.push_back(name);
  }
  void compare_settings();
  void compare_statistics();
  void compare_with_first();  // trajectories
  void report_trajectory(const std::string& name, const TrajectoryComparison& t);

  const std::vector<Run>& runs_;
  const std::string& folder_;
  const FramePool& pool_;
  std::vector<std::string> names_;
  nlohmann::json json_;
  Comparison result_;
};

void RunComparer::compare_settings() {
  const std::vector<SettingDifference> settings = setting_differences(runs_);
  std::string csv = "setting";
  for (const std::string& name : names_) csv += fmt::format(",{}", csv_cell(name));
  csv += "\n";
  result_.text = settings.empty() ? "settings: no difference\n" : "settings that differ\n";
  json_["settings"] = nlohmann::json::object();
  for (const SettingDifference& s : settings) {
    csv += csv_cell(s.key);
    result_.text += fmt::format("  {:<40}", s.key);
    for (const std::string& value : s.values) {
      csv += fmt::format(",{}", csv_cell(value));
      result_.text += fmt::format(" {:>22}", value.size() > 22 ? value.substr(0, 19) + "..." : value);
    }
    csv += "\n";
    result_.text += "\n";
    json_["settings"][s.key] = s.values;
  }
  write("settings.csv", csv);
}

void RunComparer::compare_statistics() {
  std::vector<Statistics> all;
  for (const Run& run : runs_) {
    StatisticsOptions options;
    options.frames = choose_frames(run, "all");
    options.pool = pool_;
    all.push_back(run_statistics(run, options, ""));
    for (const std::string& message : all.back().skipped) result_.notices.push_back("left out: " + message);
  }
  std::string csv = "quantity,unit";
  for (const std::string& name : names_) csv += "," + csv_cell(name) + "," + csv_cell(name + " ci95");
  csv += ",apart\n";
  result_.text += "statistics, mean +- 95 % (* apart by more than the intervals)\n";
  for (std::size_t q = 0; q < all[0].quantities.size(); ++q) {
    const Quantity& quantity = all[0].quantities[q];
    std::string line = fmt::format("  {:<40}", quantity.name), row = fmt::format("{},{}", quantity.name, quantity.unit);
    bool any = false, apart = false;
    nlohmann::json entry = {{"unit", quantity.unit}};
    const Average& first = all[0].averages[0][q];
    for (const Statistics& s : all) {
      const Average& a = s.averages[0][q];
      any = any || a.count > 0;
      apart = apart || std::abs(a.mean - first.mean) > std::hypot(a.ci95, first.ci95);
      const std::string spread = std::isfinite(a.ci95) ? fmt::format("{:.2g}", a.ci95) : "";
      line += fmt::format(" {:>22}", a.count == 0 ? "-" : fmt::format("{:.5g}{}{}", a.mean, spread.empty() ? "" : " +- ", spread));
      row += fmt::format(",{},{}", a.count == 0 ? "" : fmt::format("{:.9g}", a.mean), spread);
      entry["mean"].push_back(a.count > 0 ? nlohmann::json(a.mean) : nlohmann::json());
      entry["ci95"].push_back(std::isfinite(a.ci95) ? nlohmann::json(a.ci95) : nlohmann::json());
    }
    if (!any) continue;
    entry["apart"] = apart;
    json_["statistics"][quantity.name] = entry;
    csv += fmt::format("{},{}\n", row, apart ? "yes" : "no");
    result_.text += fmt::format("{}{}\n", line, apart ? " *" : "");
  }
  write("statistics.csv", csv);
}

void RunComparer::compare_with_first() {
  LineChart chart{"Distance between the same bodies", "time", "s", "rms distance over the mean diameter", "", true, false, {}, {}};
  std::string csv = "run,time,bodies,rms,largest,largest_angle,furthest_body,only_first,only_second\n# units: -,s,-,m,m,rad,-,-,-\n";
  result_.text += fmt::format("trajectories against {}\n", names_[0]);
  for (std::size_t r = 1; r < runs_.size(); ++r) {
    TrajectoryComparison t;
    try {
      t = compare_trajectories(runs_[0], runs_[r], pool_);
    } catch (const InputError& error) {
      result_.notices.emplace_back(error.what());
      continue;
    }
    ChartLine line{names_[r], {}, {}};
    for (const Divergence& d : t.frames) {
      csv += fmt::format("{},{},{},{:.9g},{:.9g},{:.9g},{},{},{}\n", csv_cell(names_[r]), d.time, d.bodies, d.rms, d.largest,
                         d.largest_angle, d.furthest, d.only_first, d.only_second);
      line.x.push_back(d.time);
      line.y.push_back(t.diameter > 0 ? d.rms / t.diameter : d.rms);
    }
    report_trajectory(names_[r], t);
    chart.lines.push_back(std::move(line));
  }
  write("divergence.csv", csv);
  for (const std::string& name : write_chart(folder_, "divergence", chart)) result_.files.push_back(name);
}

void RunComparer::report_trajectory(const std::string& name, const TrajectoryComparison& t) {
  const Divergence& last = t.frames.back();
  std::size_t alone = 0;
  for (const Divergence& d : t.frames) alone = std::max(alone, d.only_first + d.only_second);
  if (t.identical()) {
    result_.text += fmt::format("  {}: the same in all {} frames, bit by bit\n", name, t.frames.size());
  } else {
    if (last.bodies == 0) {
      result_.text += fmt::format("  {}: at {:.4g} s no body is in both\n", name, last.time);
    } else {
      result_.text += fmt::format(
          "  {}: after {:.4g} s rms {:.3g} m ({:.3g} diameters), at most {:.3g} m (body {}), turned by at most {:.3g} rad{}\n", name,
          last.time, last.rms, t.diameter > 0 ? last.rms / t.diameter : 0, last.largest, last.furthest, last.largest_angle,
          std::isfinite(t.growth_rate) ? fmt::format("; while small it grows as exp({:.3g} t / s)", t.growth_rate) : "");
    }
    if (alone > 0)
      result_.text += fmt::format("    up to {} bodies are in one of the runs alone, and have no part in these distances\n", alone);
    result_.text += fmt::format("    different: {}\n", fmt::join(t.differences, "; "));
  }
  json_["trajectories"].push_back({{"run", name},
                                   {"identical", t.identical()},
                                   {"differences", t.differences},
                                   {"bodies_in_one_alone", alone},
                                   {"frames", t.frames.size()},
                                   {"rms", last.rms},
                                   {"largest", last.largest},
                                   {"growth_rate", std::isfinite(t.growth_rate) ? nlohmann::json(t.growth_rate) : nlohmann::json()}});
}

}  // namespace

Comparison compare_runs(const std::vector<Run>& runs, const std::string& folder, const FramePool& pool) {
  if (runs.size() < 2) throw UsageError("compare: one run is given; give two or more");
  make_folder(folder);
  return RunComparer(runs, folder, pool).compare();
}

}  // namespace scree
