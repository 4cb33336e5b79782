// The list of all effects.
#pragma once

#include <memory>
#include <vector>

#include "solver/state/effect.hpp"

namespace scree {

/// In the order in which a step calls them.
const std::vector<EffectKind>& effect_kinds();

/// Those that the scene of a state needs.
std::vector<std::unique_ptr<Effect>> make_effects(const RunState& s);

}  // namespace scree
