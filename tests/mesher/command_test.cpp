// The commands as a user runs them: exit codes, messages and files.
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <nlohmann/json.hpp>
#include <numbers>

#include "core/geometry/features.hpp"
#include "core/storage/shape_file.hpp"
#include "mesher/io/mesh_file.hpp"
#include "mesher/io/sandbox.hpp"
#include "mesher/make/generate.hpp"
#include "tests/mesher/tool_run.hpp"
#include "tests/support/shapes.hpp"

namespace scree {
namespace {

using test::Folder;
using test::ToolRun;

// A tetrahedron of volume 1/6 as a mesh editor would write it.
const char* const kTetrahedron = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 1 4 3\n";
const char* const kInverted = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 2 3\nf 1 4 2\nf 2 4 3\nf 1 3 4\n";
const char* const kOpen = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\n";
const char* const kNan = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 nan\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 1 4 3\n";

// A block of 1 x 1 x 1.2 without its lid.
const char* const kCup =
    "OFF\n8 5 0\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n0 0 1.2\n1 0 1.2\n1 1 1.2\n0 1 1.2\n4 3 2 1 0\n4 0 1 5 4\n4 1 2 6 5\n4 2 3 7 6\n4 3 0 4 7\n";

#define EXPECT_SAYS(text, words) EXPECT_NE((text).find(words), std::string::npos) << "looked for '" << (words) << "' in\n" << (text)

std::string binary_stl() {
  const float corners[4][3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  const int faces[4][3] = {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {0, 3, 2}};
  std::string text(80, '\0');
  const auto add = [&](const void* data, std::size_t size) { text.append(static_cast<const char*>(data), size); };
  const std::uint32_t count = 4;
  add(&count, 4);
  for (const auto& face : faces) {
    const float normal[3] = {0, 0, 0};
    add(normal, 12);
    for (int v : face) add(corners[v], 12);
    add("\0", 2);
  }
  return text;
}

class Mesher : public testing::Test {
 protected:
  Folder folder;
  ToolRun run(const std::string& arguments) { return folder.mesher(arguments); }
  std::vector<Shape> shapes(const std::string& name) { return read_shape_file(folder / name).shapes; }
  bool exists(const std::string& name) { return std::filesystem::exists(folder / name); }
  /// No file but those the test wrote: no half-written shape file, no temporary one.
  void expect_nothing_written() {
    for (const auto& entry : std::filesystem::directory_iterator(folder.path())) {
      const std::string name = entry.path().filename().string();
      EXPECT_EQ(name.find(".h5"), std::string::npos) << name;
    }
  }
  /// check and import both refuse with exit 3 and these words, and nothing is written.
  void expect_refused(const std::string& file, const std::string& words) {
    for (const std::string& command : {"check " + file, "import " + file + " -o x.shape.h5"}) {
      const ToolRun result = run(command);
      EXPECT_EQ(result.code, 3) << command << "\n" << result.errors;
      EXPECT_SAYS(result.errors, words);
      EXPECT_SAYS(result.errors, file);
      EXPECT_SAYS(result.errors, "error:");
    }
    expect_nothing_written();
  }
};

class MesherImport : public Mesher {
 protected:
  void SetUp() override {
    if (assimp_version().empty()) GTEST_SKIP() << "this build has no assimp";
  }
};

class MesherGmsh : public Mesher {
 protected:
  void SetUp() override {
    if (!has_gmsh()) GTEST_SKIP() << "this build has no gmsh";
  }
};

TEST_F(MesherImport, check_tells_that_a_tetrahedron_is_a_solid) {
  folder.write("rock.obj", kTetrahedron);
  const ToolRun result = run("check rock.obj --unit m");
  EXPECT_EQ(result.code, 0) << result.errors;
  EXPECT_SAYS(result.output, "watertight               yes");
  EXPECT_SAYS(result.output, "volume                   0.166666667 m^3");
  EXPECT_SAYS(result.output, "rigid body               yes");
  EXPECT_EQ(result.errors, "");
}

TEST_F(MesherImport, check_gives_json_with_the_inertia_of_the_right_tetrahedron) {
  folder.write("rock.obj", kTetrahedron);
  const ToolRun result = run("check rock.obj --json --unit cm");
  EXPECT_EQ(result.code, 0) << result.errors;
  const nlohmann::json json = nlohmann::json::parse(result.output);
  EXPECT_EQ(json["solid"], true);
  EXPECT_NEAR(json["volume"].get<double>(), 1e-6 / 6, 1e-20);
  // right tetrahedron of legs 1: I_xx = m 3/40 and I_xy = m/80 about the centre of mass
  EXPECT_NEAR(json["inertia"][0][0].get<double>(), 1e-10 / 6 * 3 / 40, 1e-24);
  EXPECT_NEAR(json["inertia"][0][1].get<double>(), 1e-10 / 6 / 80, 1e-24);
}

TEST_F(MesherImport, check_of_an_open_mesh_still_gives_json_and_exit_3) {
  folder.write("open.obj", kOpen);
  const ToolRun result = run("check open.obj --json");
  EXPECT_EQ(result.code, 3);
  const nlohmann::json json = nlohmann::json::parse(result.output);
  EXPECT_EQ(json["boundary_edges"], 3);
  EXPECT_EQ(json["solid"], false);
}

TEST_F(MesherImport, an_open_mesh_is_refused_with_its_boundary_and_offers_surface) {
  folder.write("open.obj", kOpen);
  expect_refused("open.obj", "the mesh is open: 3 boundary edges in 1 loop");
  expect_refused("open.obj", "--surface");
}

TEST_F(MesherImport, an_inverted_mesh_is_refused_and_offers_flip) {
  folder.write("inverted.obj", kInverted);
  expect_refused("inverted.obj", "the mesh is inverted");
  expect_refused("inverted.obj", "signed volume -0.166667 m^3");
  expect_refused("inverted.obj", "--flip");
}

TEST_F(MesherImport, flip_turns_an_inverted_mesh_and_says_so) {
  folder.write("inverted.obj", kInverted);
  const ToolRun result = run("import inverted.obj --flip -o x.shape.h5");
  EXPECT_EQ(result.code, 0) << result.errors;
  EXPECT_SAYS(result.errors, "4 triangles turned to face outward");
  EXPECT_NEAR(shapes("x.shape.h5")[0].mass.volume, 1.0 / 6, 1e-15);
}

TEST_F(MesherImport, an_empty_file_is_refused) {
  folder.write("empty.stl", "");
  expect_refused("empty.stl", "the file is empty");
}

TEST_F(MesherImport, text_renamed_to_stl_is_refused) {
  folder.write("notes.stl",
               "Dear diary, today I modelled a rock. It was round and grey, and it rolled away before I "
               "could save it.\n");
  expect_refused("notes.stl", "cannot be read as .stl");
  expect_refused("notes.stl", "it is no STL");
}

TEST_F(MesherImport, a_text_that_begins_like_an_stl_but_holds_no_facet_is_refused) {
  folder.write("solid.stl", "solid as a rock\n");
  expect_refused("solid.stl", "cannot be read as .stl");
}

TEST_F(MesherImport, a_nan_vertex_is_refused) {
  folder.write("nan.obj", kNan);
  expect_refused("nan.obj", "not a finite number (NaN or infinite)");
  EXPECT_EQ(run("import nan.obj --surface -o x.shape.h5").code, 3);
}

TEST_F(MesherImport, a_truncated_binary_stl_is_refused_with_its_sizes) {
  folder.write("short.stl", binary_stl().substr(0, 150));
  expect_refused("short.stl", "4 triangles, which need 284 bytes, but the file has 150");
}

TEST_F(MesherImport, what_follows_the_triangles_of_a_binary_stl_is_left_out_and_told) {
  folder.write("more.stl", binary_stl() + std::string(60, '\xff'));
  const auto done = run("import more.stl --unit m -o more.shape.h5");
  EXPECT_EQ(done.code, 0) << done.errors;
  EXPECT_NE(done.errors.find("60 bytes after its 4 triangles are left out"), std::string::npos) << done.errors;
}

TEST_F(MesherImport, formats_without_a_reader_name_what_converts_them) {
  for (const auto& [file, says] : {std::pair("part.iges", "a CAD program (FreeCAD, gmsh) exports it as .stl"),
                                   {"part.msh", "meshio convert"},
                                   {"part.3mf", "Blender or MeshLab"}}) {
    folder.write(file, "x");
    const ToolRun result = run(std::string("import ") + file + " -o x.shape.h5");
    EXPECT_EQ(result.code, 2) << result.errors;
    EXPECT_SAYS(result.errors, says);
  }
}

// two halves of a sheet that face opposite ways: --flip turns the smaller one, the cure that the note names
TEST_F(MesherImport, a_surface_of_mixed_winding_is_told_its_cure) {
  folder.write("mixed.obj", "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 2 0 0\nv 2 1 0\nf 1 2 3\nf 1 3 4\nf 2 3 5\nf 5 6 3\n");
  const auto mixed = run("import mixed.obj --unit m --surface -o mixed.shape.h5");
  EXPECT_EQ(mixed.code, 0) << mixed.errors;
  EXPECT_NE(mixed.errors.find("import with --flip, which makes them agree"), std::string::npos) << mixed.errors;
  const auto agrees = run("import mixed.obj --unit m --surface --flip -o agrees.shape.h5");
  EXPECT_EQ(agrees.code, 0) << agrees.errors;
  EXPECT_EQ(agrees.errors.find("opposite ways"), std::string::npos) << agrees.errors;
}

TEST_F(MesherImport, an_stl_whose_header_promises_too_much_is_refused) {
  std::string text = binary_stl();
  const std::uint32_t many = 4000000000U;
  std::memcpy(text.data() + 80, &many, 4);
  folder.write("lie.stl", text);
  expect_refused("lie.stl", "4000000000 triangles");
}

TEST_F(MesherImport, a_huge_vertex_count_ends_the_importer_and_not_the_tool) {
  if (!child_memory_is_limited()) GTEST_SKIP() << "no memory limit under this sanitizer";
  folder.write("huge.off", "OFF\n2000000000 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n");
  expect_refused("huge.off", "huge.off");
}

TEST_F(MesherImport, a_binary_stl_and_an_obj_of_the_same_solid_give_the_same_shape) {
  folder.write("a.stl", binary_stl());
  folder.write("b.obj", kTetrahedron);
  const ToolRun result = run("import a.stl b.obj --unit mm --scale 2 -o x.shape.h5");
  ASSERT_EQ(result.code, 0) << result.errors;
  const std::vector<Shape> both = shapes("x.shape.h5");
  ASSERT_EQ(both.size(), 2U);
  EXPECT_EQ(both[0].name, "a");
  EXPECT_EQ(both[1].name, "b");
  for (const Shape& shape : both) {
    EXPECT_EQ(shape.kind, ShapeKind::solid);
    EXPECT_EQ(shape.mesh.vertex_count(), 4);
    EXPECT_NEAR(shape.mass.volume, 8e-9 / 6, 1e-23);
    EXPECT_LE(length(shape.origin_shift - Vec3{0.5e-3, 0.5e-3, 0.5e-3}), 1e-17);
    EXPECT_EQ((*shape.verdict)["solid"], true);
    EXPECT_EQ((*shape.verdict)["metres_per_file_unit"], 2e-3);
  }
}

TEST_F(MesherImport, the_shape_file_carries_the_hash_of_its_input_and_the_command) {
  folder.write("rock.obj", kTetrahedron);
  ASSERT_EQ(run("import rock.obj -o rock.shape.h5").code, 0);
  const nlohmann::json record = read_shape_file(folder / "rock.shape.h5").provenance;
  EXPECT_EQ(record["format"], "scree-shape");
  EXPECT_EQ(record["inputs"][0]["path"], "rock.obj");
  // sha256sum of the text above, from coreutils
  const int status = std::system(("cd '" + folder.path().string() + "' && sha256sum rock.obj | cut -c1-64 > sum").c_str());
  ASSERT_EQ(status, 0);
  EXPECT_EQ(record["inputs"][0]["sha256"].get<std::string>() + "\n", test::text_of_file(folder / "sum"));
  EXPECT_EQ(record["command"].size(), 5U);
}

TEST_F(MesherImport, a_surface_may_be_open_and_keeps_the_coordinates_of_its_file) {
  folder.write("funnel.obj", kOpen);
  const ToolRun result = run("import funnel.obj --surface -o x.shape.h5");
  EXPECT_EQ(result.code, 0) << result.errors;
  EXPECT_SAYS(result.errors, "3 boundary edges");
  const Shape shape = shapes("x.shape.h5")[0];
  EXPECT_EQ(shape.kind, ShapeKind::surface);
  EXPECT_EQ(shape.mass.volume, 0);
  EXPECT_EQ(shape.origin_shift, Vec3{});
  EXPECT_EQ(shape.mesh.vertices[0], Vec3{});
}

TEST_F(MesherImport, dropped_triangles_are_told) {
  folder.write("rock.obj", std::string(kTetrahedron) + "f 1 1 2\nf 1 3 2\n");
  const ToolRun result = run("import rock.obj -o x.shape.h5");
  EXPECT_EQ(result.code, 0) << result.errors;
  EXPECT_SAYS(result.errors, "1 zero-area triangle dropped");
  EXPECT_SAYS(result.errors, "1 duplicate triangle dropped");
}

TEST_F(MesherImport, one_bad_file_among_good_ones_leaves_nothing_behind) {
  folder.write("good.obj", kTetrahedron);
  folder.write("open.obj", kOpen);
  EXPECT_EQ(run("import good.obj open.obj -o x.shape.h5").code, 3);
  expect_nothing_written();
}

TEST_F(MesherImport, names_must_fit_the_files) {
  folder.write("rock.obj", kTetrahedron);
  EXPECT_EQ(run("import rock.obj --name boulder -o x.shape.h5").code, 0);
  EXPECT_EQ(shapes("x.shape.h5")[0].name, "boulder");
  EXPECT_EQ(run("import rock.obj rock.obj --name a --name b -o x.shape.h5").code, 0);
  const ToolRun same = run("import rock.obj rock.obj -o y.shape.h5");
  EXPECT_EQ(same.code, 2);
  EXPECT_SAYS(same.errors, "two shapes would be called 'rock'");
  EXPECT_EQ(run("import rock.obj rock.obj --name a -o y.shape.h5").code, 2);
}

TEST_F(MesherImport, wrong_units_and_scales_are_refused_with_exit_2) {
  folder.write("rock.obj", kTetrahedron);
  const ToolRun result = run("import rock.obj --unit kg -o x.shape.h5");
  EXPECT_EQ(result.code, 2);
  EXPECT_SAYS(result.errors, "a length");
  EXPECT_EQ(run("import rock.obj --scale 0 -o x.shape.h5").code, 2);
  EXPECT_EQ(run("import rock.obj --scale -1 -o x.shape.h5").code, 2);
  EXPECT_EQ(run("import rock.obj -o x.h5").code, 2);
}

TEST_F(MesherImport, a_diameter_sets_the_size_whatever_the_unit) {
  folder.write("rock.obj", kTetrahedron);
  const ToolRun result = run("import rock.obj --diameter \"20 mm\" -o x.shape.h5");
  ASSERT_EQ(result.code, 0) << result.errors;
  EXPECT_EQ(result.errors, "") << "no unit is missing";
  EXPECT_NEAR(shapes("x.shape.h5").at(0).equivalent_diameter(), 0.02, 1e-15);
  EXPECT_SAYS(run("import rock.obj --diameter \"20 mm\" --unit mm -o y.shape.h5").errors, "leave --unit and --scale out");
  EXPECT_SAYS(run("import rock.obj --diameter 0 -o y.shape.h5").errors, "expected a length > 0");
  EXPECT_SAYS(run("import rock.obj --diameter 2kg -o y.shape.h5").errors, "--diameter");
  EXPECT_EQ(run("import rock.obj --diameter 2cm --surface -o y.shape.h5").code, 2);
}

TEST_F(Mesher, without_a_unit_every_size_that_could_be_meant_is_reported) {
  folder.write("rock.obj", "v 0 0 0\nv 2 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 1 4 3\n");  // 2 mm, perhaps
  for (const char* command :
       {"check rock.obj", "import rock.obj -o x.shape.h5", "refine rock.obj --times 1 -o y.shape.h5", "describe rock.obj"}) {
    const ToolRun result = run(command);
    EXPECT_EQ(result.code, 0) << result.errors;
    EXPECT_SAYS(result.errors, "the longest side is 2 m; with --unit cm it is 20 mm, with --unit mm 2 mm, with --unit um 2 um");
    EXPECT_EQ(run(command + std::string(" --unit mm")).errors.find("--unit"), std::string::npos) << command;
  }
  EXPECT_NEAR(shapes("x.shape.h5")[0].mass.volume, 2e-9 / 6, 1e-22);
}

TEST_F(MesherImport, a_unit_that_the_file_states_is_taken_and_a_contradiction_reported) {
  folder.write("rock.dae", R"(<?xml version="1.0"?><COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1">
<asset><unit name="millimeter" meter="0.001"/><up_axis>Z_UP</up_axis></asset><library_geometries><geometry id="g"><mesh>
<source id="p"><float_array id="a" count="12">0 0 0 20 0 0 0 20 0 0 0 20</float_array><technique_common>
<accessor source="#a" count="4" stride="3"><param name="X" type="float"/><param name="Y" type="float"/><param name="Z" type="float"/></accessor>
</technique_common></source><vertices id="v"><input semantic="POSITION" source="#p"/></vertices>
<triangles count="4"><input semantic="VERTEX" source="#v" offset="0"/><p>0 2 1 0 1 3 1 2 3 0 3 2</p></triangles></mesh></geometry></library_geometries>
<library_visual_scenes><visual_scene id="s"><node id="n"><instance_geometry url="#g"/></node></visual_scene></library_visual_scenes>
<scene><instance_visual_scene url="#s"/></scene></COLLADA>)");
  const ToolRun stated = run("import rock.dae -o x.shape.h5");
  ASSERT_EQ(stated.code, 0) << stated.errors;
  EXPECT_NEAR(shapes("x.shape.h5")[0].mass.volume, 8e-6 / 6, 1e-11);
  EXPECT_EQ(stated.errors.find("--unit"), std::string::npos) << stated.errors;
  EXPECT_SAYS(stated.errors, "rounded to single precision by assimp");
  const ToolRun other = run("import rock.dae -o x.shape.h5 --unit mm");
  EXPECT_SAYS(other.errors, "the file states that its longest side is 20 mm; with --unit mm it is 20 um");
}

TEST_F(Mesher, repair_reports_the_hole_that_it_leaves_and_the_limit_that_closes_it) {
  folder.write("cup.off", kCup);  // its lid would be 17 % of what is there
  const ToolRun left = run("repair cup.off --unit cm -o cup.shape.h5 --largest-fill 0.1");
  EXPECT_EQ(left.code, 3);
  EXPECT_SAYS(left.output, "1 hole left open: all fillings together would make up 17.2 % of the area, above the limit of 10 %");
  EXPECT_EQ(left.output.find("nothing to repair"), std::string::npos);
  EXPECT_SAYS(left.errors, "close the holes that are left with --largest-fill 0.18");
  EXPECT_EQ(left.errors.find("'scree-mesher repair'"), std::string::npos) << left.errors;
  EXPECT_EQ(run("repair cup.off --unit cm -o cup.shape.h5 --largest-fill 0.18").code, 0);
  EXPECT_NEAR(shapes("cup.shape.h5").at(0).mass.volume, 1.2e-6, 1e-15);
}

TEST_F(Mesher, remesh_spans_the_opening_of_a_cup_and_keeps_what_it_encloses) {
  folder.write("cup.off", kCup);
  const ToolRun done = run("remesh cup.off --unit cm -o cup.shape.h5 --triangles 2000");
  ASSERT_EQ(done.code, 0) << done.errors;
  EXPECT_NEAR(shapes("cup.shape.h5").at(0).mass.volume, 1.2e-6, 0.05 * 1.2e-6);  // chamfered edges, and the lid's plane by sampling
}

TEST_F(Mesher, remesh_reports_a_change_of_volume_and_refuses_a_large_one) {
  ASSERT_EQ(run("generate box --size 10cm,10cm,5mm -o plate.shape.h5").code, 0);
  const ToolRun refused = run("remesh plate.shape.h5 -o x.shape.h5 --triangles 400");  // edges of 11 mm
  EXPECT_EQ(refused.code, 3);
  EXPECT_SAYS(refused.output, "area changed by");
  EXPECT_SAYS(refused.errors, "the volume of 'box' changed by -49 %: what is thinner than an edge of 11.27 mm can vanish");
  EXPECT_SAYS(refused.errors, "--largest-change 0.5");
  EXPECT_FALSE(exists("x.shape.h5"));
  const ToolRun allowed = run("remesh plate.shape.h5 -o x.shape.h5 --triangles 400 --largest-change 0.5");
  EXPECT_EQ(allowed.code, 0) << allowed.errors;
  EXPECT_SAYS(allowed.errors, "note: plate.shape.h5: the volume of 'box' changed by -49 %");
  EXPECT_EQ(run("remesh plate.shape.h5 -o x.shape.h5 --triangles 400 --largest-change -1").code, 2);
}

TEST_F(MesherGmsh, simplify_of_a_ring_that_remesh_broke_advises_more_triangles) {
  ASSERT_EQ(run("generate torus --radius 1cm --tube-radius 1mm -o ring.shape.h5").code, 0);
  const ToolRun refused = run("remesh ring.shape.h5 -o x.shape.h5 --triangles 300");  // edges of 1.8 mm
  EXPECT_EQ(refused.code, 3);
  EXPECT_SAYS(refused.errors, "1 component of 'torus' became");
  EXPECT_SAYS(refused.errors, "the volume of 'torus' changed by -");
  ASSERT_EQ(run("remesh ring.shape.h5 -o x.shape.h5 --triangles 300 --largest-change 0.9").code, 0);
  const ToolRun simplified = run("simplify x.shape.h5 -o y.shape.h5 --triangles 30");
  EXPECT_EQ(simplified.code, 3);
  EXPECT_SAYS(simplified.errors, "give more --triangles than 30");
  EXPECT_SAYS(simplified.errors, "make it again from the original with a smaller --edge-length");
  EXPECT_EQ(simplified.errors.find("unite the parts"), std::string::npos) << simplified.errors;
}

TEST_F(Mesher, an_stl_that_would_lose_the_shape_is_reported) {
  folder.write("near.obj", kTetrahedron);
  EXPECT_EQ(run("refine near.obj --unit m --times 1 -o near.stl").errors, "");
  folder.write("far.obj", "v 1e7 0 0\nv 10000001 0 0\nv 1e7 1 0\nv 1e7 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 1 4 3\n");
  const ToolRun lost = run("refine far.obj --unit m --times 1 -o far.stl");
  EXPECT_SAYS(lost.errors,
              "STL holds single precision, so that vertices of this mesh far from its origin moved by up to 0.5 of its extent");
  EXPECT_EQ(run("refine far.obj --unit m --times 1 -o far.ply").errors, "");
}

TEST_F(Mesher, missing_files_and_unknown_formats_are_told_apart) {
  EXPECT_EQ(run("check nowhere.stl").code, 4);
  folder.write("rock.xyz", "1 2 3\n");
  const ToolRun result = run("check rock.xyz");
  EXPECT_EQ(result.code, 2);
  EXPECT_SAYS(result.errors, ".bmf");
  folder.write("rock.bmf", "\x01");
  EXPECT_EQ(run("check rock.bmf").code, 3);
}

TEST_F(Mesher, misspelt_options_are_answered_with_the_nearest_one) {
  const ToolRun result = run("import rock.obj --sale 2 -o x.shape.h5");
  EXPECT_EQ(result.code, 2);
  EXPECT_SAYS(result.errors, "--scale");
  EXPECT_EQ(run("").code, 2);
  EXPECT_EQ(run("--help").code, 0);
  EXPECT_EQ(run("--version").code, 0);
}

TEST_F(MesherImport, the_hull_of_a_dented_cube_is_the_cube) {
  folder.write("dented.obj",
               "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 0 1\nv 1 0 1\nv 1 1 1\nv 0 1 1\nv 0.5 0.5 0.5\n"
               "f 1 3 2\nf 1 4 3\nf 1 2 6\nf 1 6 5\nf 2 3 7\nf 2 7 6\nf 3 4 8\nf 3 8 7\nf 4 1 5\nf 4 5 8\n"
               "f 5 6 9\nf 6 7 9\nf 7 8 9\nf 8 5 9\n");
  const ToolRun done = run("hull dented.obj -o cube.shape.h5 --unit m");
  ASSERT_EQ(done.code, 0) << done.errors;
  EXPECT_SAYS(done.output, "the hull of 14 triangles has 12, on 8 of 9 vertices");
  EXPECT_SAYS(done.output, "volume changed by +20 %");  // the dent is a pyramid of 1/6
  EXPECT_NEAR(shapes("cube.shape.h5").at(0).mass.volume, 1, 1e-14);
}

TEST_F(MesherImport, a_flat_sheet_has_no_hull) {
  folder.write("sheet.obj", "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3\nf 1 3 4\n");
  const ToolRun done = run("hull sheet.obj -o hull.shape.h5 --surface --unit m");
  EXPECT_EQ(done.code, 3);
  EXPECT_SAYS(done.errors, "lie in one plane");
  expect_nothing_written();
}

TEST_F(Mesher, a_box_has_twelve_triangles_and_its_exact_volume) {
  ASSERT_EQ(run("generate box --size '4 cm, 2cm, 0.01' -o x.shape.h5").code, 0);
  const Shape box = shapes("x.shape.h5")[0];
  EXPECT_EQ(box.name, "box");
  EXPECT_EQ(box.mesh.triangle_count(), 12);
  EXPECT_NEAR(box.mass.volume, 8e-6, 1e-18);
  EXPECT_LE(length(box.mass.principal_moments - 8e-6 / 12 * Vec3{5e-4, 17e-4, 20e-4}), 1e-20);
}

TEST_F(Mesher, a_stone_of_too_few_triangles_for_a_body_has_six_planes_and_a_notice) {
  const ToolRun few = run("generate stone --diameter '2 cm' --triangles 20 -o few.shape.h5");
  ASSERT_EQ(few.code, 0);
  EXPECT_SAYS(few.errors, "--triangles 20 is too few for a body: 6 planes cut it, the fewest, as with 48");
  const ToolRun enough = run("generate stone --diameter '2 cm' --triangles 48 -o enough.shape.h5");
  ASSERT_EQ(enough.code, 0);
  EXPECT_EQ(enough.errors.find("planes"), std::string::npos);
  EXPECT_EQ(shapes("few.shape.h5")[0].mesh.triangle_count(), shapes("enough.shape.h5")[0].mesh.triangle_count());
}

TEST_F(Mesher, an_analytic_sphere_has_no_triangles_and_the_volume_of_the_ball) {
  ASSERT_EQ(run("generate sphere --radius 5mm --analytic --name bead -o x.shape.h5").code, 0);
  const Shape ball = shapes("x.shape.h5")[0];
  EXPECT_EQ(ball.kind, ShapeKind::sphere);
  EXPECT_EQ(ball.name, "bead");
  EXPECT_NEAR(ball.mass.volume, 4.0 / 3 * std::numbers::pi * 125e-9, 1e-20);
}

TEST_F(MesherGmsh, a_generated_sphere_lies_on_the_ball_and_its_volume_converges_with_order_2) {
  double missing[2];
  for (int i = 0; i < 2; ++i) {
    const ToolRun result = run("generate sphere --radius 2 --edge-length " + std::string(i == 0 ? "0.4" : "0.2") + " -o x.shape.h5");
    ASSERT_EQ(result.code, 0) << result.errors;
    const Shape sphere = shapes("x.shape.h5")[0];
    missing[i] = 1 - sphere.mass.volume / (4.0 / 3 * std::numbers::pi * 8);
    for (const Vec3& p : sphere.mesh.vertices) EXPECT_NEAR(length(p + sphere.origin_shift), 2, 1e-14);
  }
  EXPECT_GT(missing[1], 0);
  EXPECT_NEAR(std::log2(missing[0] / missing[1]), 2,
              0.2);  // unstructured meshes: edges are not exactly halved
}

TEST_F(MesherGmsh, a_generated_cylinder_is_a_convex_prism) {
  ASSERT_EQ(run("generate cylinder --radius 5mm --height 2cm -o x.shape.h5").code, 0);
  const Shape cylinder = shapes("x.shape.h5")[0];
  const FeatureTable features = find_features(cylinder.mesh);
  const std::size_t n = features.corners.size() / 2;  // sides of the prism
  EXPECT_GT(n, 12U);
  EXPECT_EQ(features.edges.size(), 3 * n);
  EXPECT_EQ(static_cast<std::size_t>(features.region_count), n + 2);
  for (std::size_t t = 0; t < cylinder.mesh.triangles.size(); ++t) {
    for (std::size_t k = 0; k < 3; ++k) EXPECT_NE(features.edge_kind(t, k), EdgeKind::concave);
  }
  const double sides = static_cast<double>(n), area = 0.5 * sides * 25e-6 * std::sin(2 * std::numbers::pi / sides);
  EXPECT_NEAR(cylinder.mass.volume, area * 0.02, 1e-9 * area * 0.02);  // regular polygon times height
}

TEST_F(MesherGmsh, a_finely_meshed_box_keeps_8_corners_and_12_edges) {
  ASSERT_EQ(run("generate box --size 4cm,2cm,1cm --edge-length 5mm -o x.shape.h5").code, 0);
  const Shape box = shapes("x.shape.h5")[0];
  EXPECT_GT(box.mesh.triangle_count(), 100);
  EXPECT_EQ(find_features(box.mesh).corners.size(), 8U);
  EXPECT_EQ(find_features(box.mesh).edges.size(), 12U);
  EXPECT_NEAR(box.mass.volume, 8e-6, 1e-17);
}

TEST_F(MesherGmsh, generating_twice_gives_the_same_mesh) {
  ASSERT_EQ(run("generate sphere --radius 1cm -o a.shape.h5").code, 0);
  ASSERT_EQ(run("generate sphere --radius 1cm -o b.shape.h5").code, 0);
  const Shape a = shapes("a.shape.h5")[0], b = shapes("b.shape.h5")[0];
  EXPECT_EQ(a.mesh.vertices, b.mesh.vertices);
  EXPECT_EQ(a.mesh.triangles, b.mesh.triangles);
}

TEST_F(Mesher, wrong_sizes_are_refused_with_exit_2) {
  for (const char* arguments :
       {"sphere", "sphere --radius 0", "sphere --radius '5 kg'", "sphere --radius 1 --height 2", "box", "box --size 1,2",
        "box --size 1,2,-3", "cylinder --radius 1", "cone --radius 1", "sphere --radius 1 --edge-length 1e-5"}) {
    const ToolRun result = run("generate " + std::string(arguments) + " -o x.shape.h5");
    EXPECT_EQ(result.code, 2) << arguments << "\n" << result.errors;
  }
  expect_nothing_written();
}

TEST_F(Mesher, pressed_shapes_say_what_is_wrong_with_their_sizes) {
  struct Case {
    const char* arguments;
    const char* says;
  };
  for (const Case& c :
       {Case{"tablet --radius 4mm --height 3mm", "--cup is missing"},
        {"tablet --radius 4mm --height 3mm --cup 5mm", "a cap deeper than the radius"},
        {"tablet --radius 4mm --height 3mm --cup 1mm --bevel 4mm", "no flat face is left"},
        {"tablet --radius 4mm --height 3mm --cup 1mm --holes 3", "--holes has no meaning"},
        {"hollow_cylinder --radius 5mm --height 1cm", "no hole"},
        {"hollow_cylinder --radius 5mm --height 1cm --inner-radius 6mm", "reaches the rim"},
        {"hollow_cylinder --radius 5mm --height 1cm --holes 1 --hole-radius 1mm", "from 2 to 100"},
        {"hollow_cylinder --radius 5mm --height 1cm --holes 6 --hole-radius 2mm", "the holes meet each other"},
        {"hollow_cylinder --radius 5mm --height 1cm --inner-radius 1mm --hole-radius 1mm", "give their number with --holes"},
        {"lobes --radius 1mm --height 5mm", "--lobes 0: expected from 2"},
        {"lobes --radius 1mm --height 5mm --lobes 4 --spread 2mm", "do not overlap"},
        {"screw --radius 5cm --height 20cm --shaft-radius 2cm --thickness 5mm", "--pitch is missing"},
        {"screw --radius 5cm --height 20cm --shaft-radius 6cm --thickness 5mm --pitch 5cm", "as wide as the flights"},
        {"screw --radius 5cm --height 20cm --shaft-radius 2cm --thickness 3cm --pitch 5cm --starts 2", "leave no room"},
        {"screw --radius 5cm --height 20m --shaft-radius 2cm --thickness 1mm --pitch 1cm --edge-length 1mm", "triangles, more than"},
        {"paddle_wheel --radius 5cm --height 20cm --shaft-radius 2cm --thickness 5mm", "--blades 0: expected from 1"},
        {"paddle_wheel --radius 5cm --height 20cm --shaft-radius 2cm --thickness 5cm --blades 2", "thicker than the shaft"},
        {"paddle_wheel --radius 5cm --height 20cm --shaft-radius 2cm --thickness 5mm --blades 2 --pitch 1", "--pitch has no meaning"},
        {"sleeper --size 2,1,1 --edge-length 1", "--edge-length has no meaning"},
        {"cylinder --radius 1 --height 1 --starts 2", "are for screws"},
        {"box --size 1,1,1 --spread 1", "--spread has no meaning"}}) {
    const ToolRun result = run("generate " + std::string(c.arguments) + " -o x.shape.h5");
    EXPECT_EQ(result.code, 2) << c.arguments;
    EXPECT_SAYS(result.errors, c.says);
  }
  expect_nothing_written();
}

TEST_F(Mesher, pressed_shapes_are_solids_near_their_closed_forms) {
  struct Case {
    const char* arguments;
    double volume;
  };
  const double pi = std::numbers::pi;
  for (const Case& c : {Case{"tablet --radius 5mm --height 3mm --cup 1mm", pi * (25e-9 * 3 + 1e-9 * (75 + 1) / 3)},
                        {"hollow_cylinder --radius 5mm --height 1cm --inner-radius 4mm", pi * 9e-6 * 1e-2},
                        {"hollow_cylinder --radius 8mm --height 1cm --inner-radius 2mm --holes 6 --hole-radius 1.5mm",
                         pi * (64e-6 - 4e-6 - 6 * 2.25e-6) * 1e-2},
                        {"sleeper --size 26mm,3mm,2mm --top-width 2.5mm", 26e-3 * 2.75e-3 * 2e-3},
                        {"screw --radius 3mm --height 9mm --shaft-radius 1mm --pitch 4mm --thickness 0.5mm --starts 2 --left-handed",
                         pi * (1e-6 + 8e-6 * 0.25) * 9e-3},
                        {"lobes --lobes 2 --radius 1mm --spread 0.9mm --height 5mm",  // two discs less their lens
                         (2 * pi - 2 * std::acos(0.9) + 1.8 * std::sqrt(0.19)) * 1e-6 * 5e-3}}) {
    const std::string fine = std::string(c.arguments).starts_with("sleeper") ? "" : " --edge-length 0.1mm";
    ASSERT_EQ(run("generate " + std::string(c.arguments) + fine + " -o x.shape.h5").code, 0) << c.arguments;
    EXPECT_NEAR(shapes("x.shape.h5")[0].mass.volume / c.volume, 1, 3e-3) << c.arguments;
  }
}

TEST_F(Mesher, info_shows_every_shape_and_where_it_comes_from) {
  ASSERT_EQ(run("generate box --size 3,2,1 --name brick -o x.shape.h5").code, 0);
  const ToolRun result = run("info x.shape.h5");
  EXPECT_EQ(result.code, 0) << result.errors;
  EXPECT_SAYS(result.output, "brick");
  EXPECT_SAYS(result.output, "solid");
  EXPECT_SAYS(result.output, "watertight, outward");
  EXPECT_SAYS(result.output, "generate box --size \"3,2,1\"");
  folder.write("not.shape.h5", "not HDF5");
  EXPECT_EQ(run("info not.shape.h5").code, 3);
}

TEST_F(Mesher, describe_tells_shapes_of_one_name_apart_by_their_files) {
  ASSERT_EQ(run("generate box --size 3,2,1 --name brick -o a.shape.h5").code, 0);
  ASSERT_EQ(run("generate box --size 4,2,1 --name brick -o b.shape.h5").code, 0);
  const std::string text = run("describe a.shape.h5 b.shape.h5").output;
  EXPECT_SAYS(text, "brick (a.shape.h5)");
  EXPECT_SAYS(text, "brick (b.shape.h5)");
  EXPECT_EQ(run("describe a.shape.h5").output.find("(a.shape.h5)"), std::string::npos);
}

TEST_F(Mesher, describe_says_why_no_file_holds_a_solid) {
  folder.write("comma.obj", "v 0,5 0 0\n");
  folder.write("word.obj", "v 0 zero 0\n");
  const ToolRun one = run("describe comma.obj"), both = run("describe comma.obj word.obj");
  EXPECT_EQ(one.code, 3);
  EXPECT_SAYS(one.errors, "the file holds no solid: comma.obj");
  EXPECT_SAYS(one.errors, "line 1: '0,5' is no number");
  EXPECT_SAYS(both.errors, "the 2 files hold no solid");
  EXPECT_SAYS(both.errors, "line 1: '0,5' is no number");
  EXPECT_SAYS(both.errors, "line 1: 'zero' is no number");
}

TEST_F(Mesher, a_number_given_as_a_unit_is_answered_with_the_option_for_numbers) {
  folder.write("rock.obj", "v 0 0 0\nv 2 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 1 4 3\n");
  const ToolRun result = run("import rock.obj --unit \"2.5 mm\" -o x.shape.h5");
  EXPECT_EQ(result.code, 2);
  EXPECT_SAYS(result.errors, "expected the name of a unit, such as mm");
  EXPECT_SAYS(result.errors, "--scale");
}

TEST_F(Mesher, info_says_that_triangles_of_a_solid_cross) {
  TriangleMesh mesh = test::icosphere(2);
  mesh.vertices[0] = -1.2 * mesh.vertices[0];  // through the opposite side
  std::string text;
  for (const Vec3& p : mesh.vertices) text += fmt::format("v {} {} {}\n", p.x, p.y, p.z);
  for (const Triangle& t : mesh.triangles) text += fmt::format("f {} {} {}\n", t[0] + 1, t[1] + 1, t[2] + 1);
  folder.write("spike.obj", text);
  ASSERT_EQ(run("import spike.obj -o spike.shape.h5").code, 0);
  EXPECT_SAYS(run("info spike.shape.h5").output, "through or touch each other");
}

TEST_F(Mesher, a_part_within_another_one_that_is_to_stand_alone_faces_outward) {
  std::string text;
  for (const double half : {1.0, 0.5})
    for (int k = 0; k < 8; ++k) text += fmt::format("v {} {} {}\n", k & 1 ? half : -half, k & 2 ? half : -half, k & 4 ? half : -half);
  for (const int first : {1, 9}) {  // both outward
    const int quads[6][4] = {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}};
    for (const auto& q : quads) {
      text += fmt::format("f {} {} {}\n", q[0] + first, q[1] + first, q[2] + first);
      text += fmt::format("f {} {} {}\n", q[0] + first, q[2] + first, q[3] + first);
    }
  }
  folder.write("nest.obj", text);
  ASSERT_EQ(run("repair nest.obj --unit m -o both.shape.h5").code, 0);
  EXPECT_NEAR(shapes("both.shape.h5")[0].mass.volume, 7, 1e-13);  // a cavity
  ASSERT_EQ(run("repair nest.obj --unit m --separate -o parts.shape.h5").code, 0);
  EXPECT_NEAR(shapes("parts.shape.h5")[0].mass.volume, 8, 1e-13);
  EXPECT_NEAR(shapes("parts.shape.h5")[1].mass.volume, 1, 1e-13);
  ASSERT_EQ(run("repair nest.obj --unit m --component 2 -o inner.shape.h5").code, 0);
  EXPECT_NEAR(shapes("inner.shape.h5")[0].mass.volume, 1, 1e-13);
}

TEST_F(Mesher, pieces_that_are_edited_say_what_they_lose) {
  folder.write("points.csv", "x,y,z\n-0.3,0.01,0.02\n0.3,0.02,0.01\n");
  ASSERT_EQ(run("generate box --size '1, 1, 1' -o box.shape.h5").code, 0);
  ASSERT_EQ(run("fracture box.shape.h5 --points points.csv --inset '5 cm' -o pieces.shape.h5").code, 0);
  const ToolRun refined = run("refine pieces.shape.h5 --edge-length 0.5 -o fine.shape.h5");
  EXPECT_EQ(refined.code, 0);
  EXPECT_SAYS(refined.errors, "no table of shared faces");
  EXPECT_SAYS(refined.errors, "lie back by 50 mm: 0.9 m^3 in all, 1 before");
  EXPECT_NEAR(shapes("fine.shape.h5")[0].mass.volume + shapes("fine.shape.h5")[1].mass.volume, 0.9, 2e-3);  // the face is a little oblique
  const ToolRun moved = run("fracture box.shape.h5 --points points.csv --evenly -o even.shape.h5");
  EXPECT_EQ(moved.code, 2);
  EXPECT_SAYS(moved.errors, "leave one of both out");
}

}  // namespace
}  // namespace scree
