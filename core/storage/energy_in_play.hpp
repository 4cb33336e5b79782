// What the error of the energy balance of a run is measured by: one definition for the solver, run.json and the report.
#pragma once

#include <algorithm>
#include <cmath>

#include "core/storage/scene.hpp"

namespace scree {

/// Energies of a run up to a row of its log [J].
struct EnergyInPlay {
  double kinetic_peak = 0, elastic_peak = 0;                            ///< largest of the rows; elastic: that of contacts and of bonds
  double dissipated = 0, wall_work = 0, outer_work = 0, cell_work = 0;  ///< of the last row

  /// A row of the log, the next one.   in   elastic   that of contacts along their normals; below 0 where bodies attract each other
  void add_row(double kinetic, double elastic, double tangential_elastic, double bond) {
    kinetic_peak = std::max(kinetic_peak, kinetic);
    elastic_peak = std::max(elastic_peak, std::abs(elastic) + tangential_elastic + bond);
  }
  double largest() const {
    return std::max({kinetic_peak, dissipated, elastic_peak, std::abs(wall_work), std::abs(outer_work), std::abs(cell_work)});
  }
};

/// The least energy that is in play: what a fall of a millionth of their diameters, the measure of rest, gives the bodies of a scene [J].
/// Without it a scene in which nothing moves would be judged by rounding.
double still_fall_energy(const Scene& scene);

/// The error of the energy balance over what is in play.   in   error [J]
double relative_energy_error(double error, const EnergyInPlay& in_play, const Scene& scene);

}  // namespace scree
