// scree-decomposer: from a case file to a scene that the solver can run, cut for its ranks.
#include <fmt/format.h>

#include <cstdio>
#include <iterator>
#include <sstream>

#include "core/base/command_line.hpp"
#include "core/base/error.hpp"
#include "core/base/long_work.hpp"
#include "core/base/mpi_session.hpp"
#include "core/base/units.hpp"
#include "core/distance/triangle_distance.hpp"
#include "core/storage/h5_crash.hpp"
#include "decomposer/commands.hpp"

namespace {

const char* const kTool = "scree-decomposer";

int run(int argc, char** argv) {
  // 1. the commands and their options
  const auto app = scree::make_command_line(
      kTool, "Packs a case into a scene and cuts it for the solver's ranks.",
      {{"scree-decomposer check case.toml", "is the case file right?"},
       {"scree-decomposer pack case.toml -o box.scene.h5", "place all bodies"},
       {"scree-decomposer pack case.toml -o box.scene.h5 --ranks 4", "and cut the scene for 4 ranks"},
       {"scree-decomposer pack case.toml -o wet.scene.h5 --set pairs.*.friction=0.8", "with another friction"},
       {"scree-decomposer partition box.scene.h5 --ranks 8 -o box8.scene.h5", "cut it for another number"},
       {"scree-decomposer compare box.scene.h5 --parts 16,256", "count ghosts and imbalance of four ways to cut it"},
       {"scree-decomposer tile box.scene.h5 --frame box.run/frame_000100.hdf --copies 4,4,1 -o bed.scene.h5", "repeat a settled box"}});
  app->require_subcommand(1);

  std::string case_path;
  auto* check = app->add_subcommand("check", "Read a case and report its errors; places no bodies");
  check->add_option("CASE", case_path, "case.toml")->required();

  scree::PackOptions pack;
  const auto add_changes = [&pack](CLI::App* command_line) {
    command_line
        ->add_option("--set", pack.changes, "KEY=VALUE replaces a value of the case, for instance pairs.*.friction=0.4; can be repeated")
        ->take_all()
        ->expected(1)
        ->allow_extra_args(false);
  };
  add_changes(check);
  auto* pack_command = app->add_subcommand("pack", "Place all bodies of a case and write the scene");
  pack_command->add_option("CASE", pack.case_path, "case.toml")->required();
  pack_command->add_option("-o,--output", pack.output, "NAME.scene.h5")->required();
  add_changes(pack_command);
  pack_command->add_option("--ranks", pack.ranks, "Divide the scene among this number of solver ranks")->check(CLI::Range(1, 1000000000));

  pack_command->add_option("--preview", pack.preview, "With --ranks: write NAME.vtp, the parts for ParaView, and NAME.csv, their cost")
      ->needs("--ranks");
  pack_command->add_option("--sizes", pack.sizes, "Write NAME.csv and NAME.svg: requested and obtained sizes");
  std::string solver;
  pack_command->add_option(
      "--solver", solver,
      "Command for settle and compact, for instance \"mpirun -n 4 scree-solver\" (default: the scree-solver beside this)");

  scree::PartitionOptions partition;
  auto* partition_command = app->add_subcommand("partition", "Cut a scene for a number of ranks");
  partition_command->add_option("SCENE", partition.scene_path, "NAME.scene.h5")->required();
  partition_command->add_option("-o,--output", partition.output, "NAME.scene.h5")->required();
  partition_command->add_option("--preview", partition.preview, "Write NAME.vtp, the parts for ParaView, and NAME.csv, their cost");
  partition_command->add_option("--ranks", partition.ranks, "Ranks of the solver")->required()->check(CLI::Range(1, 1000000000));

  const auto add_cut = [](CLI::App* command_line, std::string& name) {
    command_line->add_option("--cut", name, "rcb (default), rib, hsfc or body")->check(CLI::IsMember(scree::cut_method_names()));
  };
  std::string cut = "rcb";
  add_cut(pack_command, cut);
  add_cut(partition_command, cut);

  scree::CompareOptions compare;
  compare.cuts = scree::cut_method_names();
  auto* compare_command = app->add_subcommand("compare", "Divide a scene by several methods; print a table of their costs");
  compare_command->add_option("SCENE", compare.scene_path, "NAME.scene.h5")->required();
  compare_command->add_option("--parts", compare.parts, "Numbers of parts, for instance 16,64,256")
      ->required()
      ->delimiter(',')
      ->check(CLI::Range(1, 1000000000));
  compare_command->add_option("--cuts", compare.cuts, "Ways to cut (default all)")
      ->delimiter(',')
      ->check(CLI::IsMember(scree::cut_method_names()));
  compare_command->add_option("--skin", compare.skin, "Skin of the body lists, of the smallest radius (default 0.1)")
      ->check(CLI::Range(0.0, 1.0));

  scree::TileOptions tile;
  auto* tile_command = app->add_subcommand("tile", "Repeat a box of bodies side by side");
  tile_command->add_option("SCENE", tile.scene_path, "NAME.scene.h5 with one wall, box_inside")->required();
  tile_command->add_option("--frame", tile.frame_path, "Frame of a run of that scene to take the bodies from");
  tile_command->add_option("--copies", tile.copies, "Copies along x, y and z, for instance 4,4,1")
      ->required()
      ->delimiter(',')
      ->check(CLI::Range(1, 1000000000));
  scree::add_quantity(*tile_command, "--duration", tile.duration, scree::Dimension::time,
                      "Of the new scene, for instance \"2 ms\" (default: as the old one)");
  tile_command->add_option("-o,--output", tile.output, "NAME.scene.h5")->required();

  // 2. run the one that was asked for; results to stdout, notes to stderr
  if (!scree::parse_command_line(*app, argc, argv)) return 0;
  const std::vector<std::string> command = scree::command_words(argc, argv);
  pack.cut = partition.cut = scree::cut_method_of(cut);
  std::istringstream solver_words(solver);
  pack.solver.command = {std::istream_iterator<std::string>(solver_words), {}};
  scree::print_progress(true);
  scree::CommandResult result;
  if (*check) {
    result = scree::check_command(case_path, pack.changes);
  } else if (*pack_command) {
    result = scree::pack_command(pack, command);
  } else if (*compare_command) {
    result = scree::compare_command(compare);
  } else if (*tile_command) {
    result = scree::tile_command(tile, command);
  } else {
    result = scree::partition_command(partition, command);
  }
  for (const std::string& warning : result.warnings) scree::warn_once(kTool, warning);
  for (const std::string& notice : result.notices) fmt::print(stderr, "{}: note: {}\n", kTool, notice);
  std::fputs(result.output.c_str(), stdout);
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  const scree::mpi::Session session(argc, argv);  // Zoltan wants it
  scree::h5::explain_crashes(kTool);
  return scree::run_main(kTool, [&] { return run(argc, argv); });
}
