// Who is shown contacts as their forces have just been computed: effects that record them (load maps, impacts), frames, the critical step.
#pragma once

#include <omp.h>

#include <algorithm>
#include <cstddef>
#include <functional>
#include <span>
#include <vector>

#include "solver/contact/pair_force.hpp"
#include "solver/neighbours/pair_list.hpp"

namespace scree {

/// A pair in contact. Borrowed: valid during the call. Features, force and motion are in the frame of A.
struct PairContact {
  const BodyPair& pair;
  const PairView& view;  ///< view.zone: where B is a wall
  const PairFeatures& features;
  const PairForce& force;
  const PairMotion& motion;
  const PairLaw& law;
  const std::vector<ContactOutput>& outputs;  ///< of each feature; empty unless the observer needs them
  const CandidateLists& lists;
  const Mat3& a_to_world;
  double friction_dt;  ///< the step that lies behind the pair [s]; 0: none, as at the start
  bool counts_here;    ///< this rank counts what the pair has once: of two owners one does
  MeshDistanceScratch& distance;
  std::size_t thread;  ///< that calls: observers keep apart what each adds
};

class PairObserver {
 public:
  virtual ~PairObserver() = default;
  /// Whether it is shown the contacts of this pair.
  virtual bool observes(const PairView& view) const = 0;
  /// Whether it is shown pairs of two bodies: these are then not computed in lanes, which keep no features.
  virtual bool observes_bodies() const { return true; }
  /// Whether it reads PairContact::outputs.
  virtual bool needs_outputs() const { return true; }
  /// Called by any thread, for the pairs of a pass in any order.
  virtual void observe(const PairContact& contact) = 0;
};
/// PairContact::thread is below this.
inline std::size_t most_threads() { return static_cast<std::size_t>(omp_get_max_threads()); }

using PairObservers = std::span<PairObserver* const>;
inline bool any_observes_bodies(PairObservers observers) {
  return std::any_of(observers.begin(), observers.end(), [](const PairObserver* o) { return o->observes_bodies(); });
}

/// Of visit_pairs.
using PairVisitor = std::function<void(const PairContact&)>;

}  // namespace scree
