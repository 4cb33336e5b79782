// The verdict on inlets: whether what was asked came in.
#pragma once

#include "post/report/verdict.hpp"

namespace scree {

Verdict judge_inlets(const Run& run);

}  // namespace scree
