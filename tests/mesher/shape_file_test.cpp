// Shape files: what is written is read back bit by bit; what is damaged or newer is refused.
#include "core/storage/shape_file.hpp"
#include "core/base/utf8.hpp"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "tests/mesher/tool_run.hpp"
#include "tests/support/shapes.hpp"

namespace scree {
namespace {

using test::Folder;

std::vector<Shape> samples() {
  TriangleMesh rock = test::icosphere(2);
  for (Vec3& p : rock.vertices) p = Vec3{1.3 * p.x + 0.1 * p.y * p.y, 0.9 * p.y, 0.7 * p.z} + Vec3{5, -3, 2};
  TriangleMesh sheet;
  sheet.vertices = {{0, 0, 1}, {1, 0, 1}, {0, 1, 1}};
  sheet.triangles = {{0, 1, 2}};
  std::vector<Shape> shapes{make_solid("rock", rock), make_surface("sheet", sheet), make_sphere("bead", 0.25)};
  shapes[0].verdict = nlohmann::json{{"solid", true}, {"triangles", 320}};
  return shapes;
}

std::string message_of(const std::string& path) {
  try {
    read_shape_file(path);
  } catch (const InputError& error) {
    return error.what();
  }
  return "no InputError";
}

#define EXPECT_SAYS(text, words) EXPECT_NE((text).find(words), std::string::npos) << "looked for '" << (words) << "' in\n" << (text)

TEST(ShapeFile, every_kind_of_shape_comes_back_bit_by_bit) {
  const Folder folder;
  const std::vector<Shape> written = samples();
  write_shape_file(folder / "x.shape.h5", written, {{"tool", "test"}});
  const ShapeFile file = read_shape_file(folder / "x.shape.h5");
  EXPECT_EQ((*file.provenance)["tool"], "test");
  ASSERT_EQ(file.shapes.size(), written.size());
  for (std::size_t i = 0; i < written.size(); ++i) {
    const Shape &a = written[i], &b = file.shapes[i];
    EXPECT_EQ(a.name, b.name);
    EXPECT_EQ(a.kind, b.kind);
    EXPECT_EQ(a.mesh.vertices, b.mesh.vertices);
    EXPECT_EQ(a.mesh.triangles, b.mesh.triangles);
    EXPECT_EQ(a.sphere_radius, b.sphere_radius);
    EXPECT_EQ(a.origin_shift, b.origin_shift);
    EXPECT_EQ(a.mass.volume, b.mass.volume);
    EXPECT_EQ(a.mass.inertia, b.mass.inertia);
    EXPECT_EQ(a.mass.principal_moments, b.mass.principal_moments);
    EXPECT_EQ(a.mass.body_from_principal, b.mass.body_from_principal);
    EXPECT_EQ(a.area, b.area);
    EXPECT_EQ(a.verdict, b.verdict);
  }
}

TEST(ShapeFile, more_than_ten_shapes_keep_their_order) {
  const Folder folder;
  std::vector<Shape> many;
  for (int i = 0; i < 120; ++i) many.push_back(make_sphere("bead" + std::to_string(i), 1 + i));
  write_shape_file(folder / "x.shape.h5", many, nullptr);
  const std::vector<Shape> back = read_shape_file(folder / "x.shape.h5").shapes;
  ASSERT_EQ(back.size(), many.size());
  for (std::size_t i = 0; i < many.size(); ++i) EXPECT_EQ(back[i].name, many[i].name);
}

TEST(ShapeFile, a_solid_has_its_centre_of_mass_at_the_origin_and_the_shift_recorded) {
  TriangleMesh mesh = box_mesh({1, 2, 3});
  for (Vec3& p : mesh.vertices) p += Vec3{10, 20, 30};
  const Shape shape = make_solid("box", mesh);
  EXPECT_LE(length(shape.origin_shift - Vec3{10, 20, 30}), 1e-13);
  EXPECT_LE(length(mass_properties(shape.mesh).centre), 1e-13);
  EXPECT_EQ(shape.mass.centre, Vec3{});
}

TEST(ShapeFile, an_inverted_mesh_is_no_solid) {
  TriangleMesh mesh = box_mesh({1, 1, 1});
  for (Triangle& t : mesh.triangles) std::swap(t[1], t[2]);
  EXPECT_THROW(make_solid("box", mesh), InputError);
}

TEST(ShapeFile, a_truncated_file_is_refused_wherever_it_was_cut) {
  const Folder folder;
  write_shape_file(folder / "x.shape.h5", samples(), nullptr);
  const std::string whole = test::text_of_file(folder / "x.shape.h5");
  for (double part : {0.0, 0.01, 0.25, 0.5, 0.75, 0.99}) {
    folder.write("cut.shape.h5", whole.substr(0, static_cast<std::size_t>(part * static_cast<double>(whole.size()))));
    EXPECT_THROW(read_shape_file(folder / "cut.shape.h5"), InputError) << "cut at " << part;
  }
}

TEST(ShapeFile, missing_foreign_and_other_files_are_refused) {
  const Folder folder;
  EXPECT_SAYS(message_of(folder / "nowhere.shape.h5"), "nowhere.shape.h5");
  folder.write("text.shape.h5", "this is no HDF5 file, but it is long enough to be looked at by the library for its signature");
  EXPECT_SAYS(message_of(folder / "text.shape.h5"), "text.shape.h5");
  h5::NewFile bare(folder / "bare.shape.h5");
  bare.commit();
  EXPECT_SAYS(message_of(folder / "bare.shape.h5"), "not a Scree file");
  h5::NewFile other(folder / "other.shape.h5");
  other.root().write_attribute("format", "scree-scene");
  other.root().write_attribute("format_version", std::int64_t{1});
  other.commit();
  EXPECT_SAYS(message_of(folder / "other.shape.h5"), "is a scree-scene file, expected scree-shape");
}

TEST(ShapeFile, a_newer_version_is_refused_with_both_versions) {
  const Folder folder;
  h5::NewFile file(folder / "new.shape.h5");
  file.root().write_attribute("format", kShapeFormat);
  file.root().write_attribute("format_version", kShapeFormatVersion + 1);
  file.commit();
  EXPECT_SAYS(message_of(folder / "new.shape.h5"), "version 2 of scree-shape");
  EXPECT_SAYS(message_of(folder / "new.shape.h5"), "use a newer Scree");
}

TEST(ShapeFile, a_triangle_of_a_vertex_that_does_not_exist_is_refused) {
  const Folder folder;
  std::vector<Shape> shapes = samples();
  Shape& sheet = shapes[1];
  const auto write = [&] {
    // the writer finds features, which needs valid indices: plant the fault in a file written by hand
    h5::NewFile file(folder / "bad.shape.h5");
    file.root().write_attribute("format", kShapeFormat);
    file.root().write_attribute("format_version", kShapeFormatVersion);
    file.root().write_text("provenance", "null");
    const h5::Group g = file.root().create_group("shapes").create_group("shape_0000");
    g.write_attribute("name", "sheet");
    g.write_attribute("kind", std::int32_t{1});
    g.write_attribute("sphere_radius", 0.0);
    g.write_attribute("volume", 0.0);
    g.write_attribute("area", 0.5);
    g.write_array("vertices", sheet.mesh.vertices, "m");
    g.write_array("triangles", std::vector<std::int32_t>{0, 1, 7}, 3, "");
    file.commit();
  };
  write();
  EXPECT_SAYS(message_of(folder / "bad.shape.h5"), "triangle 0 names vertex 7, but there are 3 vertices");
}

// Names have four digits up to the 10 000th shape, so that as text shape_10000 comes before shape_1001.
TEST(ShapeFile, more_than_10000_shapes_come_back_in_the_order_of_their_numbers) {
  const Folder folder;
  h5::NewFile file(folder / "many.shape.h5");
  const h5::Group group = file.root().create_group("shapes");
  write_shapes(group, {make_sphere("others", 1), make_sphere("at 1 and 10000", 2)});
  // links to these two: as good as 10 001 shapes to the reader, and soon written
  for (int i = 2; i <= 10000; ++i) {
    H5Lcreate_hard(group.id(), i == 10000 ? "shape_0001" : "shape_0000", group.id(), fmt::format("shape_{:04}", i).c_str(), H5P_DEFAULT,
                   H5P_DEFAULT);
  }
  const std::vector<Shape> shapes = read_shapes(group);
  ASSERT_EQ(shapes.size(), 10001U);
  std::vector<std::size_t> found;
  for (std::size_t i = 0; i < shapes.size(); ++i) {
    if (shapes[i].sphere_radius == 2) found.push_back(i);
  }
  EXPECT_EQ(found, (std::vector<std::size_t>{1, 10000}));
}

TEST(ShapeFile, the_kept_sample_of_version_1_is_read) {
  const ShapeFile file = read_shape_file(SCREE_TEST_DATA "/version_1.shape.h5");
  ASSERT_EQ(file.shapes.size(), 1U);
  const Shape& brick = file.shapes[0];
  EXPECT_EQ(brick.name, "brick");
  EXPECT_EQ(brick.mesh.triangle_count(), 12);
  EXPECT_DOUBLE_EQ(brick.mass.volume, 6);
  EXPECT_LE(length(brick.mass.principal_moments - 6.0 / 12 * Vec3{5, 10, 13}), 1e-14);
  EXPECT_EQ((*brick.verdict)["solid"], true);
  EXPECT_EQ((*file.provenance)["tool"], "scree-mesher");
}

TEST(ShapeFile, a_path_that_is_not_utf8_is_kept_byte_by_byte) {
  const Folder folder;
  write_shape_file(folder / "x.shape.h5", {make_sphere("bead", 1)}, {{"path", "caf\xe9.stl"}});
  EXPECT_EQ(bytes_from_utf8((*read_shape_file(folder / "x.shape.h5").provenance)["path"]), "caf\xe9.stl");
}

TEST(ShapeFile, a_folder_that_cannot_be_written_is_a_system_error) {
  EXPECT_THROW(write_shape_file("/proc/nowhere/x.shape.h5", samples(), nullptr), SystemError);
}

}  // namespace
}  // namespace scree
