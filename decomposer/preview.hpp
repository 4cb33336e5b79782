// What a cut of a scene looks like and would cost, before anything is queued.
#pragma once

#include <string>

#include "core/partition/partition.hpp"
#include "core/storage/scene_file.hpp"

namespace scree {

/// A VTK XML file (.vtp, text) that ParaView opens: a vertex for each body with id, part, radius [m] and predicted work, and the outlines
/// of the parts' boxes, where the cut has boxes. Cells carry `part`; outlines have kind = 1, bodies 0.
/// The scene must be partitioned.
std::string preview_file(const Scene& scene, const std::vector<double>& predicted_work);

/// Rank counts that a preview compares: powers of two up to four times `ranks`, 16 at least, and `ranks` itself, as far as
/// there are bodies for them.
std::vector<int> preview_ranks(int ranks, std::size_t bodies);

}  // namespace scree
