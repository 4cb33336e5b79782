// The functions of a scene's contact model and law, chosen once.
#pragma once

#include "solver/contact/pair_force.hpp"
#include "solver/contact/pair_stiffness.hpp"

namespace scree {

/// The function for a scene's model and law, with what the scene does not need left out of it.
PairForceFunction pair_force_function(const LawChoice& choice);

/// Null for a scene none of whose pairs remembers that.
PairHoldsFunction pair_holds_function(const LawChoice& choice);

/// The function that linearises a pair.
LineariseFunction linearise_function(const LawChoice& choice);

}  // namespace scree
