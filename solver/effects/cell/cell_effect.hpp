// The effect as its own files see it.
#pragma once

#include "solver/effects/cell/cell_sums.hpp"
#include "solver/state/effect.hpp"
#include "solver/state/run_state.hpp"

namespace scree {

class CellEffect : public Effect {
 public:
  explicit CellEffect(const RunState& s)
      : control_(*s.scene.source().settings.cell),
        first_(s.scene.source().settings.domain.upper - s.scene.source().settings.domain.lower),
        shears_(control_.shears()) {}

  void begin(RunState& s) override;
  void start(RunState& s) override;
  void before_drift(RunState& s) override;
  void drift(RunState& s) override;
  void end_step(const StepParts& parts) override;
  std::string ends_run(const RunState& s) const override;

  EffectRecord record(const RunState& s) const override;
  void restore(RunState& s, const EffectRecord& record) override;
  static std::vector<ArrayFormat> format();

  void add_energies(const RunState& s, Energies& energies) const override;
  void add_log_columns(const RunState& s, const Energies&, std::vector<Column>& columns) const override;
  void add_frame(const RunState& s, Frame& frame) const override;
  std::vector<PlanLine> plan(const RunState& s) const override;

 private:
  void take_mean_velocity(RunState& s) const;
  CellSums sums_of_step(const RunState& s) const;
  double damping(const RunState& s, int component) const;
  double next_given_rate(const RunState& s, int component) const;
  double inertia(const RunState& s, int component) const;
  /// Logarithmic, and minus the integral of L: positive in compression.
  UpperMatrix strain(const RunState& s) const;

  const CellControl control_;
  const Vec3 first_;  // lengths at the start [m]
  const bool shears_;

  // what a restart needs
  bool is_restored_ = false;
  double contact_time_ = 0;        // of the contact that limits the step, at the start [s]
  UpperMatrix next_rate_;          // L over the next step [1/s]
  UpperMatrix steady_rate_;        // which damping leaves alone: r of the theory [1/s]
  UpperMatrix mean_stress_;        // s of the theory [Pa]
  Vec3 sheared_, sheared_rest_;    // integral of L_yz, L_xz, L_xy, and what rounding took from it
  double work_ = 0, lost_ = 0;     // of the cell on the bodies; by damping and friction: the last step counts in full [J]
  double power_ = 0, losing_ = 0;  // the same at the end of the last step [W]

  double mass_ = 0, solid_volume_ = 0;  // of all bodies [kg], [m^3]
};

}  // namespace scree
