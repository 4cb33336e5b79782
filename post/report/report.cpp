#include "post/report/report.hpp"

#include <fmt/format.h>
#include <unistd.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>

#include "core/base/error.hpp"
#include "core/base/progress.hpp"
#include "core/base/provenance.hpp"
#include "core/base/units.hpp"
#include "core/base/version.hpp"
#include "core/chart/svg_chart.hpp"
#include "core/storage/h5.hpp"
#include "post/report/case_sections.hpp"
#include "post/report/cell_section.hpp"
#include "post/report/html.hpp"
#include "post/report/report_style.hpp"
#include "post/report/verdicts.hpp"
#include "post/report/view_section.hpp"
#include "post/run/choice.hpp"
#include "post/run/impacts.hpp"
#include "post/run/provenance_chain.hpp"
#include "post/run/wall_loads.hpp"
#include "post/statistics/contact_statistics.hpp"
#include "post/statistics/statistics.hpp"
#include "post/vtk/vtk_or_not.hpp"

namespace scree {

namespace {

/// Share of their way that fragments are moved by in the picture that shows them apart.
constexpr double kApart = 0.5;

std::string picture_section(const Run& run, std::size_t frame, const std::string& within, std::vector<std::string>& notes) {
  const std::string obstacle = picture_obstacle();
  if (!obstacle.empty()) {
    notes.push_back("the report has no pictures: " + obstacle);
    return "<p class=\"missing\">No pictures: " + escaped(obstacle) + "</p>\n";
  }
  std::string html, unseen;
  const auto add = [&](PictureOptions options, const std::string& alt, const std::string& caption) {
    options.within = within;
    const std::string png = (std::filesystem::temp_directory_path() / fmt::format("scree-post-{}.png", getpid())).string();
    unseen = make_picture(run, frame, png, options);
    std::ifstream stream(png, std::ios::binary);
    const std::string bytes((std::istreambuf_iterator<char>(stream)), std::istreambuf_iterator<char>());
    std::remove(png.c_str());
    html +=
        fmt::format("<figure class=\"picture\"><img alt=\"{}\" src=\"data:image/png;base64,{}\"/><figcaption>{}</figcaption></figure>\n",
                    alt, base64(bytes), caption);
  };
  const std::string time = fmt::format("t = {:.4g} s", run.frames[frame].time);
  add({}, "The bodies",
      fmt::format("True shapes at {}, coloured by shape. Walls are translucent and cut where they reach far above.", time));
  PictureOptions speed;
  speed.colour = "velocity";
  add(speed, "The bodies by speed", fmt::format("The same at {}, coloured by speed.", time));
  if (run.scene.settings.output_contacts) {
    PictureOptions network;
    network.network = true;
    add(network, "The contact network", fmt::format("Contact forces at {}: thickness and colour by normal force.", time));
  }
  if (run.scene.settings.heat) {
    PictureOptions warm;
    warm.colour = "temperature";
    add(warm, "Temperature", fmt::format("Temperature of the bodies at {}.", time));
  }
  if (!run.scene.bonds.empty()) {
    PictureOptions fragments;
    fragments.colour = "fragment";
    fragments.apart = kApart;
    add(fragments, "Fragments",
        fmt::format("Fragments at {}, a colour each, moved from the middle of their body by {:g} of their way.", time, kApart));
    PictureOptions bonds;
    bonds.bonds = "load";
    add(bonds, "Bonds", fmt::format("Faces of the bonds that hold at {}, coloured by how much of their strength they bear.", time));
  }
  if (has_load_maps(run.scene)) {
    std::vector<const char*> names{"pressure", "sliding_power", "impact_power"};
    if (has_wear(run.scene)) names.push_back("wear_depth");
    for (const char* name : names) {
      PictureOptions load;
      load.load = name;
      const LoadQuantity& of = kLoadQuantities[load_quantity(name)];
      add(load, of.title,
          fmt::format("Load map: {}, mean from the start to {}. Of a shell the near side is left out; the scale ends where "
                      "99 % of the area that bears anything is below.",
                      of.title, time));
    }
  }
  if (!unseen.empty()) html += "<p>" + escaped(unseen) + ".</p>\n";
  return html;
}

/// Forces, torques and power of the walls that any body touched.
std::string walls_table(const Statistics& s) {
  std::string rows;
  for (std::size_t w = 0; w < s.wall_names.size(); ++w) {
    for (std::size_t q = 0; q < s.wall_quantities.size(); ++q) {
      const Average& a = s.wall_averages[w][q];
      if (a.count == 0 || (a.smallest == 0 && a.largest == 0)) continue;
      rows += fmt::format(
          "<tr><td>{}</td><td title=\"{}\">{}</td><td class=\"n\">{:.5g}</td><td class=\"n\">{}</td><td class=\"n\">{:.4g}</td><td "
          "class=\"n\">{:.4g}</td><td>{}</td></tr>\n",
          escaped(s.wall_names[w]), escaped(s.wall_quantities[q].meaning), s.wall_quantities[q].name, a.mean,
          std::isfinite(a.ci95) ? fmt::format("&plusmn; {:.2g}", a.ci95) : "", a.smallest, a.largest, s.wall_quantities[q].unit);
    }
  }
  if (rows.empty()) return "";
  return "<details><summary>Forces, torques and power of the walls</summary><div class=\"wide\"><table "
         "class=\"grid-table\"><thead><tr><th>wall</th><th>quantity</th><th>mean</th><th>95 %</th><th>min</th><th>max</th><th>unit</th>"
         "</tr></thead><tbody>\n" +
         rows + "</tbody></table></div></details>\n";
}

std::string statistics_section(const Statistics& s, const std::string& apparatus) {
  std::string html = fmt::format(
      "<p>Means over {} frames from {:.4g} s to {:.4g} s with 95 % confidence intervals from {} blocks of frames, which hold for a steady "
      "state "
      "only. Definitions: <code>post/STATISTICS.md</code>.</p>\n",
      s.frames, s.first_time, s.last_time, s.blocks);
  if (!s.left.empty()) html += "<p>" + escaped(s.left) + ": left out of all that is counted.</p>\n";
  if (!apparatus.empty()) html += "<p>" + escaped(apparatus) + ".</p>\n";
  for (const NamedChart& chart : charts_of(s)) html += figure(chart.chart);
  html +=
      "<details open><summary>All quantities</summary><div class=\"wide\"><table "
      "class=\"grid-table\"><thead><tr><th>quantity</th><th>mean</th><th>95 %</th><th>min</th>"
      "<th>max</th><th>unit</th></tr></thead><tbody>\n";
  for (std::size_t q = 0; q < s.quantities.size(); ++q) {
    const Average& a = s.averages[0][q];
    if (a.count == 0) continue;
    html += fmt::format(
        "<tr><td title=\"{}\">{}</td><td class=\"n\">{:.5g}</td><td class=\"n\">{}</td><td class=\"n\">{:.4g}</td><td "
        "class=\"n\">{:.4g}</td><td>{}</td></tr>\n",
        escaped(s.quantities[q].meaning), s.quantities[q].name, a.mean, std::isfinite(a.ci95) ? fmt::format("&plusmn; {:.2g}", a.ci95) : "",
        a.smallest, a.largest, s.quantities[q].unit == "-" ? "" : s.quantities[q].unit);
  }
  html += "</tbody></table></div></details>\n";
  html += walls_table(s);
  for (const auto& [name, reason] : s.gaps) html += fmt::format("<p class=\"missing\">{}: {}.</p>\n", name, escaped(reason));
  return html;
}

std::vector<double> sum(const std::vector<double>& a, const std::vector<double>& b) {
  std::vector<double> c(a.size());
  for (std::size_t i = 0; i < a.size(); ++i) c[i] = a[i] + b[i];
  return c;
}

std::string load_section(const Run& run) {
  const Frame last = load_frame(run, run.frames.size() - 1);
  const std::vector<WallLoads> loads = wall_loads(run.scene, Frame{}, last);
  std::string html =
      "<p>Of walls with a load map, from the start of the run to the last frame. Mean force: along the axes of the wall's mesh.</p>\n"
      "<div class=\"wide\"><table class=\"grid-table\"><thead><tr><th>wall</th><th>triangles</th><th>mean force [N]</th>"
      "<th>largest mean pressure [Pa]</th><th>sliding [W]</th><th>lost along the normal [W]</th><th>contacts [1/s]</th>"
      "<th>energy of impacts [W]</th><th>worn off [m&sup3;]</th></tr></thead><tbody>\n";
  for (const WallLoads& l : loads) {
    const double per = l.time > 0 ? 1 / l.time : 0;
    html += fmt::format(
        "<tr><td>{}</td><td class=\"n\">{}</td><td class=\"n\">{:.4g}, {:.4g}, {:.4g}</td><td class=\"n\">{:.4g}</td><td "
        "class=\"n\">{:.4g}</td><td class=\"n\">{:.4g}</td><td class=\"n\">{:.4g}</td><td class=\"n\">{:.4g}</td><td "
        "class=\"n\">{}</td></tr>\n",
        escaped(run.scene.walls[l.wall].name), l.area.size(), per * l.impulse.x, per * l.impulse.y, per * l.impulse.z,
        l.values[0].empty() ? 0.0 : *std::max_element(l.values[0].begin(), l.values[0].end()), l.total(2), l.total(3), l.total(4),
        l.total(5), run.scene.walls[l.wall].wear > 0 ? fmt::format("{:.4g}", volume_worn(run.scene.walls[l.wall], last)) : "");
  }
  return html + "</tbody></table></div>\n";
}

std::string impact_section(const Run& run) {
  const Frame last = load_frame(run, run.frames.size() - 1);
  const std::vector<MaterialPairImpacts> pairs = impacts_between(run.scene, Frame{}, last);
  if (pairs.empty()) return "<p class=\"missing\">Nothing has touched yet.</p>\n";
  std::string html =
      "<p>From the start of the run to the last frame. An impact is a contact that begins; its energy is that of the motion that the "
      "contact "
      "takes up, along the normals and along the surfaces. What is dissipated is that of all contacts, also of those that last.</p>\n" +
      figure(impact_chart(pairs, last.time)) +
      "<div class=\"wide\"><table class=\"grid-table\"><thead><tr><th>materials</th><th>impacts</th><th>their energy along the normal "
      "[J]</th>"
      "<th>along the surfaces [J]</th><th>dissipated by damping [J]</th><th>by friction [J]</th><th>by rolling [J]</th><th>of all</th>"
      "</tr></thead><tbody>\n";
  double lost = 0;
  for (const MaterialPairImpacts& p : pairs) {
    lost += p.lost();
    html += fmt::format(
        "<tr><td>{} - {}</td><td class=\"n\">{}</td><td class=\"n\">{:.4g}</td><td class=\"n\">{:.4g}</td><td class=\"n\">{:.4g}</td><td "
        "class=\"n\">{:.4g}</td><td class=\"n\">{:.4g}</td><td class=\"n\">{:.1f} %</td></tr>\n",
        escaped(p.material_a), escaped(p.material_b), p.normal_count, p.normal_energy, p.shear_energy, p.damping, p.friction, p.rolling,
        last.dissipated > 0 ? 100 * p.lost() / last.dissipated : 0.0);
  }
  constexpr double kRounding = 1e-9;  // of what the frame says, whose sums are other sums
  const double others = last.dissipated - lost;
  if (std::abs(others) > kRounding * std::abs(last.dissipated))
    html += fmt::format(
        "<tr><td>not of contacts: drag, bonds, necks, wear</td><td></td><td></td><td></td><td class=\"n\" colspan=\"3\">{:.4g}</td>"
        "<td class=\"n\">{:.1f} %</td></tr>\n",
        others, last.dissipated > 0 ? 100 * others / last.dissipated : 0.0);
  return html + "</tbody></table></div>\n";
}

std::string energy_section(const Run& run) {
  const LogTable& log = run.log;
  if (log.rows() < 2) return "<p class=\"missing\">log.csv has no rows yet.</p>\n";
  const std::vector<double>& t = log.column("time");
  const std::vector<double> kinetic = sum(log.column("kinetic_translational"), log.column("kinetic_rotational"));
  std::vector<double> elastic = log.column("elastic");
  if (log.has("elastic_tangential")) elastic = sum(elastic, log.column("elastic_tangential"));
  std::vector<double> potential = log.column("potential");
  const double lowest = *std::min_element(potential.begin(), potential.end());
  for (double& p : potential) p -= lowest;

  LineChart energies{"Energies", "time", "s", "energy", "J", false, true, {}, {}};
  energies.lines = {{"kinetic", t, kinetic},
                    {"potential above its lowest", t, potential},
                    {"elastic", t, elastic},
                    {"dissipated", t, log.column("dissipated")}};
  for (const auto& [column, title] : {std::pair{"wall_work", "wall work"}, std::pair{"outer_work", "work of outer forces"},
                                      std::pair{"cell_work", "work of the periodic cell"}}) {
    if (!log.has(column)) continue;
    const std::vector<double>& work = log.column(column);
    if (std::any_of(work.begin(), work.end(), [](double w) { return w != 0; })) energies.lines.push_back({title, t, work});
  }
  const double peak = *std::max_element(kinetic.begin(), kinetic.end());
  LineChart settling{"Kinetic energy", "time", "s", "energy", "J", true, false, {}, {}};
  settling.lines = {{"translation", t, log.column("kinetic_translational")}, {"rotation", t, log.column("kinetic_rotational")}};
  if (peak > 0) settling.limits = {{kRestKinetic * peak, "at rest: 1e-6 of the peak"}};

  const double scale = std::max(energy_balance(run).in_play.largest(), still_fall_energy(run.scene));
  std::vector<double> error = log.column("energy_error");
  for (double& e : error) e = scale > 0 ? 100 * e / scale : 0;
  LineChart balance{"Error of the energy balance", "time", "s", "error [%]", "", false, false, {{"error", t, error}}, {}};
  return figure(energies) + figure(settling) + figure(balance);
}

std::string contact_section(const Run& run) {
  std::string html;
  if (run.log.rows() >= 2) {
    const std::vector<double>& t = run.log.column("time");
    if (run.log.has("contacts")) {
      html += figure(
          (LineChart{"Contact points", "time", "s", "contact points", "", false, true, {{"contacts", t, run.log.column("contacts")}}, {}}));
    }
    if (run.scene.settings.margin > 0) {
      const std::string room = run.scene.balls_touch_beside_meshes() ? "maximum" : "margin";
      html += figure((LineChart{"Largest overlap over the " + room,
                                "time",
                                "s",
                                "overlap / " + room,
                                "",
                                false,
                                true,
                                {{"overlap / " + room, t, run.log.column("max_depth_ratio")}},
                                {{1.0, "1: the surfaces would touch"}}}));
    }
  }
  if (!run.scene.settings.output_contacts)
    return html + "<p class=\"missing\">The frames hold no contacts: the case says contacts = false.</p>\n";

  const ContactStatistics last = contact_statistics(load_frame(run, run.frames.size() - 1), run.boundary_ids);

  const Distribution& c = last.contact_force;
  const Distribution& p = last.pair_force;
  const auto force_text = [](double f) { return format_quantity(f, Dimension::force); };
  FactRows rows{{"Time", fmt::format("{:.6g} s", last.time)},
                {"Particles", fmt::format("{}, of them {} rattlers (fewer than two neighbours)", last.particles, last.rattlers)},
                {"Pairs in contact", fmt::format("{} among particles, {} with walls", last.pairs_of_particles, last.pairs_with_walls)},
                {"Coordination number", fmt::format("{:.3f} neighbours per particle; {:.3f} without rattlers", last.coordination,
                                                    last.coordination_without_rattlers)},
                {"Contact points", fmt::format("{}, {:.3f} per particle", last.contacts, last.contacts_per_particle)}};
  if (c.count > 0) {
    rows.emplace_back("Normal force per contact point",
                      fmt::format("mean {}, median {}, 5 % to 95 %: {} to {}, largest {}", force_text(c.mean), force_text(c.median),
                                  force_text(c.q05), force_text(c.q95), force_text(c.largest)));
    rows.emplace_back("Force per pair",
                      fmt::format("mean {}, median {}, largest {}", force_text(p.mean), force_text(p.median), force_text(p.largest)));
  }
  if (last.pairs_of_particles > 0) {
    std::string matrix = "<table class=\"matrix\">";
    for (int i = 0; i < 3; ++i)
      matrix += fmt::format("<tr><td>{:.4f}</td><td>{:.4f}</td><td>{:.4f}</td></tr>", last.fabric[i].x, last.fabric[i].y, last.fabric[i].z);
    rows.emplace_back("Fabric tensor", matrix + fmt::format("</table>principal {:.4f}, {:.4f}, {:.4f}; 0.3333 each when isotropic",
                                                            last.fabric_principal.x, last.fabric_principal.y, last.fabric_principal.z));
  }
  return html + "<h3>At the last frame</h3>\n" + table_of(rows);
}

/// Where heat came from and went to, by the last row of the log.
std::string heat_section(const Run& run) {
  const LogTable& log = run.log;
  if (log.rows() == 0 || !log.has("heat")) return "<p class=\"missing\">The log has no heat yet.</p>\n";
  const auto last = [&](const std::string& name) { return log.has(name) ? log.column(name).back() : 0.0; };
  const auto joule = [](double value) { return format_quantity(value, Dimension::energy); };
  const double stored = last("heat") - log.column("heat").front(), drift = last("heat_balance") - log.column("heat_balance").front();
  FactRows rows{{"Stored since the start", joule(stored)},
                {"Made by contacts, in bodies", joule(last("heat_made"))},
                {"Made by contacts, in walls", joule(last("heat_made_in_walls")) + ", which leaves the scene"},
                {"From sources", joule(last("heat_from_sources"))}};
  if (log.has("heat_from_program")) {
    rows.emplace_back("From sources of the program", joule(last("heat_from_program")));
    rows.emplace_back("From media of the program", joule(last("heat_from_medium")));
  }
  if (last("heat_arrived") != 0 || last("heat_removed") != 0) {
    rows.emplace_back("With bodies that came in", joule(last("heat_arrived")));
    rows.emplace_back("With bodies that left", joule(last("heat_removed")));
  }
  std::vector<ChartLine> lines;
  for (const Wall& wall : run.scene.walls) {
    const std::string name = fmt::format("wall{}_heat", wall.id);
    if (!log.has(name)) continue;
    rows.emplace_back("From wall '" + escaped(wall.name) + "'",
                      fmt::format("{}; at the end {}", joule(last(name)), format_quantity(last(name + "_flow"), Dimension::power)));
    lines.push_back({wall.name, log.column("time"), log.column(name + "_flow")});
  }
  rows.emplace_back(
      "What the balance is off by",
      last("heat") > 0 ? fmt::format("{} ({:.1e} of the heat stored)", joule(drift), std::abs(drift / last("heat"))) : joule(drift));
  double biot = 0;
  for (const double value : log.column("biot")) biot = std::max(biot, value);
  rows.emplace_back("Largest Biot number",
                    biot > kLargestBiot
                        ? fmt::format("{:.3g}; above {:g} a body has no single temperature: heat passes too easily", biot, kLargestBiot)
                        : fmt::format("{:.3g}", biot));
  std::string html = table_of(rows);
  if (!lines.empty()) html += figure((LineChart{"Heat flow of walls", "time", "s", "power to the bodies", "W", false, true, lines, {}}));
  return html;
}

/// Over the rows of the log: bodies may come and go.
double mean_bodies(const Run& run) {
  const LogTable& log = run.log;
  const auto start = static_cast<double>(run.scene.bodies.size());
  if (!run.lets_in() && run.scene.outlets.empty() && run.removed() == 0) return start;
  double sum = 0;
  for (std::size_t i = 0; i < log.rows(); ++i) {
    const auto at = [&](const char* name) { return log.has(name) ? log.column(name)[i] : 0.0; };
    sum += start + at("inserted_bodies") - at("removed_bodies");
  }
  return log.rows() > 0 ? sum / static_cast<double>(log.rows()) : start;
}

/// Steps that take so many times what they compute say more of the machine than of the run.
constexpr double kWorthReporting = 1.5;

std::string cost_section(const Run& run) {
  BarChart bars{"Time by phase (mean over ranks)", "", {}, {}, {}, false, ""};
  double total = 0;
  std::vector<std::pair<std::string, double>> phases;
  if (run.outcome->contains("phases") && (*run.outcome)["phases"].is_object()) {
    for (const auto& [name, seconds] : (*run.outcome)["phases"].items()) {
      if (seconds.is_number()) phases.emplace_back(name, seconds.get<double>());
    }
  } else if (run.log.rows() > 0) {
    bars.title = "Time by phase so far (first rank)";
    for (const std::string& name : run.log.names) {
      if (name.starts_with("t_")) phases.emplace_back(name.substr(2), run.log.column(name).back());
    }
  }
  std::sort(phases.begin(), phases.end(), [](const auto& a, const auto& b) { return a.second > b.second; });
  for (const auto& [name, seconds] : phases) total += seconds;
  for (const auto& [name, seconds] : phases) {
    bars.names.push_back(name);
    bars.values.push_back(seconds);
    bars.texts.push_back(fmt::format("{:.3g} s ({:.1f} %)", seconds, total > 0 ? 100 * seconds / total : 0));
  }
  std::string html = phases.empty() ? "" : figure(bars);
  if (run.log.rows() >= 3 && run.log.has("steps_per_second")) {
    std::vector<double> t = run.log.column("time"), rate = run.log.column("steps_per_second");
    t.erase(t.begin());  // no step lies before the first row
    rate.erase(rate.begin());
    html += figure((LineChart{"Speed", "time", "s", "steps per second of wall time", "", false, true, {{"speed", t, rate}}, {}}));
  }
  if (!run.is_finished()) return html;
  const nlohmann::json& o = run.outcome;
  const double wall = o.value("wall_seconds", 0.0), steps = o.value("steps", 0.0);
  FactRows rows{{"Wall time", fmt::format("{} for {:.0f} steps", format_duration(wall), steps)},
                {"Ran on", fmt::format("{} ranks x {} threads", o.value("ranks", 1), o.value("threads", 1))}};
  if (wall > 0) rows.emplace_back("Rate", fmt::format("{:.3g} particle steps per second", mean_bodies(run) * steps / wall));
  if (const double slowdown = o.value("slowdown", 1.0); slowdown >= kWorthReporting)
    rows.emplace_back("Waited for cores", fmt::format("steps took {:.2g} times as long as they computed, near the end: other processes, or "
                                                      "other ranks, had the cores",
                                                      slowdown));
  if (o.contains("mean_imbalance"))
    rows.emplace_back("Mean imbalance", fmt::format("{:.3f} (largest over mean work of the ranks)", o.value("mean_imbalance", 1.0)));
  if (o.contains("peak_rss_bytes"))
    rows.emplace_back("Peak memory, all ranks", fmt::format("{:.0f} MB", o.value("peak_rss_bytes", 0.0) / 1e6));
  return html + table_of(rows);
}

}  // namespace

namespace {

nlohmann::json numbers_of(const Run& run, const std::vector<Verdict>& verdicts, const Statistics& statistics, const nlohmann::json& record,
                          const std::vector<ChainFile>& files) {
  nlohmann::json numbers = {{"format", "scree-report"},
                            {"format_version", 1},
                            {"run", run.name},
                            {"title", run.scene.settings.title},
                            {"bodies", run.scene.bodies.size()},
                            {"frames", run.frames.size()},
                            {"time", run.frames.back().time}};
  for (const Verdict& v : verdicts) {
    numbers["verdicts"].push_back(
        {{"question", v.question}, {"answer", v.answer}, {"judgement", name_of(v.judgement)}, {"evidence", v.evidence}});
  }
  numbers["settings"] = settings_json(run.scene);
  numbers["statistics"] = json_of(run, statistics);
  numbers["cost"] = nlohmann::json::object();
  for (const char* key : {"wall_seconds", "steps", "step_size", "critical_step", "ranks", "threads", "phases", "mean_imbalance", "slowdown",
                          "peak_rss_bytes", "memory", "energy", "max_depth_ratio", "lost_bodies", "state_hash", "inlets", "outlets"}) {
    if (run.outcome->contains(key)) numbers["cost"][key] = (*run.outcome)[key];
  }
  numbers["provenance"] = record;
  static constexpr std::array<const char*, 3> kStates{"same", "changed", "missing"};
  for (const ChainFile& f : files) {
    numbers["files"].push_back(
        {{"file", f.file}, {"sha256", f.sha256}, {"found", f.found}, {"state", kStates[static_cast<std::size_t>(f.state)]}});
  }
  numbers["commands"] = commands_of(record);
  return numbers;
}

/// What the head of the page says of the bodies that were not there at the start: of a run that has not ended, what its log has so far.
std::string came_in(const Run& run) {
  if (!run.lets_in()) return "";
  return fmt::format(" at the start and {:.0f} that came in{}", run.inserted(), run.is_finished() ? "" : " so far");
}

}  // namespace

ReportResult write_report(const Run& run, const std::string& path, const ReportOptions& options) {
  ReportResult result;
  const std::size_t shown = find_frame(run, options.frame);
  StatisticsOptions what = options.statistics;
  what.frames = choose_frames(run, "all");
  const Statistics statistics = run_statistics(run, what, "");
  if (!statistics.left.empty())
    result.notes.push_back(statistics.left + ": left out of all that is counted; --within all counts all bodies");
  for (const std::string& message : statistics.skipped) result.notes.push_back("left out: " + message);
  const std::vector<Verdict> verdicts = judge(run);
  for (const Verdict& v : verdicts) result.verdicts.push_back(fmt::format("{:<22} {:<36} {}", v.question, v.answer, name_of(v.judgement)));
  const nlohmann::json record = provenance_of(run);
  const std::vector<ChainFile> files = check_files(record, run.folder);
  result.numbers = numbers_of(run, verdicts, statistics, record, files);
  const ViewSection view = view_section(run, shown, what.within, what.pool);
  (*result.numbers)["view"] = view.numbers;
  for (const std::string& message : view.skipped) {  // most were named with the statistics
    if (std::find(statistics.skipped.begin(), statistics.skipped.end(), message) == statistics.skipped.end())
      result.notes.push_back("not played: " + message);
  }

  const std::string title = run.scene.settings.title.empty() ? run.name : run.scene.settings.title;
  std::string html = fmt::format(
      "<!doctype html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\"/>\n<meta name=\"viewport\" "
      "content=\"width=device-width, initial-scale=1\"/>\n<title>{}</title>\n<style>\n{}</style>\n</head>\n<body>\n<main>\n",
      escaped(title + " - Scree"), kReportStyle);
  html += fmt::format(
      "<header><p class=\"kicker\">Scree run <code>{}</code></p><h1>{}</h1><p class=\"lead\">{} bodies{}, {} frames, {:.4g} s simulated. "
      "Report of {} by scree-post {}.</p></header>\n",
      escaped(run.name), escaped(title), run.scene.bodies.size(), came_in(run), run.frames.size(), run.frames.back().time, utc_now(),
      kVersion);
  std::vector<std::array<std::string, 3>> sections{{"verdicts", "Can it be trusted?", verdict_section(verdicts)},
                                                   {"case", "What was run", case_section(run)},
                                                   {"picture", "Pictures", picture_section(run, shown, what.within, result.notes)},
                                                   {"view", "3D view", view.html},
                                                   {"statistics", "Statistics", statistics_section(statistics, options.apparatus)},
                                                   {"energies", "Energies", energy_section(run)},
                                                   {"contacts", "Contacts", contact_section(run)},
                                                   {"cost", "Cost", cost_section(run)},
                                                   {"provenance", "Where it comes from", provenance_section(record, files)},
                                                   {"repeat", "To run it again", repeat_section(run, record)}};
  if (has_load_maps(run.scene))
    sections.insert(std::find_if(sections.begin(), sections.end(), [](const auto& s) { return s[0] == "energies"; }),
                    {"loads", "Loads on walls", load_section(run)});
  if (run.scene.settings.cell)
    sections.insert(std::find_if(sections.begin(), sections.end(), [](const auto& s) { return s[0] == "energies"; }),
                    {"cell", "Periodic cell", cell_section(run)});
  if (run.scene.settings.heat)
    sections.insert(std::find_if(sections.begin(), sections.end(), [](const auto& s) { return s[0] == "contacts"; }),
                    {"heat", "Heat", heat_section(run)});
  if (has_impacts(run.scene))
    sections.insert(std::find_if(sections.begin(), sections.end(), [](const auto& s) { return s[0] == "energies"; }),
                    {"impacts", "Impacts", impact_section(run)});
  html += "<nav>";
  for (const auto& [id, name, content] : sections)
    html += fmt::format("<a href=\"#{}\">{}</a>", id, escaped(id == "verdicts" ? "Verdicts" : name));
  html += "</nav>\n";
  for (const auto& [id, name, content] : sections) html += section(id, name, content);
  html += "</main>\n</body>\n</html>\n";
  h5::write_text_file(path, html);
  return result;
}

}  // namespace scree
