#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>

#include "core/base/command_line.hpp"
#include "core/base/error.hpp"
#include "core/base/expect_ending.hpp"
#include "core/base/long_work.hpp"
#include "core/base/utf8.hpp"
#include "core/storage/h5.hpp"
#include "post/commands/commands.hpp"
#include "post/statistics/contact_statistics.hpp"
#include "post/statistics/fragments.hpp"
#include "post/statistics/tables.hpp"
#include "post/studies/compare.hpp"
#include "post/studies/error_vs_time.hpp"
#include "post/studies/scaling.hpp"

namespace scree {

namespace {

/// A command that turns a run into one table.
struct TableOptions {
  RunOptions run;
  std::string output;
  CLI::App* add(CLI::App& app, const char* name, const char* purpose) {
    CLI::App* command = app.add_subcommand(name, purpose);
    run.add_to(*command, nullptr);
    command->add_option("-o,--output", output, "Table to write (.csv)")->required();
    return command;
  }
};

Command add_bodies(CLI::App& app) {
  const auto o = std::make_shared<TableOptions>();
  CLI::App* command = o->add(app, "bodies", "Write a table of all bodies in all frames");
  return {command, [o] {
            expect_ending("-o", o->output, "a table", {".csv"});
            CommandResult result;
            write_bodies_table(o->run.open(result.notices), o->output);
            result.notices.push_back("wrote " + o->output);
            return result;
          }};
}

Command add_contacts(CLI::App& app) {
  const auto o = std::make_shared<TableOptions>();
  CLI::App* command = o->add(app, "contacts", "Write a table of all contacts, and print their statistics");
  return {command, [o] {
            expect_ending("-o", o->output, "a table", {".csv"});
            CommandResult result;
            const Run run = o->run.open(result.notices);
            if (!run.scene.settings.output_contacts) {
              throw InputError("{}: the run kept no contacts; set contacts = true in [output] of the case and run it again", run.folder);
            }
            write_contacts_table(run, o->output);
            nlohmann::json frames = nlohmann::json::array();
            ContactStatistics last;
            LongWork work("statistics of contacts", static_cast<double>(run.frames.size()));
            for (std::size_t f = 0; f < run.frames.size(); ++f) {
              work.advance();
              last = contact_statistics(load_frame(run, f), run.boundary_ids);
              frames.push_back(json_of(last));
            }
            std::filesystem::path path(o->output);
            path.replace_extension(".summary.json");
            const nlohmann::json summary = {{"run", run.name}, {"last", json_of(last)}, {"frames", frames}};
            h5::write_text_file(path.string(), json_text(summary, 1) + "\n");
            result.output = table_of(last);
            result.notices.push_back("wrote " + o->output + " and " + path.string());
            return result;
          }};
}

Command add_fragments(CLI::App& app) {
  const auto o = std::make_shared<TableOptions>();
  const auto sizes = std::make_shared<std::string>();
  CLI::App* command = o->add(app, "fragments", "Write number and share of the fragments that bonds hold together, frame by frame");
  command->add_option("--sizes", *sizes, "Table of the fragments in the last frame (.csv)");
  return {command, [o, sizes] {
            expect_ending("-o", o->output, "a table", {".csv"});
            if (!sizes->empty()) expect_ending("--sizes", *sizes, "a table", {".csv"});
            CommandResult result;
            result.output = write_fragments(o->run.open(result.notices), o->output, *sizes);
            result.notices.push_back("wrote " + o->output + (sizes->empty() ? "" : " and " + *sizes));
            return result;
          }};
}

Command add_scaling(CLI::App& app) {
  struct Options {
    std::vector<std::string> folders;
    std::string output = "scaling";
  };
  const auto o = std::make_shared<Options>();
  CLI::App* command = app.add_subcommand("scaling", "Compare runs on different numbers of ranks and threads: a table, two charts");
  command->add_option("RUN", o->folders, "NAME.run of the same bodies, or of as many more as cores")->required();
  command->add_option("-o,--output", o->output, "Folder (default scaling)");
  return {command, [o] {
            CommandResult result;
            result.output = write_scaling(o->folders, o->output);
            result.notices.push_back(fmt::format("wrote {}/scaling.csv, strong.svg and weak.svg", o->output));
            return result;
          }};
}

Command add_compare(CLI::App& app) {
  struct Options {
    std::vector<std::string> folders;
    std::string output;
    RunOptions run;  // all but the folder
  };
  const auto o = std::make_shared<Options>();
  CLI::App* command =
      app.add_subcommand("compare", "Compare runs: settings that differ, statistics side by side, divergence of the trajectories");
  command->add_option("RUN", o->folders, "NAME.run, two or more; the first is what the others are compared with")->required();
  command->add_option("-o,--output", o->output, "Folder for CSV, JSON, SVG and PNG")->required();
  o->run.add_pool_to(*command);
  return {command, [o] {
            CommandResult result;
            std::vector<Run> runs;
            for (const std::string& folder : o->folders) {
              o->run.folder = folder;
              runs.push_back(o->run.open(result.notices));
            }
            const Comparison comparison = compare_runs(runs, o->output, {o->run.jobs, o->run.skip_damaged});
            result.output = comparison.text;
            for (const std::string& notice : comparison.notices) result.notices.push_back(notice);
            result.notices.push_back(fmt::format("wrote {} files into {}", comparison.files.size(), o->output));
            return result;
          }};
}

Command add_error_vs_time(CLI::App& app) {
  const auto o = std::make_shared<ErrorVsTimeOptions>();
  CLI::App* command = app.add_subcommand(
      "error-vs-time", "Draw error against run time from the tables of studies: fronts, and the best choice for an error");
  command->add_option("CSV", o->files, "Tables of validation and work-precision studies (errors.csv)")->required();
  command->add_option("-o,--output", o->folder, "Folder for CSV, SVG and PNG")->required();
  command->add_option("--case", o->cases, "Only this case; repeat for more (default: all)")->take_all();
  command
      ->add_option("--words", o->words,
                   "A case is the first so many words of its column (default: all, or two where every row has a name of its own)")
      ->check(CLI::PositiveNumber);
  command->add_option("--error", o->errors, "Column of errors; repeat for more (default: all with two numbers)")
      ->take_all()
      ->check(CLI::IsMember(
          {"error_e", "error_t", "error_traj", "energy_drift_rms", "energy_drift_slope", "angular_momentum_drift", "momentum_drift"}));
  command->add_option("--time", o->time, "Column of times (default wall_median)");
  command->add_option("--at", o->targets, "Mark the best choice for this error; repeat for more (default: powers of ten)")
      ->take_all()
      ->check(CLI::PositiveNumber);
  return {command, [o] {
            CommandResult result;
            const ErrorVsTimeResult written = write_error_vs_time(*o);
            result.output = written.text;
            result.notices.push_back(fmt::format("wrote {} files into {}", written.files.size(), o->folder));
            return result;
          }};
}

}  // namespace

std::vector<Command> add_number_commands(CLI::App& app) {
  return {add_statistics(app), add_bed(app),      add_compare(app),   add_error_vs_time(app),
          add_bodies(app),     add_contacts(app), add_fragments(app), add_scaling(app)};
}

}  // namespace scree
