#include <memory>
#include <set>

#include "core/base/command_line.hpp"
#include "core/base/error.hpp"
#include "core/storage/h5.hpp"
#include "post/commands/commands.hpp"
#include "post/run/apparatus.hpp"
#include "post/run/choice.hpp"
#include "post/run/impacts.hpp"
#include "post/run/wall_loads.hpp"
#include "post/statistics/statistics.hpp"
#include "post/studies/chart_files.hpp"

namespace scree {

namespace {

/// Two tables, or two groups, of one name would be written into one place.
void refuse_twice(const char* option, const std::string& text, const std::string& name, std::set<std::string>& names) {
  if (!names.insert(name).second)
    throw UsageError("{} {}: '{}' is given twice; its numbers would be written over the others", option, text, name);
}

}  // namespace

void MeasureOptions::add_to(CLI::App& command) {
  CLI::Option* named = command
                           .add_option("--apparatus", apparatus,
                                       "Shape or material whose bodies count as walls: a lid, a stamp; repeat for more (default: bodies of "
                                       "[[bodies]] five times as large as those of the populations)")
                           ->take_all();
  command.add_flag("--count-all", count_all, "Count every body that is free to move as a particle, lids too")->excludes(named);
  command
      .add_option("--without", without,
                  "Leave bodies or walls out with all their contacts: a shape, a material, the name of a wall, or an id; repeat for more")
      ->take_all();
  command.add_option("--within", within, kWithinHelp);
  command
      .add_option("--mixing", mixing,
                  "Kinds of the mixing index: material, shape, population, size (above the median or not), half-x, half-y, half-z, none "
                  "(default: material, else halves along gravity)")
      ->check(CLI::IsMember({"auto", "material", "shape", "population", "size", "half-x", "half-y", "half-z", "none"}));
  command.add_option("--repose", repose, "Angle of the free surface: cone (a heap), slope (a drum, a slide), none (default)")
      ->check(CLI::IsMember({"cone", "slope", "none"}));
  command.add_option("--discharge", discharge,
                     "Count the mass that has passed below a height: z=0.1 (default: what was removed at the sides of the domain)");
}

std::string MeasureOptions::apply(Run& run, StatisticsOptions& options) const {
  options.without = ids_left_out(run, without);
  options.mixing = mixing;
  options.repose = repose;
  options.discharge = discharge;
  options.within = within;
  return count_all ? "" : set_apparatus_apart(run, apparatus);
}

Command add_statistics(CLI::App& app) {
  struct Options {
    RunOptions run;
    StatisticsOptions statistics;
    std::string output, container;
    MeasureOptions measures;
    std::vector<std::string> regions;
    double from = -1e308, to = 1e308;
    bool no_charts = false;
  };
  const auto o = std::make_shared<Options>();
  CLI::App* command = app.add_subcommand(
      "statistics", "Contacts, stress, packing, motion, walls and energy: means with confidence intervals, tables, charts");
  StatisticsOptions& s = o->statistics;
  o->run.add_to(*command, "Frames: all, last, 7, 0,5,-1, 10:50, ::5 (first:last:step; default all)");
  command->add_option("-o,--output", o->output, "Folder for CSV, JSON, SVG and PNG")->required();
  add_quantity(*command, "--from", o->from, Dimension::time, "Only frames from this time on: 2, \"500 ms\"");
  add_quantity(*command, "--to", o->to, Dimension::time, "Only frames up to this time");
  command
      ->add_option("--region", o->regions,
                   "A group of its own: [NAME=]box:x0,y0,z0,x1,y1,z1 or cylinder:x0,y0,z0,x1,y1,z1,r or sphere:x,y,z,r; repeat for more")
      ->take_all();
  command->add_flag("--by-material", s.by_material, "A group for each material");
  command->add_flag("--by-shape", s.by_shape, "A group for each shape");
  command
      ->add_option("--profile", s.profiles, "Axis and number of layers: z:20, x:10, r:8 (rings); repeat for more (default: along gravity)")
      ->take_all();
  command->add_option("--container", o->container,
                      "Box or cylinder the bodies are in, as a region (default: the wall or the periodic sides)");
  command->add_option("--blocks", s.blocks, "Blocks of frames that the confidence intervals are made from (default 10)")
      ->check(CLI::Range(2, 1000));
  o->measures.add_to(*command);
  command->add_flag("--no-charts", o->no_charts, "Tables and JSON only");
  return {command, [o] {
            CommandResult result;
            Run run = o->run.open(result.notices);
            const std::string apart = o->measures.apply(run, o->statistics);
            if (!apart.empty())
              result.notices.push_back(fmt::format("note: {}{}", apart, o->measures.apparatus.empty() ? "; --count-all counts them" : ""));
            StatisticsOptions& options = o->statistics;
            std::set<std::string> regions, axes;
            for (const std::size_t f : choose_frames(run, o->run.frames)) {
              if (run.frames[f].time >= o->from && run.frames[f].time <= o->to) options.frames.push_back(f);
            }
            if (options.frames.empty()) {
              std::string given;
              if (o->from > -1e308) given += fmt::format("--from {} ", o->from);
              if (o->to < 1e308) given += fmt::format("--to {} ", o->to);
              throw UsageError("{}: no frame between; {} has frames from {} s to {} s",
                               given.empty() ? "--frames" : given.substr(0, given.size() - 1), run.folder, run.frames.front().time,
                               run.frames.back().time);
            }
            for (const std::string& text : o->regions) {
              options.regions.push_back(parse_region(text));
              refuse_twice("--region", text, options.regions.back().name, regions);
            }
            for (const std::string& text : options.profiles) refuse_twice("--profile", text, text.substr(0, text.find(':')), axes);
            if (!o->container.empty()) {
              options.container = parse_region(o->container);
              if (options.container->kind == Region::Kind::sphere)
                throw UsageError("--container {}: a sphere has no layers; give a box or a cylinder", o->container);
            }
            options.pool = {o->run.jobs, o->run.skip_damaged};
            const Statistics statistics = run_statistics(run, options, o->output);
            std::vector<std::string> files = write_statistics(run, statistics, o->output);
            for (const LoadTable& table : load_tables(run, options.frames)) {
              h5::write_text_file(o->output + "/" + table.name, table.text);
              files.push_back(table.name);
            }
            for (const LoadTable& table : impact_tables(run, options.frames)) {
              h5::write_text_file(o->output + "/" + table.name, table.text);
              files.push_back(table.name);
            }
            if (!o->no_charts) {
              if (const std::string reason = png_obstacle(); !reason.empty()) result.notices.push_back("note: " + reason);
              for (const NamedChart& chart : charts_of(statistics)) {
                for (const std::string& name : write_chart(o->output, chart.name, chart.chart)) files.push_back(name);
              }
              if (has_impacts(run.scene)) {
                const Frame first = options.frames.size() > 1 ? load_frame(run, options.frames.front()) : Frame{};
                const Frame last = load_frame(run, options.frames.back());
                const LineChart chart = impact_chart(impacts_between(run.scene, first, last), last.time - first.time);
                if (!chart.lines.empty()) {
                  for (const std::string& name : write_chart(o->output, "impacts", chart)) files.push_back(name);
                }
              }
            }
            if (!statistics.left.empty())
              result.notices.push_back(
                  fmt::format("note: {}: left out of all that is counted; --within all counts all bodies", statistics.left));
            for (const std::string& message : statistics.skipped) result.notices.push_back("left out: " + message);
            if (!run.scene.settings.output_contacts)
              result.notices.push_back("note: the run kept no contacts: no coordination, stress, fabric or force chains");
            result.output = summary_of(statistics);
            result.notices.push_back(fmt::format("wrote {} files into {}; begin with summary.csv", files.size(), o->output));
            return result;
          }};
}

}  // namespace scree
