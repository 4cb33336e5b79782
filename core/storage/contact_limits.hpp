// How deep surfaces may touch. Decomposer and solver draw the line at the same place.
#pragma once

namespace scree {

/// The overlap over the margin sum at which a run is stopped: beyond it a step could carry a feature through the
/// surface unseen. Pairs without margin (analytic spheres) have no such limit; a contact.barrier reaches deeper.
inline constexpr double kStopOverlapRatio = 0.97;

}  // namespace scree
