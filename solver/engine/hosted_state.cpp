// States of a hosted run, in memory and in files, and bodies that come and go.
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/base/nearest_name.hpp"
#include "solver/engine/hosted_run-inl.hpp"
#include "solver/run/make_frame.hpp"
#include "solver/run/measures.hpp"

namespace scree {

namespace {

std::int32_t index_of(const std::vector<std::string>& names, const std::string& name, const char* kind) {
  const auto at = std::find(names.begin(), names.end(), name);
  if (at != names.end()) return static_cast<std::int32_t>(at - names.begin());
  const std::string near = nearest_name(name, names);
  throw UsageError("insert: the scene has no {} '{}'; {}", kind, name,
                   near.empty() ? fmt::format("there are: {}", fmt::join(names, ", ")) : fmt::format("did you mean '{}'?", near));
}

/// Of a new body [K]; 0 in a scene without heat. Throws UsageError.
double temperature_of(const Scene& scene, const NewBody& body, std::int32_t material, std::size_t number) {
  if (!scene.settings.heat) {
    if (body.temperature)
      throw UsageError(
          "insert: body {} of this call has a temperature, and the scene has no heat; leave it out, or add a table [heat] to the case",
          number);
    return 0;
  }
  if (const Material& m = scene.materials[static_cast<std::size_t>(material)]; !m.has_heat())
    throw UsageError(
        "insert: body {} of this call is of '{}', which has no heat_capacity and conductivity; give both to the material in the case",
        number, m.name);
  const double of_case = scene.settings.heat->temperature;
  if (!body.temperature && !(of_case > 0))
    throw UsageError("insert: body {} of this call has no temperature, and [heat] of the case has none for all bodies; give one", number);
  const double temperature = body.temperature.value_or(of_case);
  if (!(temperature > 0) || !std::isfinite(temperature))
    throw UsageError("insert: body {} of this call has a temperature of {:g} K; expected a finite number > 0, in kelvin", number,
                     temperature);
  return temperature;
}

template <class Items>
std::vector<std::string> names_of(const Items& items) {
  std::vector<std::string> names;
  for (const auto& item : items) names.push_back(item.name);
  return names;
}

}  // namespace

std::shared_ptr<const HostedRun::State> HostedRun::save() {
  in_->check_goes_on("save");
  in_->check_nobody_waits("save");
  auto state = std::make_shared<State>();
  state->ranks = in_->comm.size();
  state->checkpoint = present_state(in_->comm, *in_->simulation);
  state->checkpoint.scene_sha256 = in_->loaded.sha256;
  state->checkpoint.step_limited_by = in_->state().clock.size.limited_by;
  if (const auto* outer = in_->state().effect<OuterForces>()) {
    for (const int number : outer->numbers()) {
      const auto at =
          std::find_if(in_->forces.begin(), in_->forces.end(), [number](const auto& f) { return f.number_of_effect == number; });
      state->functions.push_back(at == in_->forces.end() ? 0 : at->number);
    }
  }
  return state;
}

void HostedRun::restore(const State& state) {
  if (in_->files)
    throw UsageError("restore: the engine writes a run folder, whose files would not be those of one run; open it without run");
  if (state.checkpoint.scene_sha256 != in_->loaded.sha256) throw UsageError("restore: the state is of another scene");
  if (state.ranks != in_->comm.size())
    throw UsageError("restore: the state is of a run on {} ranks, this one has {}", state.ranks, in_->comm.size());
  in_->failed.clear();
  in_->guarded([&] {
    // a simulation starts once: another one takes its place
    in_->simulation.emplace(in_->comm, *in_->loaded.prepared, in_->options.parallel);
    Checkpoint copy = state.checkpoint;
    in_->simulation->start_from_records(copy.bodies, std::move(copy.states), copy.step, copy.step_size, copy.step_limited_by, copy.totals);
    std::vector<bool> acted(in_->forces.size());
    for (std::size_t place = 0; place < state.functions.size(); ++place) {
      const int number = state.functions[place];
      if (number == 0) continue;
      const auto at = std::find_if(in_->forces.begin(), in_->forces.end(), [number](const auto& f) { return f.number == number; });
      if (at == in_->forces.end()) {
        in_->simulation->outer_forces().close_place(place);
        continue;
      }
      at->number_of_effect = in_->simulation->outer_forces().take_place(in_->change(), place, at->given);
      acted[static_cast<std::size_t>(at - in_->forces.begin())] = true;
    }
    for (std::size_t k = 0; k < in_->forces.size(); ++k)
      if (!acted[k]) in_->forces[k].number_of_effect = in_->simulation->outer_forces().add(in_->change(), in_->forces[k].given);
    in_->simulation->evaluate_contacts_at_rest();
  });
}

void HostedRun::write_checkpoint(const std::string& folder) {
  in_->check_goes_on("write_checkpoint");
  in_->check_nobody_waits("write_checkpoint");
  Checkpoint so_far;
  so_far.origin = in_->loaded.origin;
  so_far.scene_sha256 = in_->loaded.sha256;
  const nlohmann::json provenance = provenance_of_run(in_->comm, in_->options, in_->loaded, "");
  scree::write_checkpoint(in_->comm, *in_->simulation, folder, so_far, provenance);
}

void HostedRun::write_frame(const std::string& path) {
  // after a failed step as well, to find its cause: contacts are then of no step
  const bool with_contacts = in_->loaded.scene.settings.output_contacts && in_->failed.empty();
  Frame frame = make_frame(*in_->simulation, energies_of(in_->state()), in_->comm.rank(), with_contacts, in_->loaded.origin);
  frame.number = 0;
  frame.provenance = provenance_of_run(in_->comm, in_->options, in_->loaded, "");
  mpi::on_all(in_->comm, [&] { write_frame_file(in_->comm.get(), path, frame); });
}

std::vector<std::int64_t> HostedRun::insert(const std::vector<NewBody>& mine) {
  in_->check_moves("insert");
  const RunState& s = in_->state();
  std::vector<ParticleRecord> records;
  std::vector<std::int64_t> ids;
  std::int64_t before = 0, count = static_cast<std::int64_t>(mine.size());
  MPI_Exscan(&count, &before, 1, MPI_INT64_T, MPI_SUM, in_->comm.get());
  if (in_->comm.rank() == 0) before = 0;
  mpi::on_all(in_->comm, [&] {
    const Scene& scene = in_->loaded.scene;
    const std::vector<std::string> shapes = names_of(scene.shapes), materials = names_of(scene.materials);
    for (const NewBody& body : mine) {
      BodyAtStart b{};
      b.id = s.largest_id + 1 + before + static_cast<std::int64_t>(ids.size());
      b.shape = index_of(shapes, body.shape, "shape");
      b.material = index_of(materials, body.material, "material");
      b.scale = body.scale;
      b.position = body.position - in_->loaded.origin;
      b.orientation = body.orientation;
      b.velocity = body.velocity;
      b.angular_velocity = body.angular_velocity;
      const Quat& q = body.orientation;
      const double norm = q.w * q.w + q.x * q.x + q.y * q.y + q.z * q.z;
      for (const auto& [name, numbers] : {std::pair("position", body.position), std::pair("velocity", body.velocity),
                                          std::pair("angular_velocity", body.angular_velocity)})
        if (!is_finite(numbers))
          throw UsageError("insert: {} of body {} of this call is ({:g} {:g} {:g}), which is not finite; check what it is computed from",
                           name, ids.size(), numbers.x, numbers.y, numbers.z);
      if (!std::isfinite(norm))
        throw UsageError(
            "insert: quaternion of body {} of this call is ({:g} {:g} {:g} {:g}), which is not finite; check what it is computed from",
            ids.size(), q.w, q.x, q.y, q.z);
      if (!(norm > 0))
        throw UsageError("insert: the quaternion of body {} of this call is 0; without a rotation it is 1 0 0 0", ids.size());
      if (!(b.scale > 0) || !std::isfinite(b.scale))
        throw UsageError("insert: body {} of this call has a scale of {:g}; expected a number > 0", ids.size(), b.scale);
      b.temperature = temperature_of(scene, body, b.material, ids.size());
      records.push_back(make_record(*in_->loaded.prepared, b));
      ids.push_back(b.id);
    }
  });
  if (!in_->new_body_check) in_->new_body_check.emplace(*in_->loaded.prepared);
  const NewBodyCheck::Warning warning =
      in_->new_body_check->check(s, records, in_->simulation->waiting_bodies(), in_->simulation->domain().asked(), in_->loaded.origin);
  try {
    in_->simulation->add_bodies(records);
  } catch (const Error& error) {  // on every rank, and no body joins
    if (error.code() != ExitCode::run_invalid) throw;
    throw UsageError("insert: {}", error.what());
  }
  constexpr double kWorse = 2;  // than what was reported before: a small overlap must not hide a large one
  if (warning.overlap > 0 && warning.overlap >= kWorse * in_->reported_overlap) {
    in_->reported_overlap = warning.overlap;
    if (in_->comm.rank() == 0) warn_once("scree-solver", warning.text);
  }
  return ids;
}

void HostedRun::remove(const std::vector<std::int64_t>& mine) {
  in_->check_moves("remove");
  in_->check_joined("remove", mine);
  in_->simulation->remove_bodies(mine);
}

}  // namespace scree
