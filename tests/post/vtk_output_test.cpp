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
#include "post/run/bonds_in_frame.hpp"
#include "post/run/drawn_meshes.hpp"
#include "post/vtk/legend_ticks.hpp"
#include "post/vtk/paraview.hpp"
#include "post/vtk/picture.hpp"
#include "post/vtk/vtk_files.hpp"
#include "post/vtk/vtk_threads.hpp"
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
    // threads that VTK has started are not in the processes that share the frames, which would wait for them
    EXPECT_FALSE(vtk_has_threads());
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

TEST(ParaviewFiles, surfaces_that_would_fill_a_disk_are_left_to_glyphs_unless_asked_for) {
  EXPECT_EQ(expanded_frames(1e6, 200), "all");
  EXPECT_EQ(expanded_frames(1e6, 201), "last");
  EXPECT_EQ(expanded_frames(16000320, 51), "last");  // the balls of workflows/impact: 12 GB
  EXPECT_EQ(expanded_frames(2.1e8, 1), "none");
  const fs::path folder = sample("surfaces_of_the_last");
  ParaviewOptions options;
  options.surfaces = "last";
  EXPECT_EQ(write_paraview_files(open_run(folder.string()), options).surface_frames, 1u);
  EXPECT_FALSE(fs::exists(folder / "paraview" / "frame_000000.vtp"));
  EXPECT_TRUE(fs::exists(folder / "paraview" / "frame_000002.vtp"));
  EXPECT_TRUE(fs::exists(folder / "paraview" / "open_in_paraview.py"));
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

TEST(VtkFiles, faces_of_bonds_and_fragments_are_written_with_what_they_bear) {
  const fs::path folder = sample("bonds");
  scree::Run run = open_run(folder.string());
  Frame frame = load_frame(run, 0);
  for (const std::int64_t a : {0, 1}) {  // 0-1-2
    Bond bond;
    bond.a = a;
    bond.b = a + 1;
    bond.area = 4e-6;
    bond.moment_1 = bond.moment_2 = 4e-6 * 4e-6 / 12;
    run.scene.bonds.push_back(bond);
  }
  frame.bonds.bond = {1};  // 0 broke off
  frame.bonds.force = {rotate(frame.bodies.orientation[1], Vec3{8, 0, 2})};
  frame.bonds.energy = {1e-3};
  frame.bonds.load = {0.5};
  write_bonds_vtp((folder / "bonds.vtp").string(), frame, run.scene);
  const auto faces = read_vtp(folder / "bonds.vtp");
  ASSERT_EQ(faces->GetNumberOfCells(), 1);
  ASSERT_EQ(faces->GetNumberOfPoints(), 4);
  const auto cell = [&](const char* name) { return faces->GetCellData()->GetArray(name)->GetComponent(0, 0); };
  EXPECT_EQ(cell("body_a"), 1);
  EXPECT_EQ(cell("body_b"), 2);
  EXPECT_NEAR(cell("normal_stress"), 2e6, 1);
  EXPECT_NEAR(cell("shear_stress"), 0.5e6, 1);
  EXPECT_EQ(cell("load"), 0.5);
  const std::vector<Vec3> ways = ways_apart(run.scene, frame);
  EXPECT_GT(length(ways[1]), 0);
  std::vector<DrawnMesh> shapes;
  for (const Shape& shape : run.scene.shapes) shapes.push_back(drawn_shape(shape));
  write_surfaces_vtp((folder / "surfaces.vtp").string(), frame, run.scene, shapes);
  const auto surfaces = read_vtp(folder / "surfaces.vtp");
  vtkDataArray *id = surfaces->GetCellData()->GetArray("id"), *fragment = surfaces->GetCellData()->GetArray("fragment");
  for (vtkIdType c = 0; c < surfaces->GetNumberOfCells(); ++c) {
    const double body = id->GetComponent(c, 0);
    ASSERT_EQ(fragment->GetComponent(c, 0), body > 2 ? -1 : std::min(body, 1.0));
    const vtkIdType point = surfaces->GetCell(c)->GetPointId(0);
    for (int k = 0; k < 3; ++k)
      ASSERT_NEAR(surfaces->GetPointData()->GetArray("apart")->GetComponent(point, k), ways[static_cast<std::size_t>(body)][k], 1e-7);
  }
  const std::string script = paraview_script(run, "..", "here", {});
  EXPECT_NE(script.find("BONDED = [0, 1, 2]"), std::string::npos);
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

// Balls of radius 3 cm at given places in each frame, without walls unless given.
struct Balls {
  std::vector<std::vector<Vec3>> frames;
  std::vector<Wall> walls{};
  std::vector<std::int32_t> materials{};  ///< one for each ball; empty: all the first
};

Run ball_run(const std::string& name, const Balls& balls) {
  const fs::path folder = fs::path(SCREE_TEST_FOLDER) / name / "ball.run";
  fs::remove_all(folder);
  fs::create_directories(folder);
  const std::size_t count = balls.frames.front().size();
  Scene scene = test::sample_scene(0);
  scene.walls = balls.walls;
  scene.materials.push_back({"chalk", 2000, 0, 0});
  std::vector<FrameEntry> entries;
  for (std::size_t f = 0; f < balls.frames.size(); ++f) {
    BodyTable table;
    for (std::size_t i = 0; i < count; ++i) {
      BodyRow row;
      row.id = static_cast<std::int64_t>(i);
      row.shape = 2;
      row.material = balls.materials.empty() ? 0 : balls.materials[i];
      row.scale = 2;
      row.position = balls.frames[f][i];
      table.add(row);
    }
    scene.bodies = table;
    if (f == 0) write_scene_file((folder / "scene.h5").string(), scene);
    Frame frame = test::sample_frame(scene, static_cast<std::int64_t>(f), 0);
    frame.time = 0.1 * static_cast<double>(f);
    for (std::size_t i = 0; i < count; ++i) frame.bodies.material[i] = table.material[i];
    entries.push_back({(folder / fmt::format("frame_{:06}.hdf", f)).string(), frame.time});
    write_frame_file(MPI_COMM_SELF, entries.back().path, frame);
  }
  write_frame_series(folder.string(), entries);
  return open_run(folder.string());
}

Image drawn(const Run& run, std::size_t frame, const PictureOptions& options) {
  const std::string png = (fs::path(run.folder) / "drawn.png").string();
  draw_picture(run, frame, png, options);
  vtkNew<vtkPNGReader> reader;
  reader->SetFileName(png.c_str());
  reader->Update();
  Image image{options.width, options.height, {}};
  for (int y = options.height - 1; y >= 0; --y) {
    for (int x = 0; x < options.width; ++x) {
      const auto* pixel = static_cast<unsigned char*>(reader->GetOutput()->GetScalarPointer(x, y, 0));
      image.rgb.insert(image.rgb.end(), pixel, pixel + 3);
    }
  }
  return image;
}

const unsigned char* pixel_of(const Image& image, int x, int y) { return &image.rgb[3 * static_cast<std::size_t>(y * image.width + x)]; }
bool is_ground(const Image& image, int x, int y) {
  const unsigned char* p = pixel_of(image, x, y);
  return p[0] >= 250 && p[1] >= 250 && p[2] >= 250;
}
int covered(const Image& image) {
  int count = 0;
  for (int y = 0; y < image.height; ++y) {
    for (int x = 0; x < image.width; ++x) count += is_ground(image, x, y) ? 0 : 1;
  }
  return count;
}
/// Mean column of what is drawn left and right of the middle.
std::array<double, 2> places_of_two(const Image& image) {
  std::array<double, 2> sum{}, count{};
  for (int y = 0; y < image.height; ++y) {
    for (int x = 0; x < image.width; ++x) {
      if (is_ground(image, x, y)) continue;
      const auto side = static_cast<std::size_t>(x >= image.width / 2);
      sum[side] += x + 0.5;
      count[side] += 1;
    }
  }
  return {sum[0] / count[0], sum[1] / count[1]};
}

constexpr double kBall = 0.03;                                         // [m]
const double kHalfAngle = std::tan(15 * std::numbers::pi / 180);       // of the camera
double distance_of(double room_radius) { return 3.87 * room_radius; }  // of the camera from what it looks at
// 320 triangles inscribed in the ball lose up to 3 % of its silhouette
constexpr double kInscribed = 0.985, kInscribedError = 0.02;

// A ball fills the part of the picture that perspective says.
TEST(Picture, a_ball_is_as_large_as_perspective_makes_it) {
  PictureOptions options;
  options.width = options.height = 400;
  const Image image = drawn(ball_run("ball", {{{{5, -3, 2}}}}), 0, options);
  // room: the cube about the ball; its half diagonal is r sqrt 3
  const double sine = 1 / (3.87 * std::sqrt(3.0)), tangent = sine / std::sqrt(1 - sine * sine);
  const double radius = 200 * tangent / kHalfAngle;
  EXPECT_NEAR(covered(image) / (std::numbers::pi * radius * radius), kInscribed, kInscribedError);
}

// A cut through a ball shows a disc: of what is behind the plane nothing is wider than the disc when the plane lies beyond the centre.
TEST(Picture, a_cut_ball_shows_the_disc_of_the_plane) {
  PictureOptions options;
  options.width = options.height = 400;
  options.from = Vec3{0, -1, 0};
  options.cut = {1, 0.5 * kBall};
  const Image image = drawn(ball_run("cut", {{{{0, 0, 0}}}}), 0, options);
  const double distance = distance_of(kBall * std::sqrt(3.0)) + 0.5 * kBall, disc = kBall * std::sqrt(0.75);
  const double radius = 200 * disc / distance / kHalfAngle;
  EXPECT_NEAR(covered(image) / (std::numbers::pi * radius * radius), kInscribed, kInscribedError);
  // the ball is closed: its middle has the one colour of a plane, here that of the first shape of three in full light
  const unsigned char* middle = pixel_of(image, 200, 200);
  for (const auto& [x, y] : {std::array{170, 200}, std::array{200, 230}, std::array{225, 175}}) {
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(pixel_of(image, x, y)[c], middle[c], 1) << x << ' ' << y;
  }
  // from the other side the other part is left, with the centre: the whole ball is as wide as ever
  options.from = Vec3{0, 1, 0};
  const double sine = 1 / (3.87 * std::sqrt(3.0)), tangent = sine / std::sqrt(1 - sine * sine);
  const double whole = 200 * tangent / kHalfAngle;
  EXPECT_NEAR(covered(drawn(open_run((fs::path(SCREE_TEST_FOLDER) / "cut" / "ball.run").string()), 0, options)) /
                  (std::numbers::pi * whole * whole),
              kInscribed, kInscribedError);
  options.from = Vec3{1, 0, 0};
  EXPECT_THROW(drawn(open_run((fs::path(SCREE_TEST_FOLDER) / "cut" / "ball.run").string()), 0, options), UsageError);
}

// Balls at 0.2 m and at 0.6 m from the middle: what is three times as far apart looks three times as far apart.
TEST(Picture, a_point_to_look_at_keeps_the_camera_of_a_series) {
  const auto run = ball_run("series", {{{{-0.2, 0, 0}, {0.2, 0, 0}}, {{-0.6, 0, 0}, {0.6, 0, 0}}}});
  PictureOptions options;
  options.width = 640;
  options.height = 480;
  options.from = Vec3{0, -1, 0};
  options.at = Vec3{0, 0, 0};
  const auto near = places_of_two(drawn(run, 0, options)), far = places_of_two(drawn(run, 1, options));
  EXPECT_NEAR((far[1] - far[0]) / (near[1] - near[0]), 3, 0.03);
  const double radius = length(Vec3{0.6 + kBall, kBall, kBall});  // of the maximum overlap of both frames
  EXPECT_NEAR(near[1] - near[0], 480 * 0.2 / distance_of(radius) / kHalfAngle, 1);
}

// A box that reaches far above is drawn to fit what is shown: in a series that of all frames, however low the bodies lie in one.
TEST(Picture, walls_are_drawn_alike_in_a_series) {
  Wall box;
  box.id = 2;
  box.kind = WallKind::box_inside;
  box.lower = {-0.2, -0.2, 0};
  box.upper = {0.2, 0.2, 50};
  const auto run = ball_run("box", {{{{-0.1, 0, 0.4}, {0.1, 0, 0.4}}, {{-0.1, 0, 0.03}, {0.1, 0, 0.03}}}, {box}});
  PictureOptions options;
  options.width = 320;
  options.height = 240;
  options.from = Vec3{0, -1, 0};
  options.at = Vec3{0, 0, 0.2};
  const auto highest = [&](std::size_t frame) {
    const Image image = drawn(run, frame, options);
    for (int y = 0; y < image.height; ++y) {
      for (int x = 0; x < image.width; ++x) {
        if (!is_ground(image, x, y)) return y;
      }
    }
    return image.height;
  };
  EXPECT_EQ(highest(0), highest(1));
  EXPECT_LT(highest(0), 60);
}

TEST(Picture, a_drum_about_few_bodies_is_seen_as_a_whole) {
  Wall drum;
  drum.id = 1;
  drum.kind = WallKind::cylinder_inside;
  drum.axis_start = {0, -0.02, 0};
  drum.axis_end = {0, 0.02, 0};
  drum.radius = 0.11;
  const auto run = ball_run("drum", {{{{0, 0, -0.08}}}, {drum}});
  PictureOptions options;
  options.width = 480;
  options.height = 360;
  options.from = Vec3{0, -1, 0};
  const Image image = drawn(run, 0, options);
  int highest = 360, widest = 480;
  for (int y = 0; y < 360; ++y) {
    for (int x = 0; x < 480; ++x) {
      if (is_ground(image, x, y)) continue;
      highest = std::min(highest, y);
      widest = std::min(widest, x);
    }
  }
  // its front rim, 2 cm nearer than the middle of a room of 22 cm x 6 cm x 22 cm (the ball is deeper than the drum)
  const double rim = 360 * 0.11 / (distance_of(0.5 * length(Vec3{0.22, 0.06, 0.22})) - 0.02) / kHalfAngle;
  EXPECT_NEAR(180 - highest, 0.5 * rim, 2);
  EXPECT_NEAR(240 - widest, 0.5 * rim, 2);
}

TEST(Picture, kinds_are_named_beside_squares_of_their_colours) {
  const auto run = ball_run("legend", {{{{0, 0, 0}, {0.1, 0, 0}}}, {}, {0, 1}});
  PictureOptions options;
  options.width = 640;
  options.height = 480;
  const auto corner = [&](int row) {  // middle of a square: at 0.6 of the usual size, half of that in the picture
    const Image image = drawn(run, 0, options);
    const unsigned char* p = pixel_of(image, 640 - static_cast<int>(0.3 * (40 + 15)), static_cast<int>(0.3 * (44 + 15 + 44 * row)));
    return Vec3{p[0] / 255.0, p[1] / 255.0, p[2] / 255.0};
  };
  EXPECT_EQ(corner(0), (Vec3{1, 1, 1}));  // all are of one shape
  options.colour = "material";
  for (const int kind : {0, 1}) {
    const Vec3 found = corner(kind), expected = shape_colour(kind);
    EXPECT_LT(length(found - expected), 0.02) << kind << ": " << found.x << ' ' << found.y << ' ' << found.z;
  }
  EXPECT_EQ(corner(2), (Vec3{1, 1, 1}));
  options.legend = false;
  EXPECT_EQ(corner(0), (Vec3{1, 1, 1}));
}

TEST(Legend, has_round_numbers_within_its_range) {
  EXPECT_EQ(legend_ticks(0, 0.0117), (std::vector<double>{0, 0.005, 0.01}));
  const std::vector<double> both = legend_ticks(-0.00185, 0.0123);
  ASSERT_EQ(both.size(), 3u);
  EXPECT_EQ(both[0], 0);
  EXPECT_FALSE(std::signbit(both[0])) << "-0 is no label";
  EXPECT_NEAR(both[2], 0.01, 1e-15);
  EXPECT_EQ(legend_ticks(0, 1), (std::vector<double>{0, 0.5, 1}));
  EXPECT_EQ(legend_ticks(2, 2), (std::vector<double>{2, 2}));
}

}  // namespace
}  // namespace scree
