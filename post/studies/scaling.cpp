#include "post/studies/scaling.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>

#include "core/base/csv.hpp"
#include "core/base/error.hpp"
#include "core/chart/svg_chart.hpp"
#include "post/run/output_file.hpp"
#include "post/run/run_folder.hpp"

namespace scree {

namespace {

constexpr double kSameLoad = 0.02;  // bodies per core of runs that belong to one line of weak scaling

/// One line of runs: ascending in cores, of each number of cores the fastest run.
using Line = std::map<int, const ScalingRow*>;

void keep_fastest(Line& line, const ScalingRow& row) {
  const ScalingRow*& slot = line[row.cores()];
  if (slot == nullptr || row.step_seconds < slot->step_seconds) slot = &row;
}

LineChart strong_chart(const std::vector<ScalingRow>& rows) {
  LineChart chart;
  chart.title = "Strong scaling: the same bodies on more cores";
  chart.x_label = "cores (ranks x threads)";
  chart.y_label = "speedup";
  chart.from_zero = true;
  std::map<std::int64_t, Line> lines;
  for (const ScalingRow& row : rows) keep_fastest(lines[row.bodies], row);
  double most = 1;
  for (const auto& [bodies, line] : lines) {
    if (line.size() < 2) continue;
    ChartLine drawn{fmt::format("{} bodies", bodies), {}, {}};
    const ScalingRow& base = *line.begin()->second;
    for (const auto& [cores, row] : line) {
      drawn.x.push_back(cores);
      drawn.y.push_back(base.cores() * base.step_seconds / row->step_seconds);
      most = std::max(most, static_cast<double>(cores));
    }
    chart.lines.push_back(std::move(drawn));
  }
  if (!chart.lines.empty()) chart.lines.push_back({"ideal", {1, most}, {1, most}});
  return chart;
}

LineChart weak_chart(const std::vector<ScalingRow>& rows) {
  LineChart chart;
  chart.title = "Weak scaling: as many bodies more as cores";
  chart.x_label = "cores (ranks x threads)";
  chart.y_label = "efficiency";
  chart.from_zero = true;
  chart.limits = {{1, "ideal"}};
  std::vector<std::pair<double, Line>> lines;
  for (const ScalingRow& row : rows) {
    const double load = static_cast<double>(row.bodies) / row.cores();
    auto found = std::find_if(lines.begin(), lines.end(), [&](const auto& l) { return std::abs(l.first - load) <= kSameLoad * load; });
    if (found == lines.end()) found = lines.insert(lines.end(), {load, {}});
    keep_fastest(found->second, row);
  }
  for (const auto& [load, line] : lines) {
    if (line.size() < 2) continue;
    ChartLine drawn{fmt::format("{:.0f} bodies per core", load), {}, {}};
    for (const auto& [cores, row] : line) {
      drawn.x.push_back(cores);
      drawn.y.push_back(line.begin()->second->step_seconds / row->step_seconds);
    }
    chart.lines.push_back(std::move(drawn));
  }
  if (chart.lines.size() == 1) chart.title += ": " + chart.lines[0].name;  // a chart of one line has no legend
  return chart;
}

}  // namespace

ScalingRow read_scaling_row(const std::string& run_folder) {
  namespace fs = std::filesystem;
  fs::path path(run_folder);
  if (path.filename().empty()) path = path.parent_path();
  const std::string record = (path / "run.json").string(), table = (path / "ranks.csv").string();
  std::ifstream stream(record);
  if (!stream) throw InputError("{}: no such file; the run has not ended, or is no run", record);
  const nlohmann::json run = nlohmann::json::parse(stream, nullptr, false);
  if (!run.is_object()) throw InputError("{}: not JSON; the file is damaged, run the solver again", record);
  const LogTable log = read_log(table);
  if (log.rows() == 0) throw InputError("{}: missing or empty; the run was made by an older solver, run it again", table);

  ScalingRow row;
  row.run = path.filename().string();
  row.ranks = run.value("ranks", 1);
  row.threads = run.value("threads", 1);
  if (run.contains("parallel")) {
    const nlohmann::json& p = run["parallel"];
    row.strategy = p.value("halo", "") + "/" + p.value("send", "") + "/" + p.value("cut", "");
  }
  const auto ranks = static_cast<std::size_t>(row.ranks);
  const std::vector<double>& step = log.column("step");
  // A restart begins its times again: what counts are the rows at the end over which no time falls.
  const std::vector<double>& contact = log.column("t_contact");
  const std::size_t last = log.rows() - ranks;
  std::size_t first = last;
  while (first >= ranks && step[first - ranks] < step[first] && contact[first - ranks] <= contact[first]) first -= ranks;
  if (log.rows() < 2 * ranks || first == last)
    throw InputError("{}: only one step in it; let the run write at least two rows of its log", table);
  row.steps = static_cast<std::int64_t>(step[last] - step[first]);
  const double steps = static_cast<double>(row.steps);
  const auto change = [&](const std::string& name, std::size_t rank) {
    const std::vector<double>& values = log.column(name);
    return values[last + rank] - values[first + rank];
  };
  double computing_sum = 0, computing_most = 0, ghosts = 0, body_bytes = 0, ghost_bytes = 0, all = 0, ordered = 0;
  for (std::size_t r = 0; r < ranks; ++r) {
    double busy = 0;
    for (const std::string& name : log.names) {
      if (name.starts_with("t_") && name != "t_output") busy += change(name, r);
    }
    all += busy;
    ordered += change("t_sort", r) + change("t_gather", r) + change("t_twice", r);
    row.step_seconds = std::max(row.step_seconds, busy / steps);
    row.wait_seconds += (change("t_wait", r) + change("t_agree", r)) / steps / row.ranks;
    computing_sum += change("computing", r);
    computing_most = std::max(computing_most, change("computing", r));
    row.bytes += (change("bytes", r) + change("renewal_bytes", r)) / steps / row.ranks;
    row.neighbours += log.column("neighbours")[last + r] / row.ranks;
    row.bodies += std::llround(log.column("bodies")[last + r]);
    ghosts += log.column("ghosts")[last + r];
    body_bytes += log.column("body_bytes")[last + r];
    ghost_bytes += log.column("ghost_bytes")[last + r];
  }
  row.ghosts = ghosts / row.ranks;
  row.determinism = all > 0 ? ordered / all : 0;
  row.imbalance = computing_sum > 0 ? computing_most * row.ranks / computing_sum : 1;
  row.body_bytes = row.bodies > 0 ? body_bytes / static_cast<double>(row.bodies) : 0;
  row.ghost_bytes = ghosts > 0 ? ghost_bytes / ghosts : 0;
  return row;
}

std::string write_scaling(const std::vector<std::string>& run_folders, const std::string& folder) {
  std::vector<ScalingRow> rows;
  for (const std::string& run : run_folders) rows.push_back(read_scaling_row(run));
  std::string table =
      "run,strategy,bodies,ranks,threads,steps,step_seconds,ns_per_body,wait_seconds,determinism_share,imbalance,ghosts,neighbours,bytes_"
      "per_step,"
      "body_bytes,ghost_bytes\n";
  for (const ScalingRow& r : rows) {
    table += fmt::format("{},{},{},{},{},{},{:.6g},{:.5g},{:.4g},{:.4f},{:.4f},{:.1f},{:.2f},{:.0f},{:.0f},{:.0f}\n", csv_cell(r.run),
                         csv_cell(r.strategy), r.bodies, r.ranks, r.threads, r.steps, r.step_seconds,
                         1e9 * r.step_seconds / static_cast<double>(std::max<std::int64_t>(1, r.bodies)), r.wait_seconds, r.determinism,
                         r.imbalance, r.ghosts, r.neighbours, r.bytes, r.body_bytes, r.ghost_bytes);
  }
  make_folder(folder);
  const auto write = [&](const std::string& name, const std::string& text) {
    OutputFile file(folder + "/" + name);
    file.add(text);
    file.commit();
  };
  write("scaling.csv", table);
  write("strong.svg", standalone_svg(strong_chart(rows)));
  write("weak.svg", standalone_svg(weak_chart(rows)));
  return table;
}

}  // namespace scree
