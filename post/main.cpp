// scree-post: from a run folder to pictures, tables and a report.
#include <fmt/format.h>

#include <cstdio>
#include <filesystem>

#include "core/base/command_line.hpp"
#include "core/base/error.hpp"
#include "core/storage/h5.hpp"
#include "post/contact_statistics.hpp"
#include "post/report.hpp"
#include "post/run_folder.hpp"
#include "post/scaling.hpp"
#include "post/tables.hpp"
#include "post/vtk_or_not.hpp"

namespace {

const char* const kTool = "scree-post";

/// Opens the run and says what the user must know of its state.
scree::Run open(const std::string& folder) {
  scree::Run run = scree::open_run(folder);
  if (const std::string notice = run.notice(); !notice.empty()) fmt::print(stderr, "{}: note: {}\n", kTool, notice);
  return run;
}

void write_contact_summary(const scree::Run& run, const std::string& table_path) {
  nlohmann::json frames = nlohmann::json::array();
  scree::ContactStatistics last;
  for (std::size_t f = 0; f < run.frames.size(); ++f) {
    last = scree::contact_statistics(scree::load_frame(run, f), run.boundary_ids);
    frames.push_back(scree::json_of(last));
  }
  std::filesystem::path path(table_path);
  path.replace_extension(".summary.json");
  nlohmann::json summary = {{"run", run.name}, {"last", scree::json_of(last)}, {"frames", frames}};
  scree::h5::write_text_file(path.string(), summary.dump(1) + "\n");
  fmt::print("{}", scree::table_of(last));
  fmt::print(stderr, "{}: wrote {} and {}\n", kTool, table_path, path.string());
}

int run(int argc, char** argv) {
  // 1. the commands and their options
  const auto app = scree::make_command_line(
      kTool, "Makes ParaView files, tables, pictures and a report from a run of scree-solver.",
      {{"scree-post report boulders.run -o report.html", "one page: verdicts, picture, charts, provenance"},
       {"scree-post paraview boulders.run", "then: paraview --script=boulders.run/paraview/open_in_paraview.py"},
       {"scree-post contacts boulders.run -o contacts.csv", "all contacts, and their statistics"},
       {"scree-post bodies boulders.run -o bodies.csv", "all positions, orientations and velocities"},
       {"scree-post scaling r1.run r2.run r4.run -o scaling", "speedup and efficiency of the same scene on 1, 2 and 4 ranks"},
       {"scree-post picture boulders.run -o rocks.png --frame 20", "one picture (needs an X display)"}},
      scree::vtk_version());
  app->require_subcommand(1);
  std::string folder, output;
  std::int64_t frame = -1;
  const auto add = [&](const char* name, const char* purpose, const char* output_text, bool needed) {
    CLI::App* command = app->add_subcommand(name, purpose);
    command->add_option("RUN", folder, "NAME.run, as scree-solver wrote it")->required();
    CLI::Option* option = command->add_option("-o,--output", output, output_text);
    if (needed) option->required();
    return command;
  };
  std::string surfaces = "all";
  CLI::App* paraview = add("paraview", "Write what ParaView opens: a script, meshes and surfaces", "Folder (default RUN/paraview)", false);
  paraview->add_option("--surfaces", surfaces, "Frames to expand into triangles: all, last or none (default all)")
      ->check(CLI::IsMember({"all", "last", "none"}));
  CLI::App* bodies = add("bodies", "Write a table of all bodies in all frames", "Table to write (.csv)", true);
  CLI::App* contacts = add("contacts", "Write a table of all contacts, and print their statistics", "Table to write (.csv)", true);
  CLI::App* picture = add("picture", "Draw one frame with true shapes", "Picture to write (.png)", true);
  picture->add_option("--frame", frame, "Number of the frame; -1 is the last (default)");
  CLI::App* report = add("report", "Write a self-contained page about the run", "Page to write (.html)", true);
  std::vector<std::string> folders;
  std::string scaling_output = "scaling";
  CLI::App* scaling = app->add_subcommand("scaling", "Compare runs on different numbers of ranks and threads: a table, two charts");
  scaling->add_option("RUN", folders, "NAME.run of the same bodies, or of as many more as cores")->required();
  scaling->add_option("-o,--output", scaling_output, "Folder (default scaling)");
  if (!scree::parse_command_line(*app, argc, argv)) return 0;

  // 2. what this build and this machine can do
  if (*paraview || *picture) scree::require_vtk();
  if (*picture) {
    if (const std::string reason = scree::picture_obstacle(); !reason.empty()) throw scree::SystemError("cannot draw a picture: {}", reason);
  }

  // 3. read, and write what was asked for
  if (*scaling) {
    std::fputs(scree::write_scaling(folders, scaling_output).c_str(), stdout);
    fmt::print(stderr, "{}: wrote {}/scaling.csv, strong.svg and weak.svg\n", kTool, scaling_output);
    return 0;
  }
  const scree::Run the_run = open(folder);
  if (*paraview) {
    fmt::print("{}\n", scree::make_paraview_files(the_run, output, surfaces));
  } else if (*bodies) {
    scree::write_bodies_table(the_run, output);
    fmt::print(stderr, "{}: wrote {}\n", kTool, output);
  } else if (*contacts) {
    if (!the_run.scene.settings.output_contacts) {
      throw scree::InputError("{}: the run kept no contacts; set contacts = true in [output] of the case and run it again", folder);
    }
    scree::write_contacts_table(the_run, output);
    write_contact_summary(the_run, output);
  } else if (*picture) {
    scree::make_picture(the_run, scree::find_frame(the_run, frame), output);
    fmt::print(stderr, "{}: wrote {}\n", kTool, output);
  } else if (*report) {
    const scree::ReportResult result = scree::write_report(the_run, output);
    for (const std::string& line : result.verdicts) fmt::print("{}\n", line);
    for (const std::string& note : result.notes) fmt::print(stderr, "{}: note: {}\n", kTool, note);
    fmt::print(stderr, "{}: wrote {}\n", kTool, output);
  }
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  return scree::run_main(kTool, [&] { return run(argc, argv); });
}
