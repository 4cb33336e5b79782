// A frame with what all statistics ask of it: which rows are particles, their mass and solid, rows of contacts, the bed.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "core/geometry/periodic.hpp"
#include "post/region.hpp"
#include "post/run_folder.hpp"

namespace scree {

/// The room that the bodies are in, for volumes: a box or an upright cylinder, with one axis that gravity goes along.
struct Container {
  Region room;                 ///< box or cylinder
  int vertical = 2;            ///< axis (0 x, 1 y, 2 z)
  double up = 1;               ///< +1 or -1: direction of up along it
  double cross_section = 0;    ///< across the vertical axis [m^2]
};

/// What is the same for all frames.
struct SceneFacts {
  explicit SceneFacts(const Run& run, const std::optional<Region>& container, const Frame& first);
  const Run* run;
  Container container;
  Periodicity period;
  std::vector<double> volume, diameter;            ///< of each shape at scale 1: [m^3], equivalent [m]
  std::vector<std::vector<Vec3>> samples;          ///< points in each shape at scale 1 (volume_samples)
};

struct FrameView {
  FrameView(const SceneFacts& facts, const Frame& frame);
  const SceneFacts& facts;
  const Frame& frame;
  std::vector<std::uint8_t> is_particle;           ///< by row of bodies: free to move
  std::vector<double> mass, volume;                ///< by row [kg], [m^3]
  std::vector<std::int32_t> row_a, row_b;          ///< of each contact; -1: a wall
  std::size_t particles = 0;
  double particle_volume = 0, mean_diameter = 0;   ///< of all particles [m^3], number mean of equivalent diameters [m]
  /// Along the vertical axis: between which heights lie 10 % to 90 % of the solid, and all of the bodies [m].
  double solid_low = 0, solid_high = 0, lowest = 0, highest = 0;

  bool particle(std::int32_t row) const { return row >= 0 && is_particle[static_cast<std::size_t>(row)] != 0; }
  /// Calls visit(point, volume, row) for every sample point of every particle.
  template <class Visit>
  void for_each_sample(const Visit& visit) const {
    const FrameBodies& b = frame.bodies;
    for (std::size_t i = 0; i < b.size(); ++i) {
      if (is_particle[i] == 0) continue;
      const std::vector<Vec3>& samples = facts.samples[static_cast<std::size_t>(b.shape[i])];
      const Mat3 turn = matrix_of(b.orientation[i]);
      const double share = volume[i] / static_cast<double>(samples.size());
      for (const Vec3& s : samples) visit(b.position[i] + turn * (b.scale[i] * s), share, i);
    }
  }
};

/// The container of a scene: the box or cylinder wall when there is one, periodic sides where there are, else the box that the
/// bodies of `first` fill. Along gravity it is not cut.
Container container_of(const Scene& scene, const std::optional<Region>& given, const Frame& first);

}  // namespace scree
