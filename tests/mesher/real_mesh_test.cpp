// Meshes that nobody here made, from Debian packages. Volumes from independent files of the same bodies
// (Stellarium's models, measured once) or from the packages' own description.
#include <gtest/gtest.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <ostream>

#include "core/storage/shape_file.hpp"
#include "mesher/io/mesh_file.hpp"
#include "tests/mesher/tool_run.hpp"

namespace scree {
namespace {

using test::Folder;
using test::ToolRun;

#define NEEDS_FILE(path, package) \
  if (!std::filesystem::exists(path)) GTEST_SKIP() << path << " is missing: apt-get install " << (package)

const std::string kOpenuniverse = "/usr/share/openuniverse/3dmodels/";

TEST(RealMeshes, the_sixteen_small_bodies_of_openuniverse_are_watertight) {
  NEEDS_FILE(kOpenuniverse + "ida.bmf", "openuniverse-common");
  const char* const names[] = {"amalthea", "bacchus", "castalia", "deimos", "epimetheus", "gaspra",  "geographos", "hyperion",
                               "ida",      "janus",   "ky",       "phobos", "prometheus", "proteus", "toutatis",   "vesta"};
  const Folder folder;
  std::string arguments = "import --unit km -o all.shape.h5";
  for (const char* name : names) arguments += " " + kOpenuniverse + name + ".bmf";
  const ToolRun result = folder.mesher(arguments);
  ASSERT_EQ(result.code, 0) << result.errors;
  const std::vector<Shape> shapes = read_shape_file(folder / "all.shape.h5").shapes;
  ASSERT_EQ(shapes.size(), 16U);
  for (std::size_t i = 0; i < shapes.size(); ++i) {
    const bool is_deimos = shapes[i].name == "deimos";
    EXPECT_EQ(shapes[i].name, names[i]);
    EXPECT_EQ(shapes[i].mesh.vertex_count(), is_deimos ? 497 : 502);
    EXPECT_EQ(shapes[i].mesh.triangle_count(), is_deimos ? 990 : 1000);
    EXPECT_EQ((*shapes[i].verdict)["boundary_edges"], 0);
    EXPECT_EQ((*shapes[i].verdict)["euler_characteristic"], 2);
    EXPECT_EQ((*shapes[i].verdict)["solid"], true);
  }
  // km^3: Stellarium's models of the same bodies have 849.5, 5750, 1014 and 15753; both come from the same
  // surveys
  const auto volume = [&](const std::string& name) {
    return 1e-9 * std::find_if(shapes.begin(), shapes.end(), [&](const Shape& s) { return s.name == name; })->mass.volume;
  };
  EXPECT_NEAR(volume("gaspra"), 849.5, 0.001 * 849.5);
  EXPECT_NEAR(volume("phobos"), 5750, 0.005 * 5750);
  EXPECT_NEAR(volume("deimos"), 1014, 0.005 * 1014);
  EXPECT_NEAR(volume("ida"), 15753, 0.005 * 15753);
}

TEST(RealMeshes, a_space_probe_of_several_parts_is_refused_as_bmf) {
  NEEDS_FILE(kOpenuniverse + "hst.bmf", "openuniverse-common");
  const Folder folder;
  const ToolRun result = folder.mesher("check " + kOpenuniverse + "hst.bmf");
  EXPECT_EQ(result.code, 3);
  EXPECT_NE(result.errors.find("only BMF files of one object"), std::string::npos) << result.errors;
}

TEST(RealMeshes, a_step_file_of_a_linkage_becomes_a_solid_of_genus_two) {
  const std::string path = "/usr/share/opencascade/data/step/linkrods.step";
  NEEDS_FILE(path, "occt-misc");
  const std::vector<std::string> known = known_extensions();
  if (std::find(known.begin(), known.end(), ".step") == known.end()) GTEST_SKIP() << "this build has no gmsh";
  const Folder folder;
  const ToolRun result = folder.mesher("import " + path + " --unit mm -o x.shape.h5");
  ASSERT_EQ(result.code, 0) << result.errors;
  const Shape shape = read_shape_file(folder / "x.shape.h5").shapes.at(0);
  EXPECT_EQ((*shape.verdict)["euler_characteristic"], -2);
  EXPECT_NEAR(shape.mass.volume * 1e9, 3.847, 0.1);  // of the CAD model, by OpenCASCADE; facets of round parts cut corners
}

struct Model {
  const char* name;
  const char* path;
  const char* package;
  int triangles;  // as the packages' files hold them
};

/// Keeps addresses out of the test names.
void PrintTo(const Model& model, std::ostream* stream) { *stream << model.path; }

class RealSolids : public testing::TestWithParam<Model> {};

TEST_P(RealSolids, are_watertight) {
  const Model& model = GetParam();
  if (assimp_version().empty()) GTEST_SKIP() << "this build has no assimp";
  NEEDS_FILE(model.path, model.package);
  const Folder folder;
  const ToolRun result = folder.mesher(std::string("import ") + model.path + " -o x.shape.h5");
  ASSERT_EQ(result.code, 0) << result.errors;
  const Shape shape = read_shape_file(folder / "x.shape.h5").shapes.at(0);
  EXPECT_EQ(shape.mesh.triangle_count(), model.triangles);
  EXPECT_GT(shape.mass.volume, 0);
}

INSTANTIATE_TEST_SUITE_P(Packages, RealSolids,
                         testing::Values(Model{"fels", "/usr/share/assimp/models/3DS/fels.3ds", "assimp-testmodels", 768},
                                         Model{"asteroid_low", "/usr/share/glmark2/models/asteroid-low.3ds", "glmark2-data", 480},
                                         Model{"asteroid_high", "/usr/share/glmark2/models/asteroid-high.3ds", "glmark2-data", 48000},
                                         Model{"duck", "/usr/share/assimp/models/Collada/duck.dae", "assimp-testmodels", 4212},
                                         Model{"bunny", "/usr/share/glmark2/models/bunny.obj", "glmark2-data", 69666}),
                         [](const testing::TestParamInfo<Model>& model) { return model.param.name; });

class RealOpenMeshes : public testing::TestWithParam<Model> {};

TEST_P(RealOpenMeshes, are_refused_as_solids_and_taken_as_surfaces) {
  const Model& model = GetParam();
  if (assimp_version().empty()) GTEST_SKIP() << "this build has no assimp";
  NEEDS_FILE(model.path, model.package);
  const Folder folder;
  const ToolRun refused = folder.mesher(std::string("import ") + model.path + " -o x.shape.h5");
  EXPECT_EQ(refused.code, 3);
  EXPECT_NE(refused.errors.find("the mesh is open"), std::string::npos) << refused.errors;
  EXPECT_EQ(folder.mesher(std::string("import ") + model.path + " --surface -o x.shape.h5").code, 0);
}

INSTANTIATE_TEST_SUITE_P(Packages, RealOpenMeshes,
                         testing::Values(Model{"spider_obj", "/usr/share/assimp/models/OBJ/spider.obj", "assimp-testmodels", 0},
                                         Model{"wuson_ply", "/usr/share/assimp/models/PLY/Wuson.ply", "assimp-testmodels", 0},
                                         Model{"wuson_stl", "/usr/share/assimp/models/STL/Wuson.stl", "assimp-testmodels", 0},
                                         Model{"cat", "/usr/share/glmark2/models/cat.3ds", "glmark2-data", 0}),
                         [](const testing::TestParamInfo<Model>& model) { return model.param.name; });

}  // namespace
}  // namespace scree
