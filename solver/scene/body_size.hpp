// Sizes of bodies that join a run without an inlet.
#pragma once

#include <cstdint>
#include <string>

#include "solver/scene/solver_scene.hpp"

namespace scree {

/// Why the margins or the ranges of attraction of a scene were not made for a moving body, and what to do; "": they were. They follow from
/// the bodies that the scene starts with and those of its inlets. What does not follow from sizes puts no limit on them.
std::string size_fault(const SolverScene& scene, std::int32_t shape, std::int32_t material, double scale);

}  // namespace scree
