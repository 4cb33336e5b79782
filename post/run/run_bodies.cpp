#include "post/run/run_bodies.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <set>

#include "core/base/error.hpp"
#include "core/base/numbers.hpp"
#include "post/run/event_table.hpp"

namespace scree {

RunBodies::RunBodies(const Run& run) {
  add_scene(run.scene);
  if (run.scene.inlets.empty() && !run.has_program()) return;
  const bool has_table = std::filesystem::exists(run.folder + "/inserted.csv");
  if (has_table) add_inserted(run);
  if (!has_table || !run.is_finished()) add_frames(run);  // a run that was killed may have bodies that the table lacks
}

void RunBodies::add(const RunBody& body) {
  if (row_.try_emplace(body.id, all.size()).second) all.push_back(body);
}

void RunBodies::add_scene(const Scene& scene) {
  const BodyTable& b = scene.bodies;
  std::int32_t populations = 0;
  for (const std::int32_t p : b.population) populations = std::max(populations, p + 1);
  for (std::int32_t p = 0; p < populations; ++p) origins.push_back(fmt::format("population {}", p));
  origins.emplace_back("[[bodies]]");
  for (const Inlet& inlet : scene.inlets) origins.push_back("inlet " + inlet.name);
  for (std::size_t i = 0; i < b.size(); ++i)
    add({b.id[i], b.shape[i], b.material[i], b.scale[i], b.population[i] < 0 ? populations : b.population[i], b.fixed[i] != 0,
         b.position[i]});
}

void RunBodies::add_inserted(const Run& run) {
  const Scene& scene = run.scene;
  const auto first_inlet = static_cast<std::int32_t>(origins.size() - scene.inlets.size());  // no other was added yet
  const EventTable table(run.folder + "/inserted.csv", {"id", "diameter", "x", "y", "z"}, {"inlet", "shape"}, {"material"});
  for (std::size_t row = 0; row < table.rows(); ++row) {
    if (!table.is_whole(row)) continue;
    const auto shape = std::find_if(scene.shapes.begin(), scene.shapes.end(), [&](const Shape& s) { return s.name == table.text(row, 1); });
    if (shape == scene.shapes.end()) table.refuse(row, fmt::format("the shape '{}'", table.text(row, 1)));
    RunBody body;
    body.id = static_cast<std::int64_t>(table.number(row, 0));
    body.shape = static_cast<std::int32_t>(shape - scene.shapes.begin());
    body.scale = table.number(row, 1) / shape->equivalent_diameter();
    body.start = {table.number(row, 2), table.number(row, 3), table.number(row, 4)};
    if (table.text(row, 0).empty()) {
      const auto& materials = scene.materials;
      const auto material =
          std::find_if(materials.begin(), materials.end(), [&](const Material& m) { return m.name == table.text(row, 2); });
      if (material == materials.end()) table.refuse(row, fmt::format("the material '{}'", table.text(row, 2)));
      body.material = static_cast<std::int32_t>(material - materials.begin());
      body.origin = origin_called("inserted by the program");
      add(body);
      continue;
    }
    const auto inlet = std::find_if(scene.inlets.begin(), scene.inlets.end(), [&](const Inlet& i) { return i.name == table.text(row, 0); });
    if (inlet == scene.inlets.end()) table.refuse(row, fmt::format("the inlet '{}'", table.text(row, 0)));
    body.material = inlet->material;
    body.origin = first_inlet + static_cast<std::int32_t>(inlet - scene.inlets.begin());
    add(body);
  }
}

/// Index of an origin that is added where there is none of this name.
std::int32_t RunBodies::origin_called(const std::string& name) {
  const auto at = std::find(origins.begin(), origins.end(), name);
  if (at != origins.end()) return static_cast<std::int32_t>(at - origins.begin());
  origins.push_back(name);
  return static_cast<std::int32_t>(origins.size() - 1);
}

void RunBodies::add_frames(const Run& run) {
  // where there is one inlet and no program all that came later is from it; else the frames do not say
  const bool is_known = run.scene.inlets.size() == 1 && !run.has_program();
  const std::int32_t origin = is_known ? static_cast<std::int32_t>(origins.size() - 1) : origin_called("came in");
  for (std::size_t f = 0; f < run.frames.size(); ++f) {
    const FrameBodies b = load_frame(run, f, FrameParts::bodies).bodies;
    for (std::size_t i = 0; i < b.size(); ++i) add({b.id[i], b.shape[i], b.material[i], b.scale[i], origin, false, {kNaN, kNaN, kNaN}});
  }
}

const RunBody* RunBodies::find(std::int64_t id) const {
  const auto it = row_.find(id);
  return it != row_.end() ? &all[it->second] : nullptr;
}

std::vector<std::int32_t> RunBodies::kinds(std::int32_t RunBody::*kind) const {
  std::set<std::int32_t> found;
  for (const RunBody& body : all) found.insert(body.*kind);
  return {found.begin(), found.end()};
}

Box3 box_around(const FrameBodies& b, const Scene& scene, const std::vector<std::uint8_t>& counts) {
  const std::vector<double> radius = bounding_radii(scene);
  Box3 box;
  for (std::size_t i = 0; i < b.size(); ++i) {
    if (counts[i] == 0) continue;
    const auto k = static_cast<std::size_t>(b.shape[i]);
    const Shape& shape = scene.shapes[k];
    const Vec3& x = b.position[i];
    const double r = b.scale[i] * radius[k];
    const Box3 ball{x - Vec3{r, r, r}, x + Vec3{r, r, r}};
    if (shape.kind == ShapeKind::sphere) {
      box.add(ball);
      continue;
    }
    // only bodies that can reach further than all before are looked at closely
    bool reaches = box.is_empty();
    for (int axis = 0; axis < 3; ++axis) reaches = reaches || ball.lower[axis] < box.lower[axis] || ball.upper[axis] > box.upper[axis];
    if (!reaches) continue;
    const Mat3 turn = matrix_of(b.orientation[i]);
    for (const Vec3& v : shape.mesh.vertices) box.add(x + turn * (b.scale[i] * v));
  }
  return box;
}

namespace {

/// Distance of a point from a box [m].
double distance_from(const Box3& box, const Vec3& x) {
  const Vec3 out = component_max(component_max(box.lower - x, x - box.upper), Vec3{});
  return length(out);
}

}  // namespace

BodyExtent extent_of_bodies(const Run& run, const std::vector<std::size_t>& frames, const Within& within, const FramePool& pool,
                            const std::unordered_set<std::int64_t>& left_out) {
  BodyExtent extent;
  double diameters = 0, count_of_all = 0;
  const auto task = [&](std::size_t f) {
    const Frame frame = load_frame(run, f, FrameParts::bodies);
    const FrameBodies& b = frame.bodies;
    std::vector<std::uint8_t> in = within.rows(run, frame);
    std::vector<std::size_t> gone;
    double count = 0, diameter = 0;
    for (std::size_t i = 0; i < b.size(); ++i) {
      const bool is_particle = !run.boundary_ids.contains(b.id[i]) && !left_out.contains(b.id[i]);
      if (is_particle && in[i] == 0) gone.push_back(i);
      if (!is_particle) in[i] = 0;
      if (in[i] == 0) continue;
      ++count;
      diameter += b.scale[i] * run.scene.shapes[static_cast<std::size_t>(b.shape[i])].equivalent_diameter();
    }
    const Box3 box = box_around(b, run.scene, in);
    double farthest = 0;
    std::int32_t ranks = 1;
    for (const std::int32_t rank : b.rank) ranks = std::max(ranks, rank + 1);
    for (const std::size_t i : gone) {
      if (!box.is_empty()) farthest = std::max(farthest, distance_from(box, b.position[i]));
    }
    const std::vector<double> numbers{box.lower.x,
                                      box.lower.y,
                                      box.lower.z,
                                      box.upper.x,
                                      box.upper.y,
                                      box.upper.z,
                                      count,
                                      diameter,
                                      farthest,
                                      static_cast<double>(gone.size()),
                                      static_cast<double>(ranks),
                                      static_cast<double>(b.size())};
    return bytes_of(numbers);
  };
  for_each_frame(frames, pool, task, [&](std::size_t, const std::string& bytes) {
    const std::vector<double> n = doubles_of(bytes);
    if (n[6] > 0) {
      extent.box.add(Vec3{n[0], n[1], n[2]});
      extent.box.add(Vec3{n[3], n[4], n[5]});
    }
    extent.most = std::max(extent.most, static_cast<std::size_t>(n[6]));
    count_of_all += n[6];
    diameters += n[7];
    extent.farthest = n[8];
    extent.left = static_cast<std::size_t>(n[9]);
    extent.ranks = std::max(extent.ranks, static_cast<std::int32_t>(n[10]));
    extent.most_of_all = std::max(extent.most_of_all, static_cast<std::size_t>(n[11]));
    extent.left_at_most = std::max(extent.left_at_most, extent.left);
  });
  extent.diameter = count_of_all > 0 ? diameters / count_of_all : 0;
  return extent;
}

std::string words_of_left(const BodyExtent& extent, const Within& within) {
  if (extent.left_at_most == 0) return "";
  const bool is_last = extent.left > 0;
  const std::size_t count = is_last ? extent.left : extent.left_at_most;
  const bool is_one = count == 1;
  std::string text = fmt::format("{} {} {} {}", count, is_one ? "body" : "bodies",
                                 within.is_equipment() ? (is_one ? "has" : "have") : (is_one ? "is" : "are"), within.words());
  if (!is_last) text += " at one time, none at the last frame";
  if (is_last && extent.farthest > 0) text += fmt::format(", the farthest by {:.3g} m", extent.farthest);
  return text;
}

}  // namespace scree
