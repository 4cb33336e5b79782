#include "solver/pairs/deep_contacts.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <vector>

#include "core/base/units.hpp"
#include "solver/scene/solver_scene.hpp"

namespace scree {

/// Among equals the lower key wins, and the earlier step: the name does not depend on ranks.
bool DeepTotals::is_less_deep_than(const DeepTotals& other) const {
  if (step < 0 || other.excess != excess) return step < 0 || other.excess > excess;
  return other.key < key || (other.key == key && other.step < step);
}

void DeepTotals::add(const DeepContact& contact, std::int64_t at_step) {
  DeepTotals one;
  one.contacts = contact.begins ? 1 : 0;
  one.contact_steps = 1;
  one.first_step = one.last_step = one.step = at_step;
  one.overlap = contact.overlap;
  one.excess = contact.excess;
  one.key = contact.key;
  one.place = contact.place;
  add(one);
}

void DeepTotals::add(const DeepTotals& other) {
  if (other.contact_steps == 0) return;
  contacts += other.contacts;
  contact_steps += other.contact_steps;
  first_step = first_step < 0 ? other.first_step : std::min(first_step, other.first_step);
  last_step = std::max(last_step, other.last_step);
  if (!is_less_deep_than(other)) return;
  overlap = other.overlap;
  excess = other.excess;
  key = other.key;
  step = other.step;
  place = other.place;
}

DeepTotals over_ranks(MPI_Comm comm, const DeepTotals& totals) {
  int ranks = 1;
  MPI_Comm_size(comm, &ranks);
  std::vector<DeepTotals> of_ranks(static_cast<std::size_t>(ranks));
  MPI_Allgather(&totals, sizeof totals, MPI_BYTE, of_ranks.data(), sizeof totals, MPI_BYTE, comm);
  DeepTotals all;
  for (const DeepTotals& t : of_ranks) all.add(t);
  return all;
}

std::string name_of_pair(const SolverScene& scene, const PairKey& key) {
  if (key.zone < 0) return fmt::format("bodies {} and {}", key.a, key.b);
  const auto wall = static_cast<std::size_t>(scene.zones()[static_cast<std::size_t>(key.zone)].wall);
  return fmt::format("body {} and wall {} ('{}')", key.a, key.b, scene.source().walls[wall].name);
}

std::string text_of(const SolverScene& scene, const DeepTotals& t, double step_size) {
  const auto time = [&](std::int64_t step) { return format_quantity(static_cast<double>(step) * step_size, Dimension::time); };
  return fmt::format(
      "{} contact{} went deeper than the law has room for (on_overlap = \"continue\"), for {} contact-steps from {} to {}; the deepest are "
      "{} at {}, {} deep, {} too deep. Bodies lie in each other or in walls there: what presses them is doubtful",
      t.contacts, t.contacts == 1 ? "" : "s", t.contact_steps, time(t.first_step), time(t.last_step), name_of_pair(scene, t.key),
      time(t.step), format_quantity(t.overlap, Dimension::length), format_quantity(t.excess, Dimension::length));
}

}  // namespace scree
