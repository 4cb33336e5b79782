// Constant forces that the case gives to bodies. Their potential is that of a weight: state/run_state.hpp, potential_energy().
#pragma once

#include "solver/state/effect.hpp"

namespace scree {

EffectKind given_forces_effect();

}  // namespace scree
