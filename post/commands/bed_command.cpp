#include <cmath>
#include <memory>

#include "core/base/command_line.hpp"
#include "core/base/error.hpp"
#include "post/bed/bed_export.hpp"
#include "post/commands/commands.hpp"

namespace scree {

Command add_bed(CLI::App& app) {
  struct Options {
    RunOptions run;
    BedOptions bed;
    std::string container, parting = "caps";
    int ball_triangles = 1280;
  };
  const auto o = std::make_shared<Options>();
  CLI::App* command = app.add_subcommand(
      "bed", "Write a packed bed for programs of fluid flow: closed surface, void fractions, kinds of contacts, constraints");
  o->run.add_to(*command, nullptr);
  command->add_option("-o,--output", o->bed.folder, "Folder for STL, VTI, CSV and JSON")->required();
  command->add_option("--frame", o->bed.frame, "Number of the frame; -1 is the last (default)");
  command
      ->add_option(
          "--parting", o->parting,
          "caps (default): both bodies lose a thin cap where they touch or nearly touch; none: bodies as they are, overlaps included")
      ->check(CLI::IsMember({"caps", "none"}));
  command->add_option("--gap", o->bed.gap, "Distance between parted surfaces over the diameter of the smaller body (default 0.01)")
      ->check(CLI::Range(1e-4, 0.1));
  command->add_option("--ball-triangles", o->ball_triangles, "Triangles of a ball that has no mesh: 320, 1280 (default), 5120 or 20480")
      ->check(CLI::IsMember({320, 1280, 5120, 20480}));
  add_quantity(*command, "--cell", o->bed.cell, Dimension::length,
               "Edge of the cells of the void fraction: 0.5e-3, \"0.5 mm\" (default: a tenth of the mean diameter)");
  command->add_option("--rings", o->bed.rings, "Rings of the radial void fraction (default: a twentieth of the mean diameter wide)")
      ->check(CLI::Range(1, 10000));
  command->add_option("--container", o->container,
                      "Box or cylinder the bodies are in, as a region (default: the wall or the periodic sides)");
  command->add_option("--within", o->bed.within, kWithinHelp);
  return {command, [o] {
            CommandResult result;
            const Run run = o->run.open(result.notices);
            BedOptions& bed = o->bed;
            if (std::isnan(bed.gap)) throw UsageError("--gap nan: a number between 1e-4 and 0.1 expected");
            if (bed.cell < 0) throw UsageError("--cell {} m: a length > 0 expected", bed.cell);
            bed.parted = o->parting == "caps";
            for (bed.ball_level = 2; 20 << (2 * bed.ball_level) < o->ball_triangles;) ++bed.ball_level;
            if (!o->container.empty()) {
              bed.container = parse_region(o->container);
              if (bed.container->kind == Region::Kind::sphere)
                throw UsageError("--container {}: a sphere has no rings; give a box or a cylinder", o->container);
            }
            const BedResult made = export_bed(run, bed);
            result.output = made.summary;
            for (const std::string& note : made.notes) result.notices.push_back("note: " + note);
            result.notices.push_back(fmt::format("wrote {} files into {}", made.files.size(), bed.folder));
            return result;
          }};
}

}  // namespace scree
