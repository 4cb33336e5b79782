// The law of a point at concave edges (solver/features/surface_minima.hpp): the potential of one vertex, or of a ball, along paths over
// grooves, pits, cups and dented bodies, against finite differences, under refinement, and against the circle that a fine tube stands for.
// docs/reference/contact-law.md section 3.7.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "core/geometry/nearest_on_triangle.hpp"
#include "solver/features/surface_minima.hpp"
#include "tests/support/shapes.hpp"

namespace scree {
namespace {

using std::numbers::pi;

SolverShape shape_of(const TriangleMesh& mesh) {
  Settings settings;
  settings.surface = TouchAt::outside;
  SolverShape shape = make_solver_shape(make_surface("surface", mesh), settings);
  return shape;
}

/// Prism along y, |y| <= width / 2, over a counterclockwise outline of (x, z).
TriangleMesh prism(const std::vector<std::array<double, 2>>& outline, double width) {
  TriangleMesh mesh;
  const auto n = static_cast<std::int32_t>(outline.size());
  for (const double y : {-0.5 * width, 0.5 * width})
    for (const auto& p : outline) mesh.vertices.push_back({p[0], y, p[1]});
  for (std::int32_t i = 0; i < n; ++i) {
    const std::int32_t j = (i + 1) % n;
    mesh.triangles.push_back({i, n + j, j});
    mesh.triangles.push_back({i, n + i, n + j});
  }
  return mesh;
}

/// Two faces that meet in a concave edge along y through the origin; their normals are `angle` [degrees] apart.
TriangleMesh groove(double angle) {
  const double top = std::tan(angle * pi / 360);
  TriangleMesh mesh;
  mesh.vertices = {{0, -1, 0}, {0, 1, 0}, {1, -1, top}, {1, 1, top}, {-1, -1, top}, {-1, 1, top}};
  mesh.triangles = {{0, 2, 3}, {0, 3, 1}, {0, 1, 5}, {0, 5, 4}};
  return mesh;
}

/// n faces that slope down to the origin.
TriangleMesh pit(int n, double slope) {
  TriangleMesh mesh;
  mesh.vertices.push_back({});
  const double top = .6 * std::tan(slope * pi / 180);
  for (int i = 0; i < n; ++i) {
    const double a = 2 * pi * (i + .31) / n;
    mesh.vertices.push_back({.6 * std::cos(a), .6 * std::sin(a), top});
  }
  for (std::int32_t i = 0; i < n; ++i) mesh.triangles.push_back({0, 1 + i, 1 + (i + 1) % n});
  return mesh;
}

/// Inside of a tube along y; `radius` to the middle of its n facets.
TriangleMesh tube(int n, double radius) {
  std::vector<std::array<double, 2>> outline;
  for (int i = 0; i < n; ++i) {
    const double a = 2 * pi * (i + .5) / n, r = radius / std::cos(pi / n);
    outline.push_back({r * std::sin(a), -r * std::cos(a)});
  }
  return prism(outline, 3 * radius);
}

/// The potential U / k of one vertex, or of a ball's centre, by the law of PotentialModel: U = D^2 / 2, D^8 = sum a d^8.
struct PointPotential {
  PointPotential(const TriangleMesh& mesh, double reach_, double sharing_) : shape(shape_of(mesh)), reach(reach_), sharing(sharing_) {}
  SolverShape shape;
  double reach, sharing;
  std::vector<NearTriangle> near;
  std::vector<SurfaceMinimum> minima;
  double deepest = 0;

