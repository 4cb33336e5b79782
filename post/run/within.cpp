#include "post/run/within.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <unordered_set>

#include "core/base/error.hpp"
#include "post/run/contact_network.hpp"

namespace scree {

namespace {

constexpr double kFar = std::numeric_limits<double>::infinity();

/// All walls with an end and all fixed bodies of a frame.
Box3 equipment_of(const Run& run, const Frame& frame) {
  const Scene& scene = run.scene;
  Box3 box;
  const std::vector<WallPlace> places = wall_places(frame, scene);
  for (std::size_t w = 0; w < scene.walls.size(); ++w) {
    if (const std::optional<Box3> extent = wall_extent(scene.walls[w], scene, places[w])) box.add(*extent);
  }
  const std::vector<double> radius = bounding_radii(scene);
  const FrameBodies& b = frame.bodies;
  for (std::size_t i = 0; i < b.size(); ++i) {
    if (!run.boundary_ids.contains(b.id[i])) continue;
    const double r = b.scale[i] * radius[static_cast<std::size_t>(b.shape[i])];
    box.add(b.position[i] - Vec3{r, r, r});
    box.add(b.position[i] + Vec3{r, r, r});
  }
  return box;
}

/// The sides beyond which bodies have left.
Box3 open_upwards(Box3 box, const Scene& scene, const UpAxis& up) {
  (up.sign > 0 ? box.upper : box.lower)[up.axis] = up.sign * kFar;
  for (int k = 0; k < 3; ++k) {
    if (!scene.settings.domain.bounded || !scene.settings.domain.periodic[static_cast<std::size_t>(k)]) continue;
    box.lower[k] = -kFar;
    box.upper[k] = kFar;
  }
  return box;
}

/// What is not below it.
Box3 open_sideways(Box3 box, const UpAxis& up) {
  for (int k = 0; k < 3; ++k) {
    if (k == up.axis) continue;
    box.lower[k] = -kFar;
    box.upper[k] = kFar;
  }
  return box;
}

bool reaches_into(const Box3& box, const Vec3& x, double r) {
  for (int k = 0; k < 3; ++k) {
    if (x[k] + r < box.lower[k] || x[k] - r > box.upper[k]) return false;
  }
  return true;
}

/// Whether every body begins, and comes in, inside.
bool all_begin_in(const Run& run, const Box3& box, const Frame& first) {
  const Scene& scene = run.scene;
  const std::vector<double> radius = bounding_radii(scene);
  const FrameBodies& b = first.bodies;
  for (std::size_t i = 0; i < b.size(); ++i) {
    if (run.boundary_ids.contains(b.id[i])) continue;
    if (!reaches_into(box, b.position[i], b.scale[i] * radius[static_cast<std::size_t>(b.shape[i])])) return false;
  }
  return std::all_of(scene.inlets.begin(), scene.inlets.end(), [&](const Inlet& inlet) {
    const RegionShape& r = inlet.region;
    const std::optional<Box3> extent = wall_extent(r, scene, {r.position, r.orientation});
    return extent && reaches_into(box, extent->lower, 0) && reaches_into(box, extent->upper, 0);
  });
}

std::string list_of_walls(const Scene& scene) {
  std::string list;
  for (const Wall& wall : scene.walls) list += (list.empty() ? "" : ", ") + (wall.name.empty() ? fmt::format("{}", wall.id) : wall.name);
  return list.empty() ? "no walls" : "the walls " + list;
}

}  // namespace

UpAxis up_axis(const Vec3& gravity) {
  UpAxis up;
  if (!(squared_length(gravity) > 0)) return up;
  for (int k = 0; k < 3; ++k) {
    if (std::abs(gravity[k]) > std::abs(gravity[up.axis])) up.axis = k;
  }
  up.sign = gravity[up.axis] > 0 ? -1 : 1;
  return up;
}

Within Within::equipment(const Run& run) {
  const Scene& scene = run.scene;
  Within within;
  const bool has_plane = std::any_of(scene.walls.begin(), scene.walls.end(), [](const Wall& w) { return w.kind == WallKind::plane; });
  if (has_plane || !(squared_length(scene.settings.gravity) > 0)) return within;
  const Frame first = load_frame(run, 0, FrameParts::bodies);
  within.start_ = equipment_of(run, first);
  if (within.start_.is_empty()) return within;
  const Box3 box = open_upwards(within.start_, scene, up_axis(scene.settings.gravity));
  if (all_begin_in(run, box, first))
    within.kind_ = Kind::equipment;
  else if (all_begin_in(run, open_sideways(box, up_axis(scene.settings.gravity)), first))
    within.kind_ = Kind::above_bottom;
  within.words_ = "left the equipment";
  return within;
}

Within Within::named(const Run& run, const std::string& text) {
  if (text.empty()) return equipment(run);
  Within within;
  if (text == "all") return within;
  const std::vector<Wall>& walls = run.scene.walls;
  for (std::size_t w = 0; w < walls.size(); ++w) {
    if (walls[w].name != text && fmt::format("{}", walls[w].id) != text) continue;
    within.kind_ = Kind::wall;
    within.wall_ = w;
    within.words_ = "outside of the wall " + text;
    return within;
  }
  if (text.find(':') == std::string::npos) {
    throw UsageError("--within {}: no wall of the scene has this name or id; it has {}; else give a region, as in box:0,0,0,1,1,1, or all",
                     text, list_of_walls(run.scene));
  }
  within.kind_ = Kind::region;
  within.region_ = parse_region(text);
  within.words_ = "outside of " + text;
  return within;
}

std::vector<std::uint8_t> Within::rows(const Run& run, const Frame& frame) const {
  const FrameBodies& b = frame.bodies;
  const Scene& scene = run.scene;
  std::vector<std::uint8_t> in(b.size(), 1);
  if (is_everywhere()) return in;
  const UpAxis up = up_axis(scene.settings.gravity);
  const std::vector<double> radius = bounding_radii(scene);
  const Periodicity period = periodicity_of(scene, frame);
  // of a body and its images at periodic sides
  const auto any_image = [&](const Vec3& x, const auto& is_held) {
    if (is_held(x)) return true;
    if (!period.any()) return false;
    const Periodicity near = period.with_least_shear();
    for (int x_step = -1; x_step <= 1; ++x_step) {
      for (int y_step = -1; y_step <= 1; ++y_step) {
        for (int z_step = -1; z_step <= 1; ++z_step) {
          if (is_held(x + near.shift({1.0 * x_step, 1.0 * y_step, 1.0 * z_step}))) return true;
        }
      }
    }
    return false;
  };
  Box3 box;
  WallPlace place;
  Region inside;
  const Wall* wall = kind_ == Kind::wall ? &scene.walls[wall_] : nullptr;
  if (wall != nullptr) {
    place = wall_places(frame, scene)[wall_];
    if (wall->kind == WallKind::mesh)
      box = open_upwards(*wall_extent(*wall, scene, place), scene, up);
    else if (wall->kind != WallKind::plane)
      inside = inside_of(*wall);
  } else if (is_equipment()) {
    box = start_;
    box.add(equipment_of(run, frame));
    box = open_upwards(box, scene, up);
    if (kind_ == Kind::above_bottom) box = open_sideways(box, up);
  }
  for (std::size_t i = 0; i < b.size(); ++i) {
    if (run.boundary_ids.contains(b.id[i])) continue;
    const Vec3& x = b.position[i];
    bool is_in = true;
    if (kind_ == Kind::region) {
      is_in = any_image(x, [&](const Vec3& at) { return region_.contains(at); });
    } else if (is_equipment()) {
      is_in = reaches_into(box, x, b.scale[i] * radius[static_cast<std::size_t>(b.shape[i])]);
    } else if (wall->kind == WallKind::mesh) {
      is_in = reaches_into(box, x, 0);
    } else {
      const auto own = [&](const Vec3& at) { return rotate(conjugate(place.orientation), at - place.position); };
      is_in = wall->kind == WallKind::plane ? dot(own(x) - wall->point, wall->normal) > 0
                                            : any_image(x, [&](const Vec3& at) { return inside.contains(own(at)); });
    }
    in[i] = is_in ? 1 : 0;
  }
  return in;
}

Frame Within::part_of(const Run& run, Frame frame) const {
  if (is_everywhere()) return frame;
  const std::vector<std::uint8_t> in = rows(run, frame);
  std::unordered_set<std::int64_t> left;
  std::vector<std::size_t> kept;
  for (std::size_t i = 0; i < in.size(); ++i) {
    if (in[i] != 0)
      kept.push_back(i);
    else
      left.insert(frame.bodies.id[i]);
  }
  if (left.empty()) return frame;
  take_rows(frame.bodies, kept);
  kept.clear();
  for (std::size_t i = 0; i < frame.contacts.size(); ++i) {
    if (!left.contains(frame.contacts.body_a[i]) && !left.contains(frame.contacts.body_b[i])) kept.push_back(i);
  }
  take_rows(frame.contacts, kept);
  return frame;
}

}  // namespace scree
