// Bonds of a scene: their forces, which of them break, and that all ranks know which did. The bonds that a rank computes, and the fragments
// that they hold together, are RunState::bonds and RunState::fragments: pairs, damping and the critical step read them.
//
// A bond that breaks. Decided at the positions of the end of the step, for all bonds at once. The forces of bonds that break still make the
// second half kick of this step; in the first of the next one, the contacts act in their place: the motion changes from one Hamiltonian to
// another between two steps, at one place, and the difference of their energies is what the totals count as fracture.
#pragma once

#include "solver/state/effect.hpp"

namespace scree {

EffectKind bonds_effect();

}  // namespace scree
