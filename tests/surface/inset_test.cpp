// Meshes moved inwards by a margin, and the bodies that they make with the margin around them.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <random>
#include <string>

#include "core/geometry/features.hpp"
#include "core/placing/placed_body.hpp"
#include "core/surface/flat_faces.hpp"
#include "core/surface/inset.hpp"
#include "core/surface/self_intersections.hpp"
#include "core/surface/touch_surface.hpp"
#include "tests/decomposer/brute_distance.hpp"
#include "tests/support/shapes.hpp"

namespace scree {
namespace {

Vec3 area_of(const TriangleMesh& mesh, std::int32_t t) {
  return cross(mesh.corner(t, 1) - mesh.corner(t, 0), mesh.corner(t, 2) - mesh.corner(t, 0));
}

/// No triangle turned over by more than 60 degrees, none that crosses another.
void expect_sound(const TriangleMesh& drawn, const TriangleMesh& moved) {
  ASSERT_EQ(drawn.triangles, moved.triangles);
  for (std::int32_t t = 0; t < drawn.triangle_count(); ++t)
    EXPECT_GE(dot(normalised(area_of(drawn, t)), normalised(area_of(moved, t))), 0.5) << t;
  EXPECT_TRUE(find_crossing_pairs(moved).empty());
}

// Also where faces are split into triangles smaller than the margin.
TEST(Inset, of_a_box_is_the_smaller_box_however_its_faces_are_split) {
  const Vec3 size{1, .8, .6};
  const double margin = .03;
  for (const int n : {1, 4, 40}) {
    const TriangleMesh drawn = test::grid_box(n, size);
    const Inset found = inset(drawn, margin);
    for (std::size_t v = 0; v < drawn.vertices.size(); ++v) {
      for (int k = 0; k < 3; ++k) {
        const double half = .5 * size[k], p = drawn.vertices[v][k];
        const bool at_side = std::abs(std::abs(p) - half) < 1e-12;
        if (at_side)
          EXPECT_NEAR(found.mesh.vertices[v][k], std::copysign(half - margin, p), 1e-14) << n;
        else
          EXPECT_LT(std::abs(found.mesh.vertices[v][k]), half - margin) << n;
      }
      EXPECT_EQ(found.share[v], 1) << n;
    }
    for (std::int32_t t = 0; t < drawn.triangle_count(); ++t)
      EXPECT_NEAR(dot(normalised(area_of(drawn, t)), normalised(area_of(found.mesh, t))), 1, 1e-9) << n;
    if (n > 4) continue;
    const InsetDeviation off = deviation_of_inset(drawn, found.mesh, margin);
    EXPECT_NEAR(off.largest, (std::sqrt(3.0) - 1) * margin, 1e-12);  // of a corner
    // along an edge, on both sides and up to a margin from it: the integral of sqrt(eps^2 + s^2) - eps
    const double strip = margin * margin * (.5 * (std::sqrt(2.0) + std::asinh(1.0)) - 1);
    const double edges = 4 * (size.x + size.y + size.z), area = 2 * (size.x * size.y + size.y * size.z + size.z * size.x);
    EXPECT_NEAR(off.mean, 2 * strip * edges / area, .05 * off.mean);  // less what meets at corners
  }
}

/// The same surface with a part of its edges cut in the middle, with the triangles on both sides.
TriangleMesh split(TriangleMesh mesh, unsigned seed) {
  std::mt19937 random(seed);
  const auto triangle_count = mesh.triangle_count();
  for (std::int32_t t = 0; t < triangle_count; ++t) {
    if (random() % 3 != 0) continue;
    const std::int32_t a = mesh.triangles[static_cast<std::size_t>(t)][0], b = mesh.triangles[static_cast<std::size_t>(t)][1];
    const std::int32_t middle = mesh.vertex_count();
    mesh.vertices.push_back(.5 * (mesh.vertices[static_cast<std::size_t>(a)] + mesh.vertices[static_cast<std::size_t>(b)]));
    for (std::size_t i = 0, before = mesh.triangles.size(); i < before; ++i) {
      for (std::size_t k = 0; k < 3; ++k) {
        const Triangle old = mesh.triangles[i];
        const std::int32_t from = old[k], to = old[(k + 1) % 3], opposite = old[(k + 2) % 3];
        if (!((from == a && to == b) || (from == b && to == a))) continue;
        mesh.triangles[i] = {from, middle, opposite};
        mesh.triangles.push_back({middle, to, opposite});
        break;
      }
    }
  }
  return mesh;
}

// A rough rock with a margin so wide that it is moved in only partly: the same surface when its faces are split.
TEST(Inset, of_rough_rocks_does_not_depend_on_how_faces_are_split) {
  for (const unsigned seed : {1, 2, 3}) {
    const TriangleMesh drawn = test::rock(seed, 3), finer = split(drawn, seed);
    ASSERT_GT(finer.triangle_count(), drawn.triangle_count() + 100);
    for (const double margin : {.02, .3}) {
      const Inset coarse = inset(drawn, margin), fine = inset(finer, margin);
      for (std::size_t v = 0; v < drawn.vertices.size(); ++v) {
        EXPECT_EQ(coarse.share[v], fine.share[v]) << seed << ' ' << v;
        EXPECT_LT(length(coarse.mesh.vertices[v] - fine.mesh.vertices[v]), 1e-12) << seed << ' ' << v;
      }
      const double least = *std::min_element(coarse.share.begin(), coarse.share.end());
      EXPECT_EQ(least<1, margin> .1) << seed;
    }
  }
}

TriangleMesh polyhedron(const std::vector<Vec3>& vertices, const std::vector<std::vector<std::int32_t>>& faces) {
  TriangleMesh mesh;
  mesh.vertices = vertices;
  for (const auto& face : faces)
    for (std::size_t k = 1; k + 1 < face.size(); ++k) mesh.triangles.push_back({face[0], face[k], face[k + 1]});
  return mesh;
}

/// A cube of side 1 without one of its corners.
TriangleMesh chipped_cube(double chip) {
  const double c = 1 - chip;
  return polyhedron({{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0, 0, 1}, {1, 0, 1}, {0, 1, 1}, {c, 1, 1}, {1, c, 1}, {1, 1, c}},
                    {{0, 3, 2, 1}, {0, 1, 5, 4}, {0, 4, 6, 3}, {1, 2, 9, 8, 5}, {3, 6, 7, 9, 2}, {4, 5, 8, 7, 6}, {7, 8, 9}});
}

/// A roof with steep ends, between which a short ridge is left.
TriangleMesh roof(double ridge) {
  const double r = .5 * ridge;
  return polyhedron({{-.2, -1, 0}, {.2, -1, 0}, {.2, 1, 0}, {-.2, 1, 0}, {-r, 0, .8}, {r, 0, .8}},
                    {{0, 3, 2, 1}, {0, 1, 5, 4}, {2, 3, 4, 5}, {1, 2, 5}, {3, 0, 4}});
}

// A face or an edge that vanishes before the margin is reached holds nothing back: what is large moves by the margin, and stays flat.
TEST(Inset, does_not_depend_on_faces_and_edges_smaller_than_the_margin) {
  const double margin = .03;
  for (const double small : {1e-3, 1e-2}) {
    for (const TriangleMesh& drawn : {chipped_cube(small), roof(small)}) {
      const Inset found = inset(drawn, margin);
      const FlatFaces faces(drawn);
      expect_sound(drawn, found.mesh);
      // without the small parts held back: .9; the three-cornered ends of the roof lean to let its ridge be
      EXPECT_LT(deviation_of_inset(drawn, found.mesh, margin).mean, .25 * margin) << small;
      for (std::int32_t t = 0; t < drawn.triangle_count(); ++t) {
        const Vec3 n = normalised(area_of(drawn, t));
        double depth[3];
        for (int k = 0; k < 3; ++k) depth[k] = -dot(n, found.mesh.corner(t, k) - drawn.corner(t, k)) / margin;
        if (faces.corners_of_face(t).size() == 3) continue;
        EXPECT_NEAR(depth[0], depth[1], 1e-12) << t;
        EXPECT_NEAR(depth[0], depth[2], 1e-12) << t;
        if (length(area_of(drawn, t)) > .1) {
          EXPECT_NEAR(depth[0], 1, .25) << t << ' ' << small;
        }
      }
      const Inset fine = inset(split(drawn, 3), margin);
      for (std::size_t v = 0; v < drawn.vertices.size(); ++v)
        EXPECT_LT(length(found.mesh.vertices[v] - fine.mesh.vertices[v]), 1e-9 * margin) << small << ' ' << v;
    }
  }
}

TEST(Inset, moves_both_sides_of_a_concave_corner_by_the_margin) {
  const TriangleMesh drawn = test::l_shape();
  const double margin = .01;
  const TriangleMesh moved = inset(drawn, margin).mesh;
  expect_sound(drawn, moved);
  for (std::int32_t t = 0; t < drawn.triangle_count(); ++t) {
    const Vec3 n = normalised(area_of(drawn, t));
    for (int k = 0; k < 3; ++k) EXPECT_NEAR(dot(n, moved.corner(t, k) - drawn.corner(t, k)), -margin, 1e-14);
  }
}

/// A prism over the cells of a plane grid that are marked by an x, the diagonals of whose squares are drawn by lot.
TriangleMesh prism_of_cells(const std::vector<std::string>& cells, const std::vector<double>& x, const std::vector<double>& y,
                            double height, unsigned seed) {
  std::mt19937 random(seed);
  TriangleMesh mesh;
  std::map<std::array<std::size_t, 3>, std::int32_t> index;
  const auto vertex = [&](std::size_t i, std::size_t j, std::size_t top) {
    const auto [it, inserted] = index.try_emplace({i, j, top}, mesh.vertex_count());
    if (inserted) mesh.vertices.push_back({x[i], y[j], top * height});
    return it->second;
  };
  const auto quad = [&](std::int32_t a, std::int32_t b, std::int32_t c, std::int32_t d) {
    if (random() % 2 == 0)
      mesh.triangles.insert(mesh.triangles.end(), {Triangle{a, b, c}, Triangle{a, c, d}});
    else
      mesh.triangles.insert(mesh.triangles.end(), {Triangle{b, c, d}, Triangle{b, d, a}});
  };
  const auto is_full = [&](std::size_t i, std::size_t j) { return j < cells.size() && i < cells[j].size() && cells[j][i] == 'x'; };
  for (std::size_t j = 0; j < cells.size(); ++j) {
    for (std::size_t i = 0; i < cells[j].size(); ++i) {
      if (!is_full(i, j)) continue;
      quad(vertex(i, j, 1), vertex(i + 1, j, 1), vertex(i + 1, j + 1, 1), vertex(i, j + 1, 1));
      quad(vertex(i, j, 0), vertex(i, j + 1, 0), vertex(i + 1, j + 1, 0), vertex(i + 1, j, 0));
      const auto side = [&](std::size_t i0, std::size_t j0, std::size_t i1, std::size_t j1) {
        quad(vertex(i0, j0, 0), vertex(i1, j1, 0), vertex(i1, j1, 1), vertex(i0, j0, 1));
      };
      if (!is_full(i, j - 1)) side(i, j, i + 1, j);
      if (!is_full(i + 1, j)) side(i + 1, j, i + 1, j + 1);
      if (!is_full(i, j + 1)) side(i + 1, j + 1, i, j + 1);
      if (!is_full(i - 1, j)) side(i, j + 1, i, j);
    }
  }
  return mesh;
}

/// The same surface and vertices, with edges turned inside flat faces where both triangles stay fat.
TriangleMesh turned_within_faces(TriangleMesh mesh, unsigned seed) {
  std::mt19937 random(seed);
  const auto vertex = [&](std::int32_t v) { return mesh.vertices[static_cast<std::size_t>(v)]; };
  for (Triangle& t : mesh.triangles) {
    const std::size_t k = random() % 3;
    const std::int32_t a = t[k], b = t[(k + 1) % 3], c = t[(k + 2) % 3];
    const Vec3 n = normalised(cross(vertex(b) - vertex(a), vertex(c) - vertex(a)));
    for (Triangle& other : mesh.triangles) {
      for (std::size_t l = 0; l < 3; ++l) {
        if (other[l] != b || other[(l + 1) % 3] != a) continue;
        const std::int32_t d = other[(l + 2) % 3];
        const Vec3 first = cross(vertex(a) - vertex(c), vertex(d) - vertex(c)),
                   second = cross(vertex(d) - vertex(c), vertex(b) - vertex(c));
        const double least = .01 * squared_length(vertex(d) - vertex(c));
        if (std::abs(dot(n, vertex(d) - vertex(a))) > 1e-12 || dot(n, first) < least || dot(n, second) < least) continue;
        t = {c, a, d};
        other = {c, d, b};
        l = 3;
      }
    }
  }
  return mesh;
}

// Profiles of a channel, an angle, a hook, a comb and a frame, with limbs of .2 to .3: triangles of such faces may turn over where the
// face does not. The surface is the one that was asked for while limbs are wider than two margins, whatever the triangles.
TEST(Inset, of_faces_that_are_not_convex_does_not_depend_on_how_they_are_split) {
  const std::vector<double> limbs = {0, .2, .5, .7, 1, 1.3};
  int anew = 0;
  for (const std::vector<std::string>& cells : std::vector<std::vector<std::string>>{
           {"xxx", "x.x", "x.x"}, {"xxxx", "x", "x"}, {"xxx", "x.x", "..x", "..x"}, {"xxxxx", "x.x.x", "x...x"}, {"xxx", "x.x", "xxx"}}) {
    for (const double margin : {.02, .06, .098, .103, .12}) {
      TriangleMesh drawn = prism_of_cells(cells, limbs, limbs, .5, 1);
      const Quat turn = normalised(Quat{.9, .3, -.2, .4});
      for (Vec3& p : drawn.vertices) p = rotate(turn, p);
      const FlatFaces faces(drawn);
      const Inset first = inset(drawn, margin);
      for (unsigned seed = 0; seed < 6; ++seed) {
        TriangleMesh other = prism_of_cells(cells, limbs, limbs, .5, seed);
        for (Vec3& p : other.vertices) p = rotate(turn, p);
        for (unsigned times = 0; times < seed; ++times)
          other = turned_within_faces(times % 2 == 0 ? other : split(other, times), seed + times);
        const Inset found = inset(other, margin);
        anew += found.mesh.triangles != other.triangles;
        ASSERT_EQ(found.mesh.triangle_count(), other.triangle_count());
        for (const std::int32_t c : faces.corners()) {
          const auto v = static_cast<std::size_t>(c);
          EXPECT_EQ(found.share[v], first.share[v]) << cells[0] << ' ' << margin << ' ' << seed;
          EXPECT_EQ(found.share[v] == 1, margin < .1) << cells[0] << ' ' << margin << ' ' << seed;
          EXPECT_LT(length(found.mesh.vertices[v] - first.mesh.vertices[v]), 1e-12) << cells[0] << ' ' << margin << ' ' << seed;
        }
        // with the same corners and area, and nothing that crosses: the same surface
        EXPECT_TRUE(find_crossing_pairs(found.mesh, CrossingAt::corners_too).empty()) << cells[0] << ' ' << margin << ' ' << seed;
        EXPECT_NEAR(surface_area(found.mesh), surface_area(first.mesh), 1e-12) << cells[0] << ' ' << margin << ' ' << seed;
        EXPECT_EQ(find_features(found.mesh).corners, faces.corners()) << cells[0] << ' ' << margin << ' ' << seed;
      }
    }
  }
  EXPECT_GT(anew, 30);
}

// Where a triangle inside a face is so flat that mean value weights are infinite, weights are equal.
TEST(Inset, of_a_face_with_a_needle_inside_is_the_smaller_box) {
  TriangleMesh drawn = box_mesh({1, 1, 1});
  const auto top = std::find_if(drawn.triangles.begin(), drawn.triangles.end(), [&](const Triangle& t) {
    return std::all_of(t.begin(), t.end(), [&](std::int32_t v) { return drawn.vertices[static_cast<std::size_t>(v)].z > 0; });
  });
  ASSERT_NE(top, drawn.triangles.end());
  const std::size_t k =
      length(drawn.vertices[static_cast<std::size_t>((*top)[1])] - drawn.vertices[static_cast<std::size_t>((*top)[0])]) > 1.1
          ? 0
          : (length(drawn.vertices[static_cast<std::size_t>((*top)[2])] - drawn.vertices[static_cast<std::size_t>((*top)[1])]) > 1.1 ? 1
                                                                                                                                     : 2);
  const std::int32_t a = (*top)[k], b = (*top)[(k + 1) % 3], c = (*top)[(k + 2) % 3], inside = drawn.vertex_count();
  const Vec3& corner = drawn.vertices[static_cast<std::size_t>(c)];
  drawn.vertices.push_back({1e-10 * corner.x, 1e-10 * corner.y, corner.z});  // off the diagonal from a to b
  *top = {a, b, inside};
  drawn.triangles.push_back({b, c, inside});
  drawn.triangles.push_back({c, a, inside});
  const TriangleMesh moved = inset(drawn, .1).mesh;
  for (std::size_t v = 0; v < 8; ++v)
    for (int i = 0; i < 3; ++i) EXPECT_NEAR(moved.vertices[v][i], std::copysign(.4, drawn.vertices[v][i]), 1e-12);
  EXPECT_LT(length(moved.vertices[8] - Vec3{0, 0, .4}), .5);
}

TEST(Inset, of_smooth_bodies_touches_where_they_are_drawn) {
  for (const int level : {2, 3, 4}) {
    const TriangleMesh drawn = test::icosphere(level);
    for (const double margin : {.02, .1}) {
      const TriangleMesh moved = inset(drawn, margin).mesh;
      expect_sound(drawn, moved);
      EXPECT_LT(deviation_of_inset(drawn, moved, margin).mean, .03 * margin) << level;
    }
  }
}

TEST(Inset, of_rough_rocks_is_sound_and_within_a_tenth_of_the_margin_on_average) {
  for (const unsigned seed : {1, 2, 3, 4}) {
    const TriangleMesh drawn = test::rock(seed, 3);
    for (const double margin : {.02, .05, .1}) {
      const Inset found = inset(drawn, margin);
      expect_sound(drawn, found.mesh);
      EXPECT_LT(deviation_of_inset(drawn, found.mesh, margin).mean, .1 * margin) << seed << ' ' << margin;
    }
  }
}

// A plate thinner than two margins: its faces stay flat and apart, and what is missing of the margin lies outside.
TEST(Inset, of_what_is_thinner_than_two_margins_goes_as_far_as_it_can) {
  const double thickness = .04, margin = .05;
  const TriangleMesh drawn = test::grid_box(4, {1, 1, thickness});
  const Inset found = inset(drawn, margin);
  expect_sound(drawn, found.mesh);
  double top = 0;
  for (std::size_t v = 0; v < drawn.vertices.size(); ++v) {
    if (drawn.vertices[v].z < 0) continue;
    const double z = found.mesh.vertices[v].z;
    if (std::abs(drawn.vertices[v].z - .5 * thickness) > 1e-12) continue;
    EXPECT_GT(z, 0);
    EXPECT_LT(found.share[v], 1);
    if (top == 0) top = z;
    EXPECT_NEAR(z, top, 1e-15);
  }
}

TEST(Inset, caps_the_way_of_needle_corners) {
  TriangleMesh needle;  // a pyramid of 5 degrees
  needle.vertices = {{-.05, -.05, 0}, {.05, -.05, 0}, {.05, .05, 0}, {-.05, .05, 0}, {0, 0, 1}};
  needle.triangles = {{0, 2, 1}, {0, 3, 2}, {0, 1, 4}, {1, 2, 4}, {2, 3, 4}, {3, 0, 4}};
  const double margin = .005;
  const TriangleMesh moved = inset(needle, margin).mesh;
  expect_sound(needle, moved);
  EXPECT_NEAR(length(moved.vertices[4] - needle.vertices[4]), kLongestMove * margin, 1e-12);
}

// Gaps of placed bodies are those of the drawn faces; pressed ones are below 0, and bodies deeper than their margins intersect.
TEST(TouchSurface, gaps_are_those_of_the_drawn_surfaces) {
  Settings settings;
  settings.surface = TouchAt::drawn;
  settings.margin_ratio = .08;
  const PackShape cube = make_pack_shape(make_solid("cube", box_mesh({1, 1, 1})), settings);
  const PackShape ball = make_pack_shape(make_sphere("ball", .3), settings);
  EXPECT_NEAR(cube.margin, .08 * std::cbrt(3 / (4 * std::numbers::pi)), 1e-15);
  const MeshDistanceScratchPtr scratch = make_mesh_distance_scratch();
  for (const double gap : {.2, 1e-6, -1e-3, -1.9 * cube.margin}) {
    EXPECT_NEAR(gap_between({&cube, 1, {}, {}}, {&cube, 1, {1 + gap, 0, 0}, {}}, 1, *scratch), gap, 1e-13);
    if (!(gap > -cube.margin)) continue;
    EXPECT_NEAR(gap_between({&cube, 1, {}, {}}, {&ball, 1, {0, .8 + gap, 0}, {}}, 1, *scratch), gap, 1e-13);
  }
  EXPECT_EQ(gap_between({&cube, 1, {}, {}}, {&cube, 1, {1 - 2.1 * cube.margin, 0, 0}, {}}, 1, *scratch), kIntersect);
  // a cube of twice the size has twice the margin
  EXPECT_NEAR(gap_between({&cube, 1, {}, {}}, {&cube, 2, {1.5 + .01, 0, 0}, {}}, 1, *scratch), .01, 1e-13);
}

}  // namespace
}  // namespace scree
