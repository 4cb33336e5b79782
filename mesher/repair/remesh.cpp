#include "mesher/repair/remesh.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <unordered_map>
#include <vector>

#include "core/base/error.hpp"
#include "core/base/long_work.hpp"
#include "core/distance/mesh_distance.hpp"
#include "core/geometry/bvh.hpp"
#include "core/geometry/half_edges.hpp"
#include "mesher/repair/winding_field.hpp"

namespace scree {

namespace {

/// Spacing of the cubic lattice (half of the period of either sublattice's cube) for one edge length of the result.
constexpr double kSpacing = 0.6;
/// Nearest to a lattice point that a cut may come, as part of the lattice edge: keeps triangles from losing their area.
constexpr double kNearestCut = 0.02;
/// Halvings of a lattice edge when the place of a cut is sought: to a thousandth of the edge.
constexpr int kHalvings = 10;

/// Points on which the volume of a mesh that is no solid is sampled: enough to see a change of a twentieth in a body that
/// fills a hundredth of its box.
constexpr double kVolumeSamples = 2e5;

/// Lattice points have three coordinates of equal parity: all even or all odd.
struct Lattice {
  Vec3 origin;
  double spacing = 0;
  std::array<std::int64_t, 3> size{};
  std::int64_t index(std::int64_t i, std::int64_t j, std::int64_t k) const { return (k * size[1] + j) * size[0] + i; }
  Vec3 point(std::int64_t index) const {
    const std::int64_t i = index % size[0], j = index / size[0] % size[1], k = index / (size[0] * size[1]);
    return origin + spacing * Vec3{static_cast<double>(i), static_cast<double>(j), static_cast<double>(k)};
  }
};

/// Whether as many triangles run along each edge one way as the other: then the winding number changes at the surface only.
bool is_balanced(const TriangleMesh& mesh) {
  bool balanced = true;
  const std::vector<HalfEdge> half = sorted_half_edges(mesh);
  for_each_edge(half, [&](std::size_t i, std::size_t j) {
    std::int64_t forward = 0;
    for (std::size_t h = i; h < j; ++h) forward += half[h].is_forward ? 1 : -1;
    balanced = balanced && forward == 0;
  });
  return balanced;
}

/// Whether each lattice point is inside. Around a balanced surface points away from it are like their neighbours, so the winding
/// number is computed near the surface and once for each region away from it. With holes it passes one half away from the surface,
/// too, where it spans them, and is computed everywhere.
std::vector<char> find_inside(const TriangleMesh& mesh, const Bvh& bvh, const Lattice& lattice) {
  const WindingField field(mesh);
  const std::int64_t count = lattice.size[0] * lattice.size[1] * lattice.size[2];
  constexpr char kUnknown = 2, kFar = 3;
  std::vector<char> inside(static_cast<std::size_t>(count), 0);
  const double reach = is_balanced(mesh) ? 2 * lattice.spacing : std::numeric_limits<double>::infinity();
  std::vector<std::int64_t> points;
  for (std::int64_t k = 0; k < lattice.size[2]; ++k) {
    for (std::int64_t j = 0; j < lattice.size[1]; ++j) {
      for (std::int64_t i = 0; i < lattice.size[0]; ++i) {
        if ((i ^ j) & 1 || (j ^ k) & 1) continue;
        const std::int64_t n = lattice.index(i, j, k);
        points.push_back(n);
        inside[static_cast<std::size_t>(n)] = kUnknown;
      }
    }
  }
  LongWork work("remesh", static_cast<double>(points.size()));
  for (std::int64_t n : points) {
    work.advance();
    Vec3 nearest;
    std::int32_t triangle;
    const Vec3 p = lattice.point(n);
    const bool is_near = std::isinf(reach) || point_mesh_distance({&mesh, &bvh}, p, reach, nearest, triangle) < reach;
    inside[static_cast<std::size_t>(n)] = is_near ? static_cast<char>(field.at(p) > 0.5) : kFar;
  }
  std::vector<std::int64_t> queue;
  for (std::int64_t seed : points) {
    if (inside[static_cast<std::size_t>(seed)] != kFar) continue;
    const char value = static_cast<char>(field.at(lattice.point(seed)) > 0.5);
    inside[static_cast<std::size_t>(seed)] = value;
    queue.assign(1, seed);
    while (!queue.empty()) {
      const std::int64_t n = queue.back();
      queue.pop_back();
      const std::array<std::int64_t, 3> c{n % lattice.size[0], n / lattice.size[0] % lattice.size[1],
                                          n / (lattice.size[0] * lattice.size[1])};
      for (std::size_t axis = 0; axis < 3; ++axis) {
        for (std::int64_t step : {-2, 2}) {
          std::array<std::int64_t, 3> d = c;
          d[axis] += step;
          if (d[axis] < 0 || d[axis] >= lattice.size[axis]) continue;
          char& next = inside[static_cast<std::size_t>(lattice.index(d[0], d[1], d[2]))];
          if (next != kFar) continue;
          next = value;
          queue.push_back(lattice.index(d[0], d[1], d[2]));
        }
      }
    }
  }
  return inside;
}

}  // namespace

double enclosed_volume(const TriangleMesh& mesh) {
  const WindingField field(mesh);
  const Box3 box = bounding_box(mesh);
  const Vec3 e = box.extent();
  const double whole = e.x * e.y * e.z;
  if (!(whole > 0)) return 0;
  std::array<std::int64_t, 3> size{};
  const double pitch = std::cbrt(whole / kVolumeSamples);
  for (std::size_t k = 0; k < 3; ++k) {
    // a thin box has few layers, and at most so many points along it
    size[k] = static_cast<std::int64_t>(std::clamp(e[static_cast<int>(k)] / pitch, 8.0, std::sqrt(kVolumeSamples)));
  }
  std::int64_t inside = 0;
  for (std::int64_t k = 0; k < size[2]; ++k) {
    for (std::int64_t j = 0; j < size[1]; ++j) {
      for (std::int64_t i = 0; i < size[0]; ++i) {
        const Vec3 part{(static_cast<double>(i) + 0.5) / static_cast<double>(size[0]),
                        (static_cast<double>(j) + 0.5) / static_cast<double>(size[1]),
                        (static_cast<double>(k) + 0.5) / static_cast<double>(size[2])};
        inside += field.at(box.lower + Vec3{part.x * e.x, part.y * e.y, part.z * e.z}) > 0.5 ? 1 : 0;
      }
    }
  }
  return whole * static_cast<double>(inside) / static_cast<double>(size[0] * size[1] * size[2]);
}

TriangleMesh remesh(const TriangleMesh& mesh, double edge_length) {
  if (!(edge_length > 0)) throw UsageError("remesh: an edge length of {:g} m; expected a length > 0", edge_length);
  Lattice lattice;
  lattice.spacing = kSpacing * edge_length;
  const Box3 box = bounding_box(mesh);
  lattice.origin = box.lower - 3 * lattice.spacing * Vec3{1, 1, 1};
  double points = 1;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double steps = box.extent()[static_cast<int>(axis)] / lattice.spacing + 8;
    points *= steps;
    if (!(points < kMaxLatticePoints)) {
      throw UsageError("remesh: edges of {:.4g} m need more than {:g} lattice points; give a larger length", edge_length,
                       kMaxLatticePoints);
    }
    lattice.size[axis] = static_cast<std::int64_t>(steps);
  }
  const Bvh bvh = build_bvh(mesh);
  const std::vector<char> inside = find_inside(mesh, bvh, lattice);

