#include "post/report/case_sections.hpp"

#include <algorithm>
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>

#include "core/base/progress.hpp"
#include "core/base/provenance.hpp"
#include "core/base/units.hpp"
#include "core/base/version.hpp"
#include "core/storage/scene_keys.hpp"
#include "core/storage/start_state.hpp"
#include "post/report/html.hpp"

namespace scree {

namespace {

/// The keys of a pair of materials with their values, as a case gives them.
class KeyTexts : public KeyVisitor {
 public:
  std::vector<std::pair<std::string, std::string>> texts;

  void number(const Key& key, double& value, Dimension dimension, Range /*range*/) override {
    texts.emplace_back(key.name, dimension == Dimension::none ? fmt::format("{:.4g}", value) : format_quantity(value, dimension));
  }
  void count(const Key& key, std::uint64_t& value) override { texts.emplace_back(key.name, fmt::format("{}", value)); }
  void boolean(const Key& key, bool& value) override { texts.emplace_back(key.name, value ? "true" : "false"); }
  void text(const Key& key, std::string& value) override { texts.emplace_back(key.name, value); }
  void vector(const Key& /*key*/, Vec3& /*value*/, Dimension /*dimension*/) override {}
  void direction(const Key& /*key*/, Vec3& /*value*/) override {}
  void velocity(const Key& /*key*/, double& /*speed*/, Vec3& /*direction*/) override {}
  void numbers(const Key& /*key*/, std::vector<double>& /*values*/, Dimension /*dimension*/) override {}
  void vectors(const Key& /*key*/, std::vector<Vec3>& /*values*/, Dimension /*dimension*/) override {}
  void axes(const Key& /*key*/, std::array<bool, 3>& /*value*/) override {}

