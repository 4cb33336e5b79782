#include "post/bed/solid_grid.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <string>

#include "core/base/long_work.hpp"
#include "post/run/output_file.hpp"

namespace scree {

namespace {

static_assert(std::endian::native == std::endian::little, "the image says that its numbers are little-endian");

/// A convex polygon: a triangle has at most one corner more for each plane that clips it.
struct Polygon {
  std::array<Vec3, 9> corners;
  int count = 0;
  void add(const Vec3& p) { corners[static_cast<std::size_t>(count++)] = p; }
};

/// The part with sign * (p[axis] - at) >= 0.
Polygon clipped(const Polygon& p, int axis, double at, double sign) {
  Polygon kept;
  for (int i = 0; i < p.count; ++i) {
    const Vec3 &a = p.corners[static_cast<std::size_t>(i)], &b = p.corners[static_cast<std::size_t>((i + 1) % p.count)];
    const double ha = sign * (a[axis] - at), hb = sign * (b[axis] - at);
    if (ha >= 0) kept.add(a);
    if ((ha > 0 && hb < 0) || (ha < 0 && hb > 0)) {
      Vec3 x = a + (ha / (ha - hb)) * (b - a);
      x[axis] = at;
      kept.add(x);
    }
  }
  return kept;
}

struct Span {
  double low = 0, high = 0;
};

Span span_of(const Polygon& p, int axis) {
  Span s{p.corners[0][axis], p.corners[0][axis]};
  for (int i = 1; i < p.count; ++i) {
    s.low = std::min(s.low, p.corners[static_cast<std::size_t>(i)][axis]);
    s.high = std::max(s.high, p.corners[static_cast<std::size_t>(i)][axis]);
  }
  return s;
}

/// Area in the plane of x and y, positive where it faces up, and height of the centroid.
struct Projected {
  double area = 0, height = 0;
};

Projected projected(const Polygon& p) {
  Projected sum;
  const Vec3& o = p.corners[0];
  for (int i = 1; i + 1 < p.count; ++i) {
    const Vec3 &a = p.corners[static_cast<std::size_t>(i)], &b = p.corners[static_cast<std::size_t>(i + 1)];
    const double area = 0.5 * ((a.x - o.x) * (b.y - o.y) - (a.y - o.y) * (b.x - o.x));
    sum.area += area;
    sum.height += area * (o.z + a.z + b.z) / 3;
  }
  sum.height = sum.area != 0 ? sum.height / sum.area : o.z;
  return sum;
}

}  // namespace

SolidGrid::SolidGrid(const GridCells& cells) : cells_(cells), within_(cells.size()), under_(cells.size()) {}

void SolidGrid::add(const TriangleMesh& mesh, const Vec3& shift) {
  const auto plane = [&](std::int64_t i, int axis) { return cells_.lower[axis] + static_cast<double>(i) * cells_.spacing[axis]; };
  // the layer that begins at or below x by its plane as computed: a level face in a plane belongs to one layer
  const auto index_of = [&](double x, int axis) {
    const double place = (x - cells_.lower[axis]) / cells_.spacing[axis];
    const auto count = static_cast<double>(cells_.count[static_cast<std::size_t>(axis)]);
    auto i = static_cast<std::int64_t>(std::floor(std::clamp(place, -1.0, count + 1)));
    while (plane(i, axis) > x && i > -1) --i;
    while (plane(i + 1, axis) <= x && static_cast<double>(i) < count) ++i;
    return i;
  };
  const double top = plane(cells_.count[2], 2);
  /// Calls visit(index, piece) for the pieces of a polygon between the planes of an axis.
  const auto for_each_layer = [&](const Polygon& p, int axis, const auto& visit) {
    const Span s = span_of(p, axis);
    const std::int64_t last = std::min(index_of(s.high, axis), cells_.count[static_cast<std::size_t>(axis)] - 1);
    for (std::int64_t i = std::max<std::int64_t>(index_of(s.low, axis), 0); i <= last; ++i) {
      const double low = plane(i, axis), high = plane(i + 1, axis);
      Polygon piece = p;
      if (s.low < low) piece = clipped(piece, axis, low, 1);
      if (s.high > high && piece.count > 0) piece = clipped(piece, axis, high, -1);
      if (piece.count >= 3) visit(i, piece);
    }
  };
  for (std::int32_t t = 0; t < mesh.triangle_count(); ++t) {
    Polygon triangle;
    for (int k = 0; k < 3; ++k) triangle.add(mesh.corner(t, k) + shift);
    for_each_layer(triangle, 0, [&](std::int64_t ix, const Polygon& in_x) {
      for_each_layer(in_x, 1, [&](std::int64_t iy, const Polygon& in_y) {
        const auto cell = [&](std::int64_t iz) { return static_cast<std::size_t>((iz * cells_.count[1] + iy) * cells_.count[0] + ix); };
        for_each_layer(in_y, 2, [&](std::int64_t iz, const Polygon& piece) {
          const Projected p = projected(piece);
          within_[cell(iz)] += p.area * (p.height - plane(iz, 2));
          under_[cell(iz)] += p.area;
        });
        if (span_of(in_y, 2).high < top) return;  // what lies above the grid, or in its upper side, fills the whole column
        const Polygon above = clipped(in_y, 2, top, 1);
        if (above.count < 3) return;
        const double area = projected(above).area;
        within_[cell(cells_.count[2] - 1)] += area * cells_.spacing.z;
        under_[cell(cells_.count[2] - 1)] += area;
      });
    });
  }
}

std::vector<double> SolidGrid::fractions() const {
  std::vector<double> solid(cells_.size());
  const auto layer = static_cast<std::size_t>(cells_.count[0] * cells_.count[1]);
  for (std::size_t column = 0; column < layer; ++column) {
    double area = 0;
    for (std::int64_t iz = cells_.count[2] - 1; iz >= 0; --iz) {
      const std::size_t cell = static_cast<std::size_t>(iz) * layer + column;
      solid[cell] = (within_[cell] + area * cells_.spacing.z) / cells_.cell_volume();
      area += under_[cell];
    }
  }
  return solid;
}

void write_grid_vti(const std::string& path, const GridCells& cells, const std::vector<double>& solid,
                    const std::vector<std::uint8_t>& in_container) {
  OutputFile file(path);
  const std::size_t bytes = cells.size() * sizeof(float), block = sizeof(std::uint64_t) + bytes;
  file.add(fmt::format(
      "<?xml version=\"1.0\"?>\n<VTKFile type=\"ImageData\" version=\"1.0\" byte_order=\"LittleEndian\" header_type=\"UInt64\">\n"
      "<ImageData WholeExtent=\"0 {0} 0 {1} 0 {2}\" Origin=\"{3} {4} {5}\" Spacing=\"{6} {7} {8}\">\n<Piece Extent=\"0 {0} 0 {1} 0 {2}\">\n"
      "<CellData Scalars=\"void_fraction\">\n",
      cells.count[0], cells.count[1], cells.count[2], cells.lower.x, cells.lower.y, cells.lower.z, cells.spacing.x, cells.spacing.y,
      cells.spacing.z));
  std::size_t offset = 0;
  for (const char* name : {"solid_fraction", "void_fraction", "in_container"}) {
    file.add(fmt::format("<DataArray type=\"Float32\" Name=\"{}\" format=\"appended\" offset=\"{}\"/>\n", name, offset));
    offset += block;
  }
  file.add("</CellData>\n</Piece>\n</ImageData>\n<AppendedData encoding=\"raw\">\n_");
  std::string text;
  const auto add_array = [&](const auto& value) {
    const auto size = static_cast<std::uint64_t>(bytes);
    text.append(reinterpret_cast<const char*>(&size), sizeof size);
    for (std::size_t i = 0; i < cells.size(); ++i) {
      const auto v = static_cast<float>(value(i));
      text.append(reinterpret_cast<const char*>(&v), sizeof v);
      if (text.size() > (1U << 20)) file.add(text), text.clear();
    }
  };
  add_array([&](std::size_t i) { return solid[i]; });
  // bodies that overlap fill a cell twice: closures of a fluid solver divide by what is left
  add_array([&](std::size_t i) { return std::max(0.0, 1 - solid[i]); });
  add_array([&](std::size_t i) { return in_container[i] != 0 ? 1.0 : 0.0; });
  file.add(text + "\n</AppendedData>\n</VTKFile>\n");
  file.commit();
}

}  // namespace scree
