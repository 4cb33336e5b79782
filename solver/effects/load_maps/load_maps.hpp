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
// As for all sums of walls, the forces of the last step count in full, and readers of the sums take half of them back: the impulse of a
// map's triangles adds up to that of its wall in log.csv.
// Cost: per contact of such a wall and step about a microsecond (two where the body is a mesh); kLoadSums x 80 bytes a triangle and rank.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "core/geometry/vec3.hpp"
#include "solver/effects/bonds/shared_impact.hpp"
#include "solver/ranks/exact_sum.hpp"
#include "solver/state/effect.hpp"

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

/// A contact's share in a triangle, world axes.
struct LoadEntry {
  std::int32_t triangle;            ///< row of the map
  std::int32_t wall, body;          ///< index in the scene, row of the particle set
  Vec3 force;                       ///< on the wall [N]
  Vec3 arm;                         ///< of the contact from the body's centre [m]
  Vec3 damping;                     ///< what of the force on the body is damping along the normal [N]
  double slid = 0;                  ///< [J]
  double contacts = 0, impact = 0;  ///< [-], [J]; of a piece that bonds hold, what it has of the impact of its fragment [-]
  std::int32_t begun = -1;          ///< place among those that begin on a fragment in this thread; -1: none
};

/// The effect, for those that read the map: wear.
class LoadMaps : public Effect, public PairObserver {
 public:
  explicit LoadMaps(const RunState& s);

  void before_forces(RunState&) override;
  PairObserver* observer() override { return this; }
  bool observes(const PairView& view) const override;
  bool observes_bodies() const override { return false; }
  void observe(const PairContact& contact) override;
  void start(RunState& s) override;
  void after_kick(RunState& s) override;
  void on_step_change(RunState& s, double difference) override;
  void end_step(const StepParts& parts) override;

  EffectRecord record(const RunState& s) const override;
  void restore(RunState& s, const EffectRecord& record) override;
  void add_frame(const RunState& s, Frame& frame) const override;
  std::vector<PlanLine> plan(const RunState& s) const override;

  /// The map of all ranks; the forces of the last step count in full. Collective.
  LoadMap of_all_ranks(const RunState& s) const;

 private:
  const RunState& state_;
  const SolverScene& scene_;
  LoadMap map_;                                  // of this rank
  std::vector<std::vector<LoadEntry>> entries_;  // of the present forces, by thread
  std::vector<std::vector<BegunOnFragment>> begun_;
};

EffectKind load_maps_effect();

}  // namespace scree
