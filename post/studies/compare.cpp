#include "post/studies/compare.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include "core/base/csv.hpp"
#include "core/base/error.hpp"
#include "core/base/utf8.hpp"
#include "core/storage/h5.hpp"
#include "post/run/choice.hpp"
#include "post/run/contact_network.hpp"
#include "post/run/output_file.hpp"
#include "post/studies/chart_files.hpp"

namespace scree {

namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
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
  for (const char* key : {"ranks", "threads", "step_size", "outcome"}) {
    if (run.outcome.contains(key))
      all[fmt::format("run/{}", key)] = run.outcome[key].is_string() ? run.outcome[key].get<std::string>() : run.outcome[key].dump();
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

TrajectoryComparison compare_trajectories(const Run& a, const Run& b, const FramePool& pool) {
  TrajectoryComparison result;
  const auto pairs = common_frames(a, b);
  if (pairs.empty()) {
    throw InputError("{} and {}: no frames of the same time; their frames begin at {} s and {} s, write them with the same [output] every",
                     a.folder, b.folder, a.frames.front().time, b.frames.front().time);
  }
  const BodyTable& bodies = a.scene.bodies;
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    result.diameter += bodies.scale[i] * a.scene.shapes[static_cast<std::size_t>(bodies.shape[i])].equivalent_diameter() /
                       static_cast<double>(bodies.size());
  }
  const Periodicity period = periodicity_of(a.scene);
  std::vector<std::size_t> index(pairs.size());
  for (std::size_t i = 0; i < index.size(); ++i) index[i] = i;
  const auto task = [&](std::size_t p) {
    const Frame one = load_frame(a, pairs[p].first), two = load_frame(b, pairs[p].second);
    const BodyRows row(two.bodies);
    double sum = 0, largest = 0, angle = 0, differs = one.bodies.size() == two.bodies.size() ? 0 : 1;
    std::size_t count = 0;
    std::int64_t furthest = -1;
    for (std::size_t i = 0; i < one.bodies.size(); ++i) {
      const std::int32_t j = row(one.bodies.id[i]);
      if (j < 0 || a.boundary_ids.contains(one.bodies.id[i])) continue;
      const auto k = static_cast<std::size_t>(j);
      const double square = squared_length(period.nearest(one.bodies.position[i] - two.bodies.position[k]));
      const Quat turn = conjugate(one.bodies.orientation[i]) * two.bodies.orientation[k];
      angle = std::max(angle, 2 * std::atan2(length(Vec3{turn.x, turn.y, turn.z}), std::abs(turn.w)));
      if (!(one.bodies.position[i] == two.bodies.position[k] && one.bodies.orientation[i] == two.bodies.orientation[k])) differs = 1;
      sum += square;
      ++count;
      if (furthest < 0 || square > largest) {
        largest = square;
        furthest = one.bodies.id[i];
      }
    }
    return bytes_of({one.time, static_cast<double>(count), count > 0 ? std::sqrt(sum / static_cast<double>(count)) : 0, std::sqrt(largest),
                     angle, static_cast<double>(furthest), differs});
  };
  result.identical = true;
  for_each_frame(index, pool, task, [&](std::size_t, const std::string& bytes) {
    const std::vector<double> v = doubles_of(bytes);
    result.frames.push_back({v[0], static_cast<std::size_t>(v[1]), v[2], v[3], v[4], static_cast<std::int64_t>(v[5])});
    result.identical = result.identical && v[6] == 0;
  });

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
  for (const std::string& name : names_) csv += "," + csv_cell(name);
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
  std::string csv = "run,time,bodies,rms,largest,largest_angle,furthest_body\n# units: -,s,-,m,m,rad,-\n";
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
      csv += fmt::format("{},{},{},{:.9g},{:.9g},{:.9g},{}\n", csv_cell(names_[r]), d.time, d.bodies, d.rms, d.largest, d.largest_angle,
                         d.furthest);
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
  if (t.identical) {
    result_.text += fmt::format("  {}: the same in all {} frames, bit by bit\n", name, t.frames.size());
  } else {
    result_.text +=
        fmt::format("  {}: after {:.4g} s rms {:.3g} m ({:.3g} diameters), at most {:.3g} m (body {}), turned by at most {:.3g} rad{}\n",
                    name, last.time, last.rms, t.diameter > 0 ? last.rms / t.diameter : 0, last.largest, last.furthest, last.largest_angle,
                    std::isfinite(t.growth_rate) ? fmt::format("; while small it grows as exp({:.3g} t / s)", t.growth_rate) : "");
  }
  json_["trajectories"].push_back({{"run", name},
                                   {"identical", t.identical},
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
