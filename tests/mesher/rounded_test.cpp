// Solids with rounded edges against Steiner's formula: V = V' + A' r + M' r^2 + 4 pi r^3 / 3, of the inner solid with volume V', area A'
// and integral of the mean curvature M', half the sum of edges times the angles between the normals of their faces.
#include "mesher/make/rounded.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "core/base/error.hpp"
#include "mesher/check/mesh_check.hpp"
#include "mesher/edit/convex_hull.hpp"
#include "mesher/make/primitives.hpp"
#include "tests/support/shapes.hpp"

namespace scree {
namespace {

constexpr double kPi = std::numbers::pi;

/// Volume by Steiner's formula of a Platonic solid of edge 1, rounded with r within itself.
struct Platonic {
  const char* name;
  int edges;
  double cosine;  ///< of the angle between neighbouring normals
  double volume, area;

  double rounded(double r) const {
    const double s = 1 - r * area / (3 * volume);
    const double mean_curvature = 0.5 * edges * std::acos(cosine);
    return s * s * s * volume + s * s * area * r + s * mean_curvature * r * r + 4 * kPi / 3 * r * r * r;
  }
};

const double kRoot5 = std::sqrt(5.0), kGolden = 0.5 * (1 + kRoot5);
const Platonic kSolids[] = {{"tetrahedron", 6, -1.0 / 3, 1 / std::sqrt(72.0), std::sqrt(3.0)},
                            {"cube", 12, 0, 1, 6},
                            {"octahedron", 12, 1.0 / 3, std::sqrt(2.0) / 3, 2 * std::sqrt(3.0)},
                            {"dodecahedron", 30, 1 / kRoot5, (15 + 7 * kRoot5) / 4, 3 * std::sqrt(25 + 10 * kRoot5)},
                            {"icosahedron", 30, kRoot5 / 3, 5 * kGolden* kGolden / 6, 5 * std::sqrt(3.0)}};

TEST(Rounded, solids_have_the_volume_of_steiners_formula) {
  for (const Platonic& solid : kSolids) {
    const double r = 0.4 * 3 * solid.volume / solid.area, exact = solid.rounded(r);
    const TriangleMesh sharp = platonic_solid(solid.name);
    double before = 0;
    for (const int steps : {16, 32}) {
      const double edge = std::acos(solid.cosine) / steps * r;
      const MeshCheck check = check_mesh(rounded(sharp, r, edge));
      ASSERT_TRUE(check.is_solid()) << solid.name << ": " << check.problems.front();
      const double error = 1 - check.mass.volume / exact;
      EXPECT_GT(error, 0) << solid.name << ": vertices lie on the rounding";
      EXPECT_LT(error, 0.1 * (edge / r) * (edge / r)) << solid.name;
      if (before > 0) {
        EXPECT_NEAR(before / error, 4, 0.1) << solid.name << ", second order";
      }
      before = error;
    }
  }
}

TEST(Rounded, a_box_has_the_volume_of_steiners_formula_and_its_sides) {
  const Vec3 size{3, 2, 1};
  const double r = 0.3, x = 2.4, y = 1.4, z = 0.4;
  const double exact = x * y * z + 2 * (x * y + y * z + z * x) * r + kPi * (x + y + z) * r * r + 4 * kPi / 3 * r * r * r;
  const TriangleMesh mesh = rounded(box_mesh(size), r, 0.02 * r);
  const MeshCheck check = check_mesh(mesh);
  EXPECT_TRUE(check.is_solid());
  EXPECT_NEAR(check.mass.volume, exact, 0.1 * 0.02 * 0.02 * exact);
  Vec3 highest{};
  for (const Vec3& p : mesh.vertices) highest = {std::max(highest.x, p.x), std::max(highest.y, p.y), std::max(highest.z, p.z)};
  EXPECT_NEAR(length(highest - 0.5 * size), 0, 1e-14);
}

TEST(Rounded, solids_are_convex_and_as_coarse_as_asked_for) {
  for (const Platonic& solid : kSolids) {
    const double r = 0.3 * 3 * solid.volume / solid.area;
    const TriangleMesh mesh = rounded(platonic_solid(solid.name), r, 0.25 * kPi * r);
    const double volume = check_mesh(mesh).mass.volume;
    EXPECT_NEAR(check_mesh(convex_hull(mesh.vertices)).mass.volume, volume, 1e-12 * volume) << solid.name;
  }
  // 8 corners of 4 triangles, 12 edges of 2 strips, 6 faces
  EXPECT_EQ(rounded(box_mesh({1, 1, 1}), 0.2, 0.25 * kPi * 0.2).triangle_count(), 8 * 4 + 12 * 2 * 2 + 6 * 2);
}

TEST(Rounded, a_radius_that_leaves_no_face_is_refused_with_the_largest) {
  try {
    rounded(box_mesh({3e-3, 2e-3, 1e-3}), 0.5e-3, 1e-4);
    FAIL() << "not refused";
  } catch (const UsageError& error) {
    EXPECT_NE(std::string(error.what()).find("500 um found, expected one below that of the largest ball inside, 500 um"), std::string::npos)
        << error.what();
  }
}

}  // namespace
}  // namespace scree
