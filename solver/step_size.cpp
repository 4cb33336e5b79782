#include "solver/step_size.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace scree {

StepSize derive_step_size(const mpi::Communicator& comm, const SolverScene& scene, const ParticleSet& p) {
  const Scene& source = scene.source();
  const std::size_t materials = source.materials.size();
  // largest mobility W of a body of each material, and who has it
  struct Entry { double value; int rank; };
  std::vector<Entry> mobility(materials, {0, comm.rank()});
  std::vector<std::int64_t> body(materials, -1);
  for (std::size_t i = 0; i < p.owned; ++i) {
    if (p.fixed[i]) continue;
    const auto m = static_cast<std::size_t>(p.material[i]);
    const double s = p.scale[i], density = source.materials[m].density;
    const double turning = p.lock_rotation[i] ? 0.0 : scene.shape(p.shape[i]).rotational_mobility / (density * s * s * s);
    const double w = p.inverse_mass[i] + turning;
    if (w > mobility[m].value) {
      mobility[m].value = w;
      body[m] = p.id[i];
    }
  }
  MPI_Allreduce(MPI_IN_PLACE, mobility.data(), static_cast<int>(materials), MPI_DOUBLE_INT, MPI_MAXLOC, comm.get());
  for (std::size_t m = 0; m < materials; ++m) MPI_Bcast(&body[m], 1, MPI_INT64_T, mobility[m].rank, comm.get());

  // n^(2/q) for n = 4 corners of a face, q = 8
  const double features = std::sqrt(std::sqrt(4.0));
  StepSize result;
  double stiffest = 0;
  for (const MaterialPair& pair : source.pairs) {
    const auto a = static_cast<std::size_t>(pair.a), b = static_cast<std::size_t>(pair.b);
    const double w = mobility[a].value + mobility[b].value;
    const double omega2 = scene.law(pair.a, pair.b).step_stiffness * features * w;
    if (omega2 <= stiffest) continue;
    stiffest = omega2;
    const auto name = [&](std::size_t m) {
      return body[m] < 0 ? "fixed " + source.materials[m].name : fmt::format("body {} ({})", body[m], source.materials[m].name);
    };
    result.limited_by = name(a) + " on " + name(b);
  }
  if (stiffest > 0) result.contact_time = std::numbers::pi / std::sqrt(stiffest);
  if (source.settings.step > 0) {
    result.step = source.settings.step;
    result.given = true;
    // Below four steps per contact the leapfrog is past its stability limit (2 / omega) for stacked contacts.
    constexpr double kFewestSteps = 4;
    if (stiffest > 0 && result.contact_time / result.step < kFewestSteps) {
      throw UsageError("time.step = {:g} s is {:.2g} steps per contact of {} ({:g} s); use at least {}, better 30",
                       result.step, result.contact_time / result.step, result.limited_by, result.contact_time, kFewestSteps);
    }
    return result;
  }
  if (stiffest > 0) {
    result.step = result.contact_time / source.settings.steps_per_contact;
  } else {
    result.step = source.settings.duration > 0 ? source.settings.duration / 1000 : 1;
    result.limited_by = "no contact can occur: a thousandth of the duration";
  }
  return result;
}

}  // namespace scree
