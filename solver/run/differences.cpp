#include "solver/run/differences.hpp"

#include <algorithm>
#include <cstring>
#include <span>

#include "core/storage/collective_file.hpp"
#include "core/storage/frame_file.hpp"
#include "solver/run/make_frame.hpp"

namespace scree {

namespace {

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

/// Notes the first field of a body that differs, if any.
class NotedBody {
 public:
  NotedBody(std::int64_t id, Differences& differences) : id_(id), differences_(differences) {}
  template <class T>
  void compare(const char* name, const T& recorded, const T& found) {
    if (is_noted_ || same_bits(recorded, found)) return;
    differences_.add(id_, fmt::format("body {}, {}: recorded {}, found {}", id_, name, text_of(recorded), text_of(found)));
    is_noted_ = true;
  }

 private:
  std::int64_t id_;
  Differences& differences_;
  bool is_noted_ = false;
};

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

}  // namespace

Differences compare_with_frame(const mpi::Communicator& comm, const SolverScene& scene, const Checkpoint& now, const Vec3& origin,
                               const std::string& path) {
  Differences differences;
  FrameBodies recorded, found;
  mpi::on_all(comm, [&] { recorded = read_frame_file(path).bodies; });
  std::vector<std::size_t> mine;
  for (std::size_t i = 0; i < recorded.size(); ++i) {
    if (in_share(comm, recorded.id[i])) mine.push_back(i);
  }
  take_rows(recorded, mine);
  for (const ParticleRecord& body : now.bodies) add_frame_body(scene, body, comm.rank(), origin, found);
  match_bodies(recorded.id, found.id, differences, [&](std::size_t i, std::size_t j) {
    NotedBody noted(found.id[j], differences);
    FrameBodies::visit([&](const auto& c) {
      if ((c.uses & kOfThisRun) == 0) noted.compare(c.name, (recorded.*c.column)[i], (found.*c.column)[j]);
    });
  });
  return differences;
}

Differences compare_with_checkpoint(const Checkpoint& now, const Checkpoint& recorded) {
  Differences differences;
  match_bodies(ids_of(recorded.bodies), ids_of(now.bodies), differences, [&](std::size_t i, std::size_t j) {
    const ParticleRecord &a = recorded.bodies[i], &b = now.bodies[j];
    NotedBody noted(b.id, differences);
    for_each_body_column([&](const auto& c) {
      if ((c.uses & kMeasured) == 0) noted.compare(c.dataset, a.*c.field, b.*c.field);
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

}  // namespace scree
