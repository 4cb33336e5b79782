// Bodies that a case takes over from a run ([start]): read from a checkpoint or a frame of its folder.
//
// What of the state of their pairs is taken over: that of two bodies, if contacts are gathered as in the run; that of a body and a wall, if
// moreover this case has that wall where it stood in the run. See docs/develop/decisions.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "core/base/provenance.hpp"
#include "core/geometry/triangle_mesh.hpp"
#include "core/storage/start_state.hpp"
#include "decomposer/case/case_pairs.hpp"
#include "decomposer/packing/cell_of_run.hpp"

namespace scree {

/// A wall of the run that answers to force, where it stood then.
struct StoodWall {
  Wall standing;      ///< without its motion
  Vec3 displacement;  ///< from where the case of the run placed it [m]
  double way = 0;     ///< the same along its guide [m], or about it [rad]; of a checkpoint
};

struct FromRun {
  Scene scene;                              ///< of the run
  std::vector<BodyRow> bodies;              ///< by ascending id; shape: of the run's scene, material: of the case
  StartState start;                         ///< with the state of all pairs, as it is in the run
  std::vector<InputRecord> inputs;          ///< the scene of the run and its checkpoint or frame
  std::map<std::size_t, StoodWall> driven;  ///< by their index in that scene; none that has no mesh and was turned
  std::optional<CellOfRun> cell;            ///< where the periodic cell of the run deforms: as it was then
  std::int64_t in_transit = 0;              ///< bodies that wait at inlets to come in again: they are not taken over
  double clock_of_run = 0;                  ///< StartState::clock of the run, 0 where it has none [s]
  std::int64_t first_free_id = 0;           ///< above all that bodies and walls had in that run, and in those before it

  /// "body 17 of settle.run"
  std::string name_of(std::int64_t id) const;
  /// Index of the first wall of the run with this name; the number of walls: there is none.
  std::size_t wall_named(const std::string& name) const;
  /// "in settle.run wall 'lid' stood at position = [...]" of a wall with that name that answered to force there; empty: there was none.
  std::string where_it_stood(const std::string& wall) const;
};

/// in   c   with a start
/// Throws InputError when there is no such run, checkpoint or frame, or it is damaged; UsageError for materials that the case does not
/// have.
FromRun read_run(const Case& c);

/// What these bodies use of the materials of the case.
std::vector<MaterialUse> uses_of(const FromRun& from, const Case& c);

/// Whether this case has a wall, as it stands at its start, at that place in the run; one flag for each wall of the case.
///
/// in   walls    of the case, at its start     in   shapes   of its scene
/// out  partner  index of that wall in the run, -1: none
std::vector<std::int32_t> partners_of_walls(const FromRun& from, const std::vector<Wall>& walls, const std::vector<Shape>& shapes);

/// What the scene of the case begins with.
StartState start_of(const FromRun& from, const Scene& scene, const std::vector<std::int32_t>& partner);

}  // namespace scree
