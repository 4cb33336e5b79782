// What bodies do to the triangles of walls that have a load map: sums since the start of the run, which no order of contacts, ranks or
// threads changes, so that frames and checkpoints have the same bits on any of them.
//
// Each contact of a step makes an entry for each triangle that holds it (features/wall_triangles.hpp), which bears an equal share:
//
//   impulse         dt times the force on the triangle, in the axes of the wall's mesh, so that it goes round with a wall that turns
//   sliding work    of friction on the way that a contact slid: sliding force times what its spring did not take up; never below 0
//   damping work    of the normal damping: what an impact loses
//   contacts        of a body with the wall that began: no feature of theirs was within the margins one step before
//   impact energy   of such a contact as it begins: (sum d v_n)^2 / (2 Q M^-1 Q), Q the wrench of unit pressures d n at its features (d the
//                   overlap, n the normal), M the masses: the kinetic energy of the motion that the contact will take up, m v^2 / 2 for a
//                   ball or a face that lands flat, less where the body only turns away
//
// As for all sums of walls, the forces of the last step count in full, and who reads the sums takes half of them back: the impulse of a
// map's triangles adds up to that of its wall in log.csv.
// Cost: per contact of such a wall and step about a microsecond (two where the body is a mesh); kLoadSums x 80 bytes a triangle and rank.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "core/geometry/vec3.hpp"
#include "solver/ranks/exact_sum.hpp"

namespace scree {

enum LoadSum : std::size_t {
  kImpulseX,
  kImpulseY,
  kImpulseZ,
  kSlidingWork,
  kDampingWork,
  kContacts,
  kImpactEnergy,
  kLoadSums  ///< how many there are
};

/// Of one triangle.
using TriangleLoad = std::array<ShortSum, kLoadSums>;

/// Of one rank, or of all: triangle after triangle, wall after wall (SolverScene::first_mapped).
struct LoadMap {
  std::vector<TriangleLoad> triangles;
};

/// Of all walls that wear; the same on every rank.
struct WearState {
  std::vector<Vec3> vertices;  ///< as they are now, axes of their meshes, wall after wall (SolverScene::first_worn)
  std::vector<double> work;    ///< of each triangle of a load map: the sliding work that its wall has been worn for [J]
  bool operator==(const WearState&) const = default;
};

/// A contact's share in a triangle, world axes.
struct LoadEntry {
  std::int32_t triangle;            ///< row of the map
  std::int32_t wall, body;          ///< index in the scene, row of the particle set
  Vec3 force;                       ///< on the wall [N]
  Vec3 arm;                         ///< of the contact from the body's centre [m]
  Vec3 damping;                     ///< what of the force on the body is damping along the normal [N]
  double slid = 0;                  ///< [J]
  double contacts = 0, impact = 0;  ///< [-], [J]
};

/// The same for all triangles on every rank. Collective.
void add_over_ranks(MPI_Comm comm, LoadMap& map);

/// The words of all sums, as checkpoints and hashes take them: kLoadSums x ShortSum::kWords for each triangle.
std::vector<std::int64_t> words_of(const LoadMap& map);
/// in   words   as many as words_of() gives for such a map. Throws InputError.
void set_words(const std::vector<std::int64_t>& words, LoadMap& map);

}  // namespace scree
