#include "core/search/multilevel_grid.hpp"

#include <algorithm>

#include "core/base/error.hpp"

namespace scree {

void MultilevelGrid::build(std::span<const Vec3> centres, std::span<const double> radii) {
  SCREE_ASSERT(centres.size() == radii.size(), "{} centres, {} radii", centres.size(), radii.size());
  const std::size_t count = centres.size();
  centres_.assign(centres.begin(), centres.end());
  radii_.assign(radii.begin(), radii.end());
  level_.resize(count);
  order_.resize(count);
  level_count_ = 0;
  level_size_.clear();
  table_.assign(2, Cell{});
  mask_ = 1;
  if (count == 0) return;

  double smallest = radii_[0];
  for (double r : radii_) smallest = std::min(smallest, r);
  SCREE_ASSERT(smallest > 0 && std::isfinite(smallest), "smallest radius {}", smallest);
  // Level l holds radii in [smallest 2^l, smallest 2^(l+1)): its cells are 2 smallest 2^(l+1) wide.
  smallest_cell_ = 4 * smallest;
  for (std::size_t i = 0; i < count; ++i) {
    SCREE_ASSERT(std::isfinite(radii_[i]) && is_finite(centres_[i]), "ball {}", i);
    const int level = std::max(0, std::ilogb(radii_[i] / smallest));
    level_[i] = level;
    if (level >= level_count_) {
      level_count_ = level + 1;
      level_size_.resize(static_cast<std::size_t>(level_count_), 0);
    }
    ++level_size_[static_cast<std::size_t>(level)];
  }

  // count the balls of each cell, then lay the cells out one after another
  std::size_t slots = 2;
  while (slots < 2 * count) slots *= 2;
  table_.assign(slots, Cell{});
  mask_ = slots - 1;
  std::vector<std::int32_t> slot_of(count);
  for (std::size_t i = 0; i < count; ++i) {
    const std::array<std::int64_t, 3> position = cell_of(centres_[i], level_[i]);
    std::uint64_t slot = hash(level_[i], position) & mask_;
    while (table_[slot].level >= 0 && !(table_[slot].level == level_[i] && table_[slot].position == position)) {
      slot = (slot + 1) & mask_;
    }
    table_[slot].level = level_[i];
    table_[slot].position = position;
    ++table_[slot].count;
    slot_of[i] = static_cast<std::int32_t>(slot);
  }
  std::int32_t next = 0;
  for (Cell& cell : table_) {
    if (cell.level < 0) continue;
    cell.first = next;
    next += cell.count;
    cell.count = 0;
  }
  for (std::size_t i = 0; i < count; ++i) {
    Cell& cell = table_[static_cast<std::size_t>(slot_of[i])];
    order_[static_cast<std::size_t>(cell.first + cell.count++)] = static_cast<std::int32_t>(i);
  }
}

}  // namespace scree
