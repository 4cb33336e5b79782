// Files of a run that a program stepped by the engine (docs/user/engine.md).
#pragma once

#include <nlohmann/json_fwd.hpp>

namespace scree {

/// First word of the command in the provenance of such files.
inline constexpr const char* kEngineCommand = "scree.Engine";

/// Whether a provenance record says so: bodies may then come in and leave that neither the scene nor its inlets and outlets tell of.
bool is_written_by_program(const nlohmann::json& provenance);

}  // namespace scree
