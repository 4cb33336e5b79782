// Solids cut into pieces: volumes, faces, and that the pieces fit.
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <numeric>
#include <tuple>

#include "core/placing/random_numbers.hpp"
#include "mesher/check/mesh_check.hpp"
#include "mesher/fracture/cut_faces.hpp"
#include "mesher/fracture/fracture.hpp"
#include "mesher/make/primitives.hpp"
#include "tests/mesher/tool_run.hpp"
#include "tests/support/shapes.hpp"

namespace scree {
namespace {

using test::Folder;
using test::ToolRun;

/// A box whose middle is hollow: the outer box half the size, turned inwards.
TriangleMesh hollow_box() {
  TriangleMesh mesh = box_mesh({1, 1, 1});
  const TriangleMesh inner = box_mesh({0.5, 0.5, 0.5});
  const std::int32_t first = mesh.vertex_count();
  mesh.vertices.insert(mesh.vertices.end(), inner.vertices.begin(), inner.vertices.end());
  for (const Triangle& t : inner.triangles) mesh.triangles.push_back({first + t[0], first + t[2], first + t[1]});
  return mesh;
}

/// A small closed hollow near a corner, so that it lies in one cell.
TriangleMesh box_with_bubble() {
  TriangleMesh mesh = box_mesh({1, 1, 1});
  const TriangleMesh inner = box_mesh({0.02, 0.02, 0.02});
  const std::int32_t first = mesh.vertex_count();
  for (const Vec3& p : inner.vertices) mesh.vertices.push_back(p + Vec3{0.3, 0.31, 0.29});
  for (const Triangle& t : inner.triangles) mesh.triangles.push_back({first + t[0], first + t[2], first + t[1]});
  return mesh;
}

std::vector<std::pair<std::string, Shape>> bodies() {
  std::vector<std::pair<std::string, Shape>> all;
  const auto add = [&](const char* name, TriangleMesh mesh) { all.emplace_back(name, make_solid(name, std::move(mesh))); };
  add("box", box_mesh({2, 1, 3}));
  add("grid", test::grid_box(5, {1, 1, 1}));
  add("ball", test::icosphere(3));
  add("rock", test::rock(3, 3));
  add("torus", torus(2, 0.5, 40, 20));
  add("hook", rod(u_path(1, 2, 1, 12), 0.2, 12));
  add("hollow", hollow_box());
  add("bubble", box_with_bubble());
  return all;
}

double volume_of(const Fracture& cut) {
  double sum = 0;
  for (const Shape& piece : cut.pieces) sum += piece.mass.volume;
  return sum;
}

std::vector<std::int32_t> all_triangles(const TriangleMesh& mesh) {
  std::vector<std::int32_t> all(static_cast<std::size_t>(mesh.triangle_count()));
  std::iota(all.begin(), all.end(), 0);
  return all;
}

TEST(Fracture, volumes_and_centres_of_the_pieces_add_up_to_the_body) {
  for (const auto& [name, body] : bodies()) {
    for (const std::int32_t cells : {2, 5, 40}) {
      const Fracture cut = fracture(body, {cells, 7, false, {}});
      EXPECT_GE(static_cast<std::int32_t>(cut.pieces.size()), cells) << name;
      // rounding of coordinates: some 1e-16 for each of a few hundred vertices
      EXPECT_NEAR(volume_of(cut), body.mass.volume, 1e-12 * body.mass.volume) << name << " " << cells;
      Vec3 moment;
      for (const Shape& piece : cut.pieces) moment += piece.mass.volume * piece.origin_shift;
      EXPECT_LE(length(moment), 1e-12 * body.mass.volume * body.bounding_radius()) << name << " " << cells;
      for (const Shape& piece : cut.pieces) EXPECT_TRUE(check_mesh(piece.mesh).is_solid()) << name << " " << piece.name;
    }
  }
}

TEST(Fracture, every_point_of_the_body_lies_in_one_piece_and_no_other_point_in_any) {
  for (const auto& [name, body] : bodies()) {
    const Fracture cut = fracture(body, {12, 3, false, {}});
    const Box3 box = bounding_box(body.mesh);
    const Vec3 e = box.extent();
    int inside = 0;
    for (std::int64_t n = 0; n < 300; ++n) {
      const RandomNumbers random(11, n, 0);
      const Vec3 p = box.lower + Vec3{e.x * random.uniform(0), e.y * random.uniform(1), e.z * random.uniform(2)};
      double pieces = 0;
      std::size_t holder = 0;
      for (std::size_t k = 0; k < cut.pieces.size(); ++k) {
        const Shape& piece = cut.pieces[k];
        const double winding = winding_number(piece.mesh, all_triangles(piece.mesh), p - piece.origin_shift);
        if (winding > 0.5) holder = k;
        pieces += winding;
      }
      const double whole = winding_number(body.mesh, all_triangles(body.mesh), p);
      EXPECT_NEAR(pieces, whole, 1e-6) << name;  // winding numbers to their rounding
      if (whole < 0.5) continue;
      ++inside;
      // the piece is that of the nearest generator
      std::size_t nearest = 0;
      for (std::size_t g = 0; g < cut.generators.size(); ++g) {
        if (length(p - cut.generators[g]) < length(p - cut.generators[nearest])) nearest = g;
      }
      EXPECT_EQ(cut.cell_of[holder], static_cast<std::int32_t>(nearest)) << name;
    }
    EXPECT_GT(inside, 20) << name;
  }
}

/// Position of a vertex to a billionth of the body: pieces are moved to their own centres, which rounds.
std::tuple<long, long, long> place(const Vec3& p, double size) {
  const auto round = [&](double x) { return std::lround(x / size * 1e9); };
  return {round(p.x), round(p.y), round(p.z)};
}

// No gap and no overlap: each edge of each face is that of the other side, run the other way, so that the areas of cuts cancel.
TEST(Fracture, both_sides_of_a_cut_have_the_same_triangles) {
  for (const auto& [name, body] : bodies()) {
    const Fracture cut = fracture(body, {15, 4, false, {}});
    const double size = body.bounding_radius();
    using Corner = std::tuple<long, long, long>;
    std::map<std::array<Corner, 3>, int> sides;
    double outer = 0;
    for (const Shape& piece : cut.pieces) {
      for (const Triangle& t : piece.mesh.triangles) {
        std::array<Corner, 3> corners;
        for (std::size_t k = 0; k < 3; ++k)
          corners[k] = place(piece.mesh.vertices[static_cast<std::size_t>(t[k])] + piece.origin_shift, size);
        std::sort(corners.begin(), corners.end());
        ++sides[corners];
      }
      outer += piece.area;
    }
    int shared = 0;
    for (const auto& [corners, count] : sides) {
      EXPECT_LE(count, 2) << name;
      shared += count == 2;
    }
    EXPECT_EQ(shared, cut.table.face_mesh.triangle_count()) << name;
    double inner = 0;
    for (const SharedFace& face : cut.table.faces) inner += face.area;
    EXPECT_NEAR(outer, body.area + 2 * inner, 1e-9 * outer) << name;
    EXPECT_NEAR(inner, surface_area(cut.table.face_mesh), 1e-9 * inner) << name;
  }
}

// The divergence theorem for each piece: areas of its faces and of its skin close, and faces lie where the table says.
TEST(Fracture, faces_bisect_their_generators_and_lie_between_their_pieces) {
  const Shape body = make_solid("rock", test::rock(5, 3));
  const Fracture cut = fracture(body, {30, 2, false, {}});
  for (const SharedFace& face : cut.table.faces) {
    const auto a = static_cast<std::size_t>(face.piece_a), b = static_cast<std::size_t>(face.piece_b);
    const Vec3 from = cut.generators[static_cast<std::size_t>(cut.cell_of[a])],
               to = cut.generators[static_cast<std::size_t>(cut.cell_of[b])];
    EXPECT_NEAR(length(to - from), face.height, 1e-12);
    EXPECT_NEAR(dot(face.normal, to - from), face.height, 1e-12);
    EXPECT_NEAR(length(face.centroid - from), length(face.centroid - to), 1e-12);
    EXPECT_NEAR(dot(face.axis, face.normal), 0, 1e-12);
    EXPECT_LE(face.moment_1, face.moment_2);
    // a plane figure of its area has no smaller polar moment than a disc
    EXPECT_GE(face.moment_1 + face.moment_2, face.area * face.area / (2 * std::numbers::pi) * (1 - 1e-12));
    EXPECT_LE(face.moment_1 + face.moment_2, face.area * face.rim_radius * face.rim_radius);
  }
}

TEST(Fracture, a_ring_of_a_cut_torus_has_two_faces_and_a_hollow_gives_a_face_with_a_hole) {
  const Shape ring = make_solid("torus", torus(2, 0.5, 40, 20));
  const Fracture two = fracture(ring, {0, 1, false, {{1.9, 0.1, 0.05}, {-1.8, 0.02, -0.04}}});
  ASSERT_EQ(two.pieces.size(), 2U);
  ASSERT_EQ(two.table.faces.size(), 2U);
  for (const SharedFace& face : two.table.faces) EXPECT_NEAR(face.area, std::numbers::pi * 0.25, 0.08 * std::numbers::pi * 0.25);

  const Shape hollow = make_solid("hollow", hollow_box());
  const Fracture halves = fracture(hollow, {0, 1, false, {{0.3, 0.31, 0.32}, {-0.31, 0.3, 0.31}}});
  ASSERT_EQ(halves.table.faces.size(), 1U);
  // the plane lies near x = 0 and is hardly tilted: a square of 1 with a square hole of 0.5
  const SharedFace& face = halves.table.faces[0];
  EXPECT_NEAR(face.area, 0.75, 0.01);
  EXPECT_NEAR(face.moment_1, (1 - std::pow(0.5, 4)) / 12, 0.003);
  EXPECT_NEAR(face.moment_2, (1 - std::pow(0.5, 4)) / 12, 0.003);
}

TEST(Fracture, a_closed_hollow_within_a_cell_stays_in_its_piece) {
  const Fracture cut =
      fracture(make_solid("bubble", box_with_bubble()), {0, 1, false, {{0.3, 0.3, 0.3}, {-0.3, -0.3, 0}, {-0.3, 0.3, -0.2}}});
  ASSERT_EQ(cut.pieces.size(), 3U);
  EXPECT_EQ((*cut.pieces[0].verdict)["components"].size(), 2U);
}

TEST(Fracture, separate_parts_of_a_cell_become_pieces) {
  // a U whose legs lie in one cell: the second generator holds the bow
  const Shape u = make_solid("u", rod(u_path(2, 3, 3, 16), 0.3, 16));
  const Box3 box = bounding_box(u.mesh);
  const double low = box.lower.z, high = box.upper.z;
  std::vector<Vec3> points;
  for (const double share : {0.02, 0.9}) points.push_back({0, 0, low + share * (high - low)});
  const Fracture cut = fracture(u, {0, 1, false, points});
  EXPECT_EQ(cut.pieces.size(), 3U);
  EXPECT_EQ(cut.table.faces.size(), 2U);
  EXPECT_NEAR(volume_of(cut), u.mass.volume, 1e-12 * u.mass.volume);
}

TEST(Fracture, a_bar_cut_across_has_square_faces) {
  const Shape bar = make_solid("bar", box_mesh({0.01, 0.01, 0.1}));
  std::vector<Vec3> points;
  for (int i = 0; i < 10; ++i) points.push_back({0, 0, 0.01 * (i - 4.5)});
  const Fracture cut = fracture(bar, {0, 1, false, points});
  ASSERT_EQ(cut.table.faces.size(), 9U);
  for (const SharedFace& face : cut.table.faces) {
    EXPECT_NEAR(face.area, 1e-4, 1e-10);  // generators lie on a grid of 2^-23 of the body
    EXPECT_NEAR(face.moment_1, 1e-8 / 12, 1e-14);
    EXPECT_NEAR(face.moment_2, 1e-8 / 12, 1e-14);
    EXPECT_NEAR(face.height, 0.01, 1e-7);
    EXPECT_NEAR(face.rim_radius, 0.01 / std::sqrt(2.0), 1e-8);
  }
}

// A lattice has bisector planes that meet in one line, and in vertices of the mesh: the generators are moved a little, and told.
TEST(Fracture, a_lattice_of_points_is_cut_all_the_same) {
  const Shape cube = make_solid("cube", test::grid_box(4, {1, 1, 1}));
  std::vector<Vec3> points;
  for (int i = 0; i < 27; ++i) points.push_back({(i % 3 - 1) * 0.25, (i / 3 % 3 - 1) * 0.25, (i / 9 - 1) * 0.25});
  const Fracture cut = fracture(cube, {0, 1, false, points});
  EXPECT_GT(cut.attempts, 1);
  EXPECT_EQ(cut.pieces.size(), 27U);
  EXPECT_NEAR(volume_of(cut), 1, 1e-12);
}

TEST(Fracture, size_and_seed_make_the_same_cut_and_another_seed_another) {
  TriangleMesh mesh = test::rock(2, 2), large = mesh;
  for (Vec3& p : large.vertices) p *= 1024;
  const Shape small = make_solid("rock", mesh), big = make_solid("rock", large);
  const Fracture a = fracture(small, {10, 5, false, {}}), b = fracture(big, {10, 5, false, {}}), c = fracture(small, {10, 6, false, {}});
  ASSERT_EQ(a.pieces.size(), b.pieces.size());
  for (std::size_t k = 0; k < a.pieces.size(); ++k) EXPECT_EQ(1024 * a.pieces[k].origin_shift, b.pieces[k].origin_shift);
  EXPECT_NE(a.pieces[0].origin_shift, c.pieces[0].origin_shift);
}

TEST(Fracture, no_cell_is_a_sliver_and_even_points_give_cells_of_more_equal_size) {
  const Shape ball = make_solid("ball", test::icosphere(3));
  const auto spread = [&](bool evenly) {
    const Fracture cut = fracture(ball, {60, 3, evenly, {}});
    EXPECT_GE(cut.smallest_cell, kSliverCell * ball.mass.volume / 60);
    double squares = 0;
    for (const Shape& piece : cut.pieces) squares += piece.mass.volume * piece.mass.volume;
    return squares;
  };
  EXPECT_LT(spread(true), 0.95 * spread(false));
}

// Each piece keeps its mass, its skin stays where it is, and faces that two pieces share are two insets apart.
TEST(Fracture, with_an_inset_shared_faces_are_two_insets_apart) {
  for (const auto& [name, body] : bodies()) {
    const double inset = 0.01 * body.equivalent_diameter();
    FractureForm form{8, 5, true, {}, 0};
    const Fracture plain = fracture(body, form);
    form.inset = inset;
    const Fracture cut = fracture(body, form);
    ASSERT_EQ(cut.pieces.size(), plain.pieces.size()) << name;
    for (std::size_t p = 0; p < cut.pieces.size(); ++p) {
      const Shape& piece = cut.pieces[p];
      EXPECT_EQ(piece.mass.volume, plain.pieces[p].mass.volume) << name;
      EXPECT_LT(mass_properties(piece.mesh).volume, plain.pieces[p].mass.volume) << name;
      EXPECT_TRUE(check_mesh(piece.mesh).is_solid()) << name;
      for (const SharedFace& face : cut.table.faces) {
        if (face.piece_a != static_cast<std::int32_t>(p) && face.piece_b != static_cast<std::int32_t>(p)) continue;
        const Vec3 outward = face.piece_a == static_cast<std::int32_t>(p) ? face.normal : -face.normal;
        double nearest = 1e300;
        for (const Vec3& v : piece.mesh.vertices) nearest = std::min(nearest, dot(outward, face.centroid - v - piece.origin_shift));
        EXPECT_GE(nearest, inset * (1 - 1e-9)) << name;
      }
    }
  }
}

TEST(Fracture, an_inset_of_a_bar_leaves_shorter_bars) {
  const Shape bar = make_solid("bar", box_mesh({0.01, 0.01, 0.1}));
  std::vector<Vec3> points;
  for (int i = 0; i < 10; ++i) points.push_back({0, 0, 0.01 * (i - 4.5)});
  const Fracture cut = fracture(bar, {0, 1, false, points, 1e-4});
  EXPECT_NEAR(bounding_box(cut.pieces[4].mesh).extent().z, 0.0098, 1e-7);
  EXPECT_NEAR(bounding_box(cut.pieces[4].mesh).extent().x, 0.01, 1e-15);
  EXPECT_NEAR(bounding_box(cut.pieces[0].mesh).extent().z, 0.0099, 1e-7);
  EXPECT_NEAR(cut.pieces[4].mass.volume, 1e-6, 1e-11);
}

TEST(Fracture, moments_of_a_triangle_are_the_known_ones) {
  // legs b along x and h along y: I about the axis parallel to the leg b is b h^3 / 36
  const std::vector<Vec3> vertices{{0, 0, 5}, {3, 0, 5}, {0, 3, 5}};
  const std::vector<std::vector<std::int32_t>> loops{{0, 1, 2}};
  const SharedFace face = face_measures(loops, vertices, {0, 0, 1});
  EXPECT_NEAR(face.area, 4.5, 1e-14);
  EXPECT_LE(length(face.centroid - Vec3{1, 1, 5}), 1e-14);
  // Ixx = Iyy = 81/36 = 2.25, Ixy = -9/8: principal 2.25 -+ 1.125
  EXPECT_NEAR(face.moment_1, 1.125, 1e-13);
  EXPECT_NEAR(face.moment_2, 3.375, 1e-13);
  EXPECT_NEAR(std::abs(dot(face.axis, normalised(Vec3{1, -1, 0}))), 1, 1e-12);  // along the hypotenuse the figure is widest
}

TEST(FractureCommand, writes_pieces_and_faces_that_are_read_again) {
  const Folder folder;
  ASSERT_EQ(folder.mesher("generate rock --diameter 2cm --seed 3 -o rock.shape.h5").code, 0);
  const ToolRun run = folder.mesher("fracture rock.shape.h5 --cells 12 --seed 2 -o pieces.shape.h5");
  ASSERT_EQ(run.code, 0) << run.errors;
  EXPECT_NE(run.output.find("12 cells, 12 pieces"), std::string::npos) << run.output;
  const ShapeFile whole = read_shape_file(folder / "rock.shape.h5"), file = read_shape_file(folder / "pieces.shape.h5");
  ASSERT_TRUE(file.pieces.has_value());
  EXPECT_EQ(file.pieces->body, "rock");
  EXPECT_EQ(file.shapes.size(), 12U);
  EXPECT_EQ(file.shapes[0].name, "rock_1");
  const Fracture again = fracture(whole.shapes[0], {12, 2, false, {}});
  ASSERT_EQ(again.table.faces.size(), file.pieces->faces.size());
  for (std::size_t f = 0; f < again.table.faces.size(); ++f) {
    EXPECT_EQ(again.table.faces[f].area, file.pieces->faces[f].area);
    EXPECT_EQ(again.table.faces[f].piece_b, file.pieces->faces[f].piece_b);
    EXPECT_EQ(again.table.faces[f].moment_1, file.pieces->faces[f].moment_1);
  }
  EXPECT_FALSE(whole.pieces.has_value());
}

TEST(FractureCommand, bad_input_is_refused_with_numbers) {
  const Folder folder;
  ASSERT_EQ(folder.mesher("generate box --size 1cm,1cm,1cm -o box.shape.h5").code, 0);
  ASSERT_EQ(folder.mesher("generate sphere --analytic --radius 1cm -o ball.shape.h5").code, 0);
  ASSERT_EQ(folder.mesher("generate stone --diameter 1cm --count 2 -o two.shape.h5").code, 0);
  folder.write("open.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  ASSERT_EQ(folder.mesher("import open.obj --unit cm --surface -o open.shape.h5").code, 0);
  folder.write("outside.csv", "x,y,z\n0,0,0\n0,0,0.02\n");
  folder.write("one.csv", "x,y,z\n0,0,0\n");
  folder.write("twice.csv", "x,y,z\n0,0,0.001\n0,0,0.001\n");
  folder.write("word.csv", "x,y,z\n0,0,zero\n");
  folder.write("plane.csv", "x,y\n0,0\n");
  const auto refused = [&](const std::string& arguments, int code, const std::string& words) {
    const ToolRun run = folder.mesher("fracture " + arguments + " -o x.shape.h5");
    EXPECT_EQ(run.code, code) << arguments << "\n" << run.errors;
    EXPECT_NE(run.errors.find(words), std::string::npos) << arguments << "\n" << run.errors;
    EXPECT_FALSE(std::filesystem::exists(folder / "x.shape.h5"));
  };
  refused("box.shape.h5 --cells 1", 2, "--cells 1: expected from 2 to 20000");
  refused("box.shape.h5 --cells 30000", 2, "--cells 30000: expected from 2 to 20000");
  refused("box.shape.h5", 2, "give either --cells N or --points FILE");
  refused("box.shape.h5 --cells 3 --points one.csv", 2, "give either --cells N or --points FILE");
  refused("ball.shape.h5 --cells 3", 3, "analytic sphere");
  refused("open.shape.h5 --cells 3", 3, "no solid");
  refused("two.shape.h5 --cells 3", 3, "has 2 shapes; say which one to cut");
  refused("box.shape.h5 --cells 3 --shape rock", 3, "has no shape 'rock'; it has box");
  refused("box.shape.h5 --points outside.csv", 3, "outside.csv:3: (0, 0, 0.02) m does not lie in 'box'");
  refused("box.shape.h5 --points one.csv", 3, "1 points; a cut needs at least 2");
  refused("box.shape.h5 --points twice.csv", 3, "twice.csv:3: the same point as number 1");
  refused("box.shape.h5 --points word.csv", 3, "word.csv:2: 'zero' is no coordinate");
  refused("box.shape.h5 --points plane.csv", 3, "has no column 'z'");
  refused("box.shape.h5 --cells 30 --inset 4mm", 3, "and faces should be moved inwards by 0.004 m");
  refused("box.shape.h5 --cells 30 --inset 4kg", 2, "--inset");
  refused("missing.shape.h5 --cells 3", 3, "missing.shape.h5");
}

TEST(FractureCommand, a_surface_that_passes_through_itself_is_refused) {
  const Folder folder;
  // a bag whose bottom is pushed out through its top: one closed surface that crosses itself
  TriangleMesh mesh = test::grid_box(4, {1, 1, 1});
  for (Vec3& p : mesh.vertices) {
    if (p.z < -0.4 && std::abs(p.x) < 0.1 && std::abs(p.y) < 0.1) p.z = 0.9;
  }
  write_shape_file(folder / "bag.shape.h5", {make_solid("bag", mesh)}, nlohmann::json::object());
  const ToolRun run = folder.mesher("fracture bag.shape.h5 --cells 5 -o x.shape.h5");
  EXPECT_EQ(run.code, 3);
  EXPECT_NE(run.errors.find("pairs of triangles pass through each other"), std::string::npos) << run.errors;
}

TEST(FractureCommand, meshes_of_asteroids_are_cut) {
  const std::string source = "/usr/share/openuniverse/3dmodels/";
  if (!std::filesystem::exists(source + "ida.bmf")) GTEST_SKIP() << "openuniverse-common is missing";
  const Folder folder;
  for (const char* name : {"ida", "castalia", "toutatis", "bacchus"}) {
    ASSERT_EQ(folder.mesher(std::string("import --unit km ") + source + name + ".bmf -o " + name + ".shape.h5").code, 0);
    const ToolRun run = folder.mesher(std::string("fracture ") + name + ".shape.h5 --cells 50 -o p.shape.h5");
    ASSERT_EQ(run.code, 0) << name << run.errors;
    const Shape body = read_shape_file(folder / (std::string(name) + ".shape.h5")).shapes[0];
    double sum = 0;
    for (const Shape& piece : read_shape_file(folder / "p.shape.h5").shapes) sum += piece.mass.volume;
    EXPECT_NEAR(sum, body.mass.volume, 1e-9 * body.mass.volume) << name;
  }
}

}  // namespace
}  // namespace scree
