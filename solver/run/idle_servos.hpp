// What is reported of walls that answer to force when a run ends: where they are, with what force, and servos that do not press as asked.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "solver/state/run_state.hpp"

namespace scree {

/// A line for each servo that does not do what it is there for.
std::vector<std::string> idle_servos(const RunState& s);

/// One entry for each wall that answers to force, for `drives` in run.json (core/storage/RUN_FORMAT.md).
nlohmann::json drives_json(const RunState& s);

}  // namespace scree