  TriangleMesh result;
  std::unordered_map<std::uint64_t, std::int32_t> cuts;
  const auto total = static_cast<std::uint64_t>(lattice.size[0] * lattice.size[1] * lattice.size[2]);
  const WindingField field(mesh);
  const auto cut = [&](std::int64_t in, std::int64_t out) {
    const std::uint64_t key = static_cast<std::uint64_t>(in) * total + static_cast<std::uint64_t>(out);
    const auto [it, is_new] = cuts.emplace(key, result.vertex_count());
    if (is_new) {
      const Vec3 a = lattice.point(in), b = lattice.point(out);
      double from = 0, to = 1;
      for (int i = 0; i < kHalvings; ++i) {
        const double s = 0.5 * (from + to);
        (field.at(a + s * (b - a)) > 0.5 ? from : to) = s;
      }
      const double s = std::fmin(1 - kNearestCut, std::fmax(kNearestCut, 0.5 * (from + to)));
      result.vertices.push_back(a + s * (b - a));
    }
    return it->second;
  };
  const auto tetrahedron = [&](std::array<std::int64_t, 4> p) {
    std::array<std::int64_t, 4> in{}, out{};
    std::size_t n_in = 0, n_out = 0;
    for (std::int64_t n : p) {
      if (inside[static_cast<std::size_t>(n)])
        in[n_in++] = n;
      else
        out[n_out++] = n;
    }
    if (n_in == 0 || n_out == 0) return;
    const auto add = [&](std::int32_t a, std::int32_t b, std::int32_t c) {
      // outward: away from an inner point
      const Vec3 &x = result.vertices[static_cast<std::size_t>(a)], &y = result.vertices[static_cast<std::size_t>(b)],
                 &z = result.vertices[static_cast<std::size_t>(c)];
      const bool is_outward = dot(cross(y - x, z - x), x - lattice.point(in[0])) > 0;
      result.triangles.push_back(is_outward ? Triangle{a, b, c} : Triangle{a, c, b});
    };
    if (n_in == 1) {
      add(cut(in[0], out[0]), cut(in[0], out[1]), cut(in[0], out[2]));
    } else if (n_in == 3) {
      add(cut(in[0], out[0]), cut(in[1], out[0]), cut(in[2], out[0]));
    } else {
      const std::int32_t a = cut(in[0], out[0]), b = cut(in[0], out[1]), c = cut(in[1], out[1]), d = cut(in[1], out[0]);
      add(a, b, c);
      add(a, c, d);
    }
  };
  // every edge of a sublattice along an axis, with two neighbouring points of the other sublattice around it
  LongWork work("remesh", static_cast<double>(lattice.size[2] * lattice.size[1]));
  for (std::int64_t k = 0; k < lattice.size[2]; ++k) {
    for (std::int64_t j = 0; j < lattice.size[1]; ++j) {
      work.advance();
      for (std::int64_t i = 0; i < lattice.size[0]; ++i) {
        if ((i ^ j) & 1 || (j ^ k) & 1 || i & 1) continue;  // even points only: their edges give all tetrahedra
        for (std::size_t axis = 0; axis < 3; ++axis) {
          std::array<std::int64_t, 3> end{i, j, k};
          end[axis] += 2;
          const std::size_t u = (axis + 1) % 3, v = (axis + 2) % 3;
          std::array<std::int64_t, 3> ring[4];
          constexpr std::int64_t kRing[4][2] = {{1, 1}, {-1, 1}, {-1, -1}, {1, -1}};
          bool fits = end[axis] < lattice.size[axis];
          for (std::size_t r = 0; r < 4; ++r) {
            ring[r] = {i, j, k};
            ring[r][axis] += 1;
            ring[r][u] += kRing[r][0];
            ring[r][v] += kRing[r][1];
            for (std::size_t c = 0; c < 3; ++c) fits = fits && ring[r][c] >= 0 && ring[r][c] < lattice.size[c];
          }
          if (!fits) continue;
          const std::int64_t a = lattice.index(i, j, k), b = lattice.index(end[0], end[1], end[2]);
          for (std::size_t r = 0; r < 4; ++r) {
            const auto &c = ring[r], &d = ring[(r + 1) % 4];
            tetrahedron({a, b, lattice.index(c[0], c[1], c[2]), lattice.index(d[0], d[1], d[2])});
          }
        }
      }
    }
  }
  return result;
}

}  // namespace scree
