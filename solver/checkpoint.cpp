#include "solver/checkpoint.hpp"

#include <algorithm>
#include <filesystem>

#include "core/storage/h5.hpp"

namespace scree {

namespace {

struct SpringRow {
  PairKey key;
  FrictionSpring spring;
};

/// Everything of one kind on rank 0.
template <class T>
std::vector<T> gather_on_root(const mpi::Communicator& comm, std::vector<T> mine) {
  std::vector<std::vector<T>> outgoing(static_cast<std::size_t>(comm.size()));
  outgoing[0] = std::move(mine);
  std::vector<T> all;
  for (auto& block : comm.exchange(outgoing)) all.insert(all.end(), block.begin(), block.end());
  return all;
}

std::vector<std::string> list_checkpoints(const std::string& folder) {
  std::vector<std::string> names;
  std::error_code error;
  for (const auto& entry : std::filesystem::directory_iterator(folder, error)) {
    const std::string name = entry.path().filename().string();
    if (name.starts_with("checkpoint_") && name.ends_with(".h5")) names.push_back(entry.path().string());
  }
  std::sort(names.begin(), names.end());  // zero-padded steps sort as numbers
  return names;
}

}  // namespace

std::string latest_checkpoint(const std::string& folder) {
  const std::vector<std::string> names = list_checkpoints(folder);
  return names.empty() ? "" : names.back();
}

void write_checkpoint(const mpi::Communicator& comm, const Simulation& simulation, const std::string& folder,
                      const Checkpoint& so_far, const nlohmann::json& provenance) {
  const ParticleSet& p = simulation.particles();
  std::vector<ParticleRecord> mine;
  for (std::size_t i = 0; i < p.owned; ++i) mine.push_back(record_of(p, i));
  std::vector<SpringRow> my_springs;
  for (const BodyPair& pair : simulation.pairs().pairs()) {
    if (!counts_here(pair, p)) continue;
    for (const FrictionSpring& s : pair.springs) my_springs.push_back({pair.key, s});
  }
  std::vector<ParticleRecord> bodies = gather_on_root(comm, std::move(mine));
  std::vector<SpringRow> springs = gather_on_root(comm, std::move(my_springs));
  const Energies energies = simulation.energies();
  const std::vector<WallLoad> loads = simulation.wall_loads();
  const std::string hash = simulation.state_hash();
  const double wall_dissipated = simulation.wall_dissipated();

  mpi::on_root(comm, [&] {
    std::sort(bodies.begin(), bodies.end(), [](const auto& l, const auto& r) { return l.id < r.id; });
    std::sort(springs.begin(), springs.end(), [](const SpringRow& l, const SpringRow& r) {
      return l.key != r.key ? l.key < r.key : l.spring.key < r.spring.key;
    });
    h5::NewFile file(fmt::format("{}/checkpoint_{:012}.h5", folder, simulation.step()));
    const h5::Group& root = file.root();
    root.write_attribute("format", kCheckpointFormat);
    root.write_attribute("format_version", kCheckpointFormatVersion);
    root.write_attribute("step", simulation.step());
    root.write_attribute("step_size", simulation.step_size().step);
    root.write_attribute("wall_work", energies.wall_work);
    root.write_attribute("wall_dissipated", wall_dissipated);
    root.write_attribute("energy_reference", so_far.energy_reference);
    root.write_attribute("kinetic_peak", so_far.kinetic_peak);
    root.write_attribute("max_depth_ratio", so_far.max_depth_ratio);
    root.write_attribute("energy_error", so_far.energy_error);
    root.write_attribute("state_hash", hash);
    root.write_attribute("scene_sha256", so_far.scene_sha256);
    root.write_text("provenance", provenance.dump());
    const h5::Group g = root.create_group("bodies");
    const auto column = [&](const char* name, const char* unit, auto&& get, std::int64_t columns = 1) {
      std::vector<std::decay_t<decltype(get(bodies[0]))>> values;
      for (const ParticleRecord& r : bodies) values.push_back(get(r));
      g.write_array(name, values, columns, unit);
    };
    const auto vectors = [&](const char* name, const char* unit, auto&& get) {
      std::vector<Vec3> values;
      for (const ParticleRecord& r : bodies) values.push_back(get(r));
      g.write_array(name, values, unit);
    };
    column("id", "", [](const ParticleRecord& r) { return r.id; });
    column("shape", "", [](const ParticleRecord& r) { return r.shape; });
    column("material", "", [](const ParticleRecord& r) { return r.material; });
    column("fixed", "", [](const ParticleRecord& r) { return r.fixed; });
    column("lock_rotation", "", [](const ParticleRecord& r) { return r.lock_rotation; });
    column("scale", "", [](const ParticleRecord& r) { return r.scale; });
    column("dissipated", "J", [](const ParticleRecord& r) { return r.dissipated; });
    column("work", "", [](const ParticleRecord& r) { return r.work; });
    vectors("x", "m", [](const ParticleRecord& r) { return r.x; });
    vectors("v", "m/s", [](const ParticleRecord& r) { return r.v; });
    vectors("L", "kg m^2/s", [](const ParticleRecord& r) { return r.L; });
    vectors("w", "rad/s", [](const ParticleRecord& r) { return r.w; });
    vectors("force", "N", [](const ParticleRecord& r) { return r.force; });
    vectors("torque", "N m", [](const ParticleRecord& r) { return r.torque; });
    std::vector<Quat> orientations;
    for (const ParticleRecord& r : bodies) orientations.push_back(r.q);
    g.write_array("q_principal", orientations, "");

    const h5::Group s = root.create_group("springs");
    std::vector<std::int64_t> a, b, zone, key;
    std::vector<Vec3> force;
    std::vector<double> stiffness;
    for (const SpringRow& row : springs) {
      a.push_back(row.key.a);
      b.push_back(row.key.b);
      zone.push_back(row.key.zone);
      key.push_back(row.spring.key);
      force.push_back(row.spring.force);
      stiffness.push_back(row.spring.stiffness);
    }
    s.write_array("a", a, 1, "");
    s.write_array("b", b, 1, "");
    s.write_array("zone", zone, 1, "");
    s.write_array("feature", key, 1, "");
    s.write_array("force", force, "N");
    s.write_array("stiffness", stiffness, 1, "N/m");
    std::vector<Vec3> impulses;
    for (const WallLoad& load : loads) impulses.push_back(load.impulse);
    root.write_array("wall_impulse", impulses, "N s");
    file.commit();
    const std::vector<std::string> all = list_checkpoints(folder);
    for (std::size_t i = 0; i + 2 < all.size(); ++i) std::filesystem::remove(all[i]);
  });
}

Checkpoint read_checkpoint(const std::string& path) {
  const h5::File file(path);
  const h5::Group& root = file.root();
  check_format(root, kCheckpointFormat, kCheckpointFormatVersion);
  Checkpoint c;
  c.step = root.read_integer_attribute("step");
  c.step_size = root.read_double_attribute("step_size");
  c.wall_work = root.read_double_attribute("wall_work");
  c.wall_dissipated = root.read_double_attribute("wall_dissipated");
  c.energy_reference = root.read_double_attribute("energy_reference");
  c.kinetic_peak = root.read_double_attribute("kinetic_peak");
  c.max_depth_ratio = root.read_double_attribute("max_depth_ratio");
  c.energy_error = root.read_double_attribute("energy_error");
  c.state_hash = root.read_text_attribute("state_hash");
  c.scene_sha256 = root.read_text_attribute("scene_sha256");
  const h5::Group g = root.open_group("bodies");
  const auto id = g.read_array<std::int64_t>("id", 1);
  const auto shape = g.read_array<std::int32_t>("shape", 1);
  const auto material = g.read_array<std::int32_t>("material", 1);
  const auto fixed = g.read_array<std::uint8_t>("fixed", 1);
  const auto lock = g.read_array<std::uint8_t>("lock_rotation", 1);
  const auto scale = g.read_array<double>("scale", 1);
  const auto dissipated = g.read_array<double>("dissipated", 1);
  const auto work = g.read_array<double>("work", 1);
  const auto x = g.read_vectors("x"), v = g.read_vectors("v"), L = g.read_vectors("L"), w = g.read_vectors("w");
  const auto force = g.read_vectors("force"), torque = g.read_vectors("torque");
  const auto q = g.read_quaternions("q_principal");
  for (const std::size_t rows : {shape.size(), material.size(), fixed.size(), lock.size(), scale.size(), dissipated.size(),
                                 work.size(), x.size(), v.size(), L.size(), w.size(), force.size(), torque.size(), q.size()}) {
    if (rows != id.size()) throw InputError("{}: a column has {} rows, {} expected; use the previous checkpoint", path, rows, id.size());
  }
  for (std::size_t i = 0; i < id.size(); ++i) {
    ParticleRecord r{};
    r.id = id[i];
    r.shape = shape[i];
    r.material = material[i];
    r.fixed = fixed[i];
    r.lock_rotation = lock[i];
    r.scale = scale[i];
    r.dissipated = dissipated[i];
    r.work = work[i];
    r.x = x[i];
    r.v = v[i];
    r.L = L[i];
    r.w = w[i];
    r.force = force[i];
    r.torque = torque[i];
    r.q = q[i];
    c.bodies.push_back(r);
  }
  const h5::Group s = root.open_group("springs");
  const auto a = s.read_array<std::int64_t>("a", 1), b = s.read_array<std::int64_t>("b", 1);
  const auto zone = s.read_array<std::int64_t>("zone", 1), feature = s.read_array<std::int64_t>("feature", 1);
  const auto spring_force = s.read_vectors("force");
  const auto stiffness = s.read_array<double>("stiffness", 1);
  for (const std::size_t rows : {b.size(), zone.size(), feature.size(), spring_force.size(), stiffness.size()}) {
    if (rows != a.size()) throw InputError("{}: the springs are incomplete; use the previous checkpoint", path);
  }
  for (std::size_t i = 0; i < a.size(); ++i) {
    const PairKey key{a[i], b[i], static_cast<std::int32_t>(zone[i])};
    if (c.springs.empty() || c.springs.back().key != key) c.springs.push_back({key, {}});
    c.springs.back().springs.push_back({feature[i], spring_force[i], stiffness[i]});
  }
  c.wall_impulse = root.read_vectors("wall_impulse");
  return c;
}

}  // namespace scree
