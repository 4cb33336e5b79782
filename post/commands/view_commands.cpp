#include <array>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>

#include "core/base/command_line.hpp"
#include "core/base/error.hpp"
#include "core/base/expect_ending.hpp"
#include "core/base/utf8.hpp"
#include "core/storage/h5.hpp"
#include "post/commands/commands.hpp"
#include "post/report/report.hpp"
#include "post/run/apparatus.hpp"
#include "post/vtk/vtk_or_not.hpp"

namespace scree {

namespace {

Command add_report(CLI::App& app) {
  struct Options {
    RunOptions run;
    MeasureOptions measures;
    std::string output, json;
    ReportOptions report;
  };
  const auto o = std::make_shared<Options>();
  CLI::App* command = app.add_subcommand("report", "Write a self-contained page about the run");
  o->run.add_to(*command, nullptr);
  command->add_option("-o,--output", o->output, "Page to write (.html)")->required();
  command->add_option("--json", o->json, "Write the same numbers to this file");
  command->add_option("--frame", o->report.frame, "Number of the frame of the pictures and the 3D view; -1 is the last (default)");
  o->measures.add_to(*command);
  return {command, [o] {
            expect_ending("-o", o->output, "a page", {".html"});
            if (!o->json.empty()) expect_ending("--json", o->json, "its numbers", {".json"});
            CommandResult result;
            Run run = o->run.open(result.notices);
            o->report.apparatus = o->measures.apply(run, o->report.statistics);
            o->report.statistics.pool = {o->run.jobs, o->run.skip_damaged};
            const ReportResult report = write_report(run, o->output, o->report);
            if (!o->json.empty()) h5::write_text_file(o->json, json_text(report.numbers, 1) + "\n");
            for (const std::string& line : report.verdicts) result.output += line + "\n";
            if (!o->report.apparatus.empty()) result.notices.push_back("note: " + o->report.apparatus);
            for (const std::string& note : report.notes) result.notices.push_back("note: " + note);
            result.notices.push_back("wrote " + o->output);
            return result;
          }};
}

Command add_paraview(CLI::App& app) {
  struct Options {
    RunOptions run;
    ParaviewOptions files;
  };
  const auto o = std::make_shared<Options>();
  CLI::App* command = app.add_subcommand("paraview", "Write what ParaView opens: a script, meshes, contact network and surfaces");
  o->run.add_to(*command, nullptr);
  command->add_option("-o,--output", o->files.folder, "Folder (default RUN/paraview)");
  command
      ->add_option("--surfaces", o->files.surfaces,
                   "Frames to expand into triangles: all, last, none, or auto (the default): all up to 2e8 triangles in total, else the "
                   "last or none")
      ->check(CLI::IsMember({"auto", "all", "last", "none"}));
  return {command, [o] {
            require_vtk();
            CommandResult result;
            const Run run = o->run.open(result.notices);
            o->files.pool = {o->run.jobs, o->run.skip_damaged};
            std::vector<std::string> skipped;
            result.output = make_paraview_files(run, o->files, skipped) + "\n";
            for (const std::string& message : skipped) result.notices.push_back("left out: " + message);
            return result;
          }};
}

/// Bodies by what they are, as several commands choose them.
struct BodyOptions {
  BodyChoice choice;
  std::vector<std::string> regions;
  void add_to(CLI::App& command) {
    command.add_option("--ids", choice.ids, "Only these bodies: 7, 10-20, 3,5,9")->take_all();
    command.add_option("--material", choice.materials, "Only bodies of this material; repeat for more")->take_all();
    command.add_option("--shape", choice.shapes, "Only bodies of this shape; repeat for more")->take_all();
    command
        .add_option("--region", regions,
                    "Only bodies whose centre is in box:x0,y0,z0,x1,y1,z1 or cylinder:x0,y0,z0,x1,y1,z1,r or "
                    "sphere:x,y,z,r; repeat for more")
        ->take_all();
  }
  BodyChoice chosen() const {
    BodyChoice all = choice;
    for (const std::string& text : regions) all.regions.push_back(parse_region(text));
    return all;
  }
};

Command add_vtk(CLI::App& app) {
  struct Options {
    RunOptions run;
    BodyOptions bodies;
    VtkOptions files;
  };
  const auto o = std::make_shared<Options>();
  CLI::App* command = app.add_subcommand("vtk", "Write frames as .vtp and .pvd files for any VTK reader, several frames at a time");
  o->run.add_to(*command, "Frames: all, last, 7, 0,5,-1, 10:50, ::5 (first:last:step; default all)");
  command->add_option("-o,--output", o->files.folder, "Folder")->required();
  command
      ->add_option("--what", o->files.kinds,
                   "Any of surfaces, bodies (points for glyphs), contacts, network, walls, bonds, cell (default: all that the run has)")
      ->delimiter(',')
      ->check(CLI::IsMember({"surfaces", "bodies", "contacts", "network", "walls", "bonds", "cell"}));
  o->bodies.add_to(*command);
  return {command, [o] {
            require_vtk();
            CommandResult result;
            const Run run = o->run.open(result.notices);
            if (o->files.kinds.empty()) {
              o->files.kinds = {"surfaces", "bodies", "walls"};
              if (run.scene.settings.output_contacts) o->files.kinds.insert(o->files.kinds.end(), {"contacts", "network"});
              if (!run.scene.bonds.empty()) o->files.kinds.emplace_back("bonds");
              if (run.scene.settings.cell) o->files.kinds.emplace_back("cell");
            }
            o->files.frames = choose_frames(run, o->run.frames);
            o->files.bodies = o->bodies.chosen();
            o->files.pool = {o->run.jobs, o->run.skip_damaged};
            std::vector<std::string> skipped;
            result.output = make_vtk_files(run, o->files, skipped) + "\n";
            for (const std::string& message : skipped) result.notices.push_back("left out: " + message);
            return result;
          }};
}

}  // namespace

void RunOptions::add_to(CLI::App& command, const char* what_frames) {
  command.add_option("RUN", folder, "NAME.run, as scree-solver wrote it")->required();
  if (what_frames != nullptr) command.add_option("--frames", frames, what_frames);
  add_pool_to(command);
}

void RunOptions::add_pool_to(CLI::App& command) {
  command.add_option("--jobs", jobs, "Frames worked on at the same time (default: as many as cores)")->check(CLI::PositiveNumber);
  command.add_flag("--skip-damaged", skip_damaged, "Leave out frames that cannot be read, and name them; else the first one ends the work");
}

Run RunOptions::open(std::vector<std::string>& notices) const {
  Run run = open_run(folder);
  if (skip_damaged) drop_damaged_frames(run);
  if (const std::string notice = run.notice(); !notice.empty()) notices.push_back("note: " + notice);
  for (const std::string& message : run.damaged) notices.push_back("left out: " + message);
  return run;
}

std::vector<Command> add_view_commands(CLI::App& app) {
  return {add_report(app), add_paraview(app), add_vtk(app), add_picture(app), add_film(app)};
}

}  // namespace scree
