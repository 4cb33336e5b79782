#include "solver/run/guard.hpp"

#include <algorithm>
#include <cmath>

#include "solver/pairs/deep_contacts.hpp"

namespace scree {

namespace {

// A step above the critical one multiplies energy within tens of steps: a tenth of what there is distinguishes it from the error of a
// coarse but stable step. Whatever the cause, a run in which half of all energy came from nowhere is worth nothing.
constexpr double kUnstableGain = 0.1, kAnyGain = 0.5;
// Damping and friction can only take. What they seem to give back at the turn of a contact is an error of the step, up to (omega h)^2 / 30
// of the energy: 5e-3 at 8 steps a contact. More than this of all that was in motion or stored is a force that works the wrong way.
constexpr double kMaxReturned = 0.05;
constexpr double kEnergyRounding = 1e-12;  // of the potential energy, which cancels in the balance
// Of a bond's height: the stretch that rounding of places leaves, of bodies up to some thousand heights from the origin. Pieces at rest
// have the energy of that and no other.
constexpr double kPlaceRounding = 1e-12;

}  // namespace

std::string name_of(const CriticalStep& critical, const SolverScene& scene) {
  return critical.key.zone < 0 ? critical.name() : name_of_pair(scene, critical.key);
}

Guard::Guard(const mpi::Communicator& comm, const SolverScene& scene, const RunRecord& before)
    : comm_(comm), scene_(scene), record_(before) {
  for (const Bond& bond : scene.source().bonds) {
    const double stretch = kPlaceRounding * bond.height;
    bond_rounding_ += bond.area * bond.normal_stiffness * stretch * stretch;
  }
}

void Guard::begin(const Simulation& simulation, bool is_fresh) {
  // after a restart the forces of the last step are not known before the next one
  if (record_.log_rows == 0) record_.energies = energies_of(simulation.state());
  if (is_fresh) record_.energy_reference = record_.energies.balance();
}

double Guard::add_row(const Energies& energies, double overlap_ratio, double imbalance, const CriticalStep& critical) {
  RunRecord& r = record_;
  r.energies = energies;
  r.dissipated_peak = std::max(r.dissipated_peak, energies.dissipated);
  EnergyInPlay in_play = r.in_play();
  in_play.add_row(energies.translational + energies.rotational, energies.elastic, energies.tangential_elastic, energies.bond);
  r.kinetic_peak = in_play.kinetic_peak;
  r.elastic_peak = in_play.elastic_peak;
  const double error = energies.balance() - r.energy_reference;
  r.energy_error = std::max(r.energy_error, std::abs(error));
  add_overlap(overlap_ratio);
  r.imbalance_sum += imbalance;
  ++r.log_rows;
  if (critical.step < r.stiffest.step) r.stiffest = critical;
  return error;
}

void Guard::add_overlap(double ratio) { record_.max_overlap_ratio = std::max(record_.max_overlap_ratio, ratio); }

double Guard::energy_scale() const {
  const RunRecord& r = record_;
  return r.in_play().largest() + kEnergyRounding * std::abs(r.energies.potential) + bond_rounding_;
}

void Guard::check(const Simulation& simulation, double energy_error) const {
  const double scale = energy_scale(), step = simulation.state().clock.dt;
  // a fluid that streams gives energy as well
  const auto& fluid = scene_.source().settings.fluid;
  const bool streams = fluid && squared_length(fluid->velocity) > 0;
  const double returned = streams ? 0 : record_.dissipated_peak - record_.energies.dissipated;
  if (returned > kMaxReturned * scale)
    mpi::on_root(comm_, [&] {
      throw RunInvalid(
          "step {}: damping and friction gave back {:.3g} J, {:.2g} of all that was in motion or stored; they can only take energy. "
          "The step {:.4g} s is too long for the damping of the contacts that there are: reduce the step, or raise the restitution",
          simulation.step(), returned, returned / scale, step);
    });
  const CriticalStep& stiffest = record_.stiffest;
  const bool unstable = step > stiffest.step && energy_error > kUnstableGain * scale;
  const bool gains = energy_error - shadow_energy_gap(simulation.state()) > kAnyGain * scale;
  if (!unstable && !gains) return;
  const auto fastest = fastest_body(simulation.state());
  mpi::on_root(comm_, [&] {
    throw RunInvalid(
        "step {}: energy grew by {:.3g} J, {:.2g} of all that was in motion or stored, without a cause; body {} has the most, {:.3g} J. "
        "The critical step of {} is {:.4g} s, the step is {:.4g} s{}",
        simulation.step(), energy_error, energy_error / scale, fastest.first, fastest.second, name_of(stiffest, scene_), stiffest.step,
        step, unstable ? ": reduce the step or the stiffness" : "; see the integrator and the contact law");
  });
}

}  // namespace scree
