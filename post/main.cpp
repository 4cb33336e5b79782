// scree-post: from a run folder to pictures, tables, statistics and a report.
#include <fmt/format.h>

#include <cstdio>

#include "core/base/command_line.hpp"
#include "core/base/error.hpp"
#include "core/base/long_work.hpp"
#include "core/storage/h5_crash.hpp"
#include "post/commands/commands.hpp"
#include "post/vtk/vtk_or_not.hpp"

namespace {

const char* const kTool = "scree-post";

int run(int argc, char** argv) {
  // 1. the commands and their options
  const auto app = scree::make_command_line(
      kTool, "Makes ParaView files, tables, pictures and a report from a run of scree-solver.",
      {{"scree-post report boulders.run -o report.html", "one page: verdicts, picture, charts, provenance"},
       {"scree-post paraview boulders.run", "then: paraview --script=boulders.run/paraview/open_in_paraview.py"},
       {"scree-post vtk boulders.run -o vtk --what network,walls --frames 10:20", "chosen files of chosen frames for any VTK reader"},
       {"scree-post picture boulders.run -o rocks.png --frame 20", "one picture"},
       {"scree-post film drum.run -o drum.mp4 --colour velocity --turn 90", "a film; the camera goes a quarter round (needs ffmpeg)"},
       {"scree-post statistics drum.run -o drum.statistics --from 2 --profile z:20", "means with confidence intervals, tables, charts"},
       {"scree-post bed column.run -o bed --gap 0.01", "a packed bed for a program of fluid flow: surface, void fractions, contacts"},
       {"scree-post compare coarse.run fine.run -o comparison", "settings, statistics and trajectories side by side"},
       {"scree-post error-vs-time errors.csv -o fronts --at 1e-3", "which choice is fastest for an error of 1e-3"},
       {"scree-post contacts boulders.run -o contacts.csv", "all contacts, and their statistics"},
       {"scree-post bodies boulders.run -o bodies.csv", "all positions, orientations and velocities"},
       {"scree-post scaling r1.run r2.run r4.run -o scaling", "speedup and efficiency of the same scene on 1, 2 and 4 ranks"}},
      scree::vtk_version());
  app->require_subcommand(1);
  std::vector<scree::Command> commands;
  for (const auto& add : {scree::add_view_commands, scree::add_number_commands}) {
    for (scree::Command& command : add(*app)) commands.push_back(std::move(command));
  }
  if (!scree::parse_command_line(*app, argc, argv)) return 0;

  // 2. run the one that was asked for
  scree::print_progress(true);
  for (const scree::Command& command : commands) {
    if (!*command.options) continue;
    const scree::CommandResult result = command.run();
    std::fputs(result.output.c_str(), stdout);
    std::fflush(stdout);
    for (const std::string& notice : result.notices) fmt::print(stderr, "{}: {}\n", kTool, notice);
  }
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  scree::h5::explain_crashes(kTool);
  return scree::run_main(kTool, [&] { return run(argc, argv); });
}
