#include "post/statistics/statistics.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "core/base/csv.hpp"
#include "core/base/error.hpp"
#include "core/base/numbers.hpp"
#include "core/base/utf8.hpp"
#include "core/storage/h5.hpp"
#include "post/run/output_file.hpp"
#include "post/statistics/flow_output.hpp"
#include "post/statistics/frame_numbers.hpp"
#include "post/statistics/space_measures.hpp"

namespace scree {

namespace {

constexpr std::size_t kSeriesLength = 600;  // points of a chart; a longer run is drawn by every n-th frame

/// A number as it stands in a table: empty where there is none.
std::string cell(double value) { return std::isfinite(value) ? fmt::format("{:.9g}", value) : std::string(); }

std::string units_of(const std::vector<Quantity>& quantities) {
  std::string line;
  for (const Quantity& q : quantities) line += fmt::format(",{}", q.unit);
  return line + "\n";
}

std::string names_of(const std::vector<Quantity>& quantities) {
  std::string line;
  for (const Quantity& q : quantities) line += fmt::format(",{}", q.name);
  return line + "\n";
}

/// With a last column for the name of what the row is about.
std::vector<Quantity> with_name(std::vector<Quantity> quantities) {
  quantities.push_back({"name", "-", ""});
  return quantities;
}

/// What a reader calls the walls: by their names, with the id where several have the same or none.
std::vector<std::string> names_of_walls(const Scene& scene) {
  std::vector<std::string> names;
  for (const Wall& wall : scene.walls) {
    const auto same = std::count_if(scene.walls.begin(), scene.walls.end(), [&](const Wall& other) { return other.name == wall.name; });
    if (wall.name.empty())
      names.push_back(fmt::format("wall {}", wall.id));
    else
      names.push_back(same > 1 ? fmt::format("{} ({})", wall.name, wall.id) : wall.name);
  }
  return names;
}

/// The tables that have a row for every frame.
class RowWriter {
 public:
  RowWriter(const StatisticsPlan& plan, const std::string& folder) : plan_(plan) {
    if (folder.empty()) return;
    make_folder(folder);
    series_ = std::make_unique<OutputFile>(fmt::format("{}/series.csv", folder));
    series_->add("time,frame,group" + names_of(plan.quantities) + "# units: s,-,-" + units_of(plan.quantities));
    if (plan.walls() > 0) {
      walls_ = std::make_unique<OutputFile>(fmt::format("{}/walls.csv", folder));
      walls_->add("time,frame,wall" + names_of(with_name(plan.wall_quantities)) + "# units: s,-,-" +
                  units_of(with_name(plan.wall_quantities)));
    }
    for (std::size_t t = 0; t < plan.profiles.size(); ++t) {
      const StatisticsTable& table = plan.tables[t];
      profiles_.push_back(std::make_unique<OutputFile>(fmt::format("{}/{}_over_time.csv", folder, table.name)));
      profiles_.back()->add("time,frame," + table.coordinate.name + names_of(table.columns) + "# units: s,-,m" + units_of(table.columns));
    }
  }
  void add(std::int64_t number, double time, const std::vector<double>& row) {
    if (!series_) return;
    const std::string head = fmt::format("{},{}", time, number);
    const auto line = [&](const std::string& key, std::size_t begin, std::size_t count, const std::string& end = "\n") {
      std::string text = fmt::format("{},{}", head, key);
      for (std::size_t i = 0; i < count; ++i) text += fmt::format(",{}", cell(row[begin + i]));
      return text + end;
    };
    for (std::size_t g = 0; g < plan_.groups.size(); ++g)
      series_->add(line(csv_cell(plan_.groups[g].name), plan_.at(g, 0), plan_.quantities.size()));
    for (std::size_t w = 0; w < plan_.walls(); ++w) {
      const std::size_t count = plan_.wall_quantities.size();
      const Wall& wall = plan_.run.scene.walls[w];
      walls_->add(line(fmt::format("{}", wall.id), plan_.wall_begin + w * count, count, "," + csv_cell(wall.name) + "\n"));
    }
    for (std::size_t t = 0; t < profiles_.size(); ++t) {
      const StatisticsTable& table = plan_.tables[t];
      for (std::size_t k = 0; k < table.coordinates.size(); ++k) {
        profiles_[t]->add(line(cell(table.coordinates[k]), plan_.table_begin(t) + k * table.columns.size(), table.columns.size()));
      }
    }
  }
  void commit() {
    if (series_) series_->commit();
    if (walls_) walls_->commit();
    for (const auto& file : profiles_) file->commit();
  }

