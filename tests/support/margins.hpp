// Cases in which bodies touch one margin outside their surfaces, as contact.surface = "outside" says: for tests of that, and for those that
// look at places of margins as wide as bodies.
#pragma once

#include "decomposer/case/case_file.hpp"

namespace scree::test {

/// A case that says nothing else.
inline Case touching_outside(Case c) {
  if (!c.surface_given) c.settings.surface = TouchAt::outside;
  return c;
}

}  // namespace scree::test
