// From the contacts of a step to the load map of walls (load_map.hpp).
#pragma once

#include <vector>

#include "solver/contact/pair_force.hpp"
#include "solver/step/load_map.hpp"
#include "solver/step/run_state.hpp"

namespace scree {

/// A pair in contact, as its force was just worked out.
struct MappedContact {
  const PairView& view;  ///< B is the wall
  const PairMotion& motion;
  const PairFeatures& features;
  const std::vector<ContactOutput>& outputs;
  const CandidateLists& lists;
  const Mat3& a_to_world;
  std::int32_t body;          ///< row of the particle set
  std::int32_t first_mapped;  ///< SolverScene::first_mapped of the wall
  double friction_dt;         ///< the step that lies behind the pair [s]; 0: none, as at the start
};

/// Appends what its features do to the triangles of the wall. Threads: safe on distinct outputs.
void append_loads(const MappedContact& contact, MeshDistanceScratch& scratch, std::vector<LoadEntry>& entries);

/// Adds the entries of the present forces to a map.
/// in   dt       that the forces count for [s]     in  events   whether what happened in the step counts too
void book_loads(const RunState& s, double dt, bool events, LoadMap& map);

/// The map at the present moment: of all ranks, without the half of the last step that lies ahead. Collective.
LoadMap loads_now(const RunState& s);

}  // namespace scree
