#include "core/geometry/worn_mesh.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "core/base/error.hpp"
#include "core/geometry/closed_mesh.hpp"
#include "core/geometry/mass_properties.hpp"

namespace scree {
namespace {

/// A box whose faces are n x n squares of two triangles, from 0 to size.
TriangleMesh fine_box(const Vec3& size, int n) {
  TriangleMesh mesh;
  const auto vertex = [&](const Vec3& p) {
    for (std::size_t v = 0; v < mesh.vertices.size(); ++v) {
      if (mesh.vertices[v] == p) return static_cast<std::int32_t>(v);
    }
    mesh.vertices.push_back(p);
    return mesh.vertex_count() - 1;
  };
  for (int axis = 0; axis < 3; ++axis) {
    for (const int side : {0, 1}) {
      const auto at = [&](int i, int j) {
        Vec3 p;
        p[axis] = side * size[axis];
        p[(axis + 1) % 3] = size[(axis + 1) % 3] * i / n;
        p[(axis + 2) % 3] = size[(axis + 2) % 3] * j / n;
        return vertex(p);
      };
      for (int i = 0; i < n; ++i) {
        for (int j = 0; j < n; ++j) {
          const std::int32_t a = at(i, j), b = at(i + 1, j), c = at(i + 1, j + 1), d = at(i, j + 1);
          if (side == 1) {
            mesh.triangles.push_back({a, b, c});
            mesh.triangles.push_back({a, c, d});
          } else {
            mesh.triangles.push_back({a, c, b});
            mesh.triangles.push_back({a, d, c});
          }
        }
      }
    }
  }
  return mesh;
}

double height_of(const TriangleMesh& mesh, std::int32_t t) { return (mesh.corner(t, 0).z + mesh.corner(t, 1).z + mesh.corner(t, 2).z) / 3; }

TEST(WornMesh, a_closed_mesh_loses_the_volume_that_is_worn_off) {
  const TriangleMesh box = fine_box({1, 2, 0.5}, 6);
  ASSERT_TRUE(is_closed(box));
  WearOfMesh wear{std::vector<double>(box.triangles.size(), 0.0), std::vector<signed char>(box.triangles.size(), -1)};
  double total = 0;
  for (std::int32_t t = 0; t < box.triangle_count(); ++t) {  // the top, unevenly; and one triangle of a side
    if (height_of(box, t) == 0.5) total += wear.volume[static_cast<std::size_t>(t)] = 1e-4 * (1 + t % 7);
  }
  total += wear.volume[0] = 3e-4;
  TriangleMesh worn = box;
  worn.vertices = worn_vertices(box, wear);
  const double lost = mass_properties(box).volume - mass_properties(worn).volume;
  EXPECT_NEAR(lost, total, 1e-12 * total + 1e-15);
  EXPECT_NEAR(swept_volume(box, worn.vertices, wear.pushed), total, 1e-12 * total);
}

TEST(WornMesh, a_crease_stays_in_the_face_that_is_not_worn) {
  const TriangleMesh box = fine_box({1, 1, 1}, 4);
  WearOfMesh wear{std::vector<double>(box.triangles.size(), 0.0), std::vector<signed char>(box.triangles.size(), -1)};
  for (std::int32_t t = 0; t < box.triangle_count(); ++t) {
    if (height_of(box, t) == 1) wear.volume[static_cast<std::size_t>(t)] = 1e-3;
  }
  const std::vector<Vec3> worn = worn_vertices(box, wear);
  for (std::size_t v = 0; v < worn.size(); ++v) {
    const Vec3 way = worn[v] - box.vertices[v];
    EXPECT_EQ(way.x, 0);
    EXPECT_EQ(way.y, 0);
    if (box.vertices[v].z == 1)
      EXPECT_LT(way.z, 0);
    else
      EXPECT_EQ(way.z, 0);
  }
}

TEST(WornMesh, an_open_sheet_recedes_from_the_side_that_is_pressed) {
  TriangleMesh sheet{{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}}, {{0, 1, 2}, {0, 2, 3}}};
  for (const signed char pushed : {-1, 1}) {
    const WearOfMesh wear{{0.01, 0.02}, {pushed, pushed}};
    const std::vector<Vec3> worn = worn_vertices(sheet, wear);
    for (const Vec3& p : worn) EXPECT_GT(p.z * pushed, 0);
    EXPECT_NEAR(swept_volume(sheet, worn, wear.pushed), 0.03, 1e-15);
  }
  // what rubs off nothing changes nothing
  const std::vector<Vec3> same = worn_vertices(sheet, {{0, 0}, {1, 1}});
  EXPECT_EQ(same, sheet.vertices);
}

TEST(WornMesh, more_than_there_is_is_refused) {
  const TriangleMesh box = fine_box({1, 1, 0.125}, 2);
  WearOfMesh wear{std::vector<double>(box.triangles.size(), 0.0), std::vector<signed char>(box.triangles.size(), -1)};
  for (std::int32_t t = 0; t < box.triangle_count(); ++t) {
    if (height_of(box, t) == 0.125) wear.volume[static_cast<std::size_t>(t)] = 1;
  }
  EXPECT_THROW(worn_vertices(box, wear), InputError);
}

}  // namespace
}  // namespace scree
