// Shapes that tests share: icospheres, subdivided boxes and bumpy rocks, made from closed formulas.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numeric>
#include <random>
#include <utility>
#include <vector>

#include "core/geometry/triangle_mesh.hpp"

namespace scree::test {

/// Splits every triangle in four; on_sphere moves new vertices to the unit sphere.
inline TriangleMesh subdivide(const TriangleMesh& mesh, bool on_sphere) {
  TriangleMesh result;
  result.vertices = mesh.vertices;
  std::map<std::pair<std::int32_t, std::int32_t>, std::int32_t> middle;
  const auto between = [&](std::int32_t a, std::int32_t b) {
    const auto key = std::minmax(a, b);
    const auto [it, inserted] = middle.try_emplace({key.first, key.second}, result.vertex_count());
    if (inserted) {
      Vec3 p = 0.5 * (mesh.vertices[static_cast<std::size_t>(a)] + mesh.vertices[static_cast<std::size_t>(b)]);
      if (on_sphere) p = normalised(p);
      result.vertices.push_back(p);
    }
    return it->second;
  };
  for (const Triangle& t : mesh.triangles) {
    const std::int32_t a = between(t[0], t[1]), b = between(t[1], t[2]), c = between(t[2], t[0]);
    result.triangles.insert(result.triangles.end(), {Triangle{t[0], a, c}, Triangle{t[1], b, a}, Triangle{t[2], c, b}, Triangle{a, b, c}});
  }
  return result;
}

/// Unit icosphere: 20 * 4^level triangles, vertices on the unit sphere.
inline TriangleMesh icosphere(int level) {
  const double g = (1 + std::sqrt(5.0)) / 2;
  TriangleMesh mesh;
  mesh.vertices = {{-1, g, 0},  {1, g, 0},  {-1, -g, 0}, {1, -g, 0}, {0, -1, g},  {0, 1, g},
                   {0, -1, -g}, {0, 1, -g}, {g, 0, -1},  {g, 0, 1},  {-g, 0, -1}, {-g, 0, 1}};
  mesh.triangles = {{0, 11, 5}, {0, 5, 1}, {0, 1, 7}, {0, 7, 10}, {0, 10, 11}, {1, 5, 9}, {5, 11, 4}, {11, 10, 2}, {10, 7, 6}, {7, 1, 8},
                    {3, 9, 4},  {3, 4, 2}, {3, 2, 6}, {3, 6, 8},  {3, 8, 9},   {4, 9, 5}, {2, 4, 11}, {6, 2, 10},  {8, 6, 7},  {9, 8, 1}};
  for (Vec3& p : mesh.vertices) p = normalised(p);
  for (int l = 0; l < level; ++l) mesh = subdivide(mesh, true);
  return mesh;
}

/// Non-convex rock of mean radius 1: an icosphere whose radius follows twelve random waves, rms amplitude `roughness`.
/// `flat_levels` further subdivisions change the mesh but not the surface.
inline TriangleMesh rock(unsigned seed, int level, double roughness = 0.22, int flat_levels = 0) {
  std::mt19937 generator(seed);
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> phase(0, 6.283185307179586);
  std::vector<Vec3> wave(12);
  std::vector<double> shift(12);
  for (std::size_t i = 0; i < wave.size(); ++i) {
    const Vec3 d{normal(generator), normal(generator), normal(generator)};
    wave[i] = (2.5 + 3.5 * static_cast<double>(i) / 12) * normalised(d);
    shift[i] = phase(generator);
  }
  TriangleMesh mesh = icosphere(level);
  for (Vec3& p : mesh.vertices) {
    double r = 1;
    for (std::size_t i = 0; i < wave.size(); ++i) r += roughness * std::sqrt(2.0 / 12) * std::sin(dot(wave[i], p) + shift[i]);
    p *= std::fmin(1.6, std::fmax(0.5, r));
  }
  for (int l = 0; l < flat_levels; ++l) mesh = subdivide(mesh, false);
  return mesh;
}

/// Box of the given size, centred, every face an n x n grid of two triangles each.
inline TriangleMesh grid_box(int n, const Vec3& size) {
  TriangleMesh mesh;
  std::map<std::array<int, 3>, std::int32_t> index;
  const auto vertex = [&](std::array<int, 3> c) {
    const auto [it, inserted] = index.try_emplace(c, mesh.vertex_count());
    if (inserted)
      mesh.vertices.push_back({(c[0] / double(n) - 0.5) * size.x, (c[1] / double(n) - 0.5) * size.y, (c[2] / double(n) - 0.5) * size.z});
    return it->second;
  };
  for (int axis = 0; axis < 3; ++axis) {
    for (int side = 0; side < 2; ++side) {
      for (int i = 0; i < n; ++i) {
        for (int j = 0; j < n; ++j) {
          const auto at = [&](int u, int v) {
            std::array<int, 3> c{};
            c[static_cast<std::size_t>(axis)] = side * n;
            c[static_cast<std::size_t>((axis + 1) % 3)] = i + u;
            c[static_cast<std::size_t>((axis + 2) % 3)] = j + v;
            return vertex(c);
          };
          const std::int32_t a = at(0, 0), b = at(1, 0), c = at(1, 1), d = at(0, 1);
          if (side == 1) {
            mesh.triangles.insert(mesh.triangles.end(), {Triangle{a, b, c}, Triangle{a, c, d}});
          } else {
            mesh.triangles.insert(mesh.triangles.end(), {Triangle{a, c, b}, Triangle{a, d, c}});
          }
        }
      }
    }
  }
  return mesh;
}

/// Solid of revolution about z: `profile` holds (r, z) from axis to axis, `sectors` steps around.
inline TriangleMesh revolved(const std::vector<std::array<double, 2>>& profile, int sectors) {
  TriangleMesh mesh;
  std::vector<std::vector<std::int32_t>> ring(profile.size());
  for (std::size_t i = 0; i < profile.size(); ++i) {
    const bool on_axis = profile[i][0] < 1e-12;
    for (int s = 0; s < sectors; ++s) {
      if (!on_axis || s == 0) {
        const double angle = 6.283185307179586 * s / sectors;
        mesh.vertices.push_back({profile[i][0] * std::cos(angle), profile[i][0] * std::sin(angle), profile[i][1]});
      }
      ring[i].push_back(mesh.vertex_count() - 1);
    }
  }
  for (std::size_t i = 0; i + 1 < profile.size(); ++i) {
    for (std::size_t s = 0; s < static_cast<std::size_t>(sectors); ++s) {
      const std::size_t next = (s + 1) % static_cast<std::size_t>(sectors);
      const std::int32_t a = ring[i][s], b = ring[i + 1][s], c = ring[i + 1][next], d = ring[i][next];
      if (b != c) mesh.triangles.push_back({a, c, b});
      if (a != d) mesh.triangles.push_back({a, d, c});
    }
  }
  double volume = 0;
  for (const Triangle& t : mesh.triangles) {
    volume += dot(mesh.vertices[static_cast<std::size_t>(t[0])],
                  cross(mesh.vertices[static_cast<std::size_t>(t[1])], mesh.vertices[static_cast<std::size_t>(t[2])]));
  }
  if (volume < 0) {
    for (Triangle& t : mesh.triangles) std::swap(t[1], t[2]);
  }
  return mesh;
}

/// Bowl of a spherical shell, open upwards, 1.2 rad from its bottom to its rim; centre of the shell at the origin.
inline TriangleMesh bowl(double outer, double inner, int sectors, int rings) {
  std::vector<std::array<double, 2>> profile;
  for (int i = 0; i <= rings; ++i) {
    const double angle = 1.2 * i / rings;
    profile.push_back({i > 0 ? outer * std::sin(angle) : 0.0, -outer * std::cos(angle)});
  }
  for (int i = rings; i >= 0; --i) {
    const double angle = 1.2 * i / rings;
    profile.push_back({i > 0 ? inner * std::sin(angle) : 0.0, -inner * std::cos(angle)});
  }
  return revolved(profile, sectors);
}

/// Slab of width 3.2 and its flat bottom at z = -0.8, whose top of n x n cells is a bumpy hollow.
inline TriangleMesh bumpy_bed(int n = 14) {
  const double width = 3.2;
  TriangleMesh mesh;
  const auto index = [n](int i, int j, int layer) { return static_cast<std::int32_t>((layer * (n + 1) + i) * (n + 1) + j); };
  for (int layer = 0; layer < 2; ++layer) {
    for (int i = 0; i <= n; ++i) {
      for (int j = 0; j <= n; ++j) {
        const double x = -width / 2 + width * i / n, y = -width / 2 + width * j / n;
        const double top = .12 * (x * x + y * y) + .05 * std::sin(5.1 * x + 1) * std::sin(4.3 * y + .4) + .03 * std::sin(9 * x + 2 * y);
        mesh.vertices.push_back({x, y, layer == 0 ? top : -.8});
      }
    }
  }
  const auto quad = [&](std::int32_t a, std::int32_t b, std::int32_t c, std::int32_t d) {
    mesh.triangles.push_back({a, b, c});
    mesh.triangles.push_back({a, c, d});
  };
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j < n; ++j) {
      quad(index(i, j, 0), index(i + 1, j, 0), index(i + 1, j + 1, 0), index(i, j + 1, 0));
      quad(index(i, j, 1), index(i, j + 1, 1), index(i + 1, j + 1, 1), index(i + 1, j, 1));
    }
    quad(index(i, 0, 0), index(i, 0, 1), index(i + 1, 0, 1), index(i + 1, 0, 0));
    quad(index(i + 1, n, 0), index(i + 1, n, 1), index(i, n, 1), index(i, n, 0));
    quad(index(n, i, 0), index(n, i, 1), index(n, i + 1, 1), index(n, i + 1, 0));
    quad(index(0, i + 1, 0), index(0, i + 1, 1), index(0, i, 1), index(0, i, 0));
  }
  return mesh;
}

inline TriangleMesh scaled(TriangleMesh mesh, double s) {
  for (Vec3& p : mesh.vertices) p *= s;
  return mesh;
}

/// The same surface with its vertices and triangles in another order.
inline TriangleMesh shuffled(const TriangleMesh& mesh, std::mt19937& g) {
  TriangleMesh other = mesh;
  std::vector<std::int32_t> order(mesh.vertices.size());
  std::iota(order.begin(), order.end(), 0);
  std::shuffle(order.begin(), order.end(), g);
  for (std::size_t i = 0; i < order.size(); ++i) other.vertices[static_cast<std::size_t>(order[i])] = mesh.vertices[i];
  for (Triangle& t : other.triangles) {
    for (std::int32_t& v : t) v = order[static_cast<std::size_t>(v)];
    std::rotate(t.begin(), t.begin() + g() % 3, t.end());
  }
  std::shuffle(other.triangles.begin(), other.triangles.end(), g);
  return other;
}

inline Quat random_quaternion(std::mt19937& generator) {
  std::normal_distribution<double> normal;
  return normalised(Quat{normal(generator), normal(generator), normal(generator), normal(generator)});
}

}  // namespace scree::test
