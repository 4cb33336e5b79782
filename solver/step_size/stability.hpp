// The critical step of the contacts that there are, over all ranks.
#pragma once

#include "solver/state/run_state.hpp"
#include "solver/step_size/critical_step.hpp"

namespace scree {

/// Largest stable step of the present contacts, and the pair that sets it; the same on any number of ranks. Of the state it changes
/// candidate lists alone, on which no result depends. Collective.
CriticalStep critical_step(RunState& s, ForceScratch& scratch);

}  // namespace scree
