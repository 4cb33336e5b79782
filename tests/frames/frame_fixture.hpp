// Frames whose every number is a function of the body's id (frame_values.hpp).
#pragma once

#include "core/storage/frame_file.hpp"

#include <nlohmann/json.hpp>
#include "tests/frames/frame_values.hpp"

namespace scree::test {

inline void add_body(FrameBodies& bodies, std::int64_t id, int rank) {
  bodies.id.push_back(id);
  bodies.shape.push_back(static_cast<std::int32_t>(id % 3));
  bodies.material.push_back(static_cast<std::int32_t>(id % 2));
  bodies.rank.push_back(rank);
  bodies.scale.push_back(1 + 0.001 * static_cast<double>(id));
  bodies.position.push_back(position_of(id));
  bodies.orientation.push_back(orientation_of(id));
  bodies.velocity.push_back(velocity_of(id));
  bodies.angular_velocity.push_back(spin_of(id));
}

/// The share of one rank: ids dealt round robin in falling order over `owners` ranks; the others own nothing.
inline Frame share_of(std::int64_t body_count, int rank, int owners) {
  Frame frame;
  for (std::int64_t id = body_count - 1; id >= 0; --id) {
    if (id % owners == rank) add_body(frame.bodies, id, rank);
  }
  // a contact between each body and the next, owned by the rank of the first
  FrameContacts& c = frame.contacts;
  for (std::int64_t id : frame.bodies.id) {
    if (id + 1 == body_count) continue;
    c.body_a.push_back(id);
    c.body_b.push_back(id + 1);
    c.feature.push_back(7 * id + (std::int64_t{1} << 40));
    c.point.push_back(0.5 * (position_of(id) + position_of(id + 1)));
    c.normal.push_back({0, 0, -1});
    c.overlap.push_back(1e-5 * static_cast<double>(id));
    c.margin.push_back(2e-3);
    c.normal_force.push_back(3.0 * static_cast<double>(id));
    c.tangential_force.push_back({static_cast<double>(id), 0, 0});
  }
  if (rank == 0) {
    frame.number = 12;
    frame.step = 3400;
    frame.time = 0.25;
    frame.kinetic = 1.5;
    frame.potential = -2.5;
    frame.elastic = 0.125;
    frame.dissipated = 3;
    frame.walls.id = {body_count, body_count + 1};
    frame.walls.position = {Vec3{}, Vec3{0, 0, 0.5}};
    frame.walls.orientation = {Quat{}, quaternion_of(Vec3{0, 0, 1}, 1.0)};
    frame.walls.force = {Vec3{1, 2, 3}, Vec3{4, 5, 6}};
    frame.walls.torque = {Vec3{-1, -2, -3}, Vec3{}};
    frame.provenance = nlohmann::json{{"tool", "test"}, {"text", "Größe"}};
  }
  return frame;
}

}  // namespace scree::test
