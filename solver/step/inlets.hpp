// Inlets: bodies that come into a running simulation where there is room for them.
//
// The n-th body of an inlet has its shape, size, orientation and trial places from random numbers that are a function of (seed, inlet, n,
// attempt), and of nothing else. It is due when the inlet owes at least half of it. Bodies come in at steps counted from the start of the
// run, in the order of n: each rank tests the same trial places against its own bodies, one reduction joins the answers, and the first
// place of each body that is free there and apart from those accepted before it in the same step is taken. So the number of ranks, the
// time at which lists are rebuilt and a restart change nothing. One that finds no place is waited for, never passed over for a smaller one,
// and what the inlet owes meanwhile comes as soon as there is room.
//
// Shapes and sizes are drawn evenly, not independently: any number of bodies follows the shares and the distribution of sizes closely.
// Source of the sequence: M. Roberts, The unreasonable effectiveness of quasirandom sequences (2018): R2, in whole numbers modulo 2^64.
#pragma once

#include <memory>
#include <vector>

#include "core/placing/region.hpp"
#include "solver/state/run_state.hpp"
#include "solver/step/arrivals.hpp"

namespace scree {

class Inlets {
 public:
  explicit Inlets(const SolverScene& scene);
  ~Inlets();

  /// Lets in what is due and finds room, in steps that are multiples of kExchangeSteps: to be called when bodies are where they are at the
  /// end of the step, before they are sorted to their ranks. Collective.
  /// Fails: RunInvalid on every rank for an inlet that finds no room and is to stop then.
  void feed(RunState& s, Arrivals& arrivals);
  /// Bodies that came in since the last call, in their order; the same on every rank.
  std::vector<InsertedBody> take_inserted();

 private:
  struct Wanted;
  struct Candidate;
  class Feeder;

  struct Source {
    Region region;
    std::vector<double> up_to;  ///< share of the number of bodies up to each shape
    std::unique_ptr<SizeSampler> sizes;
  };

  const SolverScene& scene_;
  std::vector<Source> sources_;
  std::vector<PackShape> shapes_;  ///< of the scene, one for each
  MeshDistanceScratchPtr scratch_;
  std::vector<InsertedBody> inserted_;
};

}  // namespace scree
