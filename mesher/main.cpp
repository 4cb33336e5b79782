// scree-mesher: from mesh files to shapes that the other tools understand.
#include <fmt/format.h>

#include <cstdio>

#include "core/base/command_line.hpp"
#include "core/base/error.hpp"
#include "core/base/long_work.hpp"
#include "core/storage/h5_crash.hpp"
#include "mesher/commands/command_lines.hpp"
#include "mesher/io/mesh_file.hpp"
#include "mesher/make/generate.hpp"

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
       {"scree-mesher import funnel.stl -o funnel.shape.h5 --surface", "a wall; can be open"},
       {"scree-mesher generate cylinder --radius \"5 mm\" --height 2cm -o pill.shape.h5", "a generated solid"},
       {"scree-mesher simplify scan.ply -o rock.shape.h5 --unit mm --triangles 500", "fewer triangles, and the distance from the original"},
       {"scree-mesher repair scan.stl -o scan.ply --unit mm --picture scan.png", "close and repair it, or report why not"},
       {"scree-mesher generate rock --diameter 2cm --elongation 0.6..0.9 --count 20 -o rocks.shape.h5", "a family"},
       {"scree-mesher fracture rock.shape.h5 --cells 40 --seed 1 -o pieces.shape.h5", "pieces that share faces, for bonds that break"},
       {"scree-mesher info rock.shape.h5", "what is in a shape file"}},
      libraries);
  app->require_subcommand(1);

  const std::vector<scree::MesherCommand> commands = scree::add_commands(*app);

  // 2. run the one that was asked for
  if (!scree::parse_command_line(*app, argc, argv)) return 0;
  const std::vector<std::string> command = scree::command_words(argc, argv);
  scree::print_progress(true);
  for (const scree::MesherCommand& candidate : commands) {
    if (*candidate.app) return print(candidate.run(command));
  }
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  scree::h5::explain_crashes(kTool);
  return scree::run_main(kTool, [&] { return run(argc, argv); });
}
