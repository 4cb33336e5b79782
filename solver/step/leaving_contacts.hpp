// The energy of contacts whose bodies are taken out of a run.
#pragma once

#include <cstdint>
#include <vector>

#include "solver/state/run_state.hpp"

namespace scree {

/// Books it with what else bodies take with them: nothing holds it after. While pairs are those of the last forces. Collective.
/// in   leaves   of each owned row (DomainGuard::leaving)
void count_contacts_of_leaving(RunState& s, const std::vector<std::uint8_t>& leaves);

}  // namespace scree
