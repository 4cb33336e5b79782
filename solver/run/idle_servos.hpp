// What is told of servos when a run ends: that they touch nothing, or stand at the end of their way.
#pragma once

#include <string>
#include <vector>

#include "solver/step/run_state.hpp"

namespace scree {

/// A line for each servo that does not do what it is there for.
std::vector<std::string> idle_servos(const RunState& s);

}  // namespace scree
