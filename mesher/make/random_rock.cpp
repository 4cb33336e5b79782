#include "mesher/make/random_rock.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include "core/base/error.hpp"
#include "mesher/edit/convex_hull.hpp"
#include "mesher/edit/descriptors.hpp"
#include "mesher/edit/mesh_simplify.hpp"
#include "mesher/make/primitives.hpp"
#include "mesher/repair/mesh_repair.hpp"

namespace scree {

namespace {

/// Numbers that depend on the seed alone. Source: SplitMix64 of G. Steele, D. Lea, C. Flood, OOPSLA 2014, 453.
class RandomStream {
 public:
  explicit RandomStream(std::uint64_t seed) : state_(seed) {}
  double uniform() {
    state_ += 0x9E3779B97F4A7C15ULL;
    std::uint64_t z = state_;
    z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9ULL;
    z = (z ^ (z >> 27)) * 0x94D049BB133111EBULL;
    return static_cast<double>((z ^ (z >> 31)) >> 11) * 0x1p-53;
  }
  Vec3 direction() {
    const double z = 2 * uniform() - 1, a = 2 * std::numbers::pi * uniform(), r = std::sqrt(std::fmax(0.0, 1 - z * z));
    return {r * std::cos(a), r * std::sin(a), z};
  }

 private:
  std::uint64_t state_;
};

void check_form(const RockForm& form) {
  const auto expect = [](double value, const char* name, double least, double most) {
    if (!(value >= least && value <= most)) throw UsageError("--{} {}: expected a number from {} to {}", name, value, least, most);
  };
  expect(form.elongation, "elongation", 0.05, 1);
  expect(form.flatness, "flatness", 0.05, 1);
  expect(form.roughness, "roughness", 0, 0.4);
  if (form.triangles < 20 || form.triangles > 5'000'000) throw UsageError("--triangles {}: expected from 20 to 5000000", form.triangles);
}

/// Turns the mesh to its principal axes, the longest along x, and back to its centre of mass.
void to_principal_axes(TriangleMesh& mesh) {
  const MassProperties mass = mass_properties(mesh);
  for (Vec3& p : mesh.vertices) p = rotate_inverse(mass.body_from_principal, p - mass.centre);
}

/// Stretches until the sides of the principal box have the wanted ratios and the volume is that of the diameter.
void shape_to(TriangleMesh& mesh, const RockForm& form) {
  const Vec3 wanted{1, form.elongation, form.elongation * form.flatness};
  // sides follow the axes of inertia, which turn a little with each stretch: a few rounds settle both
  for (int round = 0; round < 24; ++round) {
    to_principal_axes(mesh);
    const Vec3 e = bounding_box(mesh).extent();
    Vec3 stretch{wanted.x / e.x, wanted.y / e.y, wanted.z / e.z};
    const double volume = stretch.x * stretch.y * stretch.z;
    stretch *= 1 / std::cbrt(volume);
    for (Vec3& p : mesh.vertices) p = {p.x * stretch.x, p.y * stretch.y, p.z * stretch.z};
    const Descriptors d = describe(mesh);
    if (std::abs(d.elongation - form.elongation) <= 0.1 * kFormTolerance && std::abs(d.flatness - form.flatness) <= 0.1 * kFormTolerance)
      break;
  }
  to_principal_axes(mesh);
  const double factor = form.diameter / std::cbrt(6 * mass_properties(mesh).volume / std::numbers::pi);
  for (Vec3& p : mesh.vertices) p *= factor;
}

}  // namespace

TriangleMesh random_rock(const RockForm& form) {
  check_form(form);
  RandomStream random(form.seed);
  // waves of the ball: frequency f, amplitude ~ 1 / f, so that the power falls with its square
  constexpr int kOctaves = 5, kWaves = 12;
  struct Wave {
    Vec3 k;
    double phase, amplitude;
  };
  std::vector<Wave> waves;
  double power = 0;
  for (int octave = 0; octave < kOctaves; ++octave) {
    for (int w = 0; w < kWaves; ++w) {
      const double f = 1.5 * std::pow(2.0, octave) * (0.8 + 0.4 * random.uniform());
      waves.push_back({f * random.direction(), 2 * std::numbers::pi * random.uniform(), 1 / f});
      power += 0.5 / (f * f);
    }
  }
  // four times as many triangles as wanted at least, so that simplification can put them where the bumps are
  int level = 2;
  while (20.0 * std::pow(4.0, level) < 2.0 * form.triangles && level < 9) ++level;
  TriangleMesh mesh = icosphere(level);
  const double scale = power > 0 ? form.roughness / std::sqrt(power) : 0;
  for (Vec3& p : mesh.vertices) {
    double r = 1;
    for (const Wave& w : waves) r += scale * w.amplitude * std::sin(dot(w.k, p) + w.phase);
    p *= std::fmax(0.3, r);  // the deepest bumps keep the centre inside
  }
  shape_to(mesh, form);
  simplify_mesh(mesh, form.triangles, false);
  shape_to(mesh, form);
  return mesh;
}

int planes_of_stone(std::int32_t triangles) { return std::max(6, triangles / 8); }

TriangleMesh crushed_stone(const RockForm& form) {
  check_form(form);
  RandomStream random(form.seed);
  // the hull of each step is cut at a plane: corners beyond it go, edges through it end there
  TriangleMesh stone = icosphere(1);
  const int planes = planes_of_stone(form.triangles);
  for (int cut = 0; cut < planes; ++cut) {
    const Vec3 n = random.direction();
    const double offset = 0.62 + 0.25 * random.uniform();
    std::vector<Vec3> corners;
    for (const Vec3& p : stone.vertices) {
      if (dot(n, p) <= offset) corners.push_back(p);
    }
    for (std::int32_t t = 0; t < stone.triangle_count(); ++t) {
      for (int k = 0; k < 3; ++k) {
        const Vec3 &a = stone.corner(t, k), &b = stone.corner(t, (k + 1) % 3);
        const double ha = dot(n, a) - offset, hb = dot(n, b) - offset;
        if (ha < 0 && hb > 0) corners.push_back(a + (ha / (ha - hb)) * (b - a));
      }
    }
    stone = convex_hull(corners);
  }
  shape_to(stone, form);
  clean_mesh(stone, false);  // corners in line on a face leave triangles without area
  return stone;
}

}  // namespace scree
