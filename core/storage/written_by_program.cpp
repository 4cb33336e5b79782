#include "core/storage/written_by_program.hpp"

#include <nlohmann/json.hpp>

namespace scree {

bool is_written_by_program(const nlohmann::json& provenance) {
  if (!provenance.is_object()) return false;
  const nlohmann::json command = provenance.value("command", nlohmann::json());
  return command.is_array() && !command.empty() && command[0] == kEngineCommand;
}

}  // namespace scree
