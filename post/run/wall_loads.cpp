#include "post/run/wall_loads.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <numeric>

#include "core/base/csv.hpp"
#include "core/base/error.hpp"
#include "post/run/drawn_meshes.hpp"

namespace scree {

namespace {

/// Sums since the start of triangle t of a wall, 0 in a frame without loads.
struct Sums {
  Vec3 impulse;
  double sliding = 0, damping = 0, contacts = 0, impact = 0;
};
Sums sums_at(const FrameLoads& loads, std::size_t row) {
  if (loads.size() == 0) return {};
  return {loads.impulse[row], loads.sliding_work[row], loads.damping_work[row], loads.contacts[row], loads.impact_energy[row]};
}

void check(const FrameLoads& loads, std::int64_t wall, std::size_t begin, std::size_t count) {
  if (loads.size() == 0) return;
  if (loads.size() < begin + count || loads.wall[begin] != wall || loads.wall[begin + count - 1] != wall)
    throw InputError("loads of a frame are not those of the triangles of wall {}; the frame is damaged or of another scene", wall);
}

}  // namespace

/// By Archard, of the sliding work that a frame's map has; the mesh has lost it at the times when it is worn.
double volume_worn(const Wall& wall, const Frame& frame) {
  double work = 0;
  for (std::size_t row = 0; row < frame.loads.size(); ++row) {
    if (frame.loads.wall[row] == wall.id) work += frame.loads.sliding_work[row];
  }
  return wall.wear * work;
}

bool has_wear(const Scene& scene) {
  return std::any_of(scene.walls.begin(), scene.walls.end(), [](const Wall& wall) { return wall.wear > 0; });
}

bool has_load_maps(const Scene& scene) {
  return std::any_of(scene.walls.begin(), scene.walls.end(), [](const Wall& wall) { return wall.load_map; });
}

double WallLoads::total(std::size_t quantity) const { return std::inner_product(area.begin(), area.end(), values[quantity].begin(), 0.0); }

std::vector<WallLoads> wall_loads(const Scene& scene, const Frame& from, const Frame& to) {
  std::vector<WallLoads> all;
  std::size_t row = 0;
  for (std::size_t w = 0; w < scene.walls.size(); ++w) {
    const Wall& wall = scene.walls[w];
    if (!wall.load_map) continue;
    const TriangleMesh& mesh = scene.shapes[static_cast<std::size_t>(wall.shape)].mesh;
    WallLoads of{w, to.time - from.time, {}, {}, {}, {}, {}};
    const std::vector<Vec3> worn = wall.wear > 0 ? worn_vertices_of(wall, to) : std::vector<Vec3>{};
    check(from.loads, wall.id, row, mesh.triangles.size());
    check(to.loads, wall.id, row, mesh.triangles.size());
    for (std::int32_t t = 0; t < mesh.triangle_count(); ++t, ++row) {
      const Vec3 a = mesh.corner(t, 0), b = mesh.corner(t, 1), c = mesh.corner(t, 2);
      const Vec3 across = cross(b - a, c - a);
      const double twice = length(across), area = 0.5 * wall.scale * wall.scale * twice;
      of.area.push_back(area);
      of.middle.push_back((wall.scale / 3) * (a + b + c));
      const Sums first = sums_at(from.loads, row), last = sums_at(to.loads, row);
      const double per = of.time > 0 && area > 0 ? 1 / (of.time * area) : 0;
      const Vec3 impulse = last.impulse - first.impulse, normal = twice > 0 ? (1 / twice) * across : Vec3{};
      of.impulse += impulse;
      of.push.push_back(impulse);
      const double along = dot(impulse, normal);
      const double values[kLoadQuantities.size()] = {std::abs(along),
                                                     length(impulse - along * normal),
                                                     last.sliding - first.sliding,
                                                     last.damping - first.damping,
                                                     last.contacts - first.contacts,
                                                     last.impact - first.impact,
                                                     0};
      for (std::size_t q = 0; q + 1 < of.values.size(); ++q) of.values[q].push_back(per * values[q]);
      Vec3 receded;
      if (worn.size() == mesh.vertices.size()) {
        for (const std::int32_t v : mesh.triangles[static_cast<std::size_t>(t)])
          receded += (wall.scale / 3) * (worn[static_cast<std::size_t>(v)] - mesh.vertices[static_cast<std::size_t>(v)]);
      }
      of.values.back().push_back(std::abs(dot(receded, normal)));
    }
    all.push_back(std::move(of));
  }
  return all;
}

std::vector<double> on_drawn_walls(const std::vector<WallLoads>& loads, std::size_t quantity, const std::vector<std::size_t>& triangles) {
  std::vector<double> values;
  for (std::size_t w = 0; w < triangles.size(); ++w) {
    const auto it = std::find_if(loads.begin(), loads.end(), [&](const WallLoads& l) { return l.wall == w; });
    if (it != loads.end() && it->area.size() == triangles[w])
      values.insert(values.end(), it->values[quantity].begin(), it->values[quantity].end());
    else
      values.insert(values.end(), triangles[w], 0.0);
  }
  return values;
}

double end_of_scale(const std::vector<WallLoads>& loads, std::size_t quantity) {
  constexpr double kShare = 0.99;
  std::vector<std::pair<double, double>> found;  // value, area
  double area = 0, sum = 0;
  for (const WallLoads& l : loads) {
    for (std::size_t t = 0; t < l.area.size(); ++t) {
      if (!(l.values[quantity][t] > 0)) continue;
      found.emplace_back(l.values[quantity][t], l.area[t]);
      area += l.area[t];
    }
  }
  std::sort(found.begin(), found.end());
  for (const auto& [value, part] : found) {
    sum += part;
    if (sum >= kShare * area) return value;
  }
  return 1;
}

std::size_t load_quantity(const std::string& name) {
  for (std::size_t q = 0; q < kLoadQuantities.size(); ++q) {
    if (name == kLoadQuantities[q].name) return q;
  }
  throw UsageError("'{}' is no quantity of a load map", name);
}

std::vector<std::string> load_names() {
  std::vector<std::string> names;
  for (const LoadQuantity& q : kLoadQuantities) names.emplace_back(q.name);
  return names;
}

std::vector<LoadTable> load_tables(const Run& run, const std::vector<std::size_t>& frames) {
  if (!has_load_maps(run.scene) || frames.empty()) return {};
  // of a wall: areas times densities; power in W, contacts in 1/s
  LoadTable series{"wall_loads.csv",
                   "time,wall,sliding_power,damping_power,contact_rate,impact_power,volume_worn,name\n# units: s,-,W,W,1/s,W,m^3,-\n"};
  LoadTable map{"load_map.csv", "wall,triangle,x,y,z,area"};
  std::string units = "-,-,m,m,m,m^2";
  for (const LoadQuantity& q : kLoadQuantities) {
    map.text += fmt::format(",{}", q.name);
    units += fmt::format(",{}", q.unit);
  }
  map.text += ",name\n# units: " + units + ",-\n";
  // since the start of the run where there is one frame alone
  const Frame first = frames.size() > 1 ? load_frame(run, frames.front()) : Frame{};
  Frame before = first;
  for (std::size_t k = frames.size() > 1 ? 1 : 0; k < frames.size(); ++k) {
    Frame now = load_frame(run, frames[k]);
    for (const WallLoads& l : wall_loads(run.scene, before, now)) {
      series.text += fmt::format("{:.9g},{}", now.time, run.scene.walls[l.wall].id);
      for (std::size_t q = 2; q + 1 < kLoadQuantities.size(); ++q) series.text += fmt::format(",{:.9g}", l.total(q));
      series.text += fmt::format(",{:.9g},{}\n", volume_worn(run.scene.walls[l.wall], now), csv_cell(run.scene.walls[l.wall].name));
    }
    before = std::move(now);
  }
  for (const WallLoads& l : wall_loads(run.scene, first, before)) {
    for (std::size_t t = 0; t < l.area.size(); ++t) {
      const Vec3& x = l.middle[t];
      map.text += fmt::format("{},{},{:.9g},{:.9g},{:.9g},{:.9g}", run.scene.walls[l.wall].id, t, x.x, x.y, x.z, l.area[t]);
      for (const auto& values : l.values) map.text += fmt::format(",{:.9g}", values[t]);
      map.text += fmt::format(",{}\n", csv_cell(run.scene.walls[l.wall].name));
    }
  }
  return {std::move(series), std::move(map)};
}

}  // namespace scree
