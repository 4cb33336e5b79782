// Contacts that yield (solver/laws/plastic.hpp): what of a case goes together. Decomposer and solver take it from here.
#pragma once

#include <algorithm>

#include "core/storage/attraction.hpp"

namespace scree {

inline bool yields(const MaterialPair& pair) { return pair.plasticity > 0; }

/// Steepest tangent of a contact over that of its law as it is pressed: k2 / k1, or the pull that its damping goes with.
inline double steepening(const MaterialPair& pair) {
  return yields(pair) ? std::max(1 / (1 - pair.plasticity), 1 + pair.adhesive_ratio) : 1;
}

/// What a pair gives that does not go together with its plasticity. Follows from the pair and the settings alone.
inline AttractionFault plasticity_fault(const Settings& settings, const MaterialPair& pair) {
  if (pair.adhesive_ratio > 0 && !yields(pair))
    return {"adhesive_ratio", "goes with plasticity: a contact pulls by it once it has yielded"};
  if (!yields(pair)) return {};
  if (!(pair.plasticity < 1)) return {"plasticity", "1 found, expected less: it is 1 - k1 / k2, and nothing unloads infinitely steeply"};
  if (attracts(pair))
    return {"plasticity",
            "does not go with pull_off, adhesion or surface_tension; adhesive_ratio is the attraction of contacts that yield"};
  if (settings.gather != Gathering::potential) return {"plasticity", "goes with contact.gather = \"potential\" only"};
  if (settings.barrier > 0) return {"plasticity", "does not go with contact.barrier"};
  if (settings.on_overlap != OnOverlap::stop)
    return {"plasticity", "does not go with contact.on_overlap = \"continue\": beyond its maximum overlap a contact has no dent"};
  return {};
}

}  // namespace scree
