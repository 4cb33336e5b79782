// The tool as a user runs it: exit codes, messages, files.
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>
#include <cmath>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <set>
#include <sstream>

#include "core/base/provenance.hpp"
#include "core/storage/scene_file.hpp"
#include "core/storage/start_state.hpp"

namespace scree {
namespace {

namespace fs = std::filesystem;

struct ToolRun {
  int code;
  std::string output, errors;
};

std::string text_of(const fs::path& path) {
  std::ifstream stream(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

const std::string kCase = R"(seed = 3
[time]
duration = "0.1 s"
[shapes.cube]
file = "cube.shape.h5"
[materials.stone]
density = 2500
[[pairs]]
between = ["stone", "stone"]
stiffness = "10 MN/m"
restitution = 0.5
[contact]
margin = "1 mm"
[[populations]]
shape = "cube"
material = "stone"
count = 40
size = "50 mm"
region = { box = [[0, 0, 0], [0.5, 0.5, 0.5]] }
[[walls]]
shape = { box_inside = [[0, 0, 0], [0.5, 0.5, 0.5]] }
material = "stone"
)";

class Command : public ::testing::Test {
 protected:
  Command() : folder_(fs::temp_directory_path() / ("scree_decomposer_" + std::to_string(getpid()))) {
    fs::create_directories(folder_);
    write_shape_file((folder_ / "cube.shape.h5").string(), {make_solid("cube", box_mesh({1, 1, 1}))}, {{"tool", "scree-mesher"}});
    write("case.toml", kCase);
  }
  ~Command() override { fs::remove_all(folder_); }
  Scene read_scene_after_pack() {
    expect("pack case.toml -o a.scene.h5", 0, {});
    return read_scene_file((folder_ / "a.scene.h5").string());
  }
  void write(const std::string& name, const std::string& text) const { std::ofstream(folder_ / name, std::ios::binary) << text; }
  void write_changed(const std::string& from, const std::string& to) const {
    std::string text = kCase;
    write("case.toml", text.replace(text.find(from), from.size(), to));
  }
  ToolRun run(const std::string& arguments) const {
    const std::string command = "cd '" + folder_.string() + "' && '" SCREE_DECOMPOSER "' " + arguments + " >.out 2>.err </dev/null";
    const int status = std::system(command.c_str());
    return {WIFEXITED(status) ? WEXITSTATUS(status) : -1, text_of(folder_ / ".out"), text_of(folder_ / ".err")};
  }
  void expect(const std::string& arguments, int code, const std::vector<std::string>& says) const {
    const ToolRun r = run(arguments);
    EXPECT_EQ(r.code, code) << r.errors;
    for (const std::string& part : says)
      EXPECT_NE((r.output + r.errors).find(part), std::string::npos) << "'" << part << "' not in: " << r.output << r.errors;
  }
  bool left_anything() const {
    for (const auto& entry : fs::directory_iterator(folder_)) {
      const std::string name = entry.path().filename().string();
      if (name.ends_with(".tmp") || name == "a.scene.h5") return true;
    }
    return false;
  }
  fs::path folder_;
};

TEST_F(Command, pack_writes_a_scene_that_tells_its_whole_chain) {
  expect("pack case.toml -o a.scene.h5 --ranks 2", 0, {"40 bodies", "solid fraction", "predicted imbalance"});
  const Scene s = read_scene_file((folder_ / "a.scene.h5").string());
  EXPECT_EQ(s.bodies.size(), 40u);
  EXPECT_EQ(s.partition.ranks, 2);
  EXPECT_EQ((*s.provenance)["configuration"], kCase);
  EXPECT_EQ((*s.provenance)["seed"], 3);
  EXPECT_EQ((*s.provenance)["tool"], "scree-decomposer");
  EXPECT_EQ((*s.provenance)["inputs"][0]["sha256"], sha256_of_file((folder_ / "case.toml").string()));
  EXPECT_EQ((*s.provenance)["inputs"][1]["sha256"], sha256_of_file((folder_ / "cube.shape.h5").string()));
  EXPECT_EQ((*s.provenance)["inputs"][1]["history"]["tool"], "scree-mesher");
}

// The file is what lies on the disk: a report compares its hash. What --set made of it is the configuration.
TEST_F(Command, a_changed_key_leaves_the_hash_of_the_case_file_in_the_record) {
  expect("pack case.toml -o a.scene.h5 --set pairs.*.friction=0.4", 0, {"40 bodies"});
  const Scene s = read_scene_file((folder_ / "a.scene.h5").string());
  EXPECT_EQ((*s.provenance)["inputs"][0]["sha256"], sha256_of_file((folder_ / "case.toml").string()));
  EXPECT_NE((*s.provenance)["configuration"].get<std::string>().find("friction = 0.4"), std::string::npos);
}

TEST_F(Command, partition_cuts_a_scene_again_and_changes_nothing_else) {
  expect("pack case.toml -o a.scene.h5 --ranks 2", 0, {});
  expect("partition a.scene.h5 --ranks 3 -o b.scene.h5", 0, {"ranks              3", "solid fraction"});
  const Scene a = read_scene_file((folder_ / "a.scene.h5").string()), b = read_scene_file((folder_ / "b.scene.h5").string());
  EXPECT_EQ(b.partition.ranks, 3);
  EXPECT_EQ(a.bodies.position, b.bodies.position);
  EXPECT_EQ(a.bodies.orientation, b.bodies.orientation);
  EXPECT_EQ(settings_json(a), settings_json(b));
  EXPECT_EQ((*b.provenance)["inputs"][0]["history"], *a.provenance);
  EXPECT_EQ((*b.provenance)["configuration"], kCase);
}

TEST_F(Command, a_preview_shows_all_bodies_with_their_parts_and_what_other_numbers_of_parts_cost) {
  expect("pack case.toml -o a.scene.h5 --ranks 3 --preview look", 0, {"look.vtp", "ghosts at most"});
  const Scene s = read_scene_file((folder_ / "a.scene.h5").string());
  const std::string picture = text_of(folder_ / "look.vtp"), table = text_of(folder_ / "look.csv");
  // a point and a vertex for each of 40 bodies, 8 corners and 12 edges for each of 3 parts
  EXPECT_NE(picture.find("NumberOfPoints=\"64\" NumberOfVerts=\"40\" NumberOfLines=\"36\""), std::string::npos);
  std::istringstream parts(picture.substr(picture.find('\n', picture.find("Name=\"part\""))));
  for (std::size_t i = 0; i < 40; ++i) {
    int part = -1;
    parts >> part;
    EXPECT_EQ(part, s.bodies.owner[i]);
  }
  // 1, 2, 3, 4, 8, 16 parts, and a header
  EXPECT_EQ(std::count(table.begin(), table.end(), '\n'), 7);
  EXPECT_NE(table.find("rcb,3,"), std::string::npos);
  expect("partition a.scene.h5 --ranks 2 -o b.scene.h5 --preview again", 0, {"again.vtp"});
  expect("pack case.toml -o a.scene.h5 --preview look", 2, {"--ranks"});
  expect("pack case.toml -o a.scene.h5 --ranks 2 --preview nowhere/look", 4, {"no folder nowhere"});
}

TEST_F(Command, sizes_asked_and_got_come_as_a_line_a_table_and_a_chart) {
  write_changed("size = \"50 mm\"", "size = { distribution = \"uniform\", min = \"40 mm\", max = \"50 mm\" }");
  expect("pack case.toml -o a.scene.h5 --sizes got", 0, {"by number", "% off at most", "got.csv"});
  const std::string table = text_of(folder_ / "got.csv"), chart = text_of(folder_ / "got.svg");
  EXPECT_EQ(table.find("population,by,diameter,asked,got\n0,number,0.04,0.000000,0.000000\n"), 0u) << table.substr(0, 100);
  EXPECT_NE(table.find("0,number,0.045,0.500000,0."), std::string::npos);
  EXPECT_NE(table.find("0,number,0.05,1.000000,1.000000"), std::string::npos);
  EXPECT_EQ(chart.find("<svg"), 0u);
}

TEST_F(Command, partition_by_other_methods_gives_every_body_an_owner_that_reads_back) {
  expect("pack case.toml -o a.scene.h5", 0, {});
  for (const char* method : {"rib", "hsfc", "body"}) {
    expect(std::string("partition a.scene.h5 --ranks 3 --cut ") + method + " -o b.scene.h5", 0, {"ranks              3"});
    const Scene b = read_scene_file((folder_ / "b.scene.h5").string());
    EXPECT_EQ(b.partition.method, method);
    EXPECT_TRUE(b.partition.lower.empty());
    EXPECT_EQ(std::set<std::int32_t>(b.bodies.owner.begin(), b.bodies.owner.end()), (std::set<std::int32_t>{0, 1, 2}));
    EXPECT_LT(b.partition.predicted_imbalance, 1.2);  // 40 equal cubes in three parts: 14 / 13.33 at best
  }
}

// Counted by hand: 10 unit-spaced cubes in a row, cut in the middle. Reach of a ghost: radius 0.05 x sqrt(3) / 2 each, far below the
// spacing.
TEST_F(Command, compare_counts_the_ghosts_of_a_row_of_bodies) {
  Scene scene = read_scene_after_pack();
  BodyTable& b = scene.bodies;
  const double radius = 0.5 * std::sqrt(3.0) * b.scale[0];
  for (std::size_t i = 0; i < b.size(); ++i) b.position[i] = {2.1 * radius * static_cast<double>(i), 0, 0};
  scene.settings.surface = TouchAt::outside;
  scene.settings.margin = 0.04 * radius;  // sums of reach: 2.08 radii: nobody touches
  write_scene_file((folder_ / "row.scene.h5").string(), scene);
  expect("compare row.scene.h5 --parts 2 --cuts rcb --skin 0", 0, {"rcb,2,1.0000,20.0,20,0.00,0,0.0,0,0,0"});
  expect("compare row.scene.h5 --parts 2 --cuts rcb --skin 0.1", 0, {"rcb,2,1.0000,20.0,20,1.00,1,1.0,1,104,104"});
  expect("compare row.scene.h5 --parts 4 --cuts rcb --skin 0.1", 0, {"rcb,4,1.0000,10.0,10,1.50,2,1.5,2,156,208"});
  // dealt out by id the row is cut in the same places
  expect("compare row.scene.h5 --parts 4 --cuts body --skin 0.1", 0, {"body,4,1.0000,10.0,10,1.50,2,1.5,2,156,208"});
  expect("compare row.scene.h5 --parts 0", 2, {});
}

TEST_F(Command, tile_repeats_the_bodies_and_grows_the_box) {
  expect("pack case.toml -o a.scene.h5 --ranks 2", 0, {});
  expect("tile a.scene.h5 --copies 2,1,3 --duration 5ms -o t.scene.h5", 0, {"240 bodies"});
  const Scene a = read_scene_file((folder_ / "a.scene.h5").string()), t = read_scene_file((folder_ / "t.scene.h5").string());
  EXPECT_EQ(t.walls[0].upper, (Vec3{1.0, 0.5, 1.5}));
  EXPECT_EQ(t.partition.ranks, 0);
  EXPECT_DOUBLE_EQ(t.settings.duration, 0.005);
  EXPECT_EQ(t.bodies.position[40 + 7], a.bodies.position[7] + (Vec3{0.5, 0, 0}));
  EXPECT_EQ(t.bodies.position[200 + 7], a.bodies.position[7] + (Vec3{0.5, 0, 1.0}));
  EXPECT_EQ(std::set<std::int64_t>(t.bodies.id.begin(), t.bodies.id.end()).size(), 240u);
  EXPECT_EQ((*t.provenance)["inputs"][0]["history"], *a.provenance);
  write_changed("[[walls]]\nshape = { box_inside = [[0, 0, 0], [0.5, 0.5, 0.5]] }\nmaterial = \"stone\"\n", "");
  expect("pack case.toml -o a.scene.h5", 0, {});
  expect("tile a.scene.h5 --copies 2,1,1 -o u.scene.h5", 2, {"0 walls"});
}

TEST_F(Command, check_reads_a_case_and_needs_no_other_file) {
  EXPECT_EQ(run("check case.toml").output.find("not there yet"), std::string::npos);
  fs::remove(folder_ / "cube.shape.h5");
  expect("check case.toml", 0, {"correct", "40 particles"});
  const std::string said = run("check case.toml").output;
  EXPECT_NE(said.find("not there yet: "), std::string::npos) << said;
  EXPECT_NE(said.find("cube.shape.h5 (case.toml:"), std::string::npos) << said;
}

TEST_F(Command, check_opens_the_shape_files_that_are_there) {
  fs::rename(folder_ / "cube.shape.h5", folder_ / "whole.shape.h5");
  write("cube.shape.h5", "solid cube\nendsolid cube\n");
  const ToolRun packed = run("pack case.toml -o a.scene.h5"), checked = run("check case.toml");
  EXPECT_EQ(checked.code, 3);
  EXPECT_EQ(checked.errors, packed.errors);
}

TEST_F(Command, a_mistake_in_the_case_exits_with_2_and_leaves_no_file) {
  write_changed("restitution = 0.5", "restitutoin = 0.5");
  expect("pack case.toml -o a.scene.h5", 2, {"scree-decomposer: error: case.toml:11: pairs[0].restitutoin", "did you mean 'restitution'"});
  write_changed("restitution = 0.5", "restitution = \"0.5 m\"");
  expect("pack case.toml -o a.scene.h5", 2,
         {"case.toml:11: pairs[0].restitution = \"0.5 m\": a length, but restitution has no unit; write 0.5"});
  write_changed("between = [\"stone\", \"stone\"]", "between = [\"stone\", \"water\"]");
  expect("check case.toml", 2, {"no material 'water'"});
  EXPECT_FALSE(left_anything());
}

TEST_F(Command, an_impossible_packing_exits_with_3_and_leaves_no_file) {
  write_changed("count = 40", "count = 850");
  expect("pack case.toml -o a.scene.h5", 3, {"placed ", " of 850 bodies", "solid fraction reached"});
  EXPECT_FALSE(left_anything());
}

TEST_F(Command, a_truncated_scene_exits_with_3) {
  expect("pack case.toml -o a.scene.h5", 0, {});
  fs::resize_file(folder_ / "a.scene.h5", fs::file_size(folder_ / "a.scene.h5") / 2);
  expect("partition a.scene.h5 --ranks 2 -o b.scene.h5", 3, {"a.scene.h5", "truncated"});
  EXPECT_FALSE(fs::exists(folder_ / "b.scene.h5"));
}

TEST_F(Command, a_newer_scene_exits_with_3) {
  {
    h5::NewFile file((folder_ / "new.scene.h5").string());
    file.root().write_attribute("format", kSceneFormat);
    file.root().write_attribute("format_version", kSceneFormatVersionWithStart + 1);
    file.commit();
  }
  expect("partition new.scene.h5 --ranks 2 -o b.scene.h5", 3, {"version 4", "newer Scree"});
}

TEST_F(Command, files_that_are_missing_and_folders_that_do_not_exist_are_told_apart) {
  expect("pack no.toml -o a.scene.h5", 3, {"no.toml", "cannot be read"});
  expect("pack case.toml -o no/a.scene.h5", 4, {"there is no folder"});
  expect("pack case.toml -o .", 2, {"is a folder"});
  fs::remove(folder_ / "cube.shape.h5");
  expect("pack case.toml -o a.scene.h5", 3, {"case.toml:4: shapes.cube", "no such file"});
}

TEST_F(Command, a_scene_without_its_ending_is_refused_with_the_name_to_write) {
  for (const char* name : {"box", "box.h5", "box.scene"}) {
    expect(std::string("pack case.toml -o ") + name, 2, {"a scene is called NAME.scene.h5; write -o box.scene.h5"});
    EXPECT_FALSE(fs::exists(folder_ / name));
  }
  expect("pack case.toml -o a.scene.h5", 0, {});
  expect("partition a.scene.h5 --ranks 2 -o b", 2, {"write -o b.scene.h5"});
  expect("tile a.scene.h5 --copies 2,1,1 -o t", 2, {"write -o t.scene.h5"});
}

TEST_F(Command, no_case_of_a_workflow_is_doubted_and_a_slip_is_a_warning_of_one_line) {
  int cases = 0;
  for (const auto& entry : fs::recursive_directory_iterator(fs::path(SCREE_DECOMPOSER_FOLDER).parent_path() / "workflows")) {
    if (entry.path().extension() != ".toml" || entry.path().filename().string().rfind("case", 0) != 0) continue;
    ++cases;
    EXPECT_EQ(run("check '" + entry.path().string() + "'").errors, "") << entry.path();
  }
  EXPECT_GE(cases, 8);
  write_changed("density = 2500", "density = 2.5");
  for (const char* command : {"check case.toml", "pack case.toml -o a.scene.h5"}) {
    expect(command, 0,
           {"scree-decomposer: warning: materials.stone.density = 2.5 kg/m^3", "scree-decomposer: warning: no friction is given"});
  }
}

TEST_F(Command, long_packings_tell_their_progress_and_short_ones_nothing) {
  write("balls.toml", R"(
seed = 4
[time]
duration = 1
[shapes.ball]
sphere = { radius = "5 mm" }
[materials.glass]
density = 2500
[[pairs]]
between = ["glass", "glass"]
stiffness = 2e3
restitution = 0.3
friction = 0.4
[contact]
margin = "100 um"
[[populations]]
shape = "ball"
material = "glass"
count = 15
method = "settle"
region = { box = [[0, 0, 0], [0.03, 0.03, 0.03]] }
[[walls]]
shape = { box_inside = [[0, 0, 0], [0.03, 0.03, 0.04]] }
material = "glass"
)");
  EXPECT_EQ(run("pack balls.toml -o a.scene.h5 --set populations.0.method=random --set populations.0.count=5").errors.find("packing:"),
            std::string::npos);
  setenv("SCREE_PROGRESS_AFTER", "0", 1);
  setenv("OMP_NUM_THREADS", "1", 1);  // a dozen balls
  expect("pack balls.toml -o a.scene.h5 --set populations.0.method=random --set populations.0.count=4", 0,
         {"packing:  50 %  2 of 4 bodies, ", " left\n"});
  expect("pack balls.toml -o a.scene.h5 --set populations.0.count=3", 0,
         {"settle:  3 bodies come to rest, ", "so far\n", "settle: done in "});
  expect("pack balls.toml -o a.scene.h5 --set populations.0.method=compact --set populations.0.count=12", 0,
         {"compact:", " of the size, stage 2 of about ", " left\n"});
  unsetenv("SCREE_PROGRESS_AFTER");
  unsetenv("OMP_NUM_THREADS");
}

TEST_F(Command, a_full_disk_exits_with_4_and_leaves_no_file) {
  if (access("/dev/full", W_OK) != 0 || geteuid() != 0) GTEST_SKIP() << "needs the right to mount a small tmpfs";
  const fs::path small = folder_ / "small";
  fs::create_directories(small);
  if (std::system(("mount -t tmpfs -o size=8k tmpfs '" + small.string() + "' 2>/dev/null").c_str()) != 0) {
    GTEST_SKIP() << "no right to mount a small tmpfs";
  }
  const ToolRun r = run("pack case.toml -o small/a.scene.h5");
  const bool empty = fs::is_empty(small);
  ASSERT_EQ(std::system(("umount '" + small.string() + "'").c_str()), 0);
  EXPECT_EQ(r.code, 4) << r.errors;
  EXPECT_NE(r.errors.find("small/a.scene.h5"), std::string::npos) << r.errors;
  EXPECT_TRUE(empty);
}

/// What stands in a page between the first fence of a language and the next fence.
std::string fenced(const std::string& page, const std::string& language) {
  const std::string text = text_of(fs::path(SCREE_DECOMPOSER_FOLDER) / page);
  const auto begin = text.find("```" + language + "\n") + language.size() + 4;
  return text.substr(begin, text.find("```", begin) - begin);
}

TEST_F(Command, the_example_of_the_case_page_and_the_command_of_the_readme_run) {
  write("case.toml", fenced("CASE.md", "toml"));
  write_shape_file((folder_ / "rock.shape.h5").string(), {make_solid("rock", box_mesh({1, 1.2, 0.8}))}, {});
  const std::string command = fenced("README.md", "sh");
  ASSERT_EQ(command.rfind("scree-decomposer ", 0), 0u) << command;
  expect(command.substr(17, command.find('\n') - 17), 0, {"box.scene.h5: 50 bodies", "margin", "(derived)"});
}

TEST_F(Command, usage_mistakes_exit_with_2) {
  expect("", 2, {});
  expect("pakc case.toml", 2, {"pack"});
  expect("pack case.toml", 2, {});
  expect("pack case.toml -o a.scene.h5 --ranks 0", 2, {});
  expect("pack case.toml -o a.scene.h5 --rank 2", 2, {});
  expect("--help", 0, {"scree-decomposer pack case.toml"});
  expect("--version", 0, {"scree-decomposer"});
}

}  // namespace
}  // namespace scree
