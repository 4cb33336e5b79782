// A run that another program steps: what libscree_engine.so does, in C++. The page for its users is scree_engine.h, which says what each
// function means; here is what is behind it.
//
// scree-solver and this class step the same Simulation, and write files by the same RunSteps: equal bits need no care.
//
// Every function is collective unless it is said to be local. What is thrown is thrown on every rank alike, provided that all give the same
// arguments but for lists of ids and bodies.
#pragma once

#include <mpi.h>

#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/storage/frame_file.hpp"
#include "solver/effects/heat/heat_effect.hpp"
#include "solver/effects/outer_forces/outer_forces.hpp"
#include "solver/run/checkpoint.hpp"

namespace scree {

/// A body that is to join.
struct NewBody {
  std::string shape, material;
  Vec3 position;
  Quat orientation;  ///< mesh to world
  Vec3 velocity, angular_velocity;
  double scale = 1;
  std::optional<double> temperature;  ///< [K]; none: that of [heat], where the scene has heat
};

class HostedRun {
 public:
  struct Options {
    std::string run_folder;  ///< "": no files
    std::string restart;     ///< as RunOptions::restart
    int threads = 0;         ///< >= 0; 0: OMP_NUM_THREADS, or as many as bodies keep busy
  };
  HostedRun(const std::string& scene, MPI_Comm comm, const Options& options);
  HostedRun(const HostedRun&) = delete;
  HostedRun& operator=(const HostedRun&) = delete;
  ~HostedRun();
  /// The last files of a run with a folder. Nothing is to be called after it.
  void close();

  /// Throws UsageError with this text on every rank, where the arguments of a call are wrong on one of them.
  void check(bool is_right, const char* text) const;

  // 1. Steps.
  /// Returns 0, or 128 and the number that a poll gave.
  int step(std::int64_t count);
  int run_until(double time);
  /// Local. Called about every `interval` [s] of wall time while steps are made.
  void on_poll(std::function<int()> poll, double interval);

  // 2. Facts. Local.
  double time() const;
  double dt() const;
  std::int64_t step_count() const;
  bool is_over() const;
  const Scene& scene() const;

  // 3. Bodies of this rank. Local. Null for a field that there is none of.
  std::int64_t body_count() const;
  const double* reals(const std::string& field);
  const std::int64_t* integers(const std::string& field);

  // 4. Forces from outside.
  void hold(const std::vector<WrenchOnBody>& mine);
  void release(const std::optional<std::vector<std::int64_t>>& mine);
  /// in   name   in messages; "": its number
  int add_force(const ForceFunction& function, std::int64_t every, const std::string& name);
  void remove_force(int number);

  // Heat from outside. UsageError in a scene without heat.
  void hold_heat(const std::vector<SourceOfBody>& mine);
  void hold_heat(const std::vector<MediumOfBody>& mine);
  void release_heat(const std::optional<std::vector<std::int64_t>>& mine);
  std::vector<double> take_medium_heat(const std::vector<std::int64_t>& mine);
  HeatMeasures heat();

  // 5. Walls and measures.
  std::vector<std::array<double, 6>> wall_loads();
  std::array<double, 13> wall_state(std::size_t wall) const;  ///< local
  void drive_wall(std::size_t wall, double rate);
  std::pair<double, double> wall_way(std::size_t wall) const;  ///< and rate, local
  Energies energies();
  std::string state_hash();
  double critical_step();
  const FrameContacts& collect_contacts();

  // 6. States.
  struct State {
    Checkpoint checkpoint;
    /// Numbers of the functions that acted, different in all runs of a process; 0: one of a restart that nobody has added again.
    std::vector<int> functions;
    int ranks = 1;
  };
  std::shared_ptr<const State> save();
  void restore(const State& state);
  void write_checkpoint(const std::string& folder);
  void write_frame(const std::string& path);

  // 7. Bodies that come and go.
  std::vector<std::int64_t> insert(const std::vector<NewBody>& mine);
  void remove(const std::vector<std::int64_t>& mine);

 private:
  struct Inner;
  std::unique_ptr<Inner> in_;
};

}  // namespace scree
