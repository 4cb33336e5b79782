#include "solver/step/arrivals.hpp"

#include <algorithm>
#include <utility>

#include "solver/built_with.hpp"
#include "solver/step_size/step_size.hpp"

namespace scree {

namespace {

/// Counts what a body brings: its energy at the end of the step if it touches nothing, and what a fluid takes of it until then.
void count_arrival(const RunState& s, const ParticleRecord& r, ArrivalTotals& arrived) {
  ParticleSet alone;
  append_record(alone, r, s.scene);
  alone.owned = 1;
  finish_in_free_flight(s, alone, 0);
  arrived.count.add(1);
  arrived.mass.add(alone.mass[0]);
  arrived.energy.add(translational_energy(alone, 0) + rotational_energy(alone, 0) + potential_energy(s, alone, 0) + alone.dissipated[0]);
}

/// Throws on every rank when an id is given twice or taken. Returns the largest; -1 when there are none.
std::int64_t check_ids(const RunState& s, const std::vector<ParticleRecord>& mine) {
  std::vector<std::int64_t> ids;
  for (const ParticleRecord& r : mine) ids.push_back(r.id);
  std::vector<std::int64_t> all = s.comm.of_all(ids);
  if (all.empty()) return -1;
  std::sort(all.begin(), all.end());
  mpi::on_root(s.comm, [&] {
    const auto twice = std::adjacent_find(all.begin(), all.end());
    if (all.front() > s.largest_id && twice == all.end()) return;
    throw InputError("body {} cannot join: its id is taken; give one above {}", twice == all.end() ? all.front() : *twice, s.largest_id);
  });
  return all.back();
}

}  // namespace

void check_built_with(const mpi::Communicator& comm, const SolverScene& scene, const ParticleSet& p) {
  const auto need = [](bool built, bool needed, const char* what) {
    if (!built && needed) throw UsageError("this build of the solver has no {}, which the scene needs; take scree-solver", what);
  };
  bool rotates = false, has_meshes = false;
  for (std::size_t i = 0; i < p.size(); ++i) {
    rotates = rotates || !(p.fixed[i] || p.lock_rotation[i]);
    has_meshes = has_meshes || scene.shape(p.shape[i]).kind != ShapeKind::sphere;
  }
  for (const WallZone& zone : scene.zones()) has_meshes = has_meshes || zone.kind == WallZone::Kind::mesh;
  need(built_with::kFriction, scene.law_choice().friction || scene.law_choice().rolling, "friction");
  need(built_with::kRotation, rotates, "rotation");
  need(built_with::kRanks, comm.size() > 1, "parallel ranks");
  need(built_with::kMeshes, has_meshes, "meshes");
}

void Arrivals::add(RunState& s, const std::vector<ParticleRecord>& mine) {
  ParticleSet joining;
  double largest = 0;
  mpi::on_all(s.comm, [&] {
    for (const ParticleRecord& r : mine) {
      s.scene.check_body(r.id, r.shape, r.scale);
      append_record(joining, r, s.scene);
      largest = std::max(largest, joining.radius.back());
    }
    check_built_with(s.comm, s.scene, joining);
    if (largest > s.scene.extremes().bounding_radius) s.scene.check_seams(largest);
  });
  const std::int64_t largest_id = check_ids(s, mine);
  if (largest_id < 0) return;
  std::vector<ParticleRecord> waiting = mine_;
  waiting.insert(waiting.end(), mine.begin(), mine.end());
  mpi::on_all(s.comm, [&] {
    check_step(s.clock.size, limit_of_contacts(s.comm, s.scene, s.particles, waiting), s.scene.source().settings, s.clock.step);
  });
  std::vector<InsertedBody> added;
  for (std::size_t k = 0; k < mine.size(); ++k) {
    const ParticleRecord& r = mine[k];
    added.push_back({r.id, 0, 0, joining.mass[k], 2 * joining.equivalent_radius[k], r.x, -1, r.shape, r.material});
  }
  added = s.comm.of_all(added);
  added_.insert(added_.end(), added.begin(), added.end());
  add_known(s, mine, largest_id);
}

void Arrivals::add_known(RunState& s, const std::vector<ParticleRecord>& mine, std::int64_t largest_id) {
  s.largest_id = s.totals.largest_id = largest_id;
  mine_.insert(mine_.end(), mine.begin(), mine.end());
  waiting_ = true;
}

bool Arrivals::join(RunState& s, const Halo& halo) {
  if (!std::exchange(waiting_, false)) return false;
  std::sort(added_.begin(), added_.end(), [](const InsertedBody& l, const InsertedBody& r) { return l.id < r.id; });
  for (InsertedBody& body : std::exchange(added_, {})) {
    body.step = s.clock.step;
    body.time = s.clock.time();
    inserted_.push_back(body);
  }
  std::vector<ParticleRecord> joined = halo.deliver(s.particles.cell.periodicity(), std::exchange(mine_, {}));
  // the order in which ranks gave them must not show
  std::sort(joined.begin(), joined.end(), [](const ParticleRecord& l, const ParticleRecord& r) { return l.id < r.id; });
  for (ParticleRecord& r : joined) {
    r.work = 0;
    r.entered = s.clock.time();
    if (s.integrator != Integrator::euler && !r.fixed) {
      // half a step before, in free flight; drag is left out
      const double share = s.fluid ? s.fluid->weight_share(r.material) : 1;
      r.v -= (0.5 * s.clock.dt * share) * s.scene.source().settings.gravity;
    }
    count_arrival(s, r, s.totals.arrived);
    append_record(s.particles, r, s.scene);
    for (const std::unique_ptr<Effect>& effect : s.effects) effect->body_joins(s, s.particles.size() - 1);
  }
  s.particles.owned = s.particles.size();
  return true;
}

std::vector<InsertedBody> Arrivals::take_inserted() { return std::exchange(inserted_, {}); }

void agree_on_bodies(RunState& s) {
  s.facts = agree_on_facts(s.comm, s.particles);
  const ContactLimit limit = limit_of_contacts(s.comm, s.scene, s.particles);
  s.clock.size.contact_time = limit.time;
  s.clock.size.slowest_contact_time = limit.slowest_time;
}

}  // namespace scree
