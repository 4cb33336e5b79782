#include "solver/effects/given_forces/given_forces.hpp"

#include <fmt/format.h>

#include "solver/state/run_state.hpp"

namespace scree {

namespace {

class GivenForces : public Effect {
 public:
  void on_rebuild(const StepParts& parts) override {
    const RunState& s = parts.state;
    given_.clear();
    for (std::size_t i = 0; i < s.particles.owned; ++i) {
      if (const BodyForce* f = s.scene.given_force(s.particles.id[i])) given_.push_back({i, f->force});
    }
  }
  void add_forces(RunState& s) override {
    for (const Given& given : given_) {
      if (s.particles.rest[given.row] != kAsleep) s.particles.force[given.row] += given.force;
    }
  }
  void add_force_at_rest(const RunState& s, std::size_t row, Vec3& force, Vec3&) const override {
    if (const BodyForce* f = s.scene.given_force(s.particles.id[row])) force += f->force;
  }
  std::vector<PlanLine> plan(const RunState& s) const override {
    return {{"given forces", fmt::format("on {} bodies", s.scene.source().forces.size())}};
  }

 private:
  struct Given {
    std::size_t row;  // of an owned body
    Vec3 force;       // [N]
  };
  std::vector<Given> given_;
};

}  // namespace

EffectKind given_forces_effect() {
  return {{}, {}, [](const RunState& s) -> std::unique_ptr<Effect> {
            if (s.scene.source().forces.empty()) return nullptr;
            return std::make_unique<GivenForces>();
          }};
}

}  // namespace scree
