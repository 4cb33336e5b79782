// What ParaView and the picture show, against positions and areas in closed form.
#include <gtest/gtest.h>
#include <vtkCellData.h>
#include <vtkDataArray.h>
#include <vtkImageData.h>
#include <vtkNew.h>
#include <vtkPNGReader.h>
#include <vtkPointData.h>
#include <vtkPolyData.h>
#include <vtkXMLPolyDataReader.h>

#include <cstdlib>
#include <optional>
#include <sstream>

#include "core/picture/display.hpp"
#include "core/picture/picture.hpp"
#include "post/run/drawn_meshes.hpp"
#include "post/vtk/paraview.hpp"
#include "post/vtk/picture.hpp"
#include "tests/post/sample_run.hpp"

namespace scree {
namespace {

namespace fs = std::filesystem;

fs::path sample(const std::string& name) {
  const fs::path folder = fs::path(SCREE_TEST_FOLDER) / name / "sample.run";
  test::write_sample_run(folder);
  return folder;
}

vtkSmartPointer<vtkPolyData> read_vtp(const fs::path& path) {
  vtkNew<vtkXMLPolyDataReader> reader;
  reader->SetFileName(path.c_str());
  reader->Update();
  return reader->GetOutput();
}

TEST(VtkFiles, any_part_of_any_frame_is_written_with_its_times_by_any_number_of_processes) {
  const fs::path folder = sample("vtk_part");
  const auto run = open_run(folder.string());
  for (const int jobs : {1, 2}) {
    VtkOptions options;
    options.folder = (folder / fmt::format("vtk{}", jobs)).string();
    options.kinds = {"bodies", "contacts", "network", "walls", "surfaces"};
    options.frames = {1, 2};
    options.bodies.ids = {"3-6"};
    options.pool = {jobs, false};
    const VtkResult result = write_vtk_files(run, options);
    EXPECT_EQ(result.frames, 2u);
    EXPECT_EQ(result.lists.size(), 5u);
    std::ifstream list(fs::path(options.folder) / "network.pvd");
    const std::string text((std::istreambuf_iterator<char>(list)), std::istreambuf_iterator<char>());
    EXPECT_NE(text.find("timestep=\"0.2\" part=\"0\" file=\"network_000002.vtp\""), std::string::npos) << text;
    EXPECT_FALSE(fs::exists(fs::path(options.folder) / "network_000000.vtp"));

    const Frame frame = load_frame(run, 2);
    const auto bodies = read_vtp(fs::path(options.folder) / "bodies_000002.vtp");
    ASSERT_EQ(bodies->GetNumberOfPoints(), 4);
    EXPECT_EQ(bodies->GetPointData()->GetArray("id")->GetComponent(1, 0), 4);
    EXPECT_NEAR(bodies->GetPointData()->GetArray("quat")->GetComponent(1, 3), frame.bodies.orientation[4].z, 1e-7);
    const auto contacts = read_vtp(fs::path(options.folder) / "contacts_000002.vtp");
    ASSERT_EQ(contacts->GetNumberOfPoints(), 3);  // 3-4, 4-5, 5-6
    EXPECT_EQ(contacts->GetPointData()->GetArray("normal_force")->GetComponent(0, 0), 4);
    const auto network = read_vtp(fs::path(options.folder) / "network_000002.vtp");
    ASSERT_EQ(network->GetNumberOfLines(), 3);
    double end[3];
    network->GetPoint(1, end);
    EXPECT_LT(length(Vec3{end[0], end[1], end[2]} - frame.bodies.position[4]), 1e-7);
  }
}

TEST(ParaviewFiles, every_triangle_is_where_its_bodys_transform_puts_it) {
  const fs::path folder = sample("surfaces");
  const auto run = open_run(folder.string());
  const ParaviewResult result = write_paraview_files(run, {});
  EXPECT_EQ(result.surface_frames, 3u);
  const auto data = read_vtp(folder / "paraview" / "frame_000002.vtp");
  const Frame frame = test::sample_frame(test::sample_scene(12), 2, 0.2);
  vtkDataArray* id = data->GetCellData()->GetArray("id");
  ASSERT_NE(id, nullptr);
  vtkIdType cell = 0;
  for (std::size_t i = 0; i < frame.bodies.size(); ++i) {
    const TriangleMesh mesh = drawn_shape(run.scene.shapes[static_cast<std::size_t>(frame.bodies.shape[i])]).mesh;
    for (const Triangle& t : mesh.triangles) {
      ASSERT_LT(cell, data->GetNumberOfCells());
      EXPECT_EQ(id->GetComponent(cell, 0), static_cast<double>(i));
      for (int k = 0; k < 3; ++k) {
        // rotation by the matrix, not by rotate(): two ways must agree
        const Vec3 v = mesh.vertices[static_cast<std::size_t>(t[static_cast<std::size_t>(k)])];
        const Vec3 expected = frame.bodies.position[i] + matrix_of(frame.bodies.orientation[i]) * (frame.bodies.scale[i] * v);
        double p[3];
        data->GetPoint(data->GetCell(cell)->GetPointId(k), p);
        EXPECT_LT(length(Vec3{p[0], p[1], p[2]} - expected), 1e-7) << "float32 at 0.5 m has 3e-8";
      }
      ++cell;
    }
  }
  EXPECT_EQ(cell, data->GetNumberOfCells());
}

TEST(ParaviewFiles, a_driven_wall_moves_and_the_times_are_listed) {
  const fs::path folder = sample("walls");
  write_paraview_files(open_run(folder.string()), {});
  double lowest[2];
  for (int f = 0; f < 2; ++f) {
    const auto data = read_vtp(folder / "paraview" / fmt::format("walls_{:06}.vtp", 2 * f));
    vtkDataArray* wall = data->GetCellData()->GetArray("wall");
    for (vtkIdType c = 0; c < data->GetNumberOfCells(); ++c) {
      double p[3];
      data->GetPoint(data->GetCell(c)->GetPointId(0), p);
      if (wall->GetComponent(c, 0) == 13) lowest[f] = p[2];
    }
  }
  EXPECT_NEAR(lowest[0], 0.4, 1e-7);
  EXPECT_NEAR(lowest[1], 0.38, 1e-7);  // 0.1 m/s downward for 0.2 s
  std::stringstream text;
  text << std::ifstream(folder / "paraview" / "sample.pvd").rdbuf();
  EXPECT_NE(text.str().find("timestep=\"0.2\" part=\"0\" file=\"frame_000002.vtp\""), std::string::npos) << text.str();
}

TEST(ParaviewFiles, the_script_names_its_run_relative_to_itself) {
  const fs::path folder = sample("script");
  const fs::path elsewhere = folder.parent_path() / "elsewhere";
  write_paraview_files(open_run(folder.string()), {elsewhere.string(), "none"});
  std::stringstream text;
  text << std::ifstream(elsewhere / "open_in_paraview.py").rdbuf();
  EXPECT_NE(text.str().find("RUN = \"../sample.run\""), std::string::npos);
  EXPECT_FALSE(fs::exists(elsewhere / "frame_000000.vtp"));
  EXPECT_TRUE(fs::exists(elsewhere / "shape_2.vtp"));
}

/// Sets or removes a variable of this process for as long as it lives.
class Variable {
 public:
  Variable(const char* name, const char* value) : name_(name) {
    if (const char* old = std::getenv(name)) kept_ = old;
    set(value);
  }
  ~Variable() { set(kept_ ? kept_->c_str() : nullptr); }
  Variable(const Variable&) = delete;
  Variable& operator=(const Variable&) = delete;

