// What a test frame holds for a body, as a function of its id, so that any reader can tell what must be there.
#pragma once

#include <cstdint>

#include "core/geometry/vec3.hpp"

namespace scree::test {

inline Vec3 position_of(std::int64_t id) { return {0.1 * static_cast<double>(id), -0.5, 1.0 / (1.0 + static_cast<double>(id))}; }
inline Vec3 velocity_of(std::int64_t id) { return {static_cast<double>(id), 2.5, -3e-300}; }
inline Vec3 spin_of(std::int64_t id) { return {0, 1.0 / 3.0, -static_cast<double>(id)}; }
inline Quat orientation_of(std::int64_t id) { return quaternion_of(Vec3{0, 0.6, 0.8}, 0.01 * static_cast<double>(id)); }

}  // namespace scree::test
