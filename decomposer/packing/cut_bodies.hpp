// Bodies that start as pieces: after packing, each is replaced by its pieces, and the faces that these share become bonds.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "decomposer/packing/packing_report.hpp"
#include "decomposer/packing/scene_parts.hpp"

namespace scree {

/// Pieces of the shapes of a case that have some, by index of the shape.
using PieceFiles = std::map<std::size_t, ShapeFile>;

/// Checks that a file holds the pieces of a shape.
/// Fails: InputError naming both.
void check_pieces(const CaseShape& shape, const Shape& whole, const ShapeFile& pieces);

/// Runs scree-mesher fracture on the file of a shape.
/// in   inset   by which shared faces are moved inwards [m]; 0: not
/// Fails: InputError with what it said.
ShapeFile cut_shape(const CaseShape& shape, double inset);

/// Replaces the bodies of these shapes in a packed scene by their pieces, which move as the whole did, with ids from one above the largest;
/// adds bonds where [[bonds]] names their material, and forces of [[bodies]].
///
/// Pieces must be inset by the margin, so that those that no bond holds do not press each other: where the smallest body of a shape is
/// scaled by s, by margin / s. A bond of bodies that are both fixed is left out, and one of an area that is none beside those of its
/// pieces. Fails: InputError with numbers for an inset that is too small, and for a fracture of a body that may not turn.
void cut_bodies(const Case& c, const SceneParts& parts, const PieceFiles& pieces, Scene& scene, PackingReport& report);

}  // namespace scree
