#include "decomposer/preview.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "core/base/error.hpp"
#include "decomposer/cut/compare_cuts.hpp"

namespace scree {

namespace {

template <class Values>
std::string data_array(const std::string& type, const std::string& name, int components, const Values& values, const char* format) {
  std::string text =
      fmt::format("<DataArray type=\"{}\" Name=\"{}\" NumberOfComponents=\"{}\" format=\"ascii\">\n", type, name, components);
  for (std::size_t i = 0; i < values.size(); ++i) {
    text += fmt::format(fmt::runtime(format), values[i]);
    text += (i + 1) % 12 == 0 ? '\n' : ' ';
  }
  return text + "\n</DataArray>\n";
}

}  // namespace

std::string preview_file(const Scene& scene, const std::vector<double>& predicted_work) {
  SCREE_ASSERT(scene.bodies.owner.size() == scene.bodies.size(), "a scene without owners has no parts");
  const std::size_t bodies = scene.bodies.size();
  std::vector<double> points;
  std::vector<std::int64_t> id(scene.bodies.id), vertex_ends, line_points, line_ends, cell_part, kind, vertices;
  std::vector<double> radius = bounding_radii(scene), work = predicted_work;
  Box3 all;
  for (std::size_t i = 0; i < bodies; ++i) {
    const Vec3& p = scene.bodies.position[i];
    const Vec3 reach{radius[i], radius[i], radius[i]};
    all.add(p - reach);
    all.add(p + reach);
    points.insert(points.end(), {p.x, p.y, p.z});
    vertices.push_back(static_cast<std::int64_t>(i));
    vertex_ends.push_back(static_cast<std::int64_t>(i) + 1);
    cell_part.push_back(scene.bodies.owner[i]);
    kind.push_back(0);
  }
  std::int64_t point_count = static_cast<std::int64_t>(bodies);
  for (std::size_t part = 0; part < scene.partition.lower.size(); ++part) {
    // outer sides lie at infinity: the outlines end where the bodies do
    const Vec3 low = component_max(scene.partition.lower[part], all.lower), high = component_min(scene.partition.upper[part], all.upper);
    if (low.x > high.x || low.y > high.y || low.z > high.z) continue;
    for (int corner = 0; corner < 8; ++corner) {
      points.insert(points.end(), {(corner & 1 ? high : low).x, (corner & 2 ? high : low).y, (corner & 4 ? high : low).z});
      id.push_back(-1);
      radius.push_back(0);
      work.push_back(0);
    }
    for (int corner = 0; corner < 8; ++corner) {
      for (const int bit : {1, 2, 4}) {
        if ((corner & bit) != 0) continue;
        line_points.insert(line_points.end(), {point_count + corner, point_count + (corner | bit)});
        line_ends.push_back(static_cast<std::int64_t>(line_points.size()));
        cell_part.push_back(static_cast<std::int64_t>(part));
        kind.push_back(1);
      }
    }
    point_count += 8;
  }
  std::string text =
      "<?xml version=\"1.0\"?>\n<VTKFile type=\"PolyData\" version=\"1.0\" byte_order=\"LittleEndian\" "
      "header_type=\"UInt64\">\n<PolyData>\n";
  text += fmt::format("<Piece NumberOfPoints=\"{}\" NumberOfVerts=\"{}\" NumberOfLines=\"{}\" NumberOfStrips=\"0\" NumberOfPolys=\"0\">\n",
                      point_count, bodies, line_ends.size());
  text += "<PointData>\n" + data_array("Int64", "id", 1, id, "{}") + data_array("Float64", "radius", 1, radius, "{:.9g}") +
          data_array("Float64", "predicted_work", 1, work, "{:.6g}") + "</PointData>\n";
  text += "<CellData>\n" + data_array("Int64", "part", 1, cell_part, "{}") + data_array("Int64", "kind", 1, kind, "{}") + "</CellData>\n";
  text += "<Points>\n" + data_array("Float64", "Points", 3, points, "{:.9g}") + "</Points>\n";
  text += "<Verts>\n" + data_array("Int64", "connectivity", 1, vertices, "{}") + data_array("Int64", "offsets", 1, vertex_ends, "{}") +
          "</Verts>\n";
  text += "<Lines>\n" + data_array("Int64", "connectivity", 1, line_points, "{}") + data_array("Int64", "offsets", 1, line_ends, "{}") +
          "</Lines>\n";
  return text + "</Piece>\n</PolyData>\n</VTKFile>\n";
}

std::vector<int> preview_ranks(int ranks, std::size_t bodies) {
  std::vector<int> counts{ranks};
  for (int n = 1; n <= std::max(16, 4 * ranks); n *= 2) counts.push_back(n);
  std::sort(counts.begin(), counts.end());
  counts.erase(std::unique(counts.begin(), counts.end()), counts.end());
  std::erase_if(counts, [&](int n) { return static_cast<std::size_t>(n) > bodies && n != ranks; });
  return counts;
}

}  // namespace scree
