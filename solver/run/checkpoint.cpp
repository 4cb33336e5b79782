#include "solver/run/checkpoint.hpp"

#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <span>
#include <string_view>
#include <tuple>
#include <type_traits>
#include <unordered_set>

#include "core/base/near_file.hpp"
#include "core/base/utf8.hpp"
#include "core/storage/collective_file.hpp"
#include "core/storage/shape_file.hpp"
#include "solver/effects/effects.hpp"
#include "solver/run/checkpoint_tables.hpp"
#include "solver/run/run_folder.hpp"

namespace scree {

namespace {

/// The numbers of a record with their names, for writer and reader alike.
template <class Record, class Action>
void for_each_number(Record& r, Action&& action) {
  action("energy_reference", r.energy_reference);
  action("kinetic_peak", r.kinetic_peak);
  action("elastic_peak", r.elastic_peak);
  action("dissipated_peak", r.dissipated_peak);
  action("energy_error", r.energy_error);
  action("max_depth_ratio", r.max_overlap_ratio);
  action("critical_step", r.stiffest.step);
  action("critical_a", r.stiffest.key.a);
  action("critical_b", r.stiffest.key.b);
  action("critical_zone", r.stiffest.key.zone);
  action("kinetic_translational", r.energies.translational);
  action("kinetic_rotational", r.energies.rotational);
  action("potential", r.energies.potential);
  action("elastic", r.energies.elastic);
  action("elastic_tangential", r.energies.tangential_elastic);
  action("dissipated", r.energies.dissipated);
  action("wall_work", r.energies.wall_work);
  action("outer_work", r.energies.outer_work);
  action("cell_work", r.energies.cell_work);
  action("removed", r.energies.removed);
  action("arrived", r.energies.arrived);
  action("bond", r.energies.bond);
  action("fracture", r.energies.fracture);
  action("slept", r.energies.slept);
  action("imbalance_sum", r.imbalance_sum);
  action("log_rows", r.log_rows);
  action("list_renewals", r.list_renewals);
  action("cuts", r.cuts);
  action("migrated", r.migrated);
  action("bytes_sent", r.bytes_sent);
  action("peak_memory", r.peak_memory);
  action("wall_seconds", r.wall_seconds);
  for (std::size_t p = 0; p < r.phases.size(); ++p) action(std::string("t_") + phase_name(static_cast<Phase>(p)), r.phases[p]);
}

/// Numbers that the file does not have stay as they are: a later version may have more of them, and version 3 has four.
void read_record(const h5::Group& group, RunRecord& record) {
  for_each_number(record, [&](const std::string& name, auto& value) {
    if (group.has_attribute(name)) read_number(group, name, value);
  });
}

/// The rank whose share holds a body (see in_share): no directory is needed to find one.
std::size_t home_rank(std::int64_t id, int ranks) { return static_cast<std::size_t>(id % ranks); }

/// Own bodies, and the state of the pairs that count here: those listed, and those that wait while their bodies are apart.
void collect_state(const Simulation& simulation, std::vector<ParticleRecord>& bodies, std::vector<WaitingState>& states) {
  const ParticleSet& p = simulation.state().particles;
  for (std::size_t i = 0; i < p.owned; ++i) bodies.push_back(record_of(p, i));
  for (const BodyPair& pair : simulation.state().pairs.pairs()) {
    if (counts_here(pair, p) && !pair.state.empty()) states.push_back({pair.key, pair.state});
  }
  const std::vector<WaitingState>& waiting = simulation.state().pairs.waiting();
  if (waiting.empty()) return;
  const std::unordered_set<std::int64_t> owned(p.id.begin(), p.id.begin() + static_cast<std::ptrdiff_t>(p.owned));
  for (const WaitingState& w : waiting) {
    if (owned.contains(w.key.a)) states.push_back(w);
  }
}

/// Sends bodies and state to the ranks whose shares they belong to. Collective.
void share_out(const mpi::Communicator& comm, const std::vector<ParticleRecord>& bodies, const std::vector<WaitingState>& states,
               Checkpoint& c) {
  const auto ranks = static_cast<std::size_t>(comm.size());
  std::vector<std::vector<ParticleRecord>> bodies_to(ranks);
  for (const ParticleRecord& r : bodies) bodies_to[home_rank(r.id, comm.size())].push_back(r);
  for (const auto& block : comm.exchange(bodies_to)) c.bodies.insert(c.bodies.end(), block.begin(), block.end());
  std::sort(c.bodies.begin(), c.bodies.end(), [](const auto& l, const auto& r) { return l.id < r.id; });

  for_each_kind(PairState{}, [&](const auto& kind) {
    using Row = typename std::decay_t<decltype(kind)>::value_type;
    std::vector<std::vector<KeyedRow<Row>>> rows_to(ranks);
    for (const KeyedRow<Row>& r : keyed_rows<Row>(states)) {
      const std::size_t first = home_rank(r.key.a, comm.size());
      rows_to[first].push_back(r);
      const bool two_bodies = r.key.zone < 0;
      if (two_bodies && home_rank(r.key.b, comm.size()) != first) rows_to[home_rank(r.key.b, comm.size())].push_back(r);
    }
    // rows of a file come in any order: those of one pair may come from several ranks
    std::vector<KeyedRow<Row>> mine;
    for (const auto& block : comm.exchange(rows_to)) mine.insert(mine.end(), block.begin(), block.end());
    std::sort(mine.begin(), mine.end(),
              [](const auto& l, const auto& r) { return std::tie(l.key, l.row.key) < std::tie(r.key, r.row.key); });
    add_rows(mine, c.states);
  });
  merge(c.states);
}

/// The state of a table, one entry for each row: share_out() puts those of one pair together.
template <class Row>
void read_states(const mpi::Communicator& comm, const h5::Group& root, std::vector<WaitingState>& states) {
  std::vector<KeyedRow<Row>> rows;
  if (!root.has(PairKind<Row>::kGroup)) return;  // of a run that has none of this kind
  for (const auto& r : read_columns<PairTableColumns<Row>>(comm, root.open_group(PairKind<Row>::kGroup), "a"))
    rows.push_back({r.key(), r.row});
  add_rows(as_in_state(rows), states);
}

template <class Row>
std::vector<PairRow<Row>> table_of(const std::vector<WaitingState>& states) {
  std::vector<PairRow<Row>> rows;
  for (const KeyedRow<Row>& r : rows_for_table<Row>(states)) rows.push_back({r.key.a, r.key.b, r.key.zone, r.row});
  return rows;
}

/// A path that a user gave.
void check_is_file(const std::string& path) {
  std::error_code error;
  if (std::filesystem::is_directory(path, error))
    throw InputError(
        "{}: is a folder, a checkpoint was expected: a file checkpoint_NNNNNNNNNNNN.h5 of a run folder, or latest of the run's own", path);
  if (!std::filesystem::exists(path, error))
    throw InputError(
        "{}: no such checkpoint{}; checkpoints are the files checkpoint_NNNNNNNNNNNN.h5 of a run folder, and latest is the newest", path,
        near_file(path));
}

void read_whole_file(const mpi::Communicator& comm, Checkpoint& c, std::vector<ParticleRecord>& bodies, std::vector<WaitingState>& states) {
  const h5::File file(c.path);
  const h5::Group& root = file.root();
  check_format(root, kCheckpointFormat, kCheckpointFormatVersion);
  c.step = root.read_integer_attribute("step");
  c.step_size = root.read_double_attribute("step_size");
  if (root.has_attribute("step_limited_by")) c.step_limited_by = root.read_text_attribute("step_limited_by");
  c.totals.level = root.read_integer_attribute("step_level");
  if (root.read_integer_attribute("format_version") < 4) {
    read_record(root, c.record);
  } else {
    read_record(root.open_group("record"), c.record);
    c.origin = Vec3{root.read_double_attribute("origin_x"), root.read_double_attribute("origin_y"), root.read_double_attribute("origin_z")};
  }
  c.totals.max_overlap_ratio = root.read_double_attribute("interval_max_depth_ratio");
  c.state_hash = root.read_text_attribute("state_hash");
  c.scene_sha256 = root.read_text_attribute("scene_sha256");
  constexpr auto kWords = static_cast<std::int64_t>(ExactSum::kWords);
  constexpr std::int64_t kSumsWithoutWalls = 6, kSumsOfWall = 3;
  const auto words = root.read_array<std::int64_t>("totals", kWords);
  const std::int64_t sums = static_cast<std::int64_t>(words.size()) / kWords;
  c.totals.walls = WallTotals(static_cast<std::size_t>(std::max<std::int64_t>(0, (sums - kSumsWithoutWalls) / kSumsOfWall)));
  set_words(words, c.totals);
  if (root.has("outlets")) {
    const auto outlets = root.read_array<std::int64_t>("outlets", kWords);
    c.totals.outlets.resize(outlets.size() / (2 * ExactSum::kWords));
    set_words(outlets, c.totals.outlets);
  }
  if (root.has("inlets")) c.totals.inlets = read_inlets(root);
  for (const EffectKind& kind : effect_kinds()) c.totals.effects.push_back(read_effect(root, kind.format));
  if (root.has("deep_contacts")) read_deep_contacts(root.open_group("deep_contacts"), c.totals.deep);
  if (root.has_attribute("largest_id")) {
    set_words(root.read_array<std::int64_t>("arrivals", kWords), c.totals.arrived);
    c.totals.largest_id = root.read_integer_attribute("largest_id");
  }
  bodies = read_columns<BodyTableColumns>(comm, root.open_group("bodies"), "id");
  for_each_table([&]<class Row>() { read_states<Row>(comm, root, states); });
}

}  // namespace

void write_checkpoint(const mpi::Communicator& comm, const Simulation& simulation, const std::string& folder, const Checkpoint& so_far,
                      const nlohmann::json& provenance) {
  std::vector<ParticleRecord> bodies;
  std::vector<WaitingState> states;
  collect_state(simulation, bodies, states);
  const RunTotals totals = overall_totals(simulation.state());
  const std::vector<std::int64_t> words = words_of(totals);
  const std::string hash = state_hash(simulation.state());
  // attributes are written by all ranks alike, and each has measured other times
  RunRecord run = so_far.record;
  static_assert(std::is_trivially_copyable_v<RunRecord>);
  MPI_Bcast(&run, sizeof run, MPI_BYTE, 0, comm.get());
  const Vec3 origin = so_far.origin.value_or(Vec3{});

  mpi::on_all(comm, [&] {
    const std::string record = broadcast_text(comm.get(), comm.rank() == 0 ? json_text(provenance) : std::string());
    const Rows body_rows = distribute(comm.get(), static_cast<std::int64_t>(bodies.size()));
    std::int64_t bytes = body_rows.total * bytes_per_row<BodyTableColumns>() +
                         static_cast<std::int64_t>(words.size() * sizeof(std::int64_t) + record.size());
    for (const EffectRecord& of_effect : totals.effects) {
      for (const StateArray& array : of_effect)
        bytes += static_cast<std::int64_t>(array.reals.size() * sizeof(double) + array.integers.size() * sizeof(std::int64_t));
    }
    for_each_table([&]<class Row>() {
      bytes += comm.sum(static_cast<std::int64_t>(rows_for_table<Row>(states).size())) * bytes_per_row<PairTableColumns<Row>>();
    });
    CollectiveFile file(comm.get(), folder + "/" + checkpoint_name(simulation.step()), bytes, CollectiveFile::Kind::checksummed);
    {
      const h5::Group& root = file.root();
      root.write_attribute("format", kCheckpointFormat);
      root.write_attribute("format_version", kCheckpointFormatVersion);
      root.write_attribute("step", simulation.step());
      root.write_attribute("step_size", simulation.state().clock.size.step);
      root.write_attribute("step_limited_by", simulation.state().clock.size.limited_by);
      root.write_attribute("step_level", totals.level);
      root.write_attribute("origin_x", origin.x);
      root.write_attribute("origin_y", origin.y);
      root.write_attribute("origin_z", origin.z);
      root.write_attribute("interval_max_depth_ratio", totals.max_overlap_ratio);
      root.write_attribute("state_hash", hash);
      root.write_attribute("scene_sha256", so_far.scene_sha256);
      const h5::Group group = root.create_group("record");
      for_each_number(run, [&](const std::string& name, const auto& value) { group.write_attribute(name, value); });
      file.write_text(root, "provenance", record);
      // the same on every rank: rank 0 writes them
      const auto write_sums = [&](const h5::Group& in, const char* name, std::span<const std::int64_t> sums) {
        const auto rows = static_cast<std::int64_t>(sums.size() / ExactSum::kWords);
        file.write(in, name, sums.data(), comm.rank() == 0 ? Rows{rows, 0, rows} : Rows{0, rows, rows},
                   static_cast<std::int64_t>(ExactSum::kWords), H5T_NATIVE_INT64, "");
      };
      write_sums(root, "totals", words);
      if (!totals.outlets.empty()) write_sums(root, "outlets", words_of(totals.outlets));
      if (!totals.inlets.empty()) write_inlets(comm, file, root, totals.inlets);
      for (std::size_t k = 0; k < effect_kinds().size(); ++k) write_effect(comm, file, root, effect_kinds()[k].format, totals.effects[k]);
      if (totals.deep.contact_steps > 0) write_deep_contacts(root.create_group("deep_contacts"), totals.deep);
      if (totals.largest_id >= 0) {
        root.write_attribute("largest_id", totals.largest_id);
        write_sums(root, "arrivals", words_of(totals.arrived));
      }
      write_columns<BodyTableColumns>(file, root.create_group("bodies"), bodies, body_rows,
                                      simulation.state().scene.source().settings.heat ? nullptr : BodyTableColumns::is_of_heat);
      for_each_table([&]<class Row>() {
        const std::vector<PairRow<Row>> table = table_of<Row>(states);
        const Rows rows = distribute(comm.get(), static_cast<std::int64_t>(table.size()));
        const bool is_always_there = std::is_same_v<Row, FrictionSpring> || (std::is_same_v<Row, KeptForce> && simulation.state().sleep);
        if (rows.total == 0 && !is_always_there) return;
        write_columns<PairTableColumns<Row>>(file, root.create_group(PairKind<Row>::kGroup), table, rows);
      });
    }
    file.commit();
  });
  mpi::on_root(comm, [&] {
    const std::vector<std::string> all = list_checkpoints(folder);
    for (std::size_t i = 0; i + 2 < all.size(); ++i) std::filesystem::remove(all[i]);
  });
}

Checkpoint read_checkpoint(const mpi::Communicator& comm, const std::string& path) {
  Checkpoint c;
  c.path = path;
  std::vector<ParticleRecord> bodies;
  std::vector<WaitingState> states;
  mpi::on_root(comm, [&] { check_is_file(path); });
  mpi::on_all(comm, [&] { check_checksum(comm.get(), path); });
  mpi::on_all(comm, [&] { read_whole_file(comm, c, bodies, states); });
  share_out(comm, bodies, states, c);
  return c;
}

Checkpoint present_state(const mpi::Communicator& comm, const Simulation& simulation) {
  Checkpoint c;
  c.step = simulation.step();
  c.step_size = simulation.state().clock.size.step;
  c.totals = overall_totals(simulation.state());
  c.state_hash = state_hash(simulation.state());
  std::vector<ParticleRecord> bodies;
  std::vector<WaitingState> states;
  collect_state(simulation, bodies, states);
  share_out(comm, bodies, states, c);
  return c;
}

InputError no_checkpoint(const std::string& folder, const OptionWords& words) {
  return InputError("{}: {} holds no checkpoint; {} begins from the scene where there is none", words.restart("latest"), folder,
                    words.restart("auto"));
}

Checkpoint read_latest_checkpoint(const mpi::Communicator& comm, const std::string& folder, const OptionWords& words) {
  std::vector<std::string> paths;
  mpi::on_root(comm, [&] { paths = list_checkpoints(folder); });
  std::string refused;
  while (true) {
    const std::string path = broadcast_text(comm.get(), paths.empty() ? std::string() : paths.back());
    if (path.empty()) {
      mpi::on_root(comm, [&] {
        if (refused.empty()) throw no_checkpoint(folder, words);
        throw InputError("{}; no older checkpoint is left: run the scene again into another folder", refused);
      });
    }
    try {
      Checkpoint checkpoint = read_checkpoint(comm, path);
      const std::string name = std::filesystem::path(path).filename().string();
      if (checkpoint_name(checkpoint.step) != name) throw InputError("{}: holds step {}, as its name does not say", path, checkpoint.step);
      return checkpoint;
    } catch (const Error& error) {
      if (error.code() != ExitCode::bad_data) throw;
      refused = error.what();
    }
    if (comm.rank() == 0) {
      paths.pop_back();
      if (!paths.empty()) warn_once("scree-solver", fmt::format("{}; the run goes on from {}", refused, paths.back()));
    }
  }
}

void start_from_checkpoint(const mpi::Communicator& comm, Simulation& simulation, Checkpoint checkpoint, const Vec3& origin) {
  mpi::on_root(comm, [&] {
    if (checkpoint.origin && *checkpoint.origin != origin) {
      throw InputError(
          "{}: was computed about another origin than this version of the solver chooses; continue with the version that wrote it",
          checkpoint.path);
    }
    for (const std::unique_ptr<Effect>& effect : simulation.state().effects) {
      const EffectFormat& format = effect_kinds()[effect->kind()].format;
      if (!format.arrays.empty() && !format.is_optional && checkpoint.totals.effects[effect->kind()].empty())
        throw InputError("{}: holds no '{}', which the scene has; it is of another scene", checkpoint.path, format.name());
    }
  });
  try {
    simulation.start_from_records(checkpoint.bodies, std::move(checkpoint.states), checkpoint.step, checkpoint.step_size,
                                  checkpoint.step_limited_by, checkpoint.totals);
  } catch (const InputError& error) {  // of all ranks: a record of an effect that is not of this scene
    throw InputError("{}: {}", checkpoint.path, error.what());
  }
  const std::string hash = state_hash(simulation.state());
  mpi::on_root(comm, [&] {
    if (hash != checkpoint.state_hash) {
      throw InputError("{}: its contents do not match the hash of their state; use another checkpoint", checkpoint.path);
    }
  });
  simulation.set_axes_of_springs();
}

}  // namespace scree
