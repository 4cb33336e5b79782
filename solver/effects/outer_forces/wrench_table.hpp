// Wrenches by the ids of bodies: what ranks tell each other of them, and how they lie in a checkpoint.
#pragma once

#include <cstdint>
#include <unordered_map>
#include <vector>

#include "solver/state/effect_record.hpp"
#include "solver/state/run_state.hpp"

namespace scree {

/// Force [N], and torque about the centre of mass [N m], world.
struct Wrench {
  Vec3 force, torque;
  bool operator==(const Wrench&) const = default;
};
struct WrenchOnBody {
  std::int64_t id;
  Wrench wrench;
};
/// By ascending id, each once.
using WrenchTable = std::vector<WrenchOnBody>;
using WrenchById = std::unordered_map<std::int64_t, Wrench>;

inline bool is_zero(const Wrench& w) { return w == Wrench{}; }
inline Wrench operator-(const Wrench& a, const Wrench& b) { return {a.force - b.force, a.torque - b.torque}; }

inline bool has_lower_id(const WrenchOnBody& l, const WrenchOnBody& r) { return l.id < r.id; }
/// A table of what lies by id in any order.
WrenchTable table_of(const WrenchById& of);

/// The owned rows by ascending id.
std::vector<std::int32_t> rows_by_id(const ParticleSet& p);

/// Calls action(entry, row) for each entry of a list by ascending id; row -1 of one that is not owned here.
/// in   by_id   rows_by_id()
template <class Action>
void join_rows(const ParticleSet& p, const std::vector<WrenchOnBody>& list, const std::vector<std::int32_t>& by_id, const Action& action) {
  auto next = by_id.begin();
  for (const WrenchOnBody& entry : list) {
    while (next != by_id.end() && p.id[static_cast<std::size_t>(*next)] < entry.id) ++next;
    const bool is_here = next != by_id.end() && p.id[static_cast<std::size_t>(*next)] == entry.id;
    action(entry, is_here ? *next : -1);
  }
}

/// What all ranks give, by ascending id, on every rank. Collective.
std::vector<WrenchOnBody> of_all_ranks(const RunState& s, const std::vector<WrenchOnBody>& mine);

/// The owned row of each that all ranks named (of_all_ranks()), -1 of others.
/// Throws UsageError on every rank for a body that is unknown, named twice or fixed, and for numbers that are not finite. Collective.
std::vector<std::int32_t> checked_rows(const RunState& s, const std::vector<WrenchOnBody>& all, const std::vector<std::int32_t>& by_id);

/// What a rank holds of bodies that it does not own any more goes to their owners; what nobody owns has left the run. Collective.
/// Cost: where bodies changed their rank, 56 B for each of them to every rank.
void travel(const RunState& s, WrenchTable& of, const std::vector<std::int32_t>& by_id);
void travel(const RunState& s, WrenchById& of, const std::vector<std::int32_t>& by_id);

// Ids, and six numbers for each, as a checkpoint holds them.
inline constexpr std::int64_t kNumbersOfWrench = 6;
StateArray ids_of(const std::vector<WrenchOnBody>& rows);
StateArray numbers_of(const std::vector<WrenchOnBody>& rows);
/// Throws InputError where they do not belong together.
WrenchTable wrenches_of(const StateArray& ids, const StateArray& numbers);

}  // namespace scree