 private:
  const StatisticsPlan& plan_;
  std::unique_ptr<OutputFile> series_, walls_;
  std::vector<std::unique_ptr<OutputFile>> profiles_;
};

nlohmann::json number(double value) { return std::isfinite(value) ? nlohmann::json(value) : nlohmann::json(); }

nlohmann::json json_of(const Average& a) {
  return {{"mean", number(a.mean)}, {"ci95", number(a.ci95)}, {"min", number(a.smallest)}, {"max", number(a.largest)}, {"frames", a.count}};
}

/// Why frames have no angle of repose, by the last of them that was read.
std::pair<std::string, std::string> gap_of_repose(const StatisticsPlan& plan, const StatisticsOptions& options, const Statistics& s) {
  const std::size_t missing = s.frames - s.of("angle_of_repose").count;
  std::string reason;
  const Frame last = plan.load(options.frames.back()).frame;
  const FrameView view(*plan.facts, last);
  options.repose == "cone" ? angle_of_repose_cone(view, &reason) : angle_of_repose_slope(view, &reason);
  return {"angle_of_repose", fmt::format("missing in {} of {} frames{}", missing, s.frames,
                                         reason.empty() ? "; the last has one" : "; in the last of them " + reason)};
}

}  // namespace

const Average& Statistics::of(const std::string& quantity, std::size_t group) const {
  for (std::size_t q = 0; q < quantities.size(); ++q) {
    if (quantities[q].name == quantity) return averages.at(group)[q];
  }
  throw InternalError("no quantity " + quantity);
}

Statistics run_statistics(const Run& run, const StatisticsOptions& options, const std::string& folder) {
  const StatisticsPlan plan(run, options);
  BlockAverage average(plan.size(), options.frames.size(), options.blocks);
  RowWriter rows(plan, folder);
  Statistics s;
  s.quantities = plan.quantities;
  s.wall_quantities = plan.wall_quantities;
  s.tables = plan.tables;
  for (const Group& group : plan.groups) s.groups.push_back(group.name);
  for (const Wall& wall : run.scene.walls) s.walls.push_back(fmt::format("{}{}{}", wall.id, wall.name.empty() ? "" : " ", wall.name));
  s.wall_names = names_of_walls(run.scene);
  s.series.resize(s.quantities.size());
  s.wall_series.assign(s.walls.size(), std::vector<Series>(s.wall_quantities.size()));

  const std::size_t stride = (options.frames.size() + kSeriesLength - 1) / kSeriesLength;
  const std::size_t discharged = plan.index_of("discharged_mass"), rate = plan.index_of("discharge_rate");
  double last_mass = kNaN;
  std::vector<double> times;
  for (const std::size_t f : options.frames) times.push_back(run.frames[f].time);
  const std::vector<double> weights = frame_weights(times);
  const auto task = [&](std::size_t f) { return bytes_of(plan.numbers_of(plan.load(f))); };
  const auto sink = [&](std::size_t f, const std::string& bytes) {
    std::vector<double> row = doubles_of(bytes);
    const double time = run.frames[f].time;
    const double last_time = s.last_time;
    row[rate] = s.frames > 0 && time > last_time ? (row[discharged] - last_mass) / (time - last_time) : kNaN;
    last_mass = row[discharged];
    if (s.frames == 0) s.first_time = time;
    s.last_time = time;
    const auto place = static_cast<std::size_t>(std::lower_bound(options.frames.begin(), options.frames.end(), f) - options.frames.begin());
    average.add(row, weights[place], rate, std::isfinite(row[rate]) ? time - last_time : 0);
    const std::string name = std::filesystem::path(run.frames[f].path).stem().string();  // frame_000012
    rows.add(std::atoll(name.c_str() + name.find('_') + 1), time, row);
    if (s.frames++ % stride != 0) return;
    for (std::size_t q = 0; q < s.quantities.size(); ++q) {
      s.series[q].time.push_back(time);
      s.series[q].value.push_back(row[q]);
    }
    for (std::size_t w = 0; w < s.walls.size(); ++w) {
      for (std::size_t q = 0; q < s.wall_quantities.size(); ++q) {
        s.wall_series[w][q].time.push_back(time);
        s.wall_series[w][q].value.push_back(row[plan.wall_begin + w * s.wall_quantities.size() + q]);
      }
    }
  };
  s.skipped = for_each_frame(options.frames, options.pool, task, sink).skipped;
  rows.commit();

  s.blocks = average.blocks();
  for (std::size_t g = 0; g < s.groups.size(); ++g) {
    s.averages.emplace_back();
    for (std::size_t q = 0; q < s.quantities.size(); ++q) s.averages[g].push_back(average.of(plan.at(g, q)));
  }
  for (std::size_t t = 0; t < s.tables.size(); ++t) {
    StatisticsTable& table = s.tables[t];
    table.values.resize(table.columns.size());
    for (std::size_t c = 0; c < table.columns.size(); ++c) {
      for (std::size_t k = 0; k < table.coordinates.size(); ++k)
        table.values[c].push_back(average.of(plan.table_begin(t) + k * table.columns.size() + c));
    }
  }
  for (std::size_t w = 0; w < s.walls.size(); ++w) {
    s.wall_averages.emplace_back();
    for (std::size_t q = 0; q < s.wall_quantities.size(); ++q)
      s.wall_averages[w].push_back(average.of(plan.wall_begin + w * s.wall_quantities.size() + q));
  }
  s.left = words_of_left(plan.extent, plan.within);
  for (const auto& gap : plan.gaps) s.gaps.push_back(gap);
  s.flow = read_flow(run, s.first_time, s.last_time, options.blocks);
  if (!s.flow.missing.empty()) s.skipped.push_back(s.flow.missing);
  if (options.repose != "none" && s.of("angle_of_repose").count < s.frames) s.gaps.push_back(gap_of_repose(plan, options, s));
  if (run.scene.settings.output_contacts && s.frames > 0) {
    const Frame last = plan.load(options.frames.back()).frame;
    s.chains = force_chains(FrameView(*plan.facts, last)).chains;
  }
  return s;
}

nlohmann::json json_of(const Run& run, const Statistics& s) {
  nlohmann::json groups = nlohmann::json::object(), tables = nlohmann::json::object(), walls = nlohmann::json::object();
  const auto quantity = [](const Quantity& q, const Average& a) {
    nlohmann::json entry = json_of(a);
    entry["unit"] = q.unit;
    return entry;
  };
  for (std::size_t g = 0; g < s.groups.size(); ++g) {
    for (std::size_t q = 0; q < s.quantities.size(); ++q) {
      if (s.averages[g][q].count > 0) groups[s.groups[g]][s.quantities[q].name] = quantity(s.quantities[q], s.averages[g][q]);
    }
  }
  for (const StatisticsTable& t : s.tables) {
    nlohmann::json table = {{"coordinate", t.coordinate.name}, {"unit", t.coordinate.unit}, {"coordinates", t.coordinates}};
    for (std::size_t c = 0; c < t.columns.size(); ++c) {
      nlohmann::json mean = nlohmann::json::array(), ci95 = nlohmann::json::array();
      for (const Average& a : t.values[c]) {
        mean.push_back(number(a.mean));
        ci95.push_back(number(a.ci95));
      }
      table["columns"][t.columns[c].name] = {{"unit", t.columns[c].unit}, {"mean", mean}, {"ci95", ci95}};
    }
    tables[t.name] = table;
  }
  for (std::size_t w = 0; w < s.walls.size(); ++w) {
    for (std::size_t q = 0; q < s.wall_quantities.size(); ++q)
      walls[s.walls[w]][s.wall_quantities[q].name] = quantity(s.wall_quantities[q], s.wall_averages[w][q]);
  }
  nlohmann::json meanings = nlohmann::json::object();
  for (const Quantity& q : s.quantities) meanings[q.name] = q.meaning;
  nlohmann::json all = {{"format", "scree-statistics"},
                        {"format_version", 1},
                        {"run", run.name},
                        {"frames", s.frames},
                        {"first_time", s.first_time},
                        {"last_time", s.last_time},
                        {"blocks", s.blocks},
                        {"confidence", 0.95},
                        {"skipped", s.skipped},
                        {"left", s.left},
                        {"groups", groups},
                        {"tables", tables},
                        {"walls", walls},
                        {"force_chains_last_frame", s.chains.size()},
                        {"meanings", meanings}};
  for (const auto& [name, reason] : s.gaps) all["gaps"][name] = reason;
  if (!s.flow.empty()) all["flow"] = json_of(s.flow);
  return all;
}

std::vector<std::string> write_statistics(const Run& run, const Statistics& s, const std::string& folder) {
  std::vector<std::string> names;
  const auto write = [&](const std::string& name, const std::string& text) {
    OutputFile file(folder + "/" + name);
    file.add(text);
    file.commit();
    names.push_back(name);
  };
  std::string text = "group,quantity,unit,mean,ci95,min,max,frames,blocks,meaning\n";
  const auto add = [&](const std::string& group, const Quantity& q, const Average& a) {
    if (a.count == 0) return;
    text += fmt::format("{},{},{},{},{},{},{},{},{},{}\n", csv_cell(group), q.name, q.unit, cell(a.mean), cell(a.ci95), cell(a.smallest),
                        cell(a.largest), a.count, s.blocks, csv_cell(q.meaning));
  };
  for (std::size_t g = 0; g < s.groups.size(); ++g) {
    for (std::size_t q = 0; q < s.quantities.size(); ++q) add(s.groups[g], s.quantities[q], s.averages[g][q]);
  }
  for (std::size_t w = 0; w < s.walls.size(); ++w) {
    for (std::size_t q = 0; q < s.wall_quantities.size(); ++q) add("wall " + s.walls[w], s.wall_quantities[q], s.wall_averages[w][q]);
  }
  for (const Gate& gate : s.flow.gates) {
    add(gate.name, {"mass_flow", "kg/s", "mass that passed per time"}, gate.flow);
    add(gate.name, {"residence_time", "s", "since a body came in, mean by mass"}, gate.residence);
  }
  // a row without numbers, whose meaning says why
  for (const auto& [name, reason] : s.gaps) {
    if (s.of(name).count == 0) text += fmt::format("{},{},,,,,,0,{},{}\n", csv_cell(s.groups[0]), name, s.blocks, csv_cell(reason));
  }
  write("summary.csv", text);
  for (const auto& [name, table] : flow_tables(s.flow)) write(name, table);
  for (const StatisticsTable& t : s.tables) {
    text = t.coordinate.name;
    std::string units = t.coordinate.unit;
    for (const Quantity& q : t.columns) {
      text += fmt::format(",{0},{0}_ci95", q.name);
      units += fmt::format(",{0},{0}", q.unit);
    }
    text += "\n# units: " + units + "\n";
    for (std::size_t k = 0; k < t.coordinates.size(); ++k) {
      text += cell(t.coordinates[k]);
      for (const auto& column : t.values) text += fmt::format(",{},{}", cell(column[k].mean), cell(column[k].ci95));
      text += "\n";
    }
    write(t.name + ".csv", text);
  }
  text = "chain,particles,ids\n";
  for (std::size_t c = 0; c < s.chains.size(); ++c) {
    text += fmt::format("{},{},", c, s.chains[c].size());
    for (std::size_t i = 0; i < s.chains[c].size(); ++i) text += fmt::format("{}{}", i > 0 ? " " : "", s.chains[c][i]);
    text += "\n";
  }
  write("force_chains.csv", text);
  if (run.log.rows() > 0) {
    static const std::vector<const char*> kColumns{"kinetic_translational",
                                                   "kinetic_rotational",
                                                   "potential",
                                                   "elastic",
                                                   "elastic_tangential",
                                                   "dissipated",
                                                   "wall_work",
                                                   "outer_work",
                                                   "cell_work",
                                                   "removed",
                                                   "inserted",
                                                   "energy_error"};
    text = "time";
    std::string units = "s";
    for (const char* name : kColumns) {
      text += run.log.has(name) ? fmt::format(",{}", name) : "";
      units += run.log.has(name) ? ",J" : "";
    }
    text += "\n# units: " + units + "\n";
    for (std::size_t i = 0; i < run.log.rows(); ++i) {
      text += cell(run.log.column("time")[i]);
      for (const char* name : kColumns) {
        if (run.log.has(name)) text += fmt::format(",{}", cell(run.log.column(name)[i]));
      }
      text += "\n";
    }
    write("energies.csv", text);
  }
  write("statistics.json", json_text(json_of(run, s), 1) + "\n");
  return names;
}

std::vector<NamedChart> charts_of(const Statistics& s) {
  std::vector<NamedChart> charts;
  const auto over_time = [&](const std::string& name, const std::string& title, const std::string& label, const std::string& unit,
                             const std::vector<std::pair<std::string, std::string>>& lines, bool from_zero) {
    NamedChart c{name, "series.csv", {}};
    c.chart.title = title;
    c.chart.x_label = "time";
    c.chart.x_unit = "s";
    c.chart.y_label = label;
    c.chart.y_unit = unit;
    c.chart.from_zero = from_zero;
    for (const auto& [quantity, text] : lines) {
      if (s.of(quantity).count == 0) continue;
      for (std::size_t q = 0; q < s.quantities.size(); ++q) {
        if (s.quantities[q].name == quantity) c.chart.lines.push_back({text, s.series[q].time, s.series[q].value});
      }
    }
    if (!c.chart.lines.empty()) charts.push_back(std::move(c));
  };
  over_time("coordination_number", "Coordination number", "neighbours per particle", "",
            {{"coordination_number", "all particles"}, {"coordination_number_without_rattlers", "without rattlers"}}, true);
  over_time("solid_fraction", "Solid fraction of the bed", "solid fraction", "", {{"solid_fraction", "inner 80 % of the bed"}}, false);
  over_time("stress", "Contact stress", "stress", "Pa",
            {{"stress_xx", "xx"}, {"stress_yy", "yy"}, {"stress_zz", "zz"}, {"pressure", "pressure"}}, true);
  over_time("anisotropy", "Anisotropy of the fabric", "anisotropy", "",
            {{"fabric_anisotropy", "contact normals"}, {"force_fabric_anisotropy", "normal forces"}}, true);
  over_time("granular_temperature", "Granular temperature", "granular temperature [m²/s²]", "", {{"granular_temperature", "all particles"}},
            true);
  const bool has_heat = std::any_of(s.quantities.begin(), s.quantities.end(), [](const auto& q) { return q.name == "temperature"; });
  if (has_heat) {
    over_time("temperature", "Temperature", "temperature", "K", {{"temperature", "mean of the bodies"}}, false);
    over_time("temperature_spread", "Spread of temperature", "standard deviation over bodies", "K",
              {{"temperature_spread", "all particles"}}, true);
  }
  over_time("force_chains", "Particles in force chains", "share of the particles", "", {{"force_chain_share", "in chains"}}, true);
  over_time("mixing_index", "Mixing index (Lacey)", "0 apart, 1 at random", "", {{"mixing_index", "mixing index"}}, true);
  over_time("size_segregation", "Segregation by size", "1 apart, 0 at random", "",
            {{"segregation_fine", "finest third"}, {"segregation_middle", "between"}, {"segregation_coarse", "coarsest third"}}, true);
  over_time("angle_of_repose", "Angle of the free surface", "angle [degrees]", "", {{"angle_of_repose", "angle"}}, false);
  over_time("discharged_mass", "Discharged mass", "mass [kg]", "", {{"discharged_mass", "mass"}}, true);
  over_time("discharge_rate", "Discharge rate", "mass per time [kg/s]", "", {{"discharge_rate", "since the frame before"}}, true);
  for (NamedChart& chart : flow_charts(s.flow)) charts.push_back(std::move(chart));
  const auto of_walls = [&](const std::string& quantity, const std::string& title, const std::string& label, const std::string& unit) {
    NamedChart c{"wall_" + quantity, "walls.csv", {}};
    c.chart.title = title;
    c.chart.x_label = "time";
    c.chart.x_unit = "s";
    c.chart.y_label = label;
    c.chart.y_unit = unit;
    for (std::size_t q = 0; q < s.wall_quantities.size(); ++q) {
      if (s.wall_quantities[q].name != quantity) continue;
      for (std::size_t w = 0; w < s.walls.size(); ++w) {
        const Series& values = s.wall_series[w][q];
        if (std::any_of(values.value.begin(), values.value.end(), [](double p) { return std::isfinite(p) && p != 0; }))
          c.chart.lines.push_back({s.wall_names[w], values.time, values.value});
      }
    }
    if (!c.chart.lines.empty()) charts.push_back(std::move(c));
  };
  of_walls("power", "Power of the walls", "power on the bodies", "W");
  of_walls("axis_torque", "Torque on walls that turn", "torque about the wall's axis", "N m");
  of_walls("way", "Way of walls that answer to force", "from where they were placed", "m or rad");
  for (std::size_t w = 0; w < s.walls.size(); ++w) {
    NamedChart c{fmt::format("wall_{}_force", w), "walls.csv", {}};
    c.chart.title = "Force on " + s.wall_names[w];
    c.chart.x_label = "time";
    c.chart.x_unit = "s";
    c.chart.y_label = "force";
    c.chart.y_unit = "N";
    for (std::size_t q = 0; q < 3; ++q)
      c.chart.lines.push_back({s.wall_quantities[q].name.substr(6), s.wall_series[w][q].time, s.wall_series[w][q].value});
    charts.push_back(std::move(c));
  }
  for (const StatisticsTable& t : s.tables) {
    for (std::size_t column = 0; column < t.columns.size(); ++column) {
      const Quantity& q = t.columns[column];
      if (q.name == "particle_count" || q.name == "velocity_y" || q.name == "velocity_z" || q.name == "probability_density_tangential")
        continue;  // with their first
      NamedChart c{
          t.columns.size() > 1 && t.name.starts_with("profile") ? t.name + "_" + (q.name == "velocity_x" ? "velocity" : q.name) : t.name,
          t.name + ".csv",
          {}};
      c.chart.title = t.title;
      c.chart.x_label = t.name == "force_distribution" ? "force over the mean normal force" : t.coordinate.name;
      std::replace(c.chart.x_label.begin(), c.chart.x_label.end(), '_', ' ');
      c.chart.x_unit = t.coordinate.unit == "-" ? "" : t.coordinate.unit;
      c.chart.y_label = q.name == "velocity_x" ? "velocity" : (t.name == "force_distribution" ? "probability density" : q.name);
      std::replace(c.chart.y_label.begin(), c.chart.y_label.end(), '_', ' ');
      if (q.unit == "m/s") c.chart.y_unit = q.unit;
      if (q.name == "granular_temperature") c.chart.y_label += " [m²/s²]";
      if (t.name.starts_with("profile")) c.chart.title += ": " + c.chart.y_label.substr(0, c.chart.y_label.find(" ["));
      c.chart.from_zero = true;
      c.chart.logarithmic = t.name == "force_distribution";
      const auto line = [&](std::size_t index, const std::string& name) {
        ChartLine l{name, t.coordinates, {}, {}};
        for (const Average& a : t.values[index]) {
          l.y.push_back(a.mean);
          l.spread.push_back(a.ci95);
        }
        c.chart.lines.push_back(std::move(l));
      };
      if (q.name == "velocity_x") {
        for (std::size_t k = 0; k < 3; ++k) line(column + k, std::string(1, static_cast<char>('x' + k)));
      } else if (t.name == "force_distribution") {
        line(column, "normal");
        line(column + 1, "tangential");
      } else {
        line(column, "mean with 95 % confidence interval");
      }
      charts.push_back(std::move(c));
    }
  }
  return charts;
}

std::string summary_of(const Statistics& s) {
  std::string text = fmt::format("{} frames from {:.6g} s to {:.6g} s; mean and 95 % confidence interval from {} blocks\n", s.frames,
                                 s.first_time, s.last_time, s.blocks);
  for (std::size_t g = 0; g < s.groups.size(); ++g) {
    text += fmt::format("{}\n", s.groups[g]);
    for (std::size_t q = 0; q < s.quantities.size(); ++q) {
      const Average& a = s.averages[g][q];
      if (a.count == 0) continue;
      constexpr double kRounding = 1e-12;  // of the mean: a quantity that does not change
      const bool varies = std::isfinite(a.ci95) && a.ci95 > kRounding * std::abs(a.mean);
      const std::string spread = varies ? fmt::format("+- {:.2g}", a.ci95) : std::string();
      text += fmt::format("  {:<38} {:>12.5g} {:<12} {}\n", s.quantities[q].name, a.mean, spread,
                          s.quantities[q].unit == "-" ? "" : s.quantities[q].unit);
    }
  }
  for (const auto& [name, reason] : s.gaps) text += fmt::format("  {}: {}\n", name, reason);
  for (const Gate& gate : s.flow.gates) {
    text += fmt::format("{}\n  {:<38} {:>12.5g} {:<12} kg/s\n", gate.name, "mass_flow", gate.flow.mean,
                        std::isfinite(gate.flow.ci95) ? fmt::format("+- {:.2g}", gate.flow.ci95) : std::string());
    if (gate.residence.count > 0) text += fmt::format("  {:<38} {:>12.5g} {:<12} s\n", "residence_time", gate.residence.mean, "");
  }
  return text;
}

}  // namespace scree
