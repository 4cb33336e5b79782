// How many bodies inlets are to let in, as a plan tells it.
#pragma once

#include "core/storage/scene.hpp"

namespace scree {

/// Mass of the mean body of an inlet [kg], with sizes by the quantiles of its distribution.
double mean_mass(const Scene& scene, const Inlet& inlet);

/// Bodies that an inlet lets in until a time [s], about: what it owes by then, if all of it finds room.   in   mean   mean_mass()
double inflow_by(const Inlet& inlet, double mean, double time);

}  // namespace scree
