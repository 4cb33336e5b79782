#include "decomposer/commands.hpp"

#include <algorithm>
#include <filesystem>
#include <iterator>
#include <nlohmann/json.hpp>
#include <numbers>
#include <set>

#include "core/base/command_line.hpp"
#include "core/base/counted.hpp"
#include "core/base/error.hpp"
#include "core/base/expect_ending.hpp"
#include "core/base/long_work.hpp"
#include "core/base/units.hpp"
#include "core/distance/triangle_distance.hpp"
#include "core/storage/frame_check.hpp"
#include "core/storage/h5.hpp"
#include "core/storage/plasticity.hpp"
#include "decomposer/cut/compare_cuts.hpp"
#include "decomposer/cut/predicted_work.hpp"
#include "decomposer/packing/build_scene.hpp"
#include "decomposer/packing/case_warnings.hpp"
#include "decomposer/packing/shape_files.hpp"
#include "decomposer/preview.hpp"
#include "decomposer/sizes_report.hpp"
#include "decomposer/tile_scene.hpp"

namespace scree {

namespace {

/// Found out before the work, not after it.
void check_folder(const std::string& path) {
  const std::filesystem::path folder = std::filesystem::path(path).parent_path();
  std::error_code unknown;  // then the file cannot be written, which says why
  if (!folder.empty() && !std::filesystem::is_directory(folder, unknown)) {
    throw SystemError("-o {}: there is no folder {}; make it first", path, folder.string());
  }
  if (std::filesystem::is_directory(path, unknown)) throw UsageError("-o {}: is a folder, expected a file name such as box.scene.h5", path);
}

void check_output(const std::string& path) {
  check_folder(path);
  expect_ending("-o", path, "a scene", {".scene.h5"});
}

nlohmann::json record(bool has_start, const std::vector<std::string>& command, const std::string& configuration,
                      const std::vector<InputRecord>& inputs, std::uint64_t seed) {
  Provenance p;
  p.format = kSceneFormat;
  p.format_version = has_start ? kSceneFormatVersionWithStart : kSceneFormatVersion;
  p.tool = "scree-decomposer";
  p.command = command;
  p.configuration = configuration;
  p.inputs = inputs;
  p.seed = seed;
  p.instruction_set = simd_target();
  return provenance_record(p);
}

std::string partition_line(const Scene& scene) {
  if (scene.partition.ranks == 0) return "ranks              not divided: there are no bodies yet\n";
  return fmt::format("ranks              {}, predicted imbalance {:.3f} (largest over mean work)\n", scene.partition.ranks,
                     scene.partition.predicted_imbalance);
}

std::string start_line(const Scene& scene, const StartState& start) {
  const std::string springs = start.q_principal.empty() ? "a frame holds no springs: all contacts start without"
                                                        : fmt::format("{} contacts keep their springs{}", start.pair_count(),
                                                                      start.left > 0 ? fmt::format(", {} do not", start.left) : "");
  return fmt::format("start              {} bodies of {}{}, {} at {}; {}\n", start.bodies, start.run,
                     start.left_out > 0 ? fmt::format(" ({} left out)", start.left_out) : "", start.file,
                     format_quantity(start.time, Dimension::time),
                     springs + ((start.q_principal.empty() || start.left > 0) && std::any_of(scene.pairs.begin(), scene.pairs.end(), yields)
                                    ? "; plastic contacts start pressed for the first time, which pushes those apart that were unloaded"
                                    : ""));
}

double solid_volume(const Scene& scene) {
  double volume = 0;
  for (std::size_t i = 0; i < scene.bodies.size(); ++i) {
    const double s = scene.bodies.scale[i];
    volume += scene.shapes[static_cast<std::size_t>(scene.bodies.shape[i])].mass.volume * s * s * s;
  }
  return volume;
}

std::string solid_fraction_line(double volume, double container) {
  if (!(container > 0)) return "";
  return fmt::format("solid fraction     {:.4f} ({:.4g} of {:.4g} m^3 inside the walls)\n", volume / container, volume, container);
}

/// Skin of the body lists [m], from its share of the smallest radius.
double skin_of(const Scene& scene, double share) {
  const std::vector<double> radius = bounding_radii(scene);
  return share * *std::min_element(radius.begin(), radius.end());
}

/// The parts as a picture for ParaView, and what as many parts and other numbers of them would cost.
/// Where touch is not where it was drawn: edges and corners are rounded, and what is thin is larger.
std::string roundings_text(const PackingReport& report) {
  std::string text;
  for (const PackingReport::Rounding& r : report.roundings) {
    text += fmt::format(
        "touch              '{}': off the drawn surface by {:.3f} of its margin on average, {:.2f} at most ({:.2g} and {:.2g} % of the "
        "radius)\n",
        r.shape, r.mean / r.margin, r.largest / r.margin, 100 * r.mean / r.radius, 100 * r.largest / r.radius);
  }
  return text;
}

/// What facets of a curved surface do to balls.
std::string facets_text(const PackingReport& report) {
  std::string text;
  for (const Facets& f : report.facets) {
    text += fmt::format(
        "facets             wall '{}': {} concave edges of up to {:.3g} degrees; a ball on two facets is up to {:.2g} % stiffer than on "
        "one\n",
        f.wall, f.edges, f.angle * 180 / std::numbers::pi, 100 * f.stiffer);
  }
  return text;
}

std::string write_preview(const std::string& name, const Scene& scene, const std::vector<double>& work) {
  if (scene.bodies.size() == 0) throw InputError("--preview: the scene holds no bodies to cut");
  h5::write_text_file(name + ".vtp", preview_file(scene, work));
  std::vector<CutMeasures> cuts;
  LongWork progress("preview", 0);
  for (const int parts : preview_ranks(scene.partition.ranks, scene.bodies.size())) {
    progress.update(0, fmt::format("cut into {} parts", parts));
    cuts.push_back(measure_cut(scene, work, cut_method_of(scene.partition.method), parts, skin_of(scene, kDefaultSkin)));
  }
  h5::write_text_file(name + ".csv", cut_table(cuts));
  std::string text = fmt::format("preview            {}.vtp (open it in ParaView, colour by part), {}.csv\n", name, name);
  text += "  ranks  imbalance  bodies at most  ghosts at most  sent at most a step\n";
  for (const CutMeasures& m : cuts) {
    text += fmt::format("  {:>5}  {:>9.3f}  {:>14.0f}  {:>14.0f}  {:>16.0f} B\n", m.parts, m.imbalance, m.bodies_max, m.ghosts_max,
                        m.bytes_max);
  }
  return text;
}

/// The margin, and what the fastest impact does to it, or to balls, which have none.
std::string margin_line(const Settings& settings, const PackingReport& report) {
  const std::string speed = format_quantity(report.fastest_impact, Dimension::velocity);
  if (!(settings.margin > 0) && !(settings.margin_ratio > 0)) {
    const std::string overlap =
        report.impact_overlap > 0 ? fmt::format(", an overlap of about {}", format_quantity(report.impact_overlap, Dimension::length)) : "";
    return fmt::format("margin             none: these bodies touch as drawn; fastest impact expected {}{}\n", speed, overlap);
  }
  const std::string ratio = settings.margin_ratio > 0 ? fmt::format(", {:.3g} % of a body's radius", 100 * settings.margin_ratio) : "";
  return fmt::format("margin             {}{} ({}); fastest impact expected {}, which would use up {:.2f} of the margins\n",
                     format_quantity(settings.margin, Dimension::length), ratio, report.margin_from, speed, report.overlap_share);
}

}  // namespace

CommandResult check_command(const std::string& case_path, const std::vector<std::string>& changes) {
  const Case c = read_case(case_path, changes);
  double count = 0;
  bool by_count = true;
  for (const CasePopulation& p : c.populations) {
    by_count = by_count && p.amount == CasePopulation::Amount::count;
    count += p.value;
  }
  CommandResult result;
  result.warnings = warnings_of_case(c);
  result.output = fmt::format("{}: correct; {} materials, {} pairs that can meet, {} shapes, {} bodies, {} populations{}, {} walls\n",
                              case_path, c.materials.size(), c.pairs.size(), c.shapes.size(), c.bodies.size(), c.populations.size(),
                              by_count && count > 0 ? fmt::format(" ({:.0f} particles)", count) : "", c.walls.size());
  if (const std::vector<std::string> missing = check_shape_files(c); !missing.empty())
    result.output += fmt::format("not there yet: {}\n", fmt::join(missing, ", "));
  return result;
}

CommandResult pack_command(const PackOptions& options, const std::vector<std::string>& command) {
  check_output(options.output);
  const Case c = read_case(options.case_path, options.changes);
  if (!options.sizes.empty()) check_folder(options.sizes);
  if (!options.preview.empty()) check_folder(options.preview);
  PackedScene packed = build_scene(c, options.solver);
  Scene& scene = packed.scene;
  const PackingReport& report = packed.report;
  const PredictedWork work = options.ranks > 0 ? predicted_work(scene) : PredictedWork{};
  if (options.ranks > 0) partition_scene(scene, work, options.ranks, options.cut);
  scene.provenance = record(packed.start.has_value(), command, c.text, packed.inputs, c.settings.seed);
  write_scene_file(options.output, scene, packed.start);

  CommandResult result;
  result.notices = report.notices;
  result.warnings = report.case_warnings;
  const std::set<std::int32_t> shapes(scene.bodies.shape.begin(), scene.bodies.shape.end());  // walls have shapes as well
  result.output =
      fmt::format("{}: {} of {}, {}, {} draws\n", options.output, counted(std::ssize(scene.bodies), "body", "bodies"),
                  counted(std::ssize(shapes), "shape", "shapes"), counted(std::ssize(scene.walls), "wall", "walls"), report.attempts);
  for (std::size_t k = 0; k < report.solid_fraction.size(); ++k) {
    const auto count = std::count(scene.bodies.population.begin(), scene.bodies.population.end(), static_cast<std::int32_t>(k));
    const auto whole = k < report.diameters.size() ? std::ssize(report.diameters[k]) : 0;
    result.output += fmt::format("population {:<7} {}, solid fraction {:.4f} of its region\n", k,
                                 count == whole ? fmt::format("{} bodies", count) : fmt::format("{} bodies in {} pieces", whole, count),
                                 report.solid_fraction[k]);
  }
  if (packed.start) result.output += start_line(scene, *packed.start);
  result.output += solid_fraction_line(report.particle_volume, report.container_volume);
  result.output += margin_line(scene.settings, report);
  result.output += roundings_text(report);
  result.output += facets_text(report);
  result.output += sizes_text(c, report);
  if (!options.sizes.empty()) {
    h5::write_text_file(options.sizes + ".csv", sizes_table(c, report));
    h5::write_text_file(options.sizes + ".svg", sizes_chart(c, report));
    result.output += fmt::format("sizes              {}.csv, {}.svg\n", options.sizes, options.sizes);
  }
  if (options.ranks > 0) result.output += partition_line(scene);
  if (!options.preview.empty()) result.output += write_preview(options.preview, scene, work.of_body);
  return result;
}

CommandResult partition_command(const PartitionOptions& options, const std::vector<std::string>& command) {
  check_output(options.output);
  if (!options.preview.empty()) check_folder(options.preview);
  Scene scene = read_scene_file(options.scene_path);
  const std::optional<StartState> start = read_start_state(options.scene_path, scene.bodies.size());
  const PredictedWork work = predicted_work(scene);
  partition_scene(scene, work, options.ranks, options.cut);
  // the configuration stays that of the case: it is what the scene is made from
  const std::string configuration = scene.provenance->value("configuration", std::string{});
  scene.provenance = record(start.has_value(), command, configuration,
                            {{options.scene_path, sha256_of_file(options.scene_path), scene.provenance}}, scene.settings.seed);
  write_scene_file(options.output, scene, start);
  CommandResult result;
  result.output = fmt::format("{}: {} bodies\n", options.output, scene.bodies.size());
  result.output += solid_fraction_line(solid_volume(scene), container_volume(scene));
  result.output += partition_line(scene);
  if (!options.preview.empty()) result.output += write_preview(options.preview, scene, work.of_body);
  return result;
}

CommandResult compare_command(const CompareOptions& options) {
  const Scene scene = read_scene_file(options.scene_path);
  if (scene.bodies.size() == 0) throw InputError("{}: holds no bodies to cut", options.scene_path);
  const double skin = skin_of(scene, options.skin);
  const std::vector<double> work = predicted_work(scene).of_body;
  std::vector<CutMeasures> cuts;
  LongWork progress("comparison", static_cast<double>(options.cuts.size() * options.parts.size()));
  for (const std::string& name : options.cuts) {
    for (const int parts : options.parts) {
      progress.update(static_cast<double>(cuts.size()), fmt::format("{} into {} parts", name, parts));
      cuts.push_back(measure_cut(scene, work, cut_method_of(name), parts, skin));
    }
  }
  CommandResult result;
  result.output = cut_table(cuts);
  return result;
}

CommandResult tile_command(const TileOptions& options, const std::vector<std::string>& command) {
  check_output(options.output);
  const Scene scene = read_scene_file(options.scene_path);
  std::vector<InputRecord> inputs{{options.scene_path, sha256_of_file(options.scene_path), scene.provenance}};
  FrameBodies now;
  if (!options.frame_path.empty()) {
    Frame frame = read_frame_file(options.frame_path);
    check_frame(scene, frame, options.frame_path);
    inputs.push_back({options.frame_path, sha256_of_file(options.frame_path), frame.provenance});
    now = std::move(frame.bodies);
  }
  Scene tiled = tile_scene(scene, now, options.copies);
  if (options.duration >= 0) tiled.settings.duration = options.duration;
  tiled.provenance = record(false, command, scene.provenance->value("configuration", std::string{}), inputs, scene.settings.seed);
  write_scene_file(options.output, tiled);
  CommandResult result;
  result.output = fmt::format("{}: {} bodies, {} x {} x {} copies of {}\n", options.output, tiled.bodies.size(), options.copies[0],
                              options.copies[1], options.copies[2], scene.bodies.size());
  result.output += solid_fraction_line(solid_volume(tiled), container_volume(tiled));
  return result;
}

}  // namespace scree
