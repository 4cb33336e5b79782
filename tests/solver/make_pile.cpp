// Writes a scene of N bumpy rocks on a jittered lattice above the floor of a box: input of the end-to-end tests.
// usage: scree_make_pile COUNT DURATION OUT.scene.h5 [TRIANGLE_LEVEL [STIFFNESS [periodic|drain|quantised|rest|far]]]
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <nlohmann/json.hpp>
#include <random>

#include "core/base/provenance.hpp"
#include "tests/support/scenes.hpp"
#include "tests/support/shapes.hpp"

int main(int argc, char** argv) {
  using namespace scree;
  return run_main("scree_make_pile", [&] {
    if (argc < 4)
      throw UsageError(
          "usage: scree_make_pile COUNT DURATION OUT.scene.h5 [TRIANGLE_LEVEL [STIFFNESS [periodic|drain|quantised|rest|far]]]");
    const int count = std::atoi(argv[1]), level = argc > 4 ? std::atoi(argv[4]) : 2;
    Scene scene = test::empty_scene(argc > 5 ? std::atof(argv[5]) : 3e5, 0.3, 0.5, 0.002, 2700);
    scene.settings.title = "pile of rocks";
    scene.settings.gravity = {0, 0, -9.81};
    scene.settings.duration = std::atof(argv[2]);
    scene.settings.output_every = scene.settings.duration / 10;
    scene.settings.checkpoint_every = scene.settings.duration / 5;
    for (unsigned s = 1; s <= 3; ++s)
      scene.shapes.push_back(make_solid("rock" + std::to_string(s), test::scaled(test::rock(s, level), 0.04)));
    const std::string kind = argc > 6 ? argv[6] : "";
    if (kind == "rest") {  // dice lie still sooner than rocks; the run ends then
      scene.shapes = {make_solid("cube", test::grid_box(1, {0.06, 0.06, 0.06})), make_solid("slab", test::grid_box(1, {0.08, 0.06, 0.03})),
                      make_solid("brick", test::grid_box(1, {0.07, 0.05, 0.04}))};
      scene.settings.stop_at_rest = true;
      scene.settings.output_every = scene.settings.checkpoint_every = 0.06;
    }
    const int side = std::max(1, static_cast<int>(std::floor(std::cbrt(count))));
    // rocks reach up to 0.06 m from their centres; the rim keeps those of the outer rows off the walls
    const double spacing = 0.125, rim = 0.01;
    std::mt19937 g(1);
    std::uniform_real_distribution<double> jitter(-0.004, 0.004);
    for (int i = 0; i < count; ++i) {
      const Vec3 at{rim + spacing * (i % side + 0.5) + jitter(g), rim + spacing * (i / side % side + 0.5) + jitter(g),
                    spacing * (i / side / side + 0.6) + jitter(g)};
      test::add_body(scene, i % 3, at, test::random_quaternion(g), {0, 0, -0.5}, {}, 0.9 + 0.2 * (i % 5) / 5.0);
    }
    Wall box;
    box.id = count;
    box.name = "box";
    box.kind = WallKind::box_inside;
    box.lower = {0, 0, 0};
    box.upper = {2 * rim + spacing * side, 2 * rim + spacing * side, 100};
    scene.walls.push_back(box);
    scene.settings.domain.bounded = kind == "periodic" || kind == "drain" || kind == "emptied" || kind == "leaves";
    if (kind == "quantised") scene.settings.step_control = StepControl::quantised;
    scene.settings.domain.lower = {0, 0, 0};
    scene.settings.domain.upper = {box.upper.x, box.upper.y, 100};
    if (kind == "periodic") {  // a chute around both axes, so that bodies pass the seams
      scene.settings.domain.periodic = {true, true, false};
      scene.settings.gravity = {3, 2, -9.81};
    } else if (kind == "drain") {  // bodies go when they come close to the floor
      scene.settings.domain.lower.z = 0.055;
      scene.settings.domain.outside = Outside::remove;
    } else if (kind == "emptied") {  // all of them; the run is to end at rest
      scene.settings.domain.lower.z = 0.09;
      scene.settings.domain.outside = Outside::remove;
      scene.settings.stop_at_rest = true;
    }
    if (kind == "leaves") {  // a column that falls out; one body that is fixed stays above it
      scene.settings.domain.lower.z = 0.09;
      scene.settings.domain.outside = Outside::remove;
      scene.settings.stop_when_empty = true;
      test::add_body(scene, 0, {0.07, 0.07, 50}, {}, {}, {}, 1);
      scene.bodies.fixed.back() = 1;
      scene.walls.back().id = count + 2;
      scene.settings.output_every = scene.settings.checkpoint_every = 0.03;
    }
    if (kind == "far") {  // from the origin of the world: computed about its own middle
      const Vec3 away{1e4, -2e4, 3e4};
      for (Vec3& x : scene.bodies.position) x += away;
      for (Vec3* corner : {&scene.walls[0].lower, &scene.walls[0].upper}) *corner += away;
    }
    Provenance record;
    record.format = kSceneFormat;
    record.format_version = kSceneFormatVersion;
    record.tool = "scree_make_pile";
    scene.provenance = provenance_record(record);
    write_scene_file(argv[3], scene);
    return 0;
  });
}
