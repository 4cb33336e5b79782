// Facets of any number of corners become triangles that cover them once.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "core/geometry/polygons.hpp"

namespace scree {
namespace {

using Outline = std::vector<std::array<double, 2>>;

double area_of(const Outline& outline) {
  double twice = 0;
  for (std::size_t i = 0, j = outline.size() - 1; i < outline.size(); j = i++)
    twice += outline[j][0] * outline[i][1] - outline[i][0] * outline[j][1];
  return 0.5 * twice;
}

/// Cuts the outline, laid into a tilted plane; every triangle must face like it, and their areas must add up to its own: then none
/// overlap, and they cover it.
void expect_covered(const Outline& outline) {
  const Vec3 u = normalised(Vec3{1, 2, -0.5}), n = normalised(cross(u, Vec3{0.3, -1, 2})), v = cross(n, u);
  for (const auto& [e1, e2, up] : {std::tuple(Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, 0, 1}),
                                   std::tuple(Vec3{0, 0, 1}, Vec3{0, 1, 0}, Vec3{-1, 0, 0}), std::tuple(u, v, n)}) {
    for (std::size_t first = 0; first < outline.size(); ++first) {
      PolygonMesh polygons;
      for (std::size_t i = 0; i < outline.size(); ++i) {
        const auto& p = outline[(i + first) % outline.size()];
        polygons.vertices.push_back(Vec3{3, 2, 1} + p[0] * e1 + p[1] * e2);
        polygons.corners.push_back(static_cast<std::int32_t>(i));
      }
      polygons.close_facet();
      PolygonCounts counts;
      const TriangleMesh mesh = triangulated(std::move(polygons), counts);
      EXPECT_EQ(counts.crossing, 0);
      EXPECT_EQ(mesh.triangles.size(), outline.size() - 2);
      double sum = 0;
      for (std::int32_t t = 0; t < mesh.triangle_count(); ++t) {
        const double area = 0.5 * dot(up, cross(mesh.corner(t, 1) - mesh.corner(t, 0), mesh.corner(t, 2) - mesh.corner(t, 0)));
        EXPECT_GT(area, 0) << "triangle " << t << ", first corner " << first;
        sum += area;
      }
      EXPECT_NEAR(sum, area_of(outline), 1e-12 * std::abs(area_of(outline)));
    }
  }
}

TEST(Polygons, of_any_outline_are_covered_once) {
  expect_covered({{0, 0}, {2, 0}, {2, 1}, {0, 1}});
  expect_covered({{0, 0}, {2, 0.5}, {0, 1}, {0.5, 0.5}});                            // an arrow: one diagonal lies outside
  expect_covered({{0, 0}, {2, 0}, {2, 1}, {1, 1}, {1, 2}, {0, 2}});                  // L
  expect_covered({{0, 0}, {1, 0}, {2, 0}, {3, 0}, {3, 1}, {2, 1}, {1, 1}, {0, 1}});  // vertices inside straight sides
  expect_covered(
      {{0, 0}, {7, 0}, {7, 3}, {6, 3}, {6, 1}, {5, 1}, {5, 3}, {4, 3}, {4, 1}, {3, 1}, {3, 3}, {2, 3}, {2, 1}, {1, 1}, {1, 3}, {0, 3}});
  expect_covered({{0, 0}, {5, 0}, {5, 4}, {1, 4}, {1, 2}, {3, 2}, {3, 3}, {2, 3}, {2, 3.5}, {4, 3.5}, {4, 1}, {0, 1}});  // a spiral
  // a square with a hole, joined to the rim by a cut that is walked twice
  expect_covered({{0, 0}, {4, 0}, {4, 4}, {0, 4}, {0, 0}, {1, 1}, {1, 3}, {3, 3}, {3, 1}, {1, 1}});
}

TEST(Polygons, random_stars_are_covered_once) {
  std::mt19937_64 random(1);
  for (int n : {5, 7, 20, 60}) {
    Outline star;
    for (int i = 0; i < n; ++i) {
      const double angle = 2 * std::numbers::pi * i / n, radius = 0.1 + 1e-3 * static_cast<double>(random() % 1000);
      star.push_back({radius * std::cos(angle), radius * std::sin(angle)});
    }
    expect_covered(star);
  }
}

TEST(Polygons, that_cross_themselves_are_counted) {
  PolygonMesh polygons;
  polygons.vertices = {{0, 0, 0}, {1, 1, 0}, {1, 0, 0}, {0, 1, 0}};
  polygons.corners = {0, 1, 2, 3};
  polygons.close_facet();
  polygons.corners.insert(polygons.corners.end(), {0, 1});
  polygons.close_facet();
  PolygonCounts counts;
  EXPECT_EQ(triangulated(std::move(polygons), counts).triangle_count(), 2);
  EXPECT_EQ(counts.crossing, 1);
  EXPECT_EQ(counts.too_few, 1);
}

}  // namespace
}  // namespace scree