 private:
  void set(const char* value) {
    if (value != nullptr)
      setenv(name_, value, 1);
    else
      unsetenv(name_);
  }
  const char* name_;
  std::optional<std::string> kept_;
};

TEST(Picture, says_what_to_do_without_a_display) {
  const Variable path("PATH", "/nowhere");
  const Variable authority("XAUTHORITY", nullptr);
  {
    const Variable display("DISPLAY", nullptr);
    EXPECT_NE(display_obstacle().find("DISPLAY is not set"), std::string::npos) << display_obstacle();
    EXPECT_NE(display_obstacle().find("install the package xvfb"), std::string::npos) << display_obstacle();
  }
  const Variable display("DISPLAY", ":4095");
  EXPECT_NE(display_obstacle().find("the X display :4095 does not answer"), std::string::npos) << display_obstacle();
  EXPECT_THROW(draw_picture(open_run(sample("no_display").string()), 0, "never.png", {}), SystemError);
}

// A ball fills the part of the picture that perspective says.
TEST(Picture, a_ball_is_as_large_as_perspective_makes_it) {
  if (const std::string reason = display_obstacle(); !reason.empty()) GTEST_SKIP() << reason;
  const fs::path folder = fs::path(SCREE_TEST_FOLDER) / "ball" / "ball.run";
  fs::remove_all(folder);
  fs::create_directories(folder);
  Scene scene = test::sample_scene(3);
  scene.walls.clear();
  const Frame three = test::sample_frame(scene, 0, 0);
  Frame frame;
  frame.bodies = three.bodies;
  for (auto* list : {&frame.bodies.shape, &frame.bodies.material, &frame.bodies.rank}) list->erase(list->begin(), list->begin() + 2);
  frame.bodies.id.erase(frame.bodies.id.begin(), frame.bodies.id.begin() + 2);
  frame.bodies.scale = {2};
  frame.bodies.position = {{5, -3, 2}};
  frame.bodies.orientation = {Quat{}};
  frame.bodies.velocity = frame.bodies.angular_velocity = {Vec3{}};
  write_scene_file((folder / "scene.h5").string(), scene);
  write_frame_file(MPI_COMM_SELF, (folder / "frame_000000.hdf").string(), frame);
  write_frame_series(folder.string(), {{(folder / "frame_000000.hdf").string(), 0}});
  const std::string png = (folder / "ball.png").string();
  PictureOptions options;
  options.width = options.height = 400;
  draw_picture(open_run(folder.string()), 0, png, options);

  vtkNew<vtkPNGReader> reader;
  reader->SetFileName(png.c_str());
  reader->Update();
  vtkDataArray* pixels = reader->GetOutput()->GetPointData()->GetScalars();
  int covered = 0;
  for (vtkIdType i = 0; i < pixels->GetNumberOfTuples(); ++i) covered += pixels->GetComponent(i, 0) < 250 ? 1 : 0;
  // room: the cube about the ball; its half diagonal is r sqrt 3, and the camera stands 3.55 of those away
  const double sine = 1 / (3.55 * std::sqrt(3.0)), tangent = sine / std::sqrt(1 - sine * sine);
  const double radius = 200 * tangent / std::tan(15 * std::numbers::pi / 180);
  // 320 triangles inscribed in the ball lose up to 3 % of its silhouette
  EXPECT_NEAR(covered / (std::numbers::pi * radius * radius), 0.985, 0.02);
}

}  // namespace
}  // namespace scree
