// Pairs of triangles in the situations that a distance kernel meets, for timing and for error statistics.
#pragma once

#include <string>
#include <vector>

#include "tests/distance/triangle_pairs.hpp"

namespace scree {

/// separated, near-1e-3, near-1e-6, touching, intersecting, parallel, coplanar, shared-edge, slivers-1e6,
/// size-ratio-1e4, far-1e6, degenerate.
const std::vector<std::string>& regime_names();

/// `count` pairs with longest edge about 1. The same for the same name and seed.
std::vector<Pair18> make_regime(const std::string& name, std::size_t count, std::uint64_t seed);

}  // namespace scree
