// Wrenches by the ids of bodies: what ranks tell each other of them, and how they lie in a checkpoint.
#pragma once

#include <cstdint>
#include <unordered_map>
#include <vector>

#include "solver/state/by_id.hpp"
#include "solver/state/effect_record.hpp"

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

/// A table of what lies by id in any order.
WrenchTable table_of(const WrenchById& of);

/// The owned row of each that all ranks named (of_all_ranks()), -1 of others.
/// Throws UsageError on every rank for a body that is unknown, named twice or fixed, and for numbers that are not finite. Collective.
std::vector<std::int32_t> checked_rows(const RunState& s, const std::vector<WrenchOnBody>& all, const std::vector<std::int32_t>& by_id);

/// As that of a table (by_id.hpp); what no rank owns has left the run. Collective.
/// Cost: where bodies changed their rank, 56 B for each of them to every rank.
void travel(const RunState& s, WrenchById& of, const std::vector<std::int32_t>& by_id);

// Ids, and six numbers for each, as a checkpoint holds them.
inline constexpr std::int64_t kNumbersOfWrench = 6;
StateArray ids_of(const std::vector<WrenchOnBody>& rows);
StateArray numbers_of(const std::vector<WrenchOnBody>& rows);
/// Throws InputError where they do not belong together.
WrenchTable wrenches_of(const StateArray& ids, const StateArray& numbers);

}  // namespace scree
