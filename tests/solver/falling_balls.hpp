// A scene of balls for tests of what is done to balls alone.
#pragma once

#include "tests/support/parallel_scenes.hpp"

namespace scree::test {

/// Balls of several sizes and two materials, some fixed or locked, that fall into each other in a box and rub.
inline Scene falling_balls(ContactLaw law, double friction, bool periodic) {
  Scene scene = empty_scene(law == ContactLaw::hertz_mindlin ? 0 : 2e3, 0.4, friction, 0);
  scene.settings.gravity = {1, 0, -9.81};
  scene.settings.law = law;
  scene.settings.impact_speed = 2;
  scene.materials = {{"glass", 2500, 1e6, 0.3}, {"light", 700, 4e5, 0.2}};
  const MaterialPair first = scene.pairs[0];
  for (std::int32_t b : {0, 1}) {
    MaterialPair pair = first;
    pair.a = b;
    pair.b = 1;
    pair.friction *= 0.5;  // one pair keeps none where there is none
    pair.restitution = b == 0 ? 0.4 : 0.9;
    if (b == 1 && law == ContactLaw::linear) {
      pair.stiffness = 0;
      pair.modulus = 4e5;  // stiffness that goes with size
    }
    scene.pairs.push_back(pair);
  }
  for (MaterialPair& pair : scene.pairs) pair.restitution_speed = 0.5;
  scene.shapes = {make_sphere("small", 0.01), make_sphere("large", 0.017)};
  add_box_walls(scene, {0, 0, 0}, {0.18, 0.18, 1});
  if (periodic) {
    scene.settings.domain.bounded = true;
    scene.settings.domain.upper = {0.18, 0.18, 1};
    scene.settings.domain.periodic = {true, true, false};
  }
  fill_lattice(scene, 5, 5, 4, {0, 0, 0.002}, 0.0355, {0.8, 0.5, -1.5});
  BodyTable& b = scene.bodies;
  for (std::size_t i = 0; i < b.size(); ++i) {
    b.material[i] = static_cast<std::int32_t>(i % 3 == 0);
    b.scale[i] = 1 - 0.1 * static_cast<double>(i % 4);
    b.fixed[i] = i % 17 == 5;
    b.lock_rotation[i] = i % 11 == 3;
    if (b.fixed[i]) b.velocity[i] = b.angular_velocity[i] = {};
  }
  return scene;
}

}  // namespace scree::test