  double at(const Vec3& p, Vec3* gradient = nullptr) {
    near.clear();
    for (std::int32_t t = 0; t < shape.mesh.triangle_count(); ++t) {
      const auto [foot, place] = nearest_on_triangle(p, shape.mesh.corner(t, 0), shape.mesh.corner(t, 1), shape.mesh.corner(t, 2));
      if (const double squared = squared_length(p - foot); squared < (reach + sharing) * (reach + sharing))
        near.push_back({t, place, foot, squared});
    }
    find_minima(shape, p, near, reach, sharing, minima);
    if (gradient != nullptr) *gradient = {};
    deepest = 0;
    double sum = 0;
    for (const SurfaceMinimum& m : minima) {
      const double d = reach - std::sqrt(m.squared);
      deepest = std::max(deepest, d);
      sum += m.weight * std::pow(d, 8);
    }
    if (!(sum > 0)) return 0;
    const double D = std::pow(sum, .125);
    for (const SurfaceMinimum& m : minima) {
      if (gradient == nullptr) break;
      const double g = std::sqrt(m.squared), r = (reach - g) / D;
      *gradient += (-D * m.weight * std::pow(r, 7)) * ((1 / g) * (p - m.foot)) + (D * D / 8 * std::pow(r, 8)) * m.gradient;
    }
    return .5 * D * D;
  }
};

struct Named {
  const char* name;
  TriangleMesh mesh;
};
std::vector<Named> concave_shapes() {
  std::vector<Named> shapes;
  for (const double angle : {.5, 5., 14., 30., 60., 90., 130., 165.}) shapes.push_back({"groove", groove(angle)});
  shapes.push_back({"pit of three, 18 degrees", pit(3, 18)});
  shapes.push_back({"pit of three, 50 degrees", pit(3, 50)});
  shapes.push_back({"pit of six", pit(6, 25)});
  shapes.push_back({"pit of twelve", pit(12, 10)});
  shapes.push_back({"L", prism({{-.5, -.5}, {.5, -.5}, {.5, 0}, {0, 0}, {0, .5}, {-.5, .5}}, .6)});
  shapes.push_back({"cup", test::bowl(.5, .4, 16, 6)});
  shapes.push_back({"dented, 320 triangles", test::scaled(test::rock(1, 2, .4), .5)});
  shapes.push_back({"dented, 1280 triangles", test::scaled(test::rock(1, 3, .4), .5)});
  return shapes;
}

/// A place in the surface's outside, nearer than the reach.
bool place_near(const PointPotential& potential, double reach, std::mt19937& g, Vec3& p) {
  std::uniform_real_distribution<double> u(0, 1);
  const TriangleMesh& mesh = potential.shape.mesh;
  const auto t = static_cast<std::int32_t>(u(g) * mesh.triangle_count());
  double a = u(g), b = u(g);
  if (a + b > 1) {
    a = 1 - a;
    b = 1 - b;
  }
  const Vec3 ab = mesh.corner(t, 1) - mesh.corner(t, 0), ac = mesh.corner(t, 2) - mesh.corner(t, 0), n = normalised(cross(ab, ac));
  p = mesh.corner(t, 0) + a * ab + b * ac + (reach * (.3 + .65 * u(g))) * n;
  return true;
}

/// The largest jump of the potential along a straight path, by halving where its change is not that of its gradient [reach^2].
double largest_jump(PointPotential& potential, const Vec3& from, const Vec3& to, int pieces) {
  double jump = 0;
  const double unit = potential.reach * potential.reach;
  for (int i = 0; i < pieces; ++i) {
    Vec3 a = from + (static_cast<double>(i) / pieces) * (to - from), b = from + (static_cast<double>(i + 1) / pieces) * (to - from);
    Vec3 ga, gb;
    double ua = potential.at(a, &ga), ub = potential.at(b, &gb);
    const auto surprise = [](double u0, const Vec3& g0, double u1, const Vec3& g1, const Vec3& way) {
      return std::abs(u1 - u0 - .5 * dot(g0 + g1, way));
    };
    if (potential.deepest > .9 * potential.reach) break;  // the path goes through the surface
    if (surprise(ua, ga, ub, gb, b - a) < 1e-7 * unit) continue;
    for (int n = 0; n < 40; ++n) {
      const Vec3 middle = .5 * (a + b);
      Vec3 g;
      const double u = potential.at(middle, &g);
      if (surprise(ua, ga, u, g, middle - a) > surprise(u, g, ub, gb, b - middle)) {
        b = middle;
        ub = u;
        gb = g;
      } else {
        a = middle;
        ua = u;
        ga = g;
      }
    }
    jump = std::max(jump, std::abs(ub - ua) / unit);
  }
  return jump;
}

constexpr double kReach = .03;

// Minima alone as screens have jumps of 5e-3; the nearest face alone has none, but a kink.
TEST(ConcaveEdge, a_vertex_has_no_jump_of_energy_along_any_path) {
  std::mt19937 g(5);
  for (const Named& shape : concave_shapes()) {
    PointPotential potential(shape.mesh, kReach, kSharingOfVertices * kReach);
    double worst = 0;
    for (int path = 0; path < 40; ++path) {
      Vec3 from, to;
      place_near(potential, kReach, g, from);
      std::normal_distribution<double> n;
      to = from + (.8 * kReach) * normalised(Vec3{n(g), n(g), n(g)});
      worst = std::max(worst, largest_jump(potential, from, to, 60));
    }
    EXPECT_LE(worst, 1e-6) << shape.name;
  }
}

TEST(ConcaveEdge, a_ball_has_no_jump_of_energy_along_any_path) {
  std::mt19937 g(6);
  for (const Named& shape : concave_shapes()) {
    constexpr double kRadius = .25;
    PointPotential potential(shape.mesh, kRadius, kSharingOfBalls * kRadius);
    double worst = 0;
    for (int path = 0; path < 25; ++path) {
      Vec3 from;
      place_near(potential, kRadius, g, from);
      std::normal_distribution<double> n;
      worst = std::max(worst, largest_jump(potential, from, from + (.1 * kRadius) * normalised(Vec3{n(g), n(g), n(g)}), 60));
    }
    EXPECT_LE(worst, 1e-6) << shape.name;
  }
}

TEST(ConcaveEdge, the_force_is_the_gradient_of_the_energy) {
  std::mt19937 g(7);
  int shared = 0, tested = 0;
  for (const Named& shape : concave_shapes()) {
    PointPotential potential(shape.mesh, kReach, kSharingOfVertices * kReach);
    for (int place = 0; place < 150; ++place) {
      Vec3 p, gradient;
      place_near(potential, kReach, g, p);
      if (!(potential.at(p, &gradient) > 0)) continue;
      for (const SurfaceMinimum& m : potential.minima) {
        ASSERT_GT(m.weight, 0) << shape.name;
        ASSERT_LE(m.weight, 1) << shape.name;
      }
      shared += potential.minima.size() > 1 ? 1 : 0;
      constexpr double kStep = 1e-5 * kReach;
      Vec3 difference;
      bool kink = false;
      for (int c = 0; c < 3; ++c) {
        Vec3 step;
        step[c] = kStep;
        const double up = potential.at(p + step), here = potential.at(p), down = potential.at(p - step);
        difference[c] = (up - down) / (2 * kStep);
        kink = kink || std::abs(up - 2 * here + down) > 1e3 * kStep * kStep;  // a foot passes an edge here
      }
      if (kink) continue;
      ++tested;
      EXPECT_LE(length(difference - gradient), 1e-5 * kReach) << shape.name << " place " << place;
    }
  }
  EXPECT_GE(tested, 1500);
  EXPECT_GE(shared, 100) << "the places must have shared minima";
}

// How finely faces are meshed does not matter.
TEST(ConcaveEdge, triangles_split_in_four_change_nothing) {
  std::mt19937 g(8);
  for (const Named& shape : concave_shapes()) {
    PointPotential coarse(shape.mesh, kReach, kSharingOfVertices * kReach);
    PointPotential fine(test::subdivide(shape.mesh, false), kReach, kSharingOfVertices * kReach);
    for (int place = 0; place < 100; ++place) {
      Vec3 p, of_coarse, of_fine;
      place_near(coarse, kReach, g, p);
      EXPECT_NEAR(coarse.at(p, &of_coarse), fine.at(p, &of_fine), 1e-12 * kReach * kReach) << shape.name;
      EXPECT_LE(length(of_coarse - of_fine), 1e-10 * kReach) << shape.name;
    }
  }
}

// Winding does not matter: minima are found by distances.
TEST(ConcaveEdge, the_winding_of_triangles_changes_nothing) {
  std::mt19937 g(9);
  for (const Named& shape : concave_shapes()) {
    TriangleMesh turned = shape.mesh;
    for (std::size_t t = 0; t < turned.triangles.size(); t += 2) std::swap(turned.triangles[t][0], turned.triangles[t][1]);
    PointPotential as_drawn(shape.mesh, kReach, kSharingOfVertices * kReach), mixed(turned, kReach, kSharingOfVertices * kReach);
    for (int place = 0; place < 100; ++place) {
      Vec3 p;
      place_near(as_drawn, kReach, g, p);
      const double u = as_drawn.at(p);
      EXPECT_NEAR(mixed.at(p), u, 1e-9 * kReach * kReach) << shape.name;
    }
  }
}

// A vertex that lies in a groove as far from both faces as it may: half the load each, no force along the groove.
TEST(ConcaveEdge, both_faces_of_a_groove_carry_alike) {
  for (const double angle : {30., 60., 90., 120.}) {
    PointPotential potential(groove(angle), kReach, kSharingOfVertices * kReach);
    Vec3 gradient;
    const double height = .8 * kReach / std::cos(angle * pi / 360);
    ASSERT_GT(potential.at({0, .1, height}, &gradient), 0);
    ASSERT_EQ(potential.minima.size(), 2u) << angle;
    EXPECT_DOUBLE_EQ(potential.minima[0].weight, potential.minima[1].weight) << angle;
    EXPECT_NEAR(gradient.x, 0, 1e-12 * kReach) << angle;
    EXPECT_NEAR(gradient.y, 0, 1e-12 * kReach) << angle;
    EXPECT_LT(gradient.z, 0) << angle;
  }
}

// A fine tube is the circle that it stands for: the ball has the contact of one facet.
TEST(ConcaveEdge, a_ball_in_a_fine_tube_has_the_stiffness_of_the_circle) {
  for (const double ratio : {.1, .5, .9}) {
    constexpr double kTube = 1;
    const double radius = ratio * kTube;
    PointPotential potential(tube(512, kTube), radius, kSharingOfBalls * radius);
    const double depth = .01 * radius, off = kTube - radius + depth;
    for (const double angle : {0., .3, .5, .77}) {  // of a facet's
      const double a = angle * 2 * pi / 512;
      const double u = potential.at({off * std::sin(a), 0, -off * std::cos(a)});
      EXPECT_NEAR(u / (.5 * potential.deepest * potential.deepest), 1, .02) << ratio << " at " << angle;
    }
  }
}

// What the width of sharing changes (docs/reference/contact-law.md section 3.7): the potential over that of the deepest minimum alone, k
// d^2 / 2, at random places. Wider: neighbours that do not touch yet take part of it away; narrower: nothing of it, but two steep faces
// carry twice.
TEST(ConcaveEdge, the_width_of_sharing_moves_the_capacity_little) {
  for (const double share : {1. / 64, 1. / 16, kSharingOfVertices, 1. / 4, 1. / 2}) {
    std::mt19937 g(10);
    double least = 1, most = 1;
    for (const Named& shape : concave_shapes()) {
      PointPotential potential(shape.mesh, kReach, share * kReach);
      for (int place = 0; place < 150; ++place) {
        Vec3 p;
        place_near(potential, kReach, g, p);
        const double u = potential.at(p);
        // a vertex that has just come to touch: its share with those that touch hardly less is the whole story of its depth
        if (!(u > 0) || potential.deepest < .02 * kReach) continue;
        const double ratio = u / (.5 * potential.deepest * potential.deepest);
        least = std::min(least, ratio);
        most = std::max(most, ratio);
      }
    }
    std::printf("sharing %.4f of the margin: U over k d^2 / 2 from %.3f to %.3f\n", share, least, most);
    EXPECT_GE(least, .8) << share;
    EXPECT_LE(most, 1.35) << share;
  }
}

// A ball's sharing is made for depths of R / 100; at others the fine tube is the circle too, but for what its facets lack of it at their
// ends: the sagitta s of a facet, 2 s / d of the energy at the depth d.
TEST(ConcaveEdge, a_ball_in_a_fine_tube_at_other_depths) {
  constexpr int kFacets = 512;
  const double sagitta = 1 / std::cos(pi / kFacets) - 1;
  for (const double radius : {.1, .5, .9}) {
    PointPotential potential(tube(kFacets, 1), radius, kSharingOfBalls * radius);
    for (const double share : {1e-4, 1e-3, .03, .1}) {
      const double depth = share * radius, off = 1 - radius + depth, lost = 2 * sagitta / depth;
      if (lost > 1) continue;
      for (const double angle : {0., .3, .5, .77}) {
        const double a = angle * 2 * pi / kFacets;
        const double u = potential.at({off * std::sin(a), 0, -off * std::cos(a)});
        EXPECT_NEAR(u / (.5 * depth * depth), 1, lost + .005) << radius << " at a depth of " << share << " R, " << angle << " of a facet";
      }
    }
  }
}

// An edge that is convex by less than the angle that is taken for flat leaves no gap between its faces.
TEST(ConcaveEdge, a_ball_above_a_nearly_flat_edge_is_carried) {
  for (const double angle : {1e-3, 1e-4, 3e-5, 1e-6, 1e-9}) {
    TriangleMesh roof = groove(angle * 180 / pi);
    for (Vec3& p : roof.vertices) p.z = -p.z;
    PointPotential potential(roof, .1, kSharingOfBalls * .1);
    for (const double aside : {0., 1e-3 * angle, .03 * angle, .09 * angle}) {
      EXPECT_GT(potential.at({aside, .013, .09}), 0) << angle << " at " << aside;
      EXPECT_EQ(potential.minima.size(), 1u) << angle << " at " << aside;
    }
  }
}

TEST(ConvexSurface, is_told_from_one_with_dents_or_of_two_parts) {
  const auto convex = [](const TriangleMesh& mesh) { return is_convex_surface(mesh, find_features(mesh)); };
  EXPECT_TRUE(convex(test::grid_box(3, {1, 2, 3})));
  EXPECT_TRUE(convex(test::icosphere(3)));
  EXPECT_FALSE(convex(test::rock(1, 2)));
  EXPECT_FALSE(convex(groove(10)));
  TriangleMesh two = test::grid_box(1, {1, 1, 1});
  const std::int32_t count = two.vertex_count();
  for (std::int32_t v = 0; v < count; ++v) two.vertices.push_back(two.vertices[static_cast<std::size_t>(v)] + Vec3{2, 0, 0});
  const std::vector<Triangle> first = two.triangles;
  for (const Triangle& t : first) two.triangles.push_back({t[0] + count, t[1] + count, t[2] + count});
  EXPECT_FALSE(convex(two));
}

}  // namespace
}  // namespace scree
