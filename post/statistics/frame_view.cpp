#include "post/statistics/frame_view.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "post/run/contact_network.hpp"
#include "post/run/drawn_meshes.hpp"
#include "post/run/run_bodies.hpp"
#include "post/statistics/volume_samples.hpp"

namespace scree {

namespace {

// More points are more exact (a layer as thick as a body is counted to about 1 / points^(2/3)); these cost about 0.05 s a frame.
constexpr std::size_t kSamplesPerFrame = 3000000;
constexpr std::size_t kMinSamples = 32, kMaxSamples = 2000;

std::vector<std::uint8_t> particles_of(const Run& run, const Frame& frame) {
  std::vector<std::uint8_t> are;
  for (const std::int64_t id : frame.bodies.id) are.push_back(run.boundary_ids.contains(id) ? 0 : 1);
  return are;
}

}  // namespace

Container container_of(const Scene& scene, const std::optional<Region>& given, const Box3& room) {
  Container c;
  const UpAxis up = up_axis(scene.settings.gravity);
  c.vertical = up.axis;
  c.up = up.sign;
  if (given) {
    c.room = *given;
  } else {
    c.room.kind = Region::Kind::box;
    if (!room.is_empty()) {  // else there are no particles, and nothing has a volume
      c.room.lower = room.lower;
      c.room.upper = room.upper;
    }
    for (std::size_t w = 0; w < scene.walls.size(); ++w) {
      const Wall& wall = scene.walls[w];
      if (wall.kind == WallKind::box_inside) {
        c.room.lower = wall.lower;
        c.room.upper = wall.upper;
      } else if (wall.kind == WallKind::cylinder_inside) {
        c.room.kind = Region::Kind::cylinder;
        c.room.lower = wall.axis_start;
        c.room.upper = wall.axis_end;
        c.room.radius = wall.radius;
      } else {
        continue;
      }
      c.wall = static_cast<int>(w);
      break;
    }
    const Domain& domain = scene.settings.domain;
    for (int k = 0; domain.bounded && c.room.kind == Region::Kind::box && k < 3; ++k) {
      if (!domain.periodic[static_cast<std::size_t>(k)]) continue;
      c.room.lower[k] = domain.lower[k];
      c.room.upper[k] = domain.upper[k];
    }
  }
  return c;
}

double Container::volume_in(const Box3& box, int lines) const {
  if (room.kind != Region::Kind::box) return room.volume_in(box, lines);
  Region open = room;
  open.lower[vertical] = box.lower[vertical];
  open.upper[vertical] = box.upper[vertical];
  return open.volume_in(box);
}

double Container::ring_volume_in(const Box3& box, double inner, double outer) const {
  if (room.kind == Region::Kind::box)
    return std::numbers::pi * (outer * outer - inner * inner) * (box.upper[vertical] - box.lower[vertical]);
  const auto core = [&](double radius) {
    Region cylinder = room;
    cylinder.radius = radius;
    return radius > 0 ? cylinder.volume_in(box) : 0.0;
  };
  return core(outer) - core(inner);
}

double Container::distance_from_axis(const Vec3& p) const {
  Vec3 d = p - room.lower;
  if (room.kind == Region::Kind::box) {
    d = p - room.bounds().centre();
    d[vertical] = 0;
    return length(d);
  }
  const Vec3 axis = normalised(room.upper - room.lower);
  return length(d - dot(d, axis) * axis);
}

double FrameView::room_between(double low, double high) const {
  Box3 slab = facts.container.room.bounds();
  slab.lower[facts.container.vertical] = low;
  slab.upper[facts.container.vertical] = high;
  return high > low ? facts.container.volume_in(slab) : 0;
}

SceneFacts::SceneFacts(const Run& the_run, const std::optional<Region>& given, const Box3& room, std::size_t most)
    : run(&the_run),
      container(container_of(the_run.scene, given, room)),
      period(periodicity_of(the_run.scene, Frame{})),
      cell_lower(the_run.scene.settings.domain.lower) {
  const std::size_t per_body =
      std::clamp(kSamplesPerFrame / std::max({std::size_t{1}, most, the_run.scene.bodies.size()}), kMinSamples, kMaxSamples);
  for (const Shape& shape : the_run.scene.shapes) {
    volume.push_back(shape.mass.volume);
    diameter.push_back(shape.equivalent_diameter());
    samples.push_back(shape.kind == ShapeKind::surface ? std::vector<Vec3>{Vec3{}} : volume_samples(shape, per_body));
  }
}

SceneFacts::SceneFacts(const Run& the_run, const std::optional<Region>& given, const Frame& frame)
    : SceneFacts(the_run, given, box_around(frame.bodies, the_run.scene, particles_of(the_run, frame)), frame.bodies.size()) {}

Region SceneFacts::within_a_period(Region region) const {
  for (int k = 0; region.kind == Region::Kind::box && k < 3; ++k) {
    if (!period.is_periodic(k) || !(region.upper[k] - region.lower[k] > period.period()[k])) continue;
    region.lower[k] = cell_lower[k];
    region.upper[k] = cell_lower[k] + period.period()[k];
  }
  return region;
}

int SceneFacts::images_in(const Region& region, const Vec3& point) const {
  if (!period.any()) return region.contains(point) ? 1 : 0;
  int count = 0;
  for_each_image(region, [&](const Vec3& shift) { count += region.contains(point + shift) ? 1 : 0; });
  return count;
}

namespace {

constexpr double kMoved = 1e-12;  // of where a wall reaches: a cylinder that turns about its own axis moves by roundings

std::optional<WallPlace> place_of_container(const SceneFacts& facts, const Frame& frame) {
  if (facts.container.wall < 0) return std::nullopt;
  return wall_places(frame, facts.run->scene)[static_cast<std::size_t>(facts.container.wall)];
}

bool is_turned(const Container& container, const WallPlace& place) {
  return container.room.kind == Region::Kind::box && !(place.orientation == Quat{});
}

/// The container where its wall is in a frame; nothing where it is as at the start, or where no box along the axes is its inside.
std::optional<Region> moved_container(const SceneFacts& facts, const Frame& frame) {
  const std::optional<WallPlace> place = place_of_container(facts, frame);
  if (!place || is_turned(facts.container, *place)) return std::nullopt;
  const Region& start = facts.container.room;
  Region room = start;
  room.lower = place->position + rotate(place->orientation, start.lower);
  room.upper = place->position + rotate(place->orientation, start.upper);
  for (int k = 0; room.kind == Region::Kind::box && k < 3; ++k) {
    if (!facts.run->scene.settings.domain.periodic[static_cast<std::size_t>(k)]) continue;
    room.lower[k] = start.lower[k];
    room.upper[k] = start.upper[k];
  }
  const double reach = std::max(length(start.lower), length(start.upper)) + start.radius;
  if (length(room.lower - start.lower) <= kMoved * reach && length(room.upper - start.upper) <= kMoved * reach) return std::nullopt;
  return room;
}

std::shared_ptr<const SceneFacts> facts_of_frame(const SceneFacts& facts, const Frame& frame) {
  const std::optional<Region> moved = moved_container(facts, frame);
  if (frame.cell.size() == 0 && !moved) return nullptr;
  auto own = std::make_shared<SceneFacts>(facts);
  Region& room = own->container.room;
  if (moved) room = *moved;
  if (frame.cell.size() == 0) return own;
  own->period = periodicity_of(facts.run->scene, frame);
  own->cell_lower = frame.cell.lower[0];
  for (int k = 0; room.kind == Region::Kind::box && k < 3; ++k) {
    const Domain& start = facts.run->scene.settings.domain;
    if (room.lower[k] != start.lower[k] || room.upper[k] != start.upper[k]) continue;  // a part that was asked for
    room.lower[k] = frame.cell.lower[0][k];
    room.upper[k] = frame.cell.upper[0][k];
  }
  return own;
}

}  // namespace

bool is_turned_box(const SceneFacts& facts, const Frame& frame) {
  const std::optional<WallPlace> place = place_of_container(facts, frame);
  return place && is_turned(facts.container, *place);
}

FrameView::FrameView(const SceneFacts& the_facts, const Frame& the_frame)
    : of_frame(facts_of_frame(the_facts, the_frame)), facts(of_frame ? *of_frame : the_facts), frame(the_frame) {
  const FrameBodies& b = frame.bodies;
  const Scene& scene = facts.run->scene;
  const std::size_t n = b.size();
  is_particle.resize(n);
  mass.resize(n);
  volume.resize(n);
  const int up_axis = facts.container.vertical;
  lowest = 1e308;
  highest = -1e308;
  const std::vector<double> bound = bounding_radii(scene);
  for (std::size_t i = 0; i < n; ++i) {
    const auto k = static_cast<std::size_t>(b.shape[i]);
    is_particle[i] = facts.run->boundary_ids.contains(b.id[i]) ? 0 : 1;
    volume[i] = facts.volume[k] * b.scale[i] * b.scale[i] * b.scale[i];
    mass[i] = volume[i] * scene.materials[static_cast<std::size_t>(b.material[i])].density;
    if (is_particle[i] == 0) continue;
    ++particles;
    particle_volume += volume[i];
    mean_diameter += facts.diameter[k] * b.scale[i];
    // how far it reaches along the axis: only bodies that can reach further than all before are looked at closely
    const double x = b.position[i][up_axis], r = bound[k] * b.scale[i];
    if (x + r <= highest && x - r >= lowest) continue;
    const Shape& shape = scene.shapes[k];
    double above = shape.sphere_radius * b.scale[i], below = -above;
    if (shape.kind != ShapeKind::sphere) {
      above = -1e308;
      below = 1e308;
      const Vec3 axis = matrix_of(b.orientation[i])[up_axis];
      for (const Vec3& v : shape.mesh.vertices) {
        const double reach = b.scale[i] * dot(axis, v);
        above = std::max(above, reach);
        below = std::min(below, reach);
      }
    }
    highest = std::max(highest, x + above);
    lowest = std::min(lowest, x + below);
  }
  if (particles > 0) {
    mean_diameter /= static_cast<double>(particles);
  } else {
    lowest = highest = 0;
  }
  if (facts.is_endless() && particles > 0) {
    lowest = facts.cell_lower[up_axis];
    highest = lowest + facts.period.period()[up_axis];
  }

  const BodyRows row(b);
  const FrameContacts& c = frame.contacts;
  row_a.resize(c.size());
  row_b.resize(c.size());
  for (std::size_t i = 0; i < c.size(); ++i) {
    row_a[i] = row(c.body_a[i]);
    row_b[i] = row(c.body_b[i]);
  }

  // heights that hold 10 % and 90 % of the solid, from a fine histogram
  constexpr std::size_t kBins = 4096;
  std::vector<double> solid(kBins);
  const double height = highest - lowest;
  if (!(height > 0)) return;
  for_each_sample([&](const Vec3& p, double v, std::size_t) {
    const double place = (p[up_axis] - lowest) / height * kBins;
    solid[static_cast<std::size_t>(std::clamp(place, 0.0, kBins - 1.0))] += v;
  });
  const auto level = [&](double share) {
    const double wanted = share * particle_volume;
    double below = 0;
    for (std::size_t i = 0; i < kBins; ++i) {
      if (below + solid[i] >= wanted)
        return lowest + height / kBins * (static_cast<double>(i) + (wanted - below) / std::max(solid[i], 1e-300));
      below += solid[i];
    }
    return highest;
  };
  solid_low = level(0.1);
  solid_high = level(0.9);
}

}  // namespace scree
