// A solid cut into pieces that share faces.
#pragma once

#include <string>
#include <vector>

#include "core/storage/piece_table.hpp"
#include "core/storage/shape_file.hpp"

namespace scree {

struct FractureForm {
  std::int32_t cells = 0;
  std::uint64_t seed = 1;
  bool evenly = false;           ///< points move to the centres of their cells: cells of more equal size
  std::vector<Vec3> generators;  ///< [m] in place of random points
  double inset = 0;              ///< [m] by which the shared faces of the pieces' meshes are moved inwards; 0: they lie on each other
};

struct Fracture {
  std::vector<Shape> pieces;          ///< NAME_1, NAME_2 ...; origin_shift: centre of mass of the piece in the coordinates of the body
  std::vector<std::int32_t> cell_of;  ///< of each piece
  PieceTable table;
  std::vector<Vec3> generators;  ///< [m] that made the cells
  std::int32_t redrawn = 0;      ///< generators drawn again since their cell was a sliver
  std::int32_t attempts = 1;     ///< cuts until no plane passed through a vertex
  double smallest_cell = 0;      ///< [m^3]
};

/// A cell of less than this part of the mean volume of cells is a sliver: its generator is drawn again. Slivers would ask for small margins
/// and small steps, and hold nothing.
inline constexpr double kSliverCell = 0.02;

/// Cuts a solid into Voronoi cells of random points in it. What of a cell falls into several components becomes several pieces; a cavity
/// belongs to the piece around it.
///
/// With an inset, the mesh of a piece is what of it lies as far behind its shared faces; mass, volume, inertia and the table of faces are
/// those of the piece as it is cut. Two such pieces with margins as wide as the inset are just in touch. The surface of the body stays
/// where it is.
///
/// How: see cut_mesh.hpp. The volumes add up to that of the body to the rounding of coordinates.
/// in   body   a solid that does not pass through itself
/// Fails: InputError with numbers when the body is no such solid, or does not hold that many cells.   Cost: see cut_mesh.hpp.
Fracture fracture(const Shape& body, const FractureForm& form);

}  // namespace scree
