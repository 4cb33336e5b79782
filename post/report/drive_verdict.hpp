// Did the walls that answer to force do what they are there for? Where they ended, and whether servos hold the force asked of them.
#pragma once

#include "post/report/verdict.hpp"

namespace scree {

/// Of a run that has such walls, from `drives` in run.json and the loads in log.csv.
Verdict judge_drives(const Run& run);

}  // namespace scree
