#include "solver/run/verify.hpp"

#include <omp.h>

#include <algorithm>
#include <climits>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <map>
#include <sstream>

#include "core/storage/collective_file.hpp"
#include "core/storage/frame_file.hpp"
#include "solver/run/checkpoint.hpp"
#include "solver/run/run_folder.hpp"
#include "solver/run/run_log.hpp"
#include "solver/run/watchdog.hpp"

namespace scree {

namespace {

/// What a run recorded of one step.
struct Record {
  std::string hash, frame, checkpoint;  ///< of the log; paths
};
using Records = std::map<std::int64_t, Record>;

/// The hashes of a log by step.
void read_log(const std::string& path, Records& records) {
  const TableRows log = read_table(path);
  if (log.names.empty()) throw InputError("{}: cannot be read; name the folder of a run", path);
  const std::size_t column = log.column("state_hash");
  if (column == log.names.size()) throw InputError("{}: has no column state_hash; it is damaged or of another kind", path);
  for (std::size_t row = 0; row < log.rows.size(); ++row) records[log.step(row)].hash = log.rows[row][column];
}

/// Rank 0's records on every rank.
void broadcast(const mpi::Communicator& comm, Records& records) {
  std::string text;
  for (const auto& [step, r] : records) text += fmt::format("{}\n{}\n{}\n{}\n", step, r.hash, r.frame, r.checkpoint);
  std::istringstream lines(broadcast_text(comm.get(), text));
  records.clear();
  for (std::string step; std::getline(lines, step);) {
    Record& r = records[std::stoll(step)];
    std::getline(lines, r.hash);
    std::getline(lines, r.frame);
    std::getline(lines, r.checkpoint);
  }
}

/// The first body of this rank's share that differs, and how many do.
struct Differences {
  std::int64_t count = 0, id = INT64_MAX;
  std::string text;
  void add(std::int64_t body, const std::string& what) {
    ++count;
    if (body < id) {
      id = body;
      text = what;
    }
  }
};

template <class T>
bool same_bits(const T& a, const T& b) {
  return std::memcmp(&a, &b, sizeof a) == 0;
}

std::span<const double> numbers(const Vec3& v) { return {&v.x, 3}; }
std::span<const double> numbers(const Quat& q) { return {&q.w, 4}; }
std::span<const double> numbers(const double& d) { return {&d, 1}; }

std::string text_of(std::span<const double> values) {
  std::string text;
  for (const double v : values) text += fmt::format("{}{:.17g}", text.empty() ? "" : " ", v);
  return text;
}
template <class T>
std::string text_of(const T& value) {
  if constexpr (std::is_integral_v<T>)
    return fmt::format("{}", value);
  else
    return text_of(numbers(value));
}

/// Notes the first field that differs, if any. Fields come as (name, recorded, found).
template <class... Fields>
void compare_fields(std::int64_t body, Differences& differences, const Fields&... fields) {
  bool told = false;
  const auto compare = [&](const char* name, std::span<const double> recorded, std::span<const double> found) {
    if (told || std::equal(recorded.begin(), recorded.end(), found.begin(), same_bits<double>)) return;
    differences.add(body, fmt::format("body {}, {}: recorded {}, found {}", body, name, text_of(recorded), text_of(found)));
    told = true;
  };
  (std::apply(compare, fields), ...);
}

template <class T>
auto field(const char* name, const T& recorded, const T& found) {
  return std::make_tuple(name, numbers(recorded), numbers(found));
}

/// Calls compare(i, j) for rows of the same id, and notes bodies that only one side has. Both are in ascending order.
template <class Compare>
void match_bodies(const std::vector<std::int64_t>& recorded, const std::vector<std::int64_t>& found, Differences& differences,
                  Compare&& compare) {
  std::size_t i = 0, j = 0;
  while (i < recorded.size() || j < found.size()) {
    if (j == found.size() || (i < recorded.size() && recorded[i] < found[j])) {
      differences.add(recorded[i], fmt::format("body {}: recorded, not found", recorded[i]));
      ++i;
    } else if (i == recorded.size() || found[j] < recorded[i]) {
      differences.add(found[j], fmt::format("body {}: found, not recorded", found[j]));
      ++j;
    } else {
      compare(i++, j++);
    }
  }
}

std::vector<std::int64_t> ids_of(const std::vector<ParticleRecord>& bodies) {
  std::vector<std::int64_t> ids;
  for (const ParticleRecord& r : bodies) ids.push_back(r.id);
  return ids;
}

/// Frames are written in the world, the present state lies about the origin that it is computed with: moved as the writer moves it, bits
/// agree.
Differences compare_with_frame(const mpi::Communicator& comm, const Simulation& simulation, const Checkpoint& now, const Vec3& origin,
                               const std::string& path) {
  Differences differences;
  FrameBodies recorded;
  mpi::on_all(comm, [&] { recorded = read_frame_file(path).bodies; });
  std::vector<std::int64_t> ids;
  std::vector<std::size_t> rows;
  for (std::size_t i = 0; i < recorded.size(); ++i) {
    if (!in_share(comm, recorded.id[i])) continue;
    ids.push_back(recorded.id[i]);
    rows.push_back(i);
  }
  match_bodies(ids, ids_of(now.bodies), differences, [&](std::size_t i, std::size_t j) {
    const std::size_t row = rows[i];
    const ParticleRecord& r = now.bodies[j];
    const Quat orientation = mesh_orientation(simulation.scene(), r.shape, r.q);
    const Vec3 position = r.x + origin;
    compare_fields(r.id, differences, field("position", recorded.position[row], position),
                   field("orientation", recorded.orientation[row], orientation), field("velocity", recorded.velocity[row], r.v),
                   field("angular velocity", recorded.angular_velocity[row], r.w));
  });
  return differences;
}

Differences compare_with_checkpoint(const Checkpoint& now, const Checkpoint& recorded) {
  Differences differences;
  match_bodies(ids_of(recorded.bodies), ids_of(now.bodies), differences, [&](std::size_t i, std::size_t j) {
    const ParticleRecord &a = recorded.bodies[i], &b = now.bodies[j];
    bool told = false;
    for_each_body_column([&](const auto& c) {
      if (told || (c.uses & kMeasured) || same_bits(a.*c.field, b.*c.field)) return;
      told = true;
      differences.add(b.id, fmt::format("body {}, {}: recorded {}, found {}", b.id, c.dataset, text_of(a.*c.field), text_of(b.*c.field)));
    });
  });
  // state in the order of its pairs; the first that differs is that of the lower body
  const std::size_t pairs = std::max(recorded.states.size(), now.states.size());
  for (std::size_t k = 0; k < pairs; ++k) {
    const bool both = k < recorded.states.size() && k < now.states.size() && recorded.states[k].key == now.states[k].key;
    const WaitingState& known = k < recorded.states.size() ? recorded.states[k] : now.states[k];
    std::string different;
    for_each_kind_of_two(known.state, both ? now.states[k].state : PairState{}, [&](const auto& a, const auto& b) {
      using Kind = KindOf<decltype(a)>;
      bool equal = both && a.size() == b.size();
      for (std::size_t r = 0; equal && r < a.size(); ++r) {
        Kind::visit([&](const char*, const char*, auto field) { equal = equal && same_bits(a[r].*field, b[r].*field); });
      }
      if (!equal && different.empty()) different = Kind::kName;
    });
    if (different.empty()) continue;
    differences.add(known.key.a, fmt::format("body {}, {} with {}", known.key.a, different, known.key.b));
    break;
  }
  return differences;
}

/// The whole picture on every rank: "17 bodies differ, the first is body 3, position: ...", or "".
std::string sum_up(const mpi::Communicator& comm, const Differences& mine) {
  const std::int64_t count = comm.sum(mine.count);
  if (count == 0) return "";
  std::int64_t lowest = mine.id;
  MPI_Allreduce(MPI_IN_PLACE, &lowest, 1, MPI_INT64_T, MPI_MIN, comm.get());
  const std::vector<char> text(mine.text.begin(), mine.text.end());
  std::vector<std::vector<char>> outgoing(static_cast<std::size_t>(comm.size()));
  if (mine.count > 0 && mine.id == lowest) outgoing[0] = text;
  std::string first;
  for (const auto& block : comm.exchange(outgoing)) {
    if (first.empty()) first.assign(block.begin(), block.end());
  }
  return fmt::format("{} difference{}; {}", count, count == 1 ? "" : "s, first", broadcast_text(comm.get(), first));
}

}  // namespace

Verdict verify_run(const mpi::Communicator& comm, const VerifyOptions& options) {
  // 1. what was recorded, and where to begin
  const LoadedScene loaded = load_scene(comm, options.run_folder + "/scene.h5");
  Records records;
  std::string from = options.from;
  mpi::on_root(comm, [&] {
    read_log(options.run_folder + "/log.csv", records);
    const std::vector<std::string> checkpoints = list_checkpoints(options.run_folder);
    if (from.empty()) from = checkpoints.size() > 1 ? checkpoints[checkpoints.size() - 2] : "start";
    for (const std::string& path : checkpoints) {
      records[*checkpoint_step_of(std::filesystem::path(path).filename().string())].checkpoint = path;
    }
  });
  from = broadcast_text(comm.get(), from);
  Watchdog watchdog(comm, options.stall_limit, options.stalled);
  Simulation simulation(comm, *loaded.prepared, options.parallel);
  if (from == "start") {
    simulation.start_from_scene();
  } else {
    Checkpoint checkpoint = read_checkpoint(comm, from);
    mpi::on_root(comm, [&] {
      if (checkpoint.scene_sha256 != loaded.sha256)
        throw InputError("{}: was made from another scene than {}/scene.h5", from, options.run_folder);
    });
    start_from_checkpoint(comm, simulation, std::move(checkpoint), loaded.origin);
  }
  const std::int64_t first = simulation.step();
  std::int64_t last = first + options.steps;
  mpi::on_root(comm, [&] {
    for (const FrameEntry& frame : list_frames(options.run_folder)) {
      records[std::llround(frame.time / simulation.step_size().step)].frame = frame.path;
    }
    std::erase_if(records, [&](const auto& entry) { return entry.first < first || (entry.first == first && from != "start"); });
    if (options.steps == 0) {
      last = first;
      for (const auto& [step, record] : records) {
        if (!record.checkpoint.empty() || from == "start") last = step;
      }
    }
    if (records.empty() || records.begin()->first > last) {
      throw UsageError("{}: nothing is recorded from step {} to {}; {}", options.run_folder, first + 1, last,
                       records.empty() ? "begin earlier, with --from start"
                                       : fmt::format("the next record is at step {}: use --steps {}", records.begin()->first,
                                                     records.begin()->first - first));
    }
    std::erase_if(records, [&](const auto& entry) { return entry.first > last; });
  });
  broadcast(comm, records);
  last = records.rbegin()->first;

  // 2. the same steps again
  std::int64_t hashes = 0, frames = 0, checkpoints = 0, equal_until = first, differs_at = -1;
  for (const auto& [step, record] : records) {
    while (simulation.step() < step) {
      simulation.advance();
      watchdog.progress(simulation.step());
    }
    simulation.agree_on_failures();
    const Checkpoint now = present_state(comm, simulation);
    std::string where;
    if (!record.checkpoint.empty()) {
      const Checkpoint recorded = read_checkpoint(comm, record.checkpoint);
      where = sum_up(comm, compare_with_checkpoint(now, recorded));
      if (where.empty() && words_of(recorded.totals) != words_of(now.totals)) where = "the accumulated work and impulse of walls differ";
      if (where.empty() && recorded.state_hash != now.state_hash) where = "the hash that the checkpoint tells differs";
      ++checkpoints;
    }
    if (!record.frame.empty()) {
      const std::string in_frame = sum_up(comm, compare_with_frame(comm, simulation, now, loaded.origin, record.frame));
      if (where.empty() && !in_frame.empty()) where = fmt::format("{} (in its frame)", in_frame);
      ++frames;
    }
    const bool hash_differs = !record.hash.empty() && record.hash != now.state_hash;
    if (!record.hash.empty()) ++hashes;
    if (differs_at < 0 && (hash_differs || !where.empty())) differs_at = step;
    if (differs_at < 0) {
      equal_until = step;
      continue;
    }
    if (where.empty() && (record.frame.empty() && record.checkpoint.empty())) continue;  // go on to a state that names bodies
    return {false, fmt::format("not the same: equal until step {}, different at step {}. At step {}: {}", equal_until, differs_at, step,
                               where.empty() ? "bodies are the same, the state of pairs differs" : where)};
  }
  if (differs_at >= 0) {
    return {false, fmt::format("not the same: equal until step {}, different at step {} by the hash of the log; no frame or checkpoint "
                               "up to step {} tells the body, use a larger --steps",
                               equal_until, differs_at, last)};
  }
  return {true,
          fmt::format(
              "the same, bit for bit: steps {} to {} on {} ranks x {} threads; {} hashes of the log, {} frames, {} checkpoints compared",
              first, last, comm.size(), omp_get_max_threads(), hashes, frames, checkpoints)};
}

}  // namespace scree
