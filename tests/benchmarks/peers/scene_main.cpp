// scree-peers-scene: makes the shapes of the comparison, and judges the states that the programs end in.
#include <nlohmann/json.hpp>

#include <cstdio>

#include "core/base/command_line.hpp"
#include "core/base/error.hpp"
#include "tests/benchmarks/peers/peer_scene.hpp"

namespace {

constexpr const char* kTool = "scree-peers-scene";

int run(int argc, char** argv) {
  std::string folder, kind = "rock", state;
  int triangles = 320, count = 4;
  double radius = 0.01, length = 0, density = 2600, gravity = 9.81, reach = 0;
  const auto app =
      scree::make_command_line(kTool, "Makes the shapes of the comparison with other programs, and judges states of bodies.",
                               {{"scree-peers-scene shapes --kind rock --triangles 320 FOLDER", "shape files"},
                                {"scree-peers-scene judge FOLDER END.state --length 0.13", "intersections, depth, energy as JSON"}});
  app->require_subcommand(1);
  CLI::App* shapes = app->add_subcommand("shapes", "Write shapes.txt and shape_K.obj");
  shapes->add_option("folder", folder, "Where")->required();
  shapes->add_option("--kind", kind, "rock (concave) or convex")->capture_default_str();
  shapes->add_option("--triangles", triangles, "20, 80, 320, 1280 or 5120")->capture_default_str();
  shapes->add_option("--count", count, "How many")->capture_default_str()->check(CLI::PositiveNumber);
  shapes->add_option("--radius", radius, "Of the ball of equal volume [m]")->capture_default_str()->check(CLI::PositiveNumber);
  CLI::App* judge = app->add_subcommand("judge", "Measure a state on the true triangles");
  judge->add_option("folder", folder, "Of the shapes")->required();
  judge->add_option("state", state, "File of bodies")->required();
  judge->add_option("--length", length, "Of the square box [m]")->required()->check(CLI::PositiveNumber);
  judge->add_option("--reach", reach, "Bodies nearer than this touch [m]")->capture_default_str();
  judge->add_option("--density", density, "[kg/m^3]")->capture_default_str();
  judge->add_option("--gravity", gravity, "[m/s^2]")->capture_default_str();
  if (!scree::parse_command_line(*app, argc, argv)) return 0;
  if (shapes->parsed()) {
    scree::write_peer_shapes(folder, scree::make_peer_shapes(kind, triangles, count, radius));
    return 0;
  }
  const std::vector<scree::PeerBody> bodies = scree::read_peer_state(state);
  const scree::Verdict v = scree::judge_state(scree::read_peer_shapes(folder), bodies, length, density, gravity, reach);
  const nlohmann::json record = {{"bodies", bodies.size()},
                                 {"touching_pairs", v.touching_pairs},
                                 {"intersecting_pairs", v.intersecting_pairs},
                                 {"deepest", v.deepest},
                                 {"kinetic", v.kinetic},
                                 {"potential", v.potential},
                                 {"largest_speed", v.largest_speed}};
  std::puts(record.dump().c_str());
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  return scree::run_main(kTool, [&] { return run(argc, argv); });
}
