// scree-mesher: from mesh files to shapes that the other tools understand.
#include <fmt/format.h>

#include <cstdio>

#include "core/base/command_line.hpp"
#include "core/base/error.hpp"
#include "mesher/commands.hpp"
#include "mesher/generate.hpp"
#include "mesher/mesh_file.hpp"

namespace {

const char* const kTool = "scree-mesher";

int print(const scree::CommandResult& result) {
  std::fputs(result.output.c_str(), stdout);
  std::fflush(stdout);
  for (const std::string& notice : result.notices) fmt::print(stderr, "{}: note: {}\n", kTool, notice);
  if (!result.refusal.empty()) throw scree::InputError(result.refusal);
  return 0;
}

int run(int argc, char** argv) {
  // 1. the commands and their options
  std::string libraries = scree::has_gmsh() ? "gmsh " + scree::gmsh_version() : "no gmsh";
  libraries += scree::assimp_version().empty() ? ", no assimp" : ", assimp " + scree::assimp_version();
  const auto app = scree::make_command_line(
      kTool, "Checks, imports and generates the triangle meshes of rigid bodies and walls.",
      {{"scree-mesher check rock.stl --unit mm", "can it be a rigid body?"},
       {"scree-mesher import rock.stl -o rock.shape.h5 --unit mm", "a solid from a mesh in millimetres"},
       {"scree-mesher import funnel.stl -o funnel.shape.h5 --surface", "a wall; may be open"},
       {"scree-mesher generate cylinder --radius \"5 mm\" --height 2cm -o pill.shape.h5",
        "a generated solid"},
       {"scree-mesher info rock.shape.h5", "what is in a shape file"}},
      libraries);
  app->require_subcommand(1);

  scree::CheckOptions check;
  auto* check_command =
      app->add_subcommand("check", "Tell whether a mesh file can be a rigid body; exit 3 when not");
  check_command->add_option("FILE", check.file, "Mesh file (stl obj ply 3ds dae off bmf)")->required();
  check_command->add_option("--unit", check.unit, "Unit of the numbers in the file (default m)");
  check_command->add_option("--scale", check.scale, "Factor on top of the unit");
  check_command->add_flag("--json", check.json, "Machine-readable output");

  scree::ImportOptions import;
  auto* import_command = app->add_subcommand("import", "Import mesh files into one shape file");
  import_command->add_option("FILE", import.files, "Mesh files, one shape each")->required();
  import_command->add_option("-o,--output", import.output, "NAME.shape.h5")->required();
  import_command->add_option("--unit", import.unit, "Unit of the numbers in the files (default m)");
  import_command->add_option("--scale", import.scale, "Factor on top of the unit");
  import_command
      ->add_option("--name", import.names, "Name of the shape; repeat it for each file (default: file name)")
      ->take_all()
      ->expected(1)
      ->allow_extra_args(false);
  import_command->add_flag("--surface", import.surface,
                           "Import as a wall: may be open, no mass, coordinates kept");
  import_command->add_flag("--flip", import.flip,
                           "Turn triangles that face inward or disagree (a surface: all of them)");

  scree::GenerateOptions generate;
  auto* generate_command = app->add_subcommand("generate", "Generate a sphere, box or cylinder");
  generate_command->add_option("SHAPE", generate.what, "sphere, box or cylinder")
      ->required()
      ->check(CLI::IsMember({"sphere", "box", "cylinder"}));
  generate_command->add_option("--radius", generate.radius, "Of sphere and cylinder, for instance \"5 mm\"");
  generate_command->add_option("--height", generate.height, "Of the cylinder, along z");
  generate_command->add_option("--size", generate.size, "Of the box: \"x, y, z\"");
  generate_command->add_option("--edge-length", generate.edge_length,
                               "Of the triangles (default: a quarter of the radius; box: 12 triangles)");
  generate_command->add_flag("--analytic", generate.analytic, "Sphere without triangles: exact and cheapest");
  generate_command->add_option("-o,--output", generate.output, "NAME.shape.h5")->required();
  generate_command->add_option("--name", generate.name,
                               "Name of the shape (default: sphere, box or cylinder)");

  scree::InfoOptions info;
  auto* info_command =
      app->add_subcommand("info", "Show the shapes in a shape file and where they come from");
  info_command->add_option("FILE", info.file, "NAME.shape.h5")->required();

  // 2. run the one that was asked for
  if (!scree::parse_command_line(*app, argc, argv)) return 0;
  const std::vector<std::string> command = scree::command_words(argc, argv);
  if (*check_command) return print(scree::check_command(check));
  if (*import_command) return print(scree::import_command(import, command));
  if (*generate_command) return print(scree::generate_command(generate, command));
  return print(scree::info_command(info));
}

}  // namespace

int main(int argc, char** argv) {
  return scree::run_main(kTool, [&] { return run(argc, argv); });
}
