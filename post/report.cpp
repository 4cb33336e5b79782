#include "post/report.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>

#include "core/base/error.hpp"
#include "core/base/progress.hpp"
#include "core/base/provenance.hpp"
#include "core/base/units.hpp"
#include "core/base/version.hpp"
#include "core/storage/h5.hpp"
#include "post/contact_statistics.hpp"
#include "post/provenance_chain.hpp"
#include "post/report_style.hpp"
#include "post/svg_chart.hpp"
#include "post/verdicts.hpp"
#include "post/vtk_or_not.hpp"

namespace scree {

namespace {

using Rows = std::vector<std::pair<std::string, std::string>>;

/// Two columns; values are HTML already.
std::string table_of(const Rows& rows) {
  std::string html = "<table class=\"facts\">\n";
  for (const auto& [name, value] : rows) html += fmt::format("<tr><th scope=\"row\">{}</th><td>{}</td></tr>\n", escaped(name), value);
  return html + "</table>\n";
}

std::string section(const std::string& id, const std::string& title, const std::string& content) {
  return fmt::format("<section id=\"{}\">\n<h2>{}</h2>\n{}</section>\n", id, escaped(title), content);
}

std::string figure(const std::string& svg) { return "<figure class=\"chart\">" + svg + "</figure>\n"; }

std::string base64(const std::string& bytes) {
  static const char* const kLetters = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  text.reserve(4 * (bytes.size() + 2) / 3);
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    std::uint32_t group = 0;
    for (std::size_t k = 0; k < 3; ++k) group = (group << 8) | (i + k < bytes.size() ? static_cast<unsigned char>(bytes[i + k]) : 0U);
    for (std::size_t k = 0; k < 4; ++k) text += i + k <= bytes.size() ? kLetters[(group >> (18 - 6 * k)) & 63U] : '=';
  }
  return text;
}

std::string verdict_section(const std::vector<Verdict>& verdicts) {
  static const std::map<Judgement, std::pair<const char*, const char*>> kSigns{
      {Judgement::good, {"good", "&#10003;"}}, {Judgement::doubtful, {"doubtful", "!"}},
      {Judgement::bad, {"bad", "&#10007;"}}, {Judgement::information, {"information", "i"}}};
  std::string html = "<div class=\"verdicts\">\n";
  for (const Verdict& v : verdicts) {
    const auto& [style, sign] = kSigns.at(v.judgement);
    html += fmt::format("<div class=\"verdict {}\"><div class=\"sign\" aria-hidden=\"true\">{}</div><div><h3>{}</h3><p class=\"answer\">{}"
                        " <span class=\"word\">{}</span></p><p class=\"evidence\">{}</p></div></div>\n", style, sign, escaped(v.question),
                        escaped(v.answer), name_of(v.judgement), escaped(v.evidence));
  }
  return html + "</div>\n";
}

std::string motion_text(const Wall& wall) {
  switch (wall.motion.kind) {
    case WallMotion::Kind::none: return "fixed";
    case WallMotion::Kind::rotate: return fmt::format("rotates at {:.4g} rad/s", wall.motion.rate);
    case WallMotion::Kind::translate: return fmt::format("translates at {:.4g} m/s", wall.motion.rate);
    case WallMotion::Kind::oscillate: return fmt::format("oscillates by {:.4g} m at {:.4g} Hz", wall.motion.amplitude, wall.motion.frequency);
    case WallMotion::Kind::table: return "follows a table";
  }
  return "";
}

std::string case_section(const Run& run) {
  const Scene& scene = run.scene;
  const Settings& s = scene.settings;
  double mass = 0, volume = 0, smallest = 1e300, largest = 0;
  std::vector<std::size_t> count(scene.shapes.size(), 0);
  for (std::size_t i = 0; i < scene.bodies.size(); ++i) {
    const auto k = static_cast<std::size_t>(scene.bodies.shape[i]);
    const double diameter = scene.bodies.scale[i] * scene.shapes[k].equivalent_diameter();
    mass += scene.mass(i);
    volume += scene.shapes[k].mass.volume * std::pow(scene.bodies.scale[i], 3);
    smallest = std::min(smallest, diameter);
    largest = std::max(largest, diameter);
    ++count[k];
  }
  const auto length_text = [](double x) { return format_quantity(x, Dimension::length); };
  Rows rows{{"Title", escaped(s.title)},
            {"Bodies", fmt::format("{} ({:.4g} kg, {:.4g} m&sup3; of solid)", scene.bodies.size(), mass, volume)}};
  if (scene.bodies.size() > 0) rows.emplace_back("Equivalent diameter", fmt::format("{} to {}", length_text(smallest), length_text(largest)));
  rows.emplace_back("Gravity", fmt::format("({:.4g}, {:.4g}, {:.4g}) m/s&sup2;", s.gravity.x, s.gravity.y, s.gravity.z));
  rows.emplace_back("Duration", fmt::format("{}, a frame every {}", format_quantity(s.duration, Dimension::time),
                                            s.output_every > 0 ? format_quantity(s.output_every, Dimension::time) : "hundredth of it"));
  rows.emplace_back("Contact", fmt::format("law {}, gathered as {}, margin {}", escaped(s.law), escaped(s.gather), length_text(s.margin)));
  rows.emplace_back("Motion", fmt::format("{}{}", escaped(s.integrator),
                                          run.outcome.contains("step_size") ? ", step " + format_quantity(run.outcome["step_size"].get<double>(), Dimension::time)
                                                                            : std::string()));
  if (run.is_finished()) {
    if (const std::string limit = run.outcome.value("step_limited_by", ""); !limit.empty()) rows.emplace_back("Step limited by", escaped(limit));
    rows.emplace_back("State hash", "<code>" + escaped(run.outcome.value("state_hash", "?")) + "</code>");
  }
  std::string html = table_of(rows);

  html += "<h3>Shapes</h3>\n<table class=\"grid-table\"><thead><tr><th>shape</th><th>bodies</th><th>triangles</th><th>eq. diameter at scale 1</th>"
          "<th>mesh check</th></tr></thead><tbody>\n";
  for (std::size_t k = 0; k < scene.shapes.size(); ++k) {
    const Shape& shape = scene.shapes[k];
    std::string check = "not checked";
    if (shape.kind == ShapeKind::sphere) check = "analytic ball";
    else if (shape.kind == ShapeKind::surface) check = "wall surface";
    else if (shape.verdict.is_object() && shape.verdict.contains("solid")) check = shape.verdict.value("solid", false) ? "watertight, outward" : "not solid";
    html += fmt::format("<tr><td>{}</td><td class=\"n\">{}</td><td class=\"n\">{}</td><td class=\"n\">{}</td><td>{}</td></tr>\n", escaped(shape.name),
                        count[k], shape.mesh.triangle_count(), shape.kind == ShapeKind::surface ? "&ndash;" : length_text(shape.equivalent_diameter()), check);
  }
  html += "</tbody></table>\n";

  html += "<h3>Materials and contacts</h3>\n<table class=\"grid-table\"><thead><tr><th>between</th><th>stiffness</th><th>restitution</th><th>friction</th>"
          "</tr></thead><tbody>\n";
  for (const MaterialPair& p : scene.pairs) {
    html += fmt::format("<tr><td>{} &ndash; {}</td><td class=\"n\">{}</td><td class=\"n\">{:.4g}</td><td class=\"n\">{:.4g}</td></tr>\n",
                        escaped(scene.materials[static_cast<std::size_t>(p.a)].name), escaped(scene.materials[static_cast<std::size_t>(p.b)].name),
                        p.stiffness > 0 ? format_quantity(p.stiffness, Dimension::stiffness) : "by the materials", p.restitution, p.friction);
  }
  html += "</tbody></table>\n";
  if (!scene.walls.empty()) {
    html += "<h3>Walls</h3>\n<table class=\"grid-table\"><thead><tr><th>id</th><th>name</th><th>motion</th></tr></thead><tbody>\n";
    for (const Wall& wall : scene.walls) {
      html += fmt::format("<tr><td class=\"n\">{}</td><td>{}</td><td>{}</td></tr>\n", wall.id, escaped(wall.name.empty() ? "wall" : wall.name), motion_text(wall));
    }
    html += "</tbody></table>\n";
  }
  const std::string text = scene.provenance.is_object() ? scene.provenance.value("configuration", "") : "";
  if (!text.empty()) html += "<details><summary>The case file as it was read</summary><pre>" + escaped(text) + "</pre></details>\n";
  return html;
}

std::string picture_section(const Run& run, std::vector<std::string>& notes) {
  std::string obstacle = picture_obstacle();
  if (obstacle.empty()) {
    const std::string png = (std::filesystem::temp_directory_path() / fmt::format("scree-post-{}.png", getpid())).string();
    make_picture(run, run.frames.size() - 1, png, {});
    std::ifstream stream(png, std::ios::binary);
    const std::string bytes((std::istreambuf_iterator<char>(stream)), std::istreambuf_iterator<char>());
    std::remove(png.c_str());
    return fmt::format("<figure class=\"picture\"><img alt=\"The bodies at the last frame\" src=\"data:image/png;base64,{}\"/>"
                       "<figcaption>True shapes at t = {:.4g} s, coloured by shape. Walls are translucent and cut where they reach far above."
                       "</figcaption></figure>\n", base64(bytes), run.frames.back().time);
  }
  notes.push_back("the report has no picture: " + obstacle);
  return "<p class=\"missing\">No picture: " + escaped(obstacle) + "</p>\n";
}

std::vector<double> sum(const std::vector<double>& a, const std::vector<double>& b) {
  std::vector<double> c(a.size());
  for (std::size_t i = 0; i < a.size(); ++i) c[i] = a[i] + b[i];
  return c;
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
  energies.lines = {{"kinetic", t, kinetic}, {"potential above its lowest", t, potential}, {"elastic", t, elastic}, {"dissipated", t, log.column("dissipated")}};
  if (log.has("wall_work")) {
    const std::vector<double>& work = log.column("wall_work");
    if (std::any_of(work.begin(), work.end(), [](double w) { return w != 0; })) energies.lines.push_back({"wall work", t, work});
  }
  const double peak = *std::max_element(kinetic.begin(), kinetic.end());
  LineChart settling{"Kinetic energy", "time", "s", "energy", "J", true, false, {}, {}};
  settling.lines = {{"translation", t, log.column("kinetic_translational")}, {"rotation", t, log.column("kinetic_rotational")}};
  if (peak > 0) settling.limits = {{kRestKinetic * peak, "at rest: 1e-6 of the peak"}};

  const double scale = std::max(peak, log.column("dissipated").back());
  std::vector<double> error = log.column("energy_error");
  for (double& e : error) e = scale > 0 ? 100 * e / scale : 0;
  LineChart balance{"Error of the energy balance", "time", "s", "error [%]", "", false, false, {{"error", t, error}}, {}};
  return figure(svg_of(energies)) + figure(svg_of(settling)) + figure(svg_of(balance));
}

std::string contact_section(const Run& run) {
  std::string html;
  if (run.log.rows() >= 2) {
    const std::vector<double>& t = run.log.column("time");
    if (run.log.has("contacts")) {
      html += figure(svg_of(LineChart{"Contact points", "time", "s", "contact points", "", false, true, {{"contacts", t, run.log.column("contacts")}}, {}}));
    }
    if (run.scene.settings.margin > 0) {
      html += figure(svg_of(LineChart{"Largest depth over margin", "time", "s", "depth / margin", "", false, true,
                                      {{"depth / margin", t, run.log.column("max_depth_ratio")}}, {{1.0, "1: the surfaces would touch"}}}));
    }
  }
  if (!run.scene.settings.output_contacts) return html + "<p class=\"missing\">The frames hold no contacts: the case says contacts = false.</p>\n";

  ChartLine all{"all particles", {}, {}}, without{"without rattlers", {}, {}};
  ContactStatistics last;
  for (std::size_t f = 0; f < run.frames.size(); ++f) {
    last = contact_statistics(load_frame(run, f), run.boundary_ids);
    for (ChartLine* line : {&all, &without}) line->x.push_back(last.time);
    all.y.push_back(last.coordination);
    without.y.push_back(last.coordination_without_rattlers);
  }
  html += figure(svg_of(LineChart{"Coordination number", "time", "s", "neighbours per particle", "", false, true, {all, without}, {}}));

  if (last.contact_force.count > 1) {
    // distribution of the normal force over its mean, the usual way to compare packings
    constexpr int kColumns = 16;
    constexpr double kLargest = 4;  // times the mean; the tail goes into the last column
    BarChart histogram{"Normal forces at the last frame", "normal force over its mean (the last column holds all above)", {}, {}, {}, true, "contact points"};
    histogram.values.assign(kColumns, 0);
    for (double force : last.contact_forces) {
      const double place = force / last.contact_force.mean * kColumns / kLargest;
      histogram.values[static_cast<std::size_t>(std::clamp(place, 0.0, kColumns - 1.0))] += 1;
    }
    for (int i = 0; i <= kColumns; ++i) histogram.names.push_back(i % 4 == 0 ? fmt::format("{:g}", kLargest * i / kColumns) : "");
    html += figure(svg_of(histogram));
  }
  const Distribution& c = last.contact_force;
  const Distribution& p = last.pair_force;
  const auto force_text = [](double f) { return format_quantity(f, Dimension::force); };
  Rows rows{{"Time", fmt::format("{:.6g} s", last.time)},
            {"Particles", fmt::format("{}, of them {} rattlers (fewer than two neighbours)", last.particles, last.rattlers)},
            {"Pairs in contact", fmt::format("{} among particles, {} with walls", last.pairs_of_particles, last.pairs_with_walls)},
            {"Coordination number", fmt::format("{:.3f} neighbours per particle; {:.3f} without rattlers", last.coordination, last.coordination_without_rattlers)},
            {"Contact points", fmt::format("{}, {:.3f} per particle", last.contacts, last.contacts_per_particle)}};
  if (c.count > 0) {
    rows.emplace_back("Normal force per contact point", fmt::format("mean {}, median {}, 5 % to 95 %: {} to {}, largest {}", force_text(c.mean),
                                                                    force_text(c.median), force_text(c.q05), force_text(c.q95), force_text(c.largest)));
    rows.emplace_back("Force per pair", fmt::format("mean {}, median {}, largest {}", force_text(p.mean), force_text(p.median), force_text(p.largest)));
  }
  if (last.pairs_of_particles > 0) {
    std::string matrix = "<table class=\"matrix\">";
    for (int i = 0; i < 3; ++i) matrix += fmt::format("<tr><td>{:.4f}</td><td>{:.4f}</td><td>{:.4f}</td></tr>", last.fabric[i].x, last.fabric[i].y, last.fabric[i].z);
    rows.emplace_back("Fabric tensor", matrix + fmt::format("</table>principal {:.4f}, {:.4f}, {:.4f}; 0.3333 each when isotropic", last.fabric_principal.x,
                                                            last.fabric_principal.y, last.fabric_principal.z));
  }
  return html + "<h3>At the last frame</h3>\n" + table_of(rows);
}

std::string cost_section(const Run& run) {
  BarChart bars{"Time by phase (mean over ranks)", "", {}, {}, {}, false, ""};
  double total = 0;
  std::vector<std::pair<std::string, double>> phases;
  if (run.outcome.contains("phases") && run.outcome["phases"].is_object()) {
    for (const auto& [name, seconds] : run.outcome["phases"].items()) {
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
  std::string html = phases.empty() ? "" : figure(svg_of(bars));
  if (run.log.rows() >= 3 && run.log.has("steps_per_second")) {
    std::vector<double> t = run.log.column("time"), rate = run.log.column("steps_per_second");
    t.erase(t.begin());  // no step lies before the first row
    rate.erase(rate.begin());
    html += figure(svg_of(LineChart{"Speed", "time", "s", "steps per second of wall time", "", false, true, {{"speed", t, rate}}, {}}));
  }
  if (!run.is_finished()) return html;
  const nlohmann::json& o = run.outcome;
  const double wall = o.value("wall_seconds", 0.0), steps = o.value("steps", 0.0);
  Rows rows{{"Wall time", fmt::format("{} for {:.0f} steps", format_duration(wall), steps)},
            {"Ran on", fmt::format("{} ranks x {} threads", o.value("ranks", 1), o.value("threads", 1))}};
  if (wall > 0) rows.emplace_back("Rate", fmt::format("{:.3g} particle steps per second", static_cast<double>(run.scene.bodies.size()) * steps / wall));
  if (o.contains("mean_imbalance")) rows.emplace_back("Mean imbalance", fmt::format("{:.3f} (largest over mean work of the ranks)", o.value("mean_imbalance", 1.0)));
  if (o.contains("peak_rss_bytes")) rows.emplace_back("Peak memory, all ranks", fmt::format("{:.0f} MB", o.value("peak_rss_bytes", 0.0) / 1e6));
  return html + table_of(rows);
}

std::string provenance_section(const nlohmann::json& record) {
  if (!record.is_object()) return "<p class=\"missing\">No provenance record was found.</p>\n";
  std::string html = "<p>From the run down to the files it began with. Each hash is of the file as it was read.</p>\n<ol class=\"chain\">\n";
  for (const ChainEntry& e : chain_of(record)) {
    html += fmt::format("<li style=\"margin-left:{}em\"><strong>{}</strong>", 1.6 * e.depth, e.depth == 0 ? "this run" : escaped(e.file));
    if (!e.sha256.empty()) html += fmt::format("<br/><span class=\"hash\">sha256 {}</span>", escaped(e.sha256));
    if (!e.tool.empty()) {
      html += fmt::format("<br/>{} {} (git {}), {}", escaped(e.tool), escaped(e.version), escaped(e.git), escaped(e.utc));
      if (!e.command.empty()) html += "<br/><code>" + escaped(e.command) + "</code>";
    } else {
      html += "<br/>an input from outside";
    }
    html += "</li>\n";
  }
  return html + "</ol>\n";
}

std::string repeat_section(const Run& run, const nlohmann::json& record) {
  const std::vector<std::string> commands = commands_of(record);
  if (commands.empty()) return "<p class=\"missing\">The provenance holds no commands.</p>\n";
  std::string text;
  for (const std::string& command : commands) text += command + "\n";
  std::string html = "<pre>" + escaped(text) + "</pre>\n";
  if (run.is_finished()) {
    html += fmt::format("<p>Given in the folders where they were given first. The same program, ranks and threads end in the state hash "
                        "<code>{}</code>.</p>\n", escaped(run.outcome.value("state_hash", "?")));
  }
  return html;
}

}  // namespace

ReportResult write_report(const Run& run, const std::string& path) {
  ReportResult result;
  const std::vector<Verdict> verdicts = judge(run);
  for (const Verdict& v : verdicts) result.verdicts.push_back(fmt::format("{:<18} {:<32} {}", v.question, v.answer, name_of(v.judgement)));
  const nlohmann::json record = run.outcome.contains("provenance") ? run.outcome["provenance"] : load_frame(run, 0).provenance;

  const std::string title = run.scene.settings.title.empty() ? run.name : run.scene.settings.title;
  std::string html = fmt::format("<!doctype html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\"/>\n<meta name=\"viewport\" "
                                 "content=\"width=device-width, initial-scale=1\"/>\n<title>{}</title>\n<style>\n{}</style>\n</head>\n<body>\n<main>\n",
                                 escaped(title + " - Scree"), kReportStyle);
  html += fmt::format("<header><p class=\"kicker\">Scree run <code>{}</code></p><h1>{}</h1><p class=\"lead\">{} bodies, {} frames, {:.4g} s simulated. "
                      "Report of {} by scree-post {}.</p></header>\n", escaped(run.name), escaped(title), run.scene.bodies.size(), run.frames.size(),
                      run.frames.back().time, utc_now(), kVersion);
  html += "<nav><a href=\"#verdicts\">Verdicts</a><a href=\"#picture\">Picture</a><a href=\"#case\">Case</a><a href=\"#energies\">Energies</a>"
          "<a href=\"#contacts\">Contacts</a><a href=\"#cost\">Cost</a><a href=\"#provenance\">Provenance</a><a href=\"#repeat\">Repeat</a></nav>\n";
  html += section("verdicts", "Can it be trusted?", verdict_section(verdicts));
  html += section("picture", "Picture", picture_section(run, result.notes));
  html += section("case", "What was run", case_section(run));
  html += section("energies", "Energies", energy_section(run));
  html += section("contacts", "Contacts", contact_section(run));
  html += section("cost", "Cost", cost_section(run));
  html += section("provenance", "Where it comes from", provenance_section(record));
  html += section("repeat", "To run it again", repeat_section(run, record));
  html += "</main>\n</body>\n</html>\n";
  h5::write_text_file(path, html);
  return result;
}

}  // namespace scree
