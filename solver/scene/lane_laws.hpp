// The laws of a scene as pairs in lanes read them, whatever the bodies are: without zones of walls.
#pragma once

#include "solver/scene/ball_laws.hpp"

namespace scree {

class SolverScene;

/// Kind none where no pair of the scene may go in lanes.
BallLaws make_lane_laws(const SolverScene& scene);

}  // namespace scree
