// A frame with what all statistics ask of it: which rows are particles, their mass and solid, rows of contacts, the bed.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <memory>
#include <utility>
#include <vector>

#include "core/geometry/periodic.hpp"
#include "post/run/region.hpp"
#include "post/run/run_folder.hpp"

namespace scree {

/// The room that the bodies are in, for volumes: a box or a cylinder that stands, lies or leans, and the axis that gravity goes along.
struct Container {
  Region room;       ///< box, along the vertical axis without an end, or cylinder
  int vertical = 2;  ///< axis (0 x, 1 y, 2 z)
  double up = 1;     ///< +1 or -1: direction of up along it
  int wall = -1;     ///< of the scene's walls the one whose inside it is; -1: of none

  bool holds(Vec3 p) const {
    if (room.kind == Region::Kind::box) p[vertical] = room.lower[vertical];
    return room.contains(p);
  }
  /// Volume of its part in a box, of a ring about its axis in a box [m^3]. The ring must lie within it.
  double volume_in(const Box3& box, int lines = 128) const;
  double ring_volume_in(const Box3& box, double inner, double outer) const;
  /// Distance from the axis of the cylinder, or from the vertical line in the middle of the box.
  double distance_from_axis(const Vec3& p) const;
};

/// What is the same for all frames.
struct SceneFacts {
  /// in   room   around the particles at all frames      in   most   particles at one time
  SceneFacts(const Run& run, const std::optional<Region>& container, const Box3& room, std::size_t most);
  /// Of one frame alone.
  SceneFacts(const Run& run, const std::optional<Region>& container, const Frame& frame);
  const Run* run;
  Container container;
  Periodicity period;
  Vec3 cell_lower;  ///< of the periodic cell [m]
  /// Whether the vertical axis is periodic: then the cell is full of the bed, not the way from its lowest to its highest body.
  bool is_endless() const { return period.is_periodic(container.vertical); }
  /// A box that is longer than a period along a periodic axis is one period long there: it holds each body once.
  Region within_a_period(Region region) const;
  /// How many images of a point, which lies in the cell, are in a region: at a periodic side it may reach into the next cell.
  int images_in(const Region& region, const Vec3& point) const;
  /// Calls visit(shift) for the shift from the cell to each image of it that a region can hold a part of.
  template <class Visit>
  void for_each_image(const Region& region, const Visit& visit) const {
    int first[3] = {0, 0, 0}, last[3] = {0, 0, 0};
    const Box3 box = region.bounds();
    if (period.is_sheared()) return for_each_image_in_sheared(box, visit);
    for (int k = 0; k < 3; ++k) {
      if (!period.is_periodic(k)) continue;
      // one more on each side: a branch may reach half a period out of the cell
      first[k] = static_cast<int>(std::floor((box.lower[k] - cell_lower[k]) / period.period()[k])) - 1;
      last[k] = static_cast<int>(std::floor((box.upper[k] - cell_lower[k]) / period.period()[k])) + 1;
    }
    for (int x = first[0]; x <= last[0]; ++x) {
      for (int y = first[1]; y <= last[1]; ++y) {
        for (int z = first[2]; z <= last[2]; ++z) visit(Vec3{x * period.period().x, y * period.period().y, z * period.period().z});
      }
    }
  }
  /// The same of a cell that is sheared: which images along one axis meet a region depends on those along the later ones.
  template <class Visit>
  void for_each_image_in_sheared(const Box3& box, const Visit& visit) const {
    const auto range = [&](int k, const Vec3& shift) -> std::pair<double, double> {
      if (!period.is_periodic(k)) return {0, 0};
      const double from = cell_lower[k] + shift[k], length = period.period()[k];
      return {std::floor((box.lower[k] - from) / length) - 1, std::floor((box.upper[k] - from) / length) + 1};
    };
    const auto [first_z, last_z] = range(2, {});
    for (double z = first_z; z <= last_z; ++z) {
      const auto [first_y, last_y] = range(1, period.shift({0, 0, z}));
      for (double y = first_y; y <= last_y; ++y) {
        const auto [first_x, last_x] = range(0, period.shift({0, y, z}));
        for (double x = first_x; x <= last_x; ++x) visit(period.shift({x, y, z}));
      }
    }
  }
  std::vector<double> volume, diameter;    ///< of each shape at scale 1: [m^3], equivalent [m]
  std::vector<std::vector<Vec3>> samples;  ///< points in each shape at scale 1 (volume_samples)
};

struct FrameView {
  FrameView(const SceneFacts& facts, const Frame& frame);
  std::shared_ptr<const SceneFacts> of_frame;  ///< the facts where the cell or the wall around the container has moved; else null
  const SceneFacts& facts;
  const Frame& frame;
  std::vector<std::uint8_t> is_particle;   ///< by row of bodies: free to move
  std::vector<double> mass, volume;        ///< by row [kg], [m^3]
  std::vector<std::int32_t> row_a, row_b;  ///< of each contact; -1: a wall
  std::size_t particles = 0;
  double particle_volume = 0, mean_diameter = 0;  ///< of all particles [m^3], number mean of equivalent diameters [m]
  /// Along the vertical axis: between which heights lie 10 % to 90 % of the solid, and all of the bodies [m]; of a bed without an end those
  /// of the cell.
  double solid_low = 0, solid_high = 0, lowest = 0, highest = 0;
  /// Volume of the container between two heights, 0 without an extent.
  double room_between(double low, double high) const;

  bool particle(std::int32_t row) const { return row >= 0 && is_particle[static_cast<std::size_t>(row)] != 0; }
  /// Calls visit(point, volume, row) for every sample point of every particle. Points beyond a periodic side come in at the other.
  template <class Visit>
  void for_each_sample(const Visit& visit) const {
    const FrameBodies& b = frame.bodies;
    Vec3 image;
    for (std::size_t i = 0; i < b.size(); ++i) {
      if (is_particle[i] == 0) continue;
      const std::vector<Vec3>& samples = facts.samples[static_cast<std::size_t>(b.shape[i])];
      const Mat3 turn = matrix_of(b.orientation[i]);
      const double share = volume[i] / static_cast<double>(samples.size());
      for (const Vec3& s : samples) {
        Vec3 p = b.position[i] + turn * (b.scale[i] * s);
        if (facts.period.any()) facts.period.wrap(p, image);
        visit(p, share, i);
      }
    }
  }
};

/// The container of a scene at its start: the box or cylinder wall when there is one, periodic sides where there are, else `room`, the box
/// around the particles at all frames. Along gravity it is not cut. A FrameView has it where the wall is in its frame.
Container container_of(const Scene& scene, const std::optional<Region>& given, const Box3& room);

/// Whether the wall of the container is a box that is turned in a frame: its container stays the box at the start, without the turn.
bool is_turned_box(const SceneFacts& facts, const Frame& frame);

}  // namespace scree
