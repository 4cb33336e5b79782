// A run folder made up by hand: the same files as the solver writes, with numbers that are known in closed form.
#pragma once

#include <mpi.h>
#include <nlohmann/json.hpp>

#include <array>
#include <filesystem>
#include <fstream>
#include <numbers>
#include <string>

#include "core/base/error.hpp"
#include "core/base/provenance.hpp"
#include "core/storage/frame_file.hpp"
#include "core/storage/h5.hpp"
#include "core/storage/scene_file.hpp"
#include "core/storage/wall_state.hpp"

namespace scree::test {

namespace fs = std::filesystem;

inline TriangleMesh wedge_mesh() {
  TriangleMesh mesh = box_mesh({0.02, 0.03, 0.05});
  mesh.vertices[0] += Vec3{-0.004, -0.006, -0.01};  // no symmetry is left, so that a wrong rotation shows
  return mesh;
}

/// Files that the sample's provenance names, and what is in them.
inline constexpr std::array<std::pair<const char*, const char*>, 3> kSampleInputs{
    {{"my rock.stl", "solid rock"}, {"rock.shape.h5", "shapes of rock"}, {"sample.scene.h5", "a scene"}}};
inline InputRecord sample_input(std::size_t k, const nlohmann::json& history) {
  const std::string content = kSampleInputs[k].second;
  return {kSampleInputs[k].first, sha256_of_bytes(content.data(), content.size()), history};
}

/// Three shapes (two meshes, one ball), a box wall and a driven plane. Ids: bodies 0..n-1, then the walls.
inline Scene sample_scene(std::size_t bodies) {
  Scene scene;
  scene.settings.title = "a <sample> & its report";
  scene.settings.gravity = {0, 0, -9.81};
  scene.settings.duration = 0.2;
  scene.settings.output_every = 0.1;
  scene.settings.margin = 1e-3;
  scene.materials = {{"rock", 2500, 0, 0}};
  scene.pairs = {{0, 0, 1e5, 0.5, 0.4, -1, 0}};
  scene.shapes = {make_solid("box", box_mesh({0.04, 0.02, 0.03})), make_solid("wedge", wedge_mesh()), make_sphere("ball", 0.015)};
  scene.shapes[0].verdict = nlohmann::json{{"solid", true}, {"watertight", true}};
  scene.shapes[1].verdict = nlohmann::json{{"solid", true}, {"watertight", true}};
  for (std::size_t i = 0; i < bodies; ++i) {
    BodyRow row;
    row.id = static_cast<std::int64_t>(i);
    row.shape = static_cast<std::int32_t>(i % 3);
    row.scale = 1 + 0.1 * static_cast<double>(i % 4);
    row.position = {0.07 * static_cast<double>(i % 3), 0.07 * static_cast<double>(i / 3 % 3), 0.05 + 0.07 * static_cast<double>(i / 9)};
    row.orientation = quaternion_of(normalised(Vec3{1, 2, 3}), 0.7 * static_cast<double>(i));
    row.velocity = {0.1, 0, -1.0 / 3.0};
    row.angular_velocity = {0, 0, static_cast<double>(i)};
    scene.bodies.add(row);
  }
  Wall box;
  box.id = static_cast<std::int64_t>(bodies);
  box.name = "box";
  box.kind = WallKind::box_inside;
  box.lower = {-0.05, -0.05, 0};
  box.upper = {0.2, 0.2, 50};
  Wall lid;
  lid.id = box.id + 1;
  lid.name = "lid";
  lid.point = {0, 0, 0.4};
  lid.normal = {0, 0, -1};
  lid.motion.kind = Translate{.axis = {0, 0, -1}, .rate = 0.1};
  scene.walls = {box, lid};
  Provenance mesh, record;
  mesh.tool = "scree-mesher";
  mesh.command = {"/opt/bin/scree-mesher", "import", "my rock.stl", "-o", "rock.shape.h5"};
  mesh.inputs = {sample_input(0, nullptr)};
  record.format = kSceneFormat;
  record.format_version = kSceneFormatVersion;
  record.tool = "scree-decomposer";
  record.command = {"scree-decomposer", "pack", "sample.toml", "-o", "sample.scene.h5"};
  record.configuration = "title = \"a <sample>\"\n";
  record.inputs = {sample_input(1, provenance_record(mesh))};
  scene.provenance = provenance_record(record);
  return scene;
}

/// Every body moved by t (0.1, 0.2, 0.3) and turned by t about z from where the scene has it.
inline Frame sample_frame(const Scene& scene, std::int64_t number, double time) {
  Frame frame;
  frame.number = number;
  frame.step = 100 * number;
  frame.time = time;
  const BodyTable& b = scene.bodies;
  for (std::size_t i = 0; i < b.size(); ++i) {
    frame.bodies.id.push_back(b.id[i]);
    frame.bodies.shape.push_back(b.shape[i]);
    frame.bodies.material.push_back(0);
    frame.bodies.rank.push_back(0);
    frame.bodies.scale.push_back(b.scale[i]);
    frame.bodies.position.push_back(b.position[i] + time * Vec3{0.1, 0.2, 0.3});
    frame.bodies.orientation.push_back(quaternion_of(Vec3{0, 0, 1}, time) * b.orientation[i]);
    frame.bodies.velocity.push_back(b.velocity[i]);
    frame.bodies.angular_velocity.push_back(b.angular_velocity[i]);
  }
  for (const Wall& wall : scene.walls) {
    frame.walls.id.push_back(wall.id);
    frame.walls.position.push_back(wall_state(wall, time).position);
    frame.walls.orientation.push_back(wall.orientation);
    frame.walls.force.push_back({});
    frame.walls.torque.push_back({});
  }
  Provenance record;
  record.tool = "scree-solver";
  record.command = {"scree-solver", "sample.scene.h5", "-o", "sample.run"};
  record.inputs = {sample_input(2, scene.provenance)};
  record.ranks = 2;
  record.threads = 1;
  frame.provenance = provenance_record(record);
  return frame;
}

inline void add_contact(Frame& frame, std::int64_t a, std::int64_t b, std::int64_t feature, const Vec3& normal, double force,
                        double overlap = 1e-4) {
  FrameContacts& c = frame.contacts;
  c.body_a.push_back(a);
  c.body_b.push_back(b);
  c.feature.push_back(feature);
  c.point.push_back({0.1, 0.2, 1.0 / 3.0});
  c.normal.push_back(normal);
  c.overlap.push_back(overlap);
  c.margin.push_back(2e-3);
  c.normal_force.push_back(force);
  c.tangential_force.push_back({});
}

inline std::string log_header() {
  return "step,time,kinetic_translational,kinetic_rotational,potential,elastic,elastic_tangential,dissipated,wall_work,energy_error,"
         "contacts,"
         "max_depth_ratio,imbalance,t_search,t_force,steps_per_second,state_hash\n# units: -,s,J,J,J,J,J,J,J,J,-,-,-,s,s,1/s,-\n";
}

/// Peak kinetic energy 10 J, 20 J dissipated at the end, largest error `error` J.
inline std::string sample_log(double error, double final_kinetic, double overlap_ratio) {
  return log_header() + "0,0,0,0,20,0,0,0,0,0,0,0,1,0,0,0,aa\n" +
         fmt::format("100,0.1,8,2,5,0.5,0,4.5,0,{},12,{},1.2,0.5,2.5,1000,bb\n", error, overlap_ratio) +
         fmt::format("200,0.2,{},0,0,0.1,0,20,0,0,30,0.1,1.1,1,5,900,cc\n", final_kinetic);
}

inline nlohmann::json sample_outcome(const Scene& scene, const Frame& frame) {
  return {{"format", "scree-run"},
          {"format_version", 1},
          {"outcome", "completed"},
          {"message", ""},
          {"exit_code", 0},
          {"steps", 200},
          {"step_size", 1e-3},
          {"critical_step", 0.02},
          {"mean_imbalance", 1.1},
          {"time", 0.2},
          {"state_hash", "cafe0123"},
          {"ranks", 2},
          {"threads", 1},
          {"bodies", scene.bodies.size()},
          {"lost_bodies", 0},
          {"bodies_outside_domain", 0},
          {"wall_seconds", 6.5},
          {"phases", {{"search", 1.0}, {"force", 5.0}}},
          {"max_depth_ratio", 0.25},
          {"slowdown", 12.0},
          {"peak_rss_bytes", 1000000},
          {"provenance", frame.provenance}};
}

/// The frame without some of its bodies: all in the first frame of a run, then in turn every fourth.
inline void take_some_away(Frame& frame) {
  std::vector<std::size_t> kept;
  for (std::size_t i = 0; i < frame.bodies.size(); ++i) {
    if (frame.number > 0 && (static_cast<std::size_t>(frame.number) + i) % 4 != 0) kept.push_back(i);
  }
  take_rows(frame.bodies, kept);
}

/// Writes NAME.run with three frames: t = 0, 0.1, 0.2, and beside it the files that it was made from.
/// in   come_and_go   bodies are not in all frames, see take_some_away(), and touch nothing
inline std::string write_sample_run(const fs::path& folder, std::size_t bodies = 12, int frames = 3, bool come_and_go = false) {
  fs::remove_all(folder);
  fs::create_directories(folder);
  for (const auto& [name, content] : kSampleInputs) std::ofstream(fs::absolute(folder).parent_path() / name) << content;
  const Scene scene = sample_scene(bodies);
  write_scene_file((folder / "scene.h5").string(), scene);
  std::vector<FrameEntry> entries;
  Frame frame;
  for (int n = 0; n < frames; ++n) {
    frame = sample_frame(scene, n, 0.1 * n);
    if (come_and_go) take_some_away(frame);
    for (std::int64_t i = 0; n > 0 && !come_and_go && i + 1 < static_cast<std::int64_t>(bodies); ++i) {
      add_contact(frame, i, i + 1, 3 * i, normalised(Vec3{1, static_cast<double>(i), 2}), 1.0 + static_cast<double>(i));
    }
    entries.push_back({(folder / fmt::format("frame_{:06}.hdf", n)).string(), frame.time});
    write_frame_file(MPI_COMM_SELF, entries.back().path, frame);
  }
  write_frame_series(folder.string(), entries);
  h5::write_text_file((folder / "log.csv").string(), sample_log(0.05, 1e-7, 0.25));
  h5::write_text_file((folder / "run.json").string(), sample_outcome(scene, frame).dump(1));
  return folder.string();
}

}  // namespace scree::test
