// How bodies are turned where they are placed: those of a population, and those that come in later.
#pragma once

#include "core/base/words.hpp"
#include "core/geometry/vec3.hpp"

namespace scree {

/// How bodies are turned where they are placed.
struct BodyOrientation {
  enum class Kind { random, given, aligned };
  enum class Axis { longest, shortest, given };
  Kind kind = Kind::random;
  Quat given;
  Vec3 direction{0, 0, 1};  ///< aligned: where the axis of the body points, unit, world
  Axis axis = Axis::longest;
  Vec3 body_axis{0, 0, 1};  ///< aligned, when it is given: unit, mesh axes
  double scatter = 0;       ///< aligned: deviation of the tilt about each of the two directions across [rad]
};

template <>
inline constexpr auto kWordsOf<BodyOrientation::Axis> = std::to_array<Word<BodyOrientation::Axis>>(
    {{BodyOrientation::Axis::longest, "longest"}, {BodyOrientation::Axis::shortest, "shortest"}});

}  // namespace scree
