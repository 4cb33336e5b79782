// Walls that wear: at whole steps counted from the start of the run, their vertices recede until the mesh has lost `wear` times the
// sliding work since the last time (Archard). Source: J. F. Archard, Contact and rubbing of flat surfaces, J. Appl. Phys. 24 (1953) 981.
//
// The work is an exact sum over all ranks, so that all ranks move the same vertices to the same places. Between two steps nothing else
// changes: pairs with the wall keep their friction springs, each with the feature that now is where its own was, since corners, edges and
// flat regions of a worn mesh have other numbers; and what their contacts store less than before counts as dissipated.
// Cost: of a wall that is worn, its tree and features again; a look at each of its pairs. Nothing in the steps between.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/geometry/triangle_mesh.hpp"
#include "solver/state/effect.hpp"

namespace scree {

struct Wall;

/// Of the margin of a body: by more than this no vertex recedes at a time. What touches a wall would lose its contact and fall onto it, and
/// a run would depend on the interval; a tenth keeps the forces of a contact at rest within some tenths.
inline constexpr double kMaxWear = 0.1;

/// In how many steps a wall is worn.
std::int64_t wear_steps(const Wall& wall, double step);

/// Of all walls that wear; the same on every rank.
struct WearState {
  std::vector<Vec3> vertices;  ///< as they are now, axes of their meshes, wall after wall (SolverScene::first_worn)
  std::vector<double> work;    ///< of each triangle of a load map: the sliding work that its wall has been worn for [J]
};

/// A wall with all that slid on it, what slid since it was last worn included.
struct WornWall {
  std::size_t wall;
  TriangleMesh mesh;  ///< as the state's where that cannot be worn further
  double volume = 0;  ///< that it has lost [m^3], also where the mesh does not show it
  double depth = 0;   ///< how far its farthest vertex has receded [m]
  std::string fault;  ///< why the mesh is without what slid since it was last worn; empty where it is with it
};

/// The effect, for those that read what walls have lost.
class Wear : public Effect {
 public:
  explicit Wear(const RunState& s);

  /// Gives the scene the vertices that the state has: at the start and after a restart.
  void begin(RunState& s) override;
  /// Wears the walls that are due. Candidates of pairs are forgotten. A mesh that cannot be worn so is kept as the failure of every rank.
  bool after_step(const StepParts& parts) override;
  EffectRecord record(const RunState&) const override;
  void restore(RunState& s, const EffectRecord& record) override;
  void add_frame(const RunState& s, Frame& frame) const override;
  std::vector<PlanLine> plan(const RunState& s) const override;

  /// All walls that wear, at the end of a run. The state stays as it is. Collective.
  std::vector<WornWall> at_end(const RunState& s) const;

 private:
  void wear_walls(const StepParts& parts, const std::vector<std::size_t>& due);

  WearState state_;
};

EffectKind wear_effect();

}  // namespace scree