 protected:
  void choose(const Key& key, std::size_t& index, const std::vector<std::string>& words) override {
    texts.emplace_back(key.name, words[index]);
  }
};

/// "rolling_friction 0.1, plasticity 0.5": keys of a pair that are not those of a new one, without stiffness, restitution and friction,
/// which have columns.
std::string other_keys(MaterialPair pair, const Settings& settings) {
  KeyTexts of_pair, of_default;
  MaterialPair fresh;
  if (pair.friction_sliding == pair.friction) pair.friction_sliding = fresh.friction_sliding;
  pair_keys(of_pair, pair, settings);
  pair_keys(of_default, fresh, settings);
  std::string text;
  for (const auto& entry : of_pair.texts) {
    const std::string& name = entry.first;
    if (name == "stiffness" || name == "modulus" || name == "restitution" || name == "friction") continue;
    if (std::find(of_default.texts.begin(), of_default.texts.end(), entry) != of_default.texts.end()) continue;
    text += fmt::format("{}{} {}", text.empty() ? "" : ", ", name, entry.second);
  }
  return text;
}

}  // namespace

std::string verdict_section(const std::vector<Verdict>& verdicts) {
  static const std::map<Judgement, std::pair<const char*, const char*>> kSigns{{Judgement::good, {"good", "&#10003;"}},
                                                                               {Judgement::doubtful, {"doubtful", "!"}},
                                                                               {Judgement::bad, {"bad", "&#10007;"}},
                                                                               {Judgement::information, {"information", "i"}}};
  std::string html = "<div class=\"verdicts\">\n";
  for (const Verdict& v : verdicts) {
    const auto& [style, sign] = kSigns.at(v.judgement);
    html += fmt::format(
        "<div class=\"verdict {}\"><div class=\"sign\" aria-hidden=\"true\">{}</div><div><h3>{}</h3><p class=\"answer\">{}"
        " <span class=\"word\">{}</span></p><p class=\"evidence\">{}</p></div></div>\n",
        style, sign, escaped(v.question), escaped(v.answer), name_of(v.judgement), escaped(v.evidence));
  }
  return html + "</div>\n";
}

namespace {

/// Functions and held forces of the program that stepped a run, and their work.
std::string program_forces(const Run& run) {
  const nlohmann::json known = run.outcome->value("program", nlohmann::json::object());
  std::string text;
  if (!known.empty()) {
    const nlohmann::json names = known.value("force_functions", nlohmann::json::array());
    std::string list;
    for (const nlohmann::json& name : names) list += (list.empty() ? ": " : ", ") + (name.is_string() ? name.get<std::string>() : "?");
    text = fmt::format("at the end {} function{} within the step{}, and held forces on {:.0f} bodies; ", names.size(),
                       names.size() == 1 ? "" : "s", list, known.value("held_bodies", 0.0));
  }
  const std::vector<double>& work = run.log.column("outer_work");
  return escaped(text + "work since the start " + format_quantity(work.empty() ? 0.0 : work.back(), Dimension::energy));
}

}  // namespace

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
  FactRows rows{{"Title", escaped(s.title)},
                {"Bodies", fmt::format("{} ({:.4g} kg, {:.4g} m&sup3; of solid)", scene.bodies.size(), mass, volume)}};
  if (scene.bodies.size() > 0)
    rows.emplace_back("Equivalent diameter", fmt::format("{} to {}", length_text(smallest), length_text(largest)));
  if (const std::optional<StartState> start = read_start_state(run.folder + "/scene.h5", scene.bodies.size()))
    rows.emplace_back("Started from",
                      fmt::format("{} of {} at {}: {} bodies, {} contacts with their springs", escaped(start->file), escaped(start->run),
                                  format_quantity(start->time, Dimension::time), start->bodies, start->pair_count()));
  for (std::size_t k = 0; k < scene.inlets.size(); ++k) {
    const Inlet& inlet = scene.inlets[k];
    const nlohmann::json at_end = run.outcome->contains("inlets") ? (*run.outcome)["inlets"][k] : nlohmann::json::object();
    std::string text = inlet.rate.by_number ? fmt::format("up to {:.4g} bodies/s", inlet.rate.largest())
                                            : fmt::format("up to {:.4g} kg/s", inlet.rate.largest());
    if (!at_end.empty()) {
      text += fmt::format("; {:.0f} bodies, {:.4g} kg came in", at_end.value("bodies", 0.0), at_end.value("mass", 0.0));
      if (const double missing = at_end.value("shortfall", 0.0); missing > 0)
        text += fmt::format("; {:.4g} {} found no room", missing, inlet.rate.by_number ? "bodies" : "kg");
    }
    rows.emplace_back(escaped("Inlet " + inlet.name), text);
  }
  for (std::size_t k = 0; k < scene.outlets.size(); ++k) {
    const nlohmann::json at_end = run.outcome->contains("outlets") ? (*run.outcome)["outlets"][k] : nlohmann::json::object();
    const std::int32_t to = scene.outlets[k].to;
    std::string text = at_end.empty()
                           ? "takes bodies out"
                           : fmt::format("{:.0f} bodies, {:.4g} kg went out", at_end.value("bodies", 0.0), at_end.value("mass", 0.0));
    if (to >= 0) text += "; they come in again through " + escaped(scene.inlets[static_cast<std::size_t>(to)].name);
    rows.emplace_back(escaped("Outlet " + scene.outlets[k].name), text);
  }
  if (run.has_program()) rows.emplace_back("Forces of the program", program_forces(run));
  rows.emplace_back("Gravity", fmt::format("({:.4g}, {:.4g}, {:.4g}) m/s&sup2;", s.gravity.x, s.gravity.y, s.gravity.z));
  rows.emplace_back("Duration", fmt::format("{}, a frame every {}", format_quantity(s.duration, Dimension::time),
                                            s.output_every > 0 ? format_quantity(s.output_every, Dimension::time) : "hundredth of it"));
  rows.emplace_back("Contact", fmt::format("law {}, gathered as {}, margin {}", word_of(s.law), word_of(s.gather), length_text(s.margin)));
  rows.emplace_back("Motion", fmt::format("{}{}", word_of(s.integrator),
                                          run.outcome->contains("step_size")
                                              ? ", step " + format_quantity((*run.outcome)["step_size"].get<double>(), Dimension::time)
                                              : std::string()));
  if (run.is_finished()) {
    if (const std::string limit = run.outcome->value("step_limited_by", ""); !limit.empty())
      rows.emplace_back("Step limited by", escaped(limit));
    rows.emplace_back("State hash", "<code>" + escaped(run.outcome->value("state_hash", "?")) + "</code>");
  }
  std::string html = table_of(rows);

  html +=
      "<h3>Shapes</h3>\n<table class=\"grid-table\"><thead><tr><th>shape</th><th>bodies</th><th>triangles</th><th>eq. diameter at scale "
      "1</th>"
      "<th>mesh check</th></tr></thead><tbody>\n";
  for (std::size_t k = 0; k < scene.shapes.size(); ++k) {
    const Shape& shape = scene.shapes[k];
    std::string check = "not checked";
    if (shape.kind == ShapeKind::sphere)
      check = "analytic ball";
    else if (shape.kind == ShapeKind::surface)
      check = "wall surface";
    else if (shape.verdict->is_object() && shape.verdict->contains("solid"))
      check = shape.verdict->value("solid", false) ? "watertight, outward" : "not solid";
    if (const std::int64_t pairs = crossing_pairs(shape); pairs > 0 && shape.kind == ShapeKind::solid)
      check += fmt::format("; {} of triangles {} through or touch each other", pairs == 1 ? "1 pair" : fmt::format("{} pairs", pairs),
                           pairs == 1 ? "passes" : "pass");
    html += fmt::format("<tr><td>{}</td><td class=\"n\">{}</td><td class=\"n\">{}</td><td class=\"n\">{}</td><td>{}</td></tr>\n",
                        escaped(shape.name), count[k], shape.mesh.triangle_count(),
                        shape.kind == ShapeKind::surface ? "&ndash;" : length_text(shape.equivalent_diameter()), check);
  }
  html += "</tbody></table>\n";

