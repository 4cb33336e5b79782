// Small scenes in which bodies cross ranks, touch across cuts, or do not fit their rank.
#pragma once

#include "tests/support/scenes.hpp"
#include "tests/support/shapes.hpp"

namespace scree::test {

inline Wall& add_wall(Scene& scene, WallKind kind) {
  Wall wall;
  wall.id = static_cast<std::int64_t>(scene.bodies.size() + scene.walls.size());
  wall.kind = kind;
  wall.name = "wall";
  scene.walls.push_back(wall);
  return scene.walls.back();
}

inline void add_box_walls(Scene& scene, const Vec3& lower, const Vec3& upper) {
  Wall& box = add_wall(scene, WallKind::box_inside);
  box.lower = lower;
  box.upper = upper;
}

/// Bodies of all shapes of a scene on a lattice, turned at random, closer than their bounding spheres: they touch after a
/// few hundred steps.
inline void fill_lattice(Scene& scene, int nx, int ny, int nz, const Vec3& lower, double spacing, const Vec3& velocity, unsigned seed = 3) {
  std::mt19937 generator(seed);
  std::uniform_real_distribution<double> shake(-0.03 * spacing, 0.03 * spacing);
  for (int z = 0; z < nz; ++z)
    for (int y = 0; y < ny; ++y)
      for (int x = 0; x < nx; ++x) {
        const Vec3 position =
            lower + spacing * Vec3{x + 0.5, y + 0.5, z + 0.5} + Vec3{shake(generator), shake(generator), shake(generator)};
        const auto shape = static_cast<std::int32_t>(scene.bodies.size() % scene.shapes.size());
        add_body(scene, shape, position, random_quaternion(generator), velocity, {3 * shake(generator) / spacing, 0, 0});
      }
}

inline Scene rock_scene(int level = 1) {
  Scene scene = empty_scene(2e5, 0.4, 0.5, 0.002);
  scene.settings.gravity = {0, 0, -9.81};
  scene.settings.steps_per_contact = 20;
  for (unsigned seed = 1; seed <= 3; ++seed) {
    scene.shapes.push_back(make_solid("rock" + std::string(1, static_cast<char>('a' + seed)), scaled(rock(seed, level), 0.04)));
  }
  return scene;
}

/// Rocks fall a little and press on each other in a box: most touch several others, and the walls.
/// A `spacing` of 0.105 m suits few rocks; among many some would overlap from the start.
inline Scene dense_heap(int nx = 3, int ny = 3, int nz = 4, double spacing = 0.105) {
  Scene scene = rock_scene();
  const Vec3 upper{nx * spacing, ny * spacing, 2 * nz * spacing};
  add_box_walls(scene, {-0.005, -0.005, 0}, {upper.x + 0.005, upper.y + 0.005, upper.z});
  fill_lattice(scene, nx, ny, nz, {0, 0, 0.005}, spacing, {0, 0, -0.6});
  return scene;
}

/// A scene in water that streams along x.
inline Scene in_water(Scene scene) {
  scene.settings.fluid = Fluid{998, 1e-3, {0.3, 0, 0}, Drag::haider_levenspiel};
  return scene;
}

/// A scene of rock_scene() whose bodies attract each other with seven times their weight, over an eighth of the margins.
inline Scene sticky(Scene scene) {
  scene.pairs[0].pull_off = 20;
  scene.pairs[0].adhesion_range = 5e-4;
  return scene;
}

/// The same with liquid bridges that hold over a seventh of the margins.
inline Scene wet(Scene scene) {
  scene.pairs[0].surface_tension = 80;
  scene.pairs[0].contact_angle = 0.4;
  scene.pairs[0].bridge_volume = 1e-10;
  return scene;
}

/// A scene of rock_scene() whose contacts yield, and pull by a third of what they bear.
inline Scene plastic(Scene scene) {
  scene.pairs[0].plasticity = 0.7;
  scene.pairs[0].adhesive_ratio = 0.3;
  return scene;
}

/// Balls that stick by the necks of JKR with seven times their weight.
inline Scene necked_heap() {
  Scene scene = rock_scene();
  for (Shape& shape : scene.shapes) shape = make_sphere(shape.name, 0.04);
  scene.settings.law = ContactLaw::hertz_mindlin;
  scene.settings.margin = 0.004;
  scene.settings.impact_speed = 1;
  scene.materials[0].young = 1e7;
  scene.pairs[0].stiffness = 0;
  scene.pairs[0].adhesion = 212;
  scene.pairs[0].adhesion_hysteresis = true;
  add_box_walls(scene, {-0.005, -0.005, 0}, {0.215, 0.215, 0.7});
  fill_lattice(scene, 2, 2, 3, {0, 0, 0.005}, 0.105, {0, 0, -0.6});
  return scene;
}

/// A dense heap with gather = "area": a layer that an impact at 1 m/s presses to a third.
inline Scene layered_heap() {
  Scene scene = dense_heap();
  scene.settings.gather = Gathering::area;
  scene.pairs[0].stiffness = 0;
  scene.pairs[0].layer_modulus = 1e7;
  return scene;
}

/// The same with a traction of 16 kPa over an eighth of the margins.
inline Scene sticky_layers() {
  Scene scene = layered_heap();
  scene.pairs[0].adhesion = 4;
  scene.pairs[0].adhesion_range = 5e-4;
  return scene;
}

/// Rocks that slide on a floor through both seams of a domain that is periodic along x and y, rubbing on each other.
inline Scene periodic_bed() {
  Scene scene = rock_scene();
  constexpr double kPeriod = 4 * 0.108;
  Domain& domain = scene.settings.domain;
  domain.bounded = true;
  domain.lower = {0, 0, -0.1};
  domain.upper = {kPeriod, kPeriod, 1};
  domain.periodic = {true, true, false};
  add_wall(scene, WallKind::plane).normal = {0, 0, 1};
  fill_lattice(scene, 4, 4, 3, {0, 0, 0.005}, 0.108, {2, 1.2, -0.6});
  return scene;
}

/// A third of a drum of radius 0.25 m filled with rocks, turning fast enough to carry them through all cuts.
inline Scene rotating_drum() {
  Scene scene = rock_scene();
  Wall& drum = add_wall(scene, WallKind::cylinder_inside);
  drum.axis_start = {0, 0, 0};
  drum.axis_end = {0, 0.25, 0};
  drum.radius = 0.25;
  drum.motion.kind = Rotate{.axis = {0, 1, 0}, .rate = 5};
  drum.motion.stop = 1e300;
  fill_lattice(scene, 3, 2, 3, {-0.162, 0.01, -0.2}, 0.108, {0, 0, -1});
  return scene;
}

/// A slab that spans every cut through the rocks that fall on it, and long thin rods across it.
inline Scene slab_and_rods() {
  Scene scene = rock_scene();
  scene.shapes.push_back(make_solid("slab", grid_box(1, {1.2, 0.12, 0.04})));
  scene.shapes.push_back(make_solid("rod", grid_box(1, {0.02, 0.7, 0.02})));
  scene.shapes.resize(5);
  add_plane(scene, {0, 0, 0}, {0, 0, 1});
  add_body(scene, 3, {0.6, 0.06, 0.025});
  for (int i = 0; i < 3; ++i) add_body(scene, 4, {0.2 + 0.4 * i, 0.06, 0.065 + 0.001 * i}, {}, {0, 0, -0.2});
  std::mt19937 generator(5);
  for (int i = 0; i < 12; ++i)
    add_body(scene, i % 3, {0.05 + 0.1 * i, 0.06, 0.15 + 0.01 * (i % 4)}, random_quaternion(generator), {0, 0, -0.8});
  return scene;
}

/// Three rocks for up to five ranks: some own nothing, now or later.
inline Scene three_rocks() {
  Scene scene = rock_scene();
  add_plane(scene, {0, 0, 0}, {0, 0, 1});
  std::mt19937 generator(8);
  for (int i = 0; i < 3; ++i) add_body(scene, i, {0.07 * i, 0.01 * i, 0.07 + 0.06 * i}, random_quaternion(generator), {0.4, 0, -0.5});
  return scene;
}

}  // namespace scree::test
