// Which materials of a case can touch.
#pragma once

#include "decomposer/case/case.hpp"

namespace scree {

/// What uses a material besides the case's own bodies, populations and walls: bodies that come from a run.
struct MaterialUse {
  std::int32_t material = 0;
  double movers = 0;       ///< how many of these bodies move
  bool has_fixed = false;  ///< whether any of them does not
  std::string where;       ///< their names, for messages
};

/// Throws UsageError when two materials can touch and no [[pairs]] says how.
void check_pairs(const Case& c, const std::vector<MaterialUse>& others);
/// Leaves only the pairs of materials that can touch.
void drop_pairs_that_cannot_meet(Case& c, const std::vector<MaterialUse>& others);

}  // namespace scree