  html +=
      "<h3>Materials and contacts</h3>\n<table "
      "class=\"grid-table\"><thead><tr><th>between</th><th>stiffness</th><th>restitution</th><th>friction</th>"
      "<th>further</th></tr></thead><tbody>\n";
  for (const MaterialPair& p : scene.pairs) {
    html += fmt::format(
        "<tr><td>{} &ndash; {}</td><td class=\"n\">{}</td><td class=\"n\">{:.4g}</td><td class=\"n\">{:.4g}</td><td>{}</td></tr>\n",
        escaped(scene.materials[static_cast<std::size_t>(p.a)].name), escaped(scene.materials[static_cast<std::size_t>(p.b)].name),
        p.modulus > 0     ? format_quantity(p.modulus, Dimension::pressure) + " by size"
        : p.stiffness > 0 ? format_quantity(p.stiffness, Dimension::stiffness)
                          : "by the materials",
        p.restitution, p.friction, escaped(other_keys(p, scene.settings)));
  }
  html += "</tbody></table>\n";
  if (!scene.walls.empty()) {
    html += "<h3>Walls</h3>\n<table class=\"grid-table\"><thead><tr><th>id</th><th>name</th><th>motion</th></tr></thead><tbody>\n";
    for (const Wall& wall : scene.walls) {
      html +=
          fmt::format("<tr><td class=\"n\">{}</td><td>{}</td><td>{}</td></tr>\n", wall.id, escaped(wall.name.empty() ? "wall" : wall.name),
                      wall.surface.is_given() ? wall.motion.text() + ", " + wall.surface.text() : wall.motion.text());
    }
    html += "</tbody></table>\n";
  }
  const std::string text = scene.provenance->is_object() ? scene.provenance->value("configuration", "") : "";
  if (!text.empty()) html += "<details><summary>The case file as it was read</summary><pre>" + escaped(text) + "</pre></details>\n";
  return html;
}

std::string provenance_section(const nlohmann::json& record, const std::vector<ChainFile>& files) {
  if (!record.is_object()) return "<p class=\"missing\">No provenance record was found.</p>\n";
  std::string html =
      "<p>From the run down to the files it began with. Each hash is of the file as it was read.</p>\n<ol class=\"chain\">\n";
  for (const ChainEntry& e : chain_of(record)) {
    html += fmt::format("<li style=\"margin-left:{}em\"><strong>{}</strong>", 1.6 * e.depth, e.depth == 0 ? "this run" : escaped(e.file));
    if (!e.sha256.empty()) html += fmt::format("<br/><span class=\"hash\">sha256 {}</span>", escaped(e.sha256));
    for (const ChainFile& file : files) {
      if (e.depth == 0 || file.file != e.file || file.sha256 != e.sha256) continue;
      html += file.state == ChainFile::State::same
                  ? " <span class=\"state\">&#10003; there, unchanged</span>"
                  : (file.state == ChainFile::State::changed ? " <span class=\"state spoilt\">&#10007; there, but changed</span>"
                                                             : " <span class=\"state lost\">not found</span>");
    }
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
  const bool by_program = has_program(record);
  if (commands.empty() && !by_program) return "<p class=\"missing\">The provenance holds no commands.</p>\n";
  std::string html, text;
  if (by_program)
    html = fmt::format(
        "<p>A program stepped {} with the engine (<code>scree.Engine</code>, <code>scree_engine.h</code>). The forces, motions of walls "
        "and "
        "bodies that it gave are in no file of the run: to run it again, run that program again. The commands below make the files around "
        "it.</p>\n",
        run.has_program() ? "this run" : "a run that this one starts from");
  for (const std::string& command : commands) text += command + "\n";
  if (!commands.empty()) html += "<pre>" + escaped(text) + "</pre>\n<p>Given in the folders where they were given first.</p>\n";
  if (run.is_finished())
    html += fmt::format("<p>{} in the state hash <code>{}</code>.</p>\n",
                        by_program ? "The same version of Scree, with the same calls of that program at the same steps, ends"
                                   : "The same program, ranks and threads end",
                        escaped(run.outcome->value("state_hash", "?")));
  return html;
}

}  // namespace scree
