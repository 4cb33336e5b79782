// Where a point lies outside a domain, for messages.
#pragma once

#include <string>

#include "core/storage/scene.hpp"

namespace scree {

/// "100 mm beyond domain.max z", of the side that it is farthest beyond; empty: it lies inside, or the domain is unbounded.
/// in   of_periodic   also sides of periodic axes, which a point passes through in a run
std::string beyond_side(const Domain& domain, const Vec3& point, bool of_periodic);

}  // namespace scree
