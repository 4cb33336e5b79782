// Broad phase: which balls come close, at a cost per ball that does not depend on how many there are and
// hardly on how different their sizes are.
//
// Levels by radius, cell ratio 2. A ball is inserted once, at its own level, whose cells are at least as wide
// as its diameter, and searches its own and all coarser levels: 27 cells in each. Cells are hashed, so the
// domain has no bounds and coordinates may be negative.
// Source: Ogarko & Luding, Comput. Phys. Commun. 183 (2012) 931; Krijgsman, Ogarko & Luding, CPM 1 (2014) 357.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <span>
#include <vector>

#include "core/geometry/vec3.hpp"

namespace scree {

class MultilevelGrid {
 public:
  /// in   centres   N x 3 [m]
  /// in   radii     N [m], > 0: reach of each ball, margins and skin included
  /// Cost: O(N log N) for the sort by cell.   Memory: about 40 bytes a ball, kept between builds.
  void build(std::span<const Vec3> centres, std::span<const double> radii);

  /// Calls visit(j) for every ball j that touches ball i and is of a coarser level, or of the same level with
  /// j > i: every touching pair is visited exactly once over all i.   Threads: const, safe.
  template <class Visit>
  void for_each_partner(std::int32_t i, Visit&& visit) const {
    const auto index = static_cast<std::size_t>(i);
    for (int level = level_[index]; level < level_count_; ++level) {
      if (level_size_[static_cast<std::size_t>(level)] == 0) continue;
      const std::array<std::int64_t, 3> home = cell_of(centres_[index], level);
      for (std::int64_t x = home[0] - 1; x <= home[0] + 1; ++x) {
        for (std::int64_t y = home[1] - 1; y <= home[1] + 1; ++y) {
          for (std::int64_t z = home[2] - 1; z <= home[2] + 1; ++z) {
            const Cell* cell = find_cell(level, {x, y, z});
            if (cell == nullptr) continue;
            for (std::int32_t k = cell->first; k < cell->first + cell->count; ++k) {
              const std::int32_t j = order_[static_cast<std::size_t>(k)];
              if (level == level_[index] && j <= i) continue;
              const double reach = radii_[index] + radii_[static_cast<std::size_t>(j)];
              if (squared_length(centres_[index] - centres_[static_cast<std::size_t>(j)]) < reach * reach) visit(j);
            }
          }
        }
      }
    }
  }

  /// Calls visit(j) for every inserted ball that touches the given ball.
  template <class Visit>
  void for_each_touching(const Vec3& centre, double radius, Visit&& visit) const {
    for (int level = 0; level < level_count_; ++level) {
      if (level_size_[static_cast<std::size_t>(level)] == 0) continue;
      const double reach = radius + 0.5 * cell_size(level);
      const std::array<std::int64_t, 3> low = cell_of(centre - Vec3{reach, reach, reach}, level);
      const std::array<std::int64_t, 3> high = cell_of(centre + Vec3{reach, reach, reach}, level);
      for (std::int64_t x = low[0]; x <= high[0]; ++x) {
        for (std::int64_t y = low[1]; y <= high[1]; ++y) {
          for (std::int64_t z = low[2]; z <= high[2]; ++z) {
            const Cell* cell = find_cell(level, {x, y, z});
            if (cell == nullptr) continue;
            for (std::int32_t k = cell->first; k < cell->first + cell->count; ++k) {
              const std::int32_t j = order_[static_cast<std::size_t>(k)];
              const double sum = radius + radii_[static_cast<std::size_t>(j)];
              if (squared_length(centre - centres_[static_cast<std::size_t>(j)]) < sum * sum) visit(j);
            }
          }
        }
      }
    }
  }

  int level_count() const { return level_count_; }

 private:
  struct Cell {
    std::array<std::int64_t, 3> position;
    std::int32_t level = -1;   // -1: empty slot
    std::int32_t first = 0, count = 0;
  };

  double cell_size(int level) const { return std::ldexp(smallest_cell_, level); }
  std::array<std::int64_t, 3> cell_of(const Vec3& p, int level) const {
    const double inverse = 1.0 / cell_size(level);
    return {static_cast<std::int64_t>(std::floor(p.x * inverse)), static_cast<std::int64_t>(std::floor(p.y * inverse)),
            static_cast<std::int64_t>(std::floor(p.z * inverse))};
  }
  static std::uint64_t hash(int level, const std::array<std::int64_t, 3>& c);
  const Cell* find_cell(int level, const std::array<std::int64_t, 3>& c) const {
    for (std::uint64_t slot = hash(level, c) & mask_;; slot = (slot + 1) & mask_) {
      const Cell& cell = table_[static_cast<std::size_t>(slot)];
      if (cell.level < 0) return nullptr;
      if (cell.level == level && cell.position == c) return &cell;
    }
  }

  std::vector<Vec3> centres_;
  std::vector<double> radii_;
  std::vector<std::int32_t> level_;
  std::vector<std::int32_t> order_;        // balls, cell by cell
  std::vector<std::int64_t> level_size_;
  std::vector<Cell> table_;                // open addressing, a power of two, at most half full
  std::uint64_t mask_ = 0;
  double smallest_cell_ = 1;
  int level_count_ = 0;
};

inline std::uint64_t MultilevelGrid::hash(int level, const std::array<std::int64_t, 3>& c) {
  std::uint64_t h = static_cast<std::uint64_t>(level) * 0x9E3779B97F4A7C15ull;
  for (std::int64_t v : c) {
    h ^= static_cast<std::uint64_t>(v);
    h *= 0xBF58476D1CE4E5B9ull;
    h ^= h >> 29;
  }
  return h ^ (h >> 32);
}

}  // namespace scree
