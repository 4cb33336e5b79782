// Forces and torques that a program beside the simulation gives: held on bodies until they are given again, or as functions that are
// evaluated within each step.
//
// Time. What is given between two steps acts from that moment on: the force on the body changes at once, and with it the first half kick of
// the next step. A held force that follows a place x then lags by half a step on the mean, so that a spring held between steps gains
// energy: 2 pi w dt / 2 of itself in a period. Functions are called in every step when bodies are at their new places, with velocities of
// half a step before, as damping is evaluated: velocity Verlet holds.
//
// Work. A half kick of dt/2 by all forces changes the kinetic energy of a body by dt/2 F . (v_before + v_after) / 2, of which each force
// has its exact share; the same of torques, with angular velocities at the orientation of the kick. Both half kicks of a step are counted
// as they happen, by exact sums.
//
// Ranks. What belongs to a body lies on the rank that owns it, by its id, and goes with it: what a rank holds of bodies that it does not
// own any more is gathered on all ranks, and their new owners keep it. That costs 56 B for each such body and rank.
//
// Sleep. The wrench with which a body fell asleep is kept. It wakes when the present one differs from it by more than `sleep_tolerance` of
// its weight (or of weight times radius, as torque): at once, however slowly that came about.
//
// Source: the kick of W. C. Swope, H. C. Andersen, P. H. Berens, K. R. Wilson, J. Chem. Phys. 76 (1982) 637.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "solver/effects/outer_forces/wrench_table.hpp"
#include "solver/ranks/exact_sum.hpp"
#include "solver/state/effect.hpp"

namespace scree {

/// Adds to force and torque of each owned row, all 0 before. What it throws ends the step on all ranks.
using ForceFunction = std::function<void(std::span<Vec3> force, std::span<Vec3> torque)>;

/// What a program beside the simulation gives of a function.
struct GivenFunction {
  ForceFunction call;
  std::int64_t every = 1;  ///< it is called in steps whose number is a multiple of it
  std::string name;        ///< in messages
};

class OuterForces : public Effect {
 public:
  // 1. Between two steps. Collective.
  /// Holds wrenches, each in place of that which its body had. Any rank may name any body.
  /// Throws UsageError on every rank, and nothing is changed: a body that is unknown, named twice or fixed; a number that is not finite.
  void hold(RunState& s, const std::vector<WrenchOnBody>& mine);
  /// Holds nothing any more: on these bodies, without a list on all. Throws as hold().
  void release(RunState& s, const std::optional<std::vector<std::int64_t>>& mine);
  /// Adds a function: it is called now, and in each step whose number is a multiple of `every`; between them its last forces are held.
  /// Functions are called in the order in which they were added. Returns a number. Throws on every rank what it throws on one.
  /// A restored state has the forces of its functions, and no functions. Up to the next step, a function that is added takes the first of
  /// these places that is open: it has the forces of the state, and is not called now. Their velocities were those of half a step before,
  /// which the state does not have: a call now would give a drag another force, and the run other bits.
  int add(RunState& s, const GivenFunction& given);
  /// Gives the function of a place of a restored state, from 0 up.
  int take_place(RunState& s, std::size_t place, const GivenFunction& given);
  /// No function that is added takes this place: its forces act up to the next evaluation of forces, and then no more.
  void close_place(std::size_t place) { functions_[place].is_open = false; }
  /// The numbers of the functions, in their order; 0: a place that no function has taken.
  std::vector<int> numbers() const;
  /// Throws UsageError for a number that is not there.
  void remove(RunState& s, int number);

  /// Of a body that goes too far in a step: what its forces have to do with it, for the message. "": nothing.
  std::string cause_of_motion(const RunState& s, std::size_t row) const;
  /// Whether functions are called in steps: the same on every rank.
  bool has_functions() const { return !functions_.empty(); }
  std::vector<std::string> function_names() const;
  /// Of all ranks. Collective.
  std::int64_t held_count(const RunState& s) const;

  // 2. As an effect.
  bool is_idle() const override { return is_current_ && functions_.empty() && acting_.row.empty(); }
  void drift(RunState& s) override;
  void after_migration(RunState& s, bool left) override;
  void on_rebuild(const StepParts& parts) override;
  void before_forces(RunState& s) override;
  void add_forces(RunState& s) override;
  void after_kick(RunState& s) override;
  void falls_asleep(RunState& s, std::size_t row) override;
  void add_force_at_rest(const RunState& s, std::size_t row, Vec3& force, Vec3& torque) const override;
  EffectRecord record(const RunState& s) const override;
  void restore(RunState& s, const EffectRecord& record) override;
  std::vector<ItemHash> hashes(const RunState&) const override { return {}; }  // bodies say it
  void add_energies(const RunState& s, Energies& energies) const override;
  void add_log_columns(const RunState& s, const Energies& energies, std::vector<Column>& columns) const override;
  std::vector<PlanLine> plan(const RunState& s) const override;

 private:
  /// A wrench on an owned row.
  struct OnRow {
    std::size_t row;
    Wrench wrench;
  };
  /// What acts since the last evaluation of forces, by ascending rows, with what its work follows from: the velocities at the beginning of
  /// the present half kick, and for torques the orientation at which w follows from L.
  struct Acting {
    std::vector<std::size_t> row;
    std::vector<Vec3> force, v;
    struct Turning {
      std::size_t row;
      Vec3 torque, w, L;
      Quat q;
    };
    std::vector<Turning> turning;  // rows with a torque
    void clear();
    void add(const ParticleSet& p, const OnRow& on);
    /// A half kick begins: what its work follows from is as it is now.
    void begin_kick(const ParticleSet& p);
    std::vector<OnRow> list() const;
  };
  struct Function {
    int number = 0;
    GivenFunction given;              ///< without `call`: a place of a restored state that no function has taken
    bool is_open = false;             ///< such a place that add() may take
    std::vector<Vec3> force, torque;  ///< by owned row
    WrenchById latest;                ///< where it is not called in every step: rows may change between
  };

  const std::vector<std::int32_t>& by_id(const RunState& s);
  void call(const RunState& s, Function& f);
  void hold_latest(const RunState& s, Function& f);
  void keep_latest(const RunState& s, Function& f);
  void place_restored(const RunState& s);
  void sum_functions(const RunState& s);
  void add_to_sum(const RunState& s, const Function& f);
  std::vector<OnRow> present(const RunState& s) const;
  void change_now(RunState& s);
  void wake_changed(RunState& s, const std::vector<OnRow>& now);
  void find_rows(const RunState& s);
  template <class WAfter>
  void add_work(const RunState& s, double dt, const WAfter& w_after);

  WrenchTable held_;                 // of bodies of this rank
  WrenchById kept_;                  // the same, as they fell asleep
  std::vector<OnRow> held_rows_;     // ascending
  std::vector<std::int32_t> by_id_;  // rows; empty: not known since lists were made again
  std::vector<Function> functions_;
  std::vector<Vec3> force_, torque_;  // of all functions together, by owned row; empty without functions
  std::vector<OnRow> now_;            // what acts in this step, on bodies asleep too
  Acting acting_;
  bool is_current_ = false;   // acting_ is what is held, on the present rows
  bool is_restored_ = false;  // a restart, until rows are known, with the forces of each function in the step before:
  std::vector<WrenchTable> restored_;
  bool is_used_ = false;  // anything was ever given: the same on every rank
  int last_number_ = 0;
  ExactSum work_;  // of this rank [J]
};

/// Made where a record asks for it, or by Simulation::outer_forces(): no case has it.
EffectKind outer_forces_effect();

}  // namespace scree
