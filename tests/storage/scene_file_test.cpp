// Scene files: what is written is read back bit for bit, and what cannot be right is refused by name.
#include "core/storage/scene_file.hpp"

#include <gtest/gtest.h>
#include <unistd.h>
#include <nlohmann/json.hpp>

#include <filesystem>
#include <fstream>

#include "core/base/error.hpp"
#include "core/storage/scene_settings.hpp"
#include "core/storage/start_state.hpp"
#include "tests/support/shapes.hpp"

namespace scree {
namespace {

namespace fs = std::filesystem;

class SceneFile : public ::testing::Test {
 protected:
  SceneFile() : folder_(fs::temp_directory_path() / ("scree_scene_" + std::to_string(getpid()))) { fs::create_directories(folder_); }
  ~SceneFile() override { fs::remove_all(folder_); }
  std::string path(const std::string& name) const { return (folder_ / name).string(); }
  fs::path folder_;
};

/// One of everything, with numbers that no decimal of six digits holds.
Scene rich_scene() {
  Scene s;
  s.settings.title = "a \"quoted\" title, é";
  s.settings.seed = 18446744073709551615ull;
  s.settings.gravity = {0.1, -1.0 / 3, -9.80665};
  s.settings.duration = 2.0 / 3;
  s.settings.margin = 1e-4 / 3;
  s.settings.domain.bounded = true;
  s.settings.domain.lower = {-1, -2, -3};
  s.settings.domain.upper = {1, 2, 3.3};
  s.settings.domain.outside = Outside::keep;
  s.settings.output_every = 0.01;
  s.settings.fluid = Fluid{998.2, 1e-3 / 3, {0.1, -1.0 / 3, 0}, Drag::stokes};
  s.shapes = {make_solid("rock", test::rock(3, 1)), make_sphere("bead", 0.005), make_surface("floor", test::icosphere(0))};
  s.materials = {{"rock", 2700.1, 0, 0}, {"steel", 7800, 2.1e11, 0.3}};
  s.pairs = {{0, 0, 1e6 / 3, 0.5, 0.4, 0.3, 0}, {0, 1, 2e6, 0.4, 0.3, -1, 0}};
  Wall plane;
  plane.id = 2;
  plane.name = "plane";
  plane.normal = normalised(Vec3{1, 2, 3});
  plane.motion.kind = Oscillate{.axis = {0, 0, 1}, .amplitude = 0.01, .frequency = 50};
  Wall box;
  box.id = 3;
  box.kind = WallKind::box_inside;
  box.lower = {-1, -1, 0};
  box.upper = {1, 1, 2};
  box.material = 1;
  Wall cylinder;
  cylinder.id = 4;
  cylinder.kind = WallKind::cylinder_inside;
  cylinder.axis_end = {0, 0, 1};
  cylinder.radius = 0.7;
  Wall sphere;
  sphere.id = 5;
  sphere.kind = WallKind::sphere_inside;
  sphere.radius = 4;
  Wall mesh;
  mesh.id = 6;
  mesh.kind = WallKind::mesh;
  mesh.shape = 2;
  mesh.scale = 0.1;
  mesh.orientation = quaternion_of({0, 1, 0}, 0.3);
  mesh.motion.kind = FollowTable{.time = {0, 0.1, 0.3}, .position = {{}, {0, 0, 0.1}, {1.0 / 7, 0, 0}}};
  s.walls = {plane, box, cylinder, sphere, mesh};
  BodyTable& b = s.bodies;
  b.id = {0, std::int64_t{1} << 40};
  b.shape = {0, 1};
  b.material = {0, 1};
  b.scale = {0.013, 1};
  b.position = {{1.0 / 3, 0, 0.3}, {0, 0, 1e-17}};
  b.orientation = {quaternion_of(normalised(Vec3{1, 1, 3}), 2.0), Quat{}};
  b.velocity = {{0, 0, -1}, {}};
  b.angular_velocity = {{0.1, 0, 0}, {}};
  b.fixed = {0, 1};
  b.lock_rotation = {1, 0};
  b.population = {-1, 0};
  b.owner = {1, 0};
  s.partition.ranks = 2;
  s.partition.lower = {{-1e300, -1e300, -1e300}, {0.1, -1e300, -1e300}};
  s.partition.upper = {{0.1, 1e300, 1e300}, {1e300, 1e300, 1e300}};
  s.partition.predicted_imbalance = 1.25;
  s.provenance = nlohmann::json{{"tool", "test"}};
  return s;
}

/// The message of the error that a call throws, or "nothing was thrown".
template <class Call>
std::string message_of(Call&& call) {
  try {
    call();
  } catch (const InputError& e) {
    return e.what();
  } catch (const std::exception& e) {
    return std::string("another error: ") + e.what();
  }
  return "nothing was thrown";
}

void expect_says(const std::string& message, const std::vector<std::string>& parts) {
  for (const std::string& part : parts) EXPECT_NE(message.find(part), std::string::npos) << "'" << part << "' not in: " << message;
}

TEST_F(SceneFile, what_is_written_is_read_back_bit_for_bit) {
  const Scene a = rich_scene();
  write_scene_file(path("a.scene.h5"), a);
  const Scene b = read_scene_file(path("a.scene.h5"));
  EXPECT_EQ(settings_json(a), settings_json(b));
  EXPECT_EQ(a.settings.seed, b.settings.seed);
  EXPECT_EQ(a.settings.gravity, b.settings.gravity);
  EXPECT_EQ(a.settings.margin, b.settings.margin);
  ASSERT_TRUE(b.settings.fluid);
  EXPECT_EQ(a.settings.fluid->viscosity, b.settings.fluid->viscosity);
  EXPECT_EQ(a.pairs[0].stiffness, b.pairs[0].stiffness);
  EXPECT_EQ(a.walls[0].normal, b.walls[0].normal);
  EXPECT_EQ(std::get<FollowTable>(a.walls[4].motion.kind).position, std::get<FollowTable>(b.walls[4].motion.kind).position);
  EXPECT_EQ(a.walls[4].orientation, b.walls[4].orientation);
  EXPECT_EQ(a.bodies.id, b.bodies.id);
  EXPECT_EQ(a.bodies.shape, b.bodies.shape);
  EXPECT_EQ(a.bodies.material, b.bodies.material);
  EXPECT_EQ(a.bodies.scale, b.bodies.scale);
  EXPECT_EQ(a.bodies.position, b.bodies.position);
  EXPECT_EQ(a.bodies.orientation, b.bodies.orientation);
  EXPECT_EQ(a.bodies.velocity, b.bodies.velocity);
  EXPECT_EQ(a.bodies.angular_velocity, b.bodies.angular_velocity);
  EXPECT_EQ(a.bodies.fixed, b.bodies.fixed);
  EXPECT_EQ(a.bodies.lock_rotation, b.bodies.lock_rotation);
  EXPECT_EQ(a.bodies.population, b.bodies.population);
  EXPECT_EQ(a.bodies.owner, b.bodies.owner);
  EXPECT_EQ(a.partition.lower, b.partition.lower);
  EXPECT_EQ(a.partition.upper, b.partition.upper);
  EXPECT_EQ(a.partition.predicted_imbalance, b.partition.predicted_imbalance);
  EXPECT_EQ(a.provenance, b.provenance);
  ASSERT_EQ(b.shapes.size(), 3u);
  EXPECT_EQ(a.shapes[0].mesh.vertices, b.shapes[0].mesh.vertices);
  EXPECT_EQ(b.shapes[1].sphere_radius, 0.005);
  EXPECT_EQ(b.shapes[2].kind, ShapeKind::surface);
}

TEST_F(SceneFile, a_scene_without_bodies_walls_or_cuts_is_a_scene) {
  Scene empty;
  write_scene_file(path("empty.scene.h5"), empty);
  const Scene read = read_scene_file(path("empty.scene.h5"));
  EXPECT_EQ(read.bodies.size(), 0u);
  EXPECT_EQ(read.partition.ranks, 0);
}

TEST_F(SceneFile, the_mass_of_a_body_is_density_times_scaled_volume) {
  Scene s = rich_scene();
  s.shapes = {make_solid("cube", box_mesh({1, 2, 3})), make_sphere("bead", 0.005)};
  s.bodies.scale = {0.5, 2};
  EXPECT_NEAR(s.mass(0), 2700.1 * 6 / 8, 1e-10);
  EXPECT_NEAR(s.mass(1), 7800 * 4.0 / 3 * 3.141592653589793 * 1e-6, 1e-14);  // radius 2 x 5 mm
}

TEST_F(SceneFile, a_pair_is_found_in_either_order_and_a_missing_one_is_named) {
  const Scene s = rich_scene();
  EXPECT_EQ(&s.pair(0, 1), &s.pair(1, 0));
  expect_says(message_of([&] { s.pair(1, 1); }), {"'steel' and 'steel'", "[[pairs]]"});
}

TEST_F(SceneFile, a_truncated_scene_is_refused) {
  write_scene_file(path("a.scene.h5"), rich_scene());
  const auto size = fs::file_size(path("a.scene.h5"));
  for (const double share : {0.0, 0.01, 0.3, 0.6, 0.9, 0.999}) {
    fs::copy_file(path("a.scene.h5"), path("cut.scene.h5"), fs::copy_options::overwrite_existing);
    fs::resize_file(path("cut.scene.h5"), static_cast<std::uintmax_t>(share * static_cast<double>(size)));
    const std::string message = message_of([&] { read_scene_file(path("cut.scene.h5")); });
    expect_says(message, {"cut.scene.h5", "truncated"});
  }
}

TEST_F(SceneFile, every_flipped_byte_is_either_refused_or_harmless_and_never_ends_the_program) {
  write_scene_file(path("a.scene.h5"), rich_scene());
  std::ifstream stream(path("a.scene.h5"), std::ios::binary);
  const std::string bytes{std::istreambuf_iterator<char>(stream), {}};
  int refused = 0;
  for (std::size_t at = 0; at < bytes.size(); at += bytes.size() / 200 + 1) {
    std::string damaged = bytes;
    damaged[at] = static_cast<char>(damaged[at] ^ 0x5a);
    std::ofstream(path("damaged.scene.h5"), std::ios::binary) << damaged;
    try {
      read_scene_file(path("damaged.scene.h5"));
    } catch (const Error& e) {
      EXPECT_NE(e.code(), ExitCode::internal) << "byte " << at << ": " << e.what();
      ++refused;
    }
  }
  EXPECT_GT(refused, 0);
}

TEST_F(SceneFile, a_scene_of_a_newer_version_is_refused_with_what_to_do) {
  {
    h5::NewFile file(path("new.scene.h5"));
    file.root().write_attribute("format", kSceneFormat);
    file.root().write_attribute("format_version", kSceneFormatVersionWithStart + 1);
    file.commit();
  }
  expect_says(message_of([&] { read_scene_file(path("new.scene.h5")); }), {"new.scene.h5", "version 4", "newer Scree"});
}

TEST_F(SceneFile, a_file_of_another_kind_is_refused) {
  write_shape_file(path("a.shape.h5"), {make_sphere("bead", 1)}, {});
  expect_says(message_of([&] { read_scene_file(path("a.shape.h5")); }), {"scree-shape", "expected scree-scene"});
  std::ofstream(path("text.scene.h5")) << "not HDF5";
  expect_says(message_of([&] { read_scene_file(path("text.scene.h5")); }), {"not an HDF5 file"});
  expect_says(message_of([&] { read_scene_file(path("missing.scene.h5")); }), {"no such file"});
}

TEST_F(SceneFile, contents_that_cannot_be_right_are_refused_by_name) {
  struct Damage {
    void (*harm)(Scene&);
    std::vector<std::string> says;
  };
  const std::vector<Damage> damages = {
      {[](Scene& s) { s.bodies.shape[1] = 7; }, {"/bodies", "shape 7", "there are 3 shapes"}},
      {[](Scene& s) { s.bodies.shape[0] = 2; }, {"wall surface"}},
      {[](Scene& s) { s.bodies.material[0] = -1; }, {"material -1"}},
      {[](Scene& s) { s.bodies.scale[0] = 0; }, {"scale 0", "> 0"}},
      {[](Scene& s) { s.bodies.scale[0] = std::nan(""); }, {"scale nan"}},
      {[](Scene& s) { s.bodies.position[1].y = std::nan(""); }, {"body 1099511627776", "position"}},
      {[](Scene& s) { s.bodies.velocity[0].x = HUGE_VAL; }, {"velocity"}},
      {[](Scene& s) { s.bodies.orientation[0].w += 1e-3; }, {"unit quaternion"}},
      {[](Scene& s) { s.bodies.id[1] = 0; }, {"unique"}},
      {[](Scene& s) { s.bodies.id[1] = 3; }, {"id 3 is used twice"}},
      {[](Scene& s) { s.bodies.owner[0] = 2; }, {"owner 2", "2 ranks"}},
      {[](Scene& s) { s.bodies.velocity.pop_back(); }, {"velocity", "1 rows found, 2 expected"}},
      {[](Scene& s) { s.partition.lower.pop_back(); }, {"1 boxes found, 2 expected"}},
      {[](Scene& s) { s.pairs[1].b = 2; }, {"pairs[1].b", "there are 2 materials"}},
      {[](Scene& s) { s.pairs[0].restitution = 1.5; }, {"restitution", "1.5"}},
      {[](Scene& s) { s.pairs[0].stiffness = std::nan(""); }, {"stiffness", "finite"}},
      {[](Scene& s) { s.materials[0].density = 0; }, {"density", "> 0"}},
      {[](Scene& s) { s.walls[4].shape = 3; }, {"walls[4].shape"}},
      {[](Scene& s) {
         s.walls[0].normal = {0, 0, 2};
       },
       {"normal", "unit vector"}},
      {[](Scene& s) { s.walls[2].radius = -1; }, {"radius", "> 0"}},
      {[](Scene& s) { s.settings.gravity.x = std::nan(""); }, {"gravity", "finite"}},
      {[](Scene& s) { s.settings.fluid->viscosity = 0; }, {"settings.fluid.viscosity", "> 0"}},
      {[](Scene& s) { s.settings.domain.lower.x = 5; }, {"min is not below max"}},
  };
  for (const Damage& damage : damages) {
    Scene s = rich_scene();
    damage.harm(s);
    write_scene_file(path("bad.scene.h5"), s);
    expect_says(message_of([&] { read_scene_file(path("bad.scene.h5")); }), damage.says);
  }
}

TEST_F(SceneFile, unknown_words_are_refused_with_those_that_are_known) {
  const Scene s = rich_scene();
  const auto message_for = [&](const nlohmann::json::json_pointer& place) {
    nlohmann::json text = settings_json(s);
    text[place] = "magic";
    Scene read;
    read.shapes = s.shapes;
    return message_of([&] { read_settings_json(text, "X", read); });
  };
  using P = nlohmann::json::json_pointer;
  EXPECT_EQ(message_for(P("/settings/law")), "X.settings.law: 'magic' found, expected one of linear, hunt-crossley, hertz-mindlin");
  EXPECT_EQ(message_for(P("/settings/gather")), "X.settings.gather: 'magic' found, expected one of potential, area, pairs");
  EXPECT_EQ(message_for(P("/settings/integrator")),
            "X.settings.integrator: 'magic' found, expected one of kdk-dlm, rig, spiral, midpoint, euler");
  EXPECT_EQ(message_for(P("/settings/step_control")), "X.settings.step_control: 'magic' found, expected one of fixed, quantised");
  EXPECT_EQ(message_for(P("/settings/domain/outside")), "X.settings.domain.outside: 'magic' found, expected one of stop, remove, keep");
  EXPECT_EQ(message_for(P("/settings/fluid/drag")), "X.settings.fluid.drag: 'magic' found, expected one of haider-levenspiel, stokes");
  EXPECT_EQ(message_for(P("/pairs/0/rolling_model")), "X.pairs[0].rolling_model: 'magic' found, expected one of elastic-plastic, constant");
  EXPECT_EQ(message_for(P("/walls/0/kind")),
            "X.walls[0].kind: 'magic' found, expected one of plane, box_inside, cylinder_inside, sphere_inside, mesh");
}

TEST_F(SceneFile, a_quaternion_that_lost_digits_is_made_unit_again) {
  Scene s = rich_scene();
  s.bodies.orientation[0].w += 3e-8;
  write_scene_file(path("a.scene.h5"), s);
  EXPECT_NEAR(norm(read_scene_file(path("a.scene.h5")).bodies.orientation[0]), 1.0, 3e-16);
}

TEST_F(SceneFile, every_dataset_with_a_dimension_carries_its_unit) {
  write_scene_file(path("a.scene.h5"), rich_scene());
  const h5::File file(path("a.scene.h5"));
  const h5::Group bodies = file.root().open_group("bodies");
  for (const auto& [name, unit] :
       std::vector<std::pair<std::string, std::string>>{{"position", "m"}, {"velocity", "m/s"}, {"angular_velocity", "rad/s"}}) {
    const h5::Group dataset(h5::Handle(H5Dopen2(bodies.id(), name.c_str(), H5P_DEFAULT), H5Dclose, name), name);
    EXPECT_EQ(dataset.read_text_attribute("unit"), unit);
  }
}

}  // namespace
}  // namespace scree
