// Impacts by energy and dissipation by cause, each by pair of materials: what happened between two frames of a run that recorded them
// (output.impacts).
#pragma once

#include <string>
#include <vector>

#include "core/chart/svg_chart.hpp"
#include "post/run/run_folder.hpp"
#include "post/run/wall_loads.hpp"

namespace scree {

/// Contacts that began with an energy from one end of a bin to the other.
struct ImpactBinRow {
  double from, to;  ///< [J]
  std::int64_t normal_count, shear_count;
  double normal_energy, shear_energy;  ///< of them together [J]
};

struct MaterialPairImpacts {
  std::string material_a, material_b;
  std::vector<ImpactBinRow> bins;      ///< ascending, those that have any
  double damping, friction, rolling;   ///< dissipated [J]
  double normal_energy, shear_energy;  ///< of all impacts [J]
  std::int64_t normal_count;
  double lost() const { return damping + friction + rolling; }
};

bool has_impacts(const Scene& scene);

/// Pairs of materials that touched between two frames; Frame{} stands for the start of the run.
/// Fails: InputError where a frame does not have what its scene asks for.
std::vector<MaterialPairImpacts> impacts_between(const Scene& scene, const Frame& from, const Frame& to);

/// impacts.csv and losses.csv of a folder of statistics; empty where the run recorded no impacts. in   frames   indices, ascending
std::vector<LoadTable> impact_tables(const Run& run, const std::vector<std::size_t>& frames);

/// How many impacts per second had how much energy, per power of two of it: a line for each pair and direction.
LineChart impact_chart(const std::vector<MaterialPairImpacts>& pairs, double time);

}  // namespace scree
