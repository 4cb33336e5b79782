// Broad phase: which balls come close, at a cost per ball that does not depend on how many there are and
// hardly on how different their sizes are. Some axes may be periodic.
//
// Levels by radius, cell ratio 2. A ball is inserted once, at its own level, and searches its own and all coarser
// levels. Cells are hashed, so the domain has no bounds and coordinates may be negative.
// Source: Ogarko & Luding, Comput. Phys. Commun. 183 (2012) 931; Krijgsman, Ogarko & Luding, CPM 1 (2014) 357.
//
// Departures from the source. Cells are twice as wide as the largest diameter of their level, so that 8 of them, those
// around the corner nearest to a ball's centre, hold all that it can touch: hash look-ups and mispredicted branches
// cost more than distance tests. The hash keeps a block of 2 x 2 x 2 cells on one cache line. Cells are anchored at the
// largest radius, so that balls of one size fit them. Balls are sorted along a Z-order curve of the cells, so that balls
// which meet lie close in memory, whatever order they came in. Where sizes differ much, most levels hold nothing near a
// given ball: a bitmap, two bytes a cell, tells so for one look-up instead of eight.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <span>
#include <type_traits>
#include <vector>

#include "core/geometry/vec3.hpp"

namespace scree {

/// Image of a ball: it stands at its centre + (image[0] * period.x, image[1] * period.y, image[2] * period.z).
using PeriodicImage = std::array<std::int32_t, 3>;

class MultilevelGrid {
 public:
  /// in   centres   N x 3 [m]; on a periodic axis any coordinate, wrapped or not
  /// in   radii     N [m], > 0: reach of each ball, margins and skin included
  /// in   period    length of each periodic axis [m]; 0: the axis is not periodic
  /// Fails: throws InputError when a ball's diameter exceeds half of a period: it could touch another ball, or
  /// itself, in two images at once; and when a centre lies 2^40 widths of the largest ball, or 2^30 periods, from
  /// the origin.
  /// Cost: O(N), about 60 ns a ball.   Memory: 75 bytes a ball, 64 to 96 a cell that holds balls, kept between builds.
  void build(std::span<const Vec3> centres, std::span<const double> radii, const Vec3& period = {});

  /// Calls visit(j, image), or visit(j), for balls j that touch ball i in that image: over all i every touching
  /// pair is visited exactly once, from the smaller ball or, between balls of one level, from either. image is
  /// relative to the centres as given; all zero when nothing is periodic.
  /// Cost: 200 to 400 ns for balls of one size; least when i runs through order(), since then neighbours are in cache.
  /// Threads: const, safe.
  template <class Visit>
  void for_each_partner(std::int32_t i, Visit&& visit) const {
    for_each_partner_at(place_[static_cast<std::size_t>(i)], visit);
  }
  /// The same for ball order()[place]: cheapest, with place from 0 to N - 1.
  template <class Visit>
  void for_each_partner_at(std::int32_t place, Visit&& visit) const {
    if (is_periodic_) {
      search_partners<true>(place, visit);
    } else {
      search_partners<false>(place, visit);
    }
  }

  /// Calls visit(j, image), or visit(j), for every inserted ball that touches the given one (image of j). On a
  /// periodic grid its diameter is limited as in build.
  template <class Visit>
  void for_each_touching(const Vec3& centre, double radius, Visit&& visit) const {
    check_period(radius);
    if (is_periodic_) {
      search_touching<true>(centre, radius, visit);
    } else {
      search_touching<false>(centre, radius, visit);
    }
  }

  /// All balls, neighbours next to one another: the order in which to ask for partners, or to store bodies.
  std::span<const std::int32_t> order() const { return order_; }

  int level_count() const { return static_cast<int>(levels_.size()); }

  /// Bytes held at present, capacity of the vectors included.
  std::size_t memory() const;

 private:
  using Cell = std::array<std::int64_t, 3>;

  struct Ball {
    Vec3 centre;  // wrapped into [0, period) on periodic axes
    double radius;
  };
  struct Level {
    int depth = 0;                                    // cells are the coarsest ones divided by 2^depth
    double largest_radius = 0, cell_halves = 0;       // width of a cell in half cells of the finest depth
    std::int32_t begin = 0, end = 0, cell_count = 0;  // its balls, and how many cells hold them
  };
  struct Slot {
    std::uint64_t tag = 0;            // hash of the cell
    std::int32_t begin = 0, end = 0;  // of balls_; end 0: empty
  };
  struct alignas(64) SlotLine {
    std::array<Slot, 4> slot;
  };
  /// The two cells of an axis that a ball can touch something in, and the images they are taken in.
  struct Neighbours {
    std::array<std::int64_t, 2> cell;
    std::array<std::int32_t, 2> image = {0, 0};
  };

  static constexpr PeriodicImage kHome = {0, 0, 0};
  /// Deeper levels than this join it; it has to fit the sort key.
  static constexpr int kDeepest = 100;
  /// Cells are wider than the diameters they hold by this part, so that two balls that touch never lie two cells apart by
  /// the rounding of their cells: that is below 2^-12 cells up to kFarthestCell.
  static constexpr double kCellSlack = 0x1p-10;

  void check_period(double largest_radius) const;
  void sort_balls();
  void lay_out_cells(std::span<const Vec3> centres, std::span<const double> radii);
  std::int64_t cell_count(int axis, int depth) const { return cell_count_[static_cast<std::size_t>(axis)] << depth; }

  /// Wraps a point into [0, period); turns is how many periods it lay above.
  Vec3 wrap(Vec3 p, PeriodicImage& turns) const;

  static std::int64_t floor_of(double x) {
    const auto i = static_cast<std::int64_t>(x);
    return i - (x < static_cast<double>(i) ? 1 : 0);
  }
  /// Half cells of a wrapped point at the finest depth, not wrapped themselves. At depth d: shifted by depth_ - d.
  Cell finest_halves(const Vec3& p) const {
    return {floor_of(p.x * inverse_half_.x), floor_of(p.y * inverse_half_.y), floor_of(p.z * inverse_half_.z)};
  }
  /// Cell at a depth of a wrapped point.
  Cell cell_of(const Cell& finest_halves, int depth) const {
    Cell cell;
    for (std::size_t c = 0; c < 3; ++c) {
      cell[c] = finest_halves[c] >> (depth_ - depth + 1);
      // a point just below the period may round up to it
      if (const std::int64_t n = cell_count(static_cast<int>(c), depth); n > 0 && cell[c] >= n) cell[c] = n - 1;
    }
    return cell;
  }
  /// Wraps a cell; returns how many periods it lay above.
  std::int32_t wrap_cell(std::int64_t& cell, int axis, int depth) const {
    const std::int64_t n = cell_count(axis, depth);
    if (n == 0) return 0;
    const std::int64_t turns = cell >= 0 ? cell / n : -((n - 1 - cell) / n);
    cell -= turns * n;
    return static_cast<std::int32_t>(turns);
  }

  /// The hash of a cell is made of a part for each axis, so that eight cells around a corner share six parts: the block's
  /// coordinate times an odd constant, and which half of the block. The eight cells of a block get consecutive values.
  struct HashPart {
    std::uint64_t product, half;
  };
  HashPart hash_part(std::size_t axis, std::int64_t cell) const {
    constexpr std::array<std::uint64_t, 3> kOdd = {0x9E3779B97F4A7C15ull, 0xC2B2AE3D27D4EB4Full, 0xD6E8FEB86659FD93ull};
    return {static_cast<std::uint64_t>(cell >> 1) * (kOdd[axis] + hash_seed_), static_cast<std::uint64_t>(cell & 1) << axis};
  }
  static std::uint64_t join(int level, const HashPart& x, const HashPart& y, const HashPart& z) {
    std::uint64_t h = x.product + y.product + z.product + (static_cast<std::uint64_t>(level) << 56);
    h ^= h >> 32;
    h *= 0xBF58476D1CE4E5B9ull;
    h ^= h >> 29;
    return (h & ~7ull) | x.half | y.half | z.half;
  }
  std::uint64_t hash(int level, const Cell& cell) const {
    return join(level, hash_part(0, cell[0]), hash_part(1, cell[1]), hash_part(2, cell[2]));
  }
  Slot& slot_at(std::uint64_t slot) { return table_[static_cast<std::size_t>(slot >> 2)].slot[static_cast<std::size_t>(slot & 3)]; }
  const Slot& slot_at(std::uint64_t slot) const {
    return table_[static_cast<std::size_t>(slot >> 2)].slot[static_cast<std::size_t>(slot & 3)];
  }
  /// Cells that hold balls have different tags (see lay_out_cells); one that holds none may share its tag with one that
  /// does: is_in tells.
  const Slot* find_slot(std::uint64_t tag) const {
    for (std::uint64_t slot = tag & mask_;; slot = (slot + 1) & mask_) {
      const Slot& at = slot_at(slot);
      if (at.tag == tag && at.end > 0) return &at;
      if (at.end == 0) return nullptr;
    }
  }
  /// Whether the cells around a corner may hold balls of the level. Bits stand for blocks of 2 x 2 x 2 corners; a corner has
  /// the number of the upper of its two cells on each axis.
  std::uint64_t block_bit(std::int32_t level, const Cell& corner) const {
    return join(level, hash_part(0, corner[0]), hash_part(1, corner[1]), hash_part(2, corner[2])) >> 24 & near_mask_;
  }
  bool may_hold(const Cell& finest, std::int32_t level) const {
    const int shift = depth_ - levels_[static_cast<std::size_t>(level)].depth;
    const Cell corner = {((finest[0] >> shift) + 1) >> 1, ((finest[1] >> shift) + 1) >> 1, ((finest[2] >> shift) + 1) >> 1};
    const std::uint64_t bit = block_bit(level, corner);
    return (near_[static_cast<std::size_t>(bit >> 6)] >> (bit & 63) & 1) != 0;
  }
  void mark_neighbourhoods();
  bool is_in(std::size_t place, std::int32_t level, const Cell& cell) const {
    return level_[place] == level && cell_of(finest_halves(balls_[place].centre), levels_[static_cast<std::size_t>(level)].depth) == cell;
  }

  template <class Visit>
  static void call(Visit& visit, std::int32_t j, const PeriodicImage& image) {
    if constexpr (std::is_invocable_v<Visit&, std::int32_t, const PeriodicImage&>) {
      visit(j, image);
    } else {
      visit(j);
    }
  }

  /// Visits those of the balls begin .. end, taken in an image, that touch the given one (both as wrapped) and for which
  /// is_meant(place) holds.
  template <bool kPeriodic, class IsMeant, class Visit>
  void visit_touching(const Ball& ball, const PeriodicImage& ball_turns, const PeriodicImage& image, std::int32_t begin, std::int32_t end,
                      const IsMeant& is_meant, Visit& visit) const {
    Vec3 centre = ball.centre;
    if constexpr (kPeriodic)
      for (int c = 0; c < 3; ++c) centre[c] -= image[static_cast<std::size_t>(c)] * period_[c];
    for (std::int32_t m = begin; m < end; ++m) {
      const auto at = static_cast<std::size_t>(m);
      const double reach = ball.radius + balls_[at].radius;
      if (!(squared_length(centre - balls_[at].centre) < reach * reach)) [[likely]]
        continue;
      if (!is_meant(at)) [[unlikely]]
        continue;
      if constexpr (kPeriodic) {
        PeriodicImage as_given = image;
        for (std::size_t c = 0; c < 3; ++c) as_given[c] += ball_turns[c] - turns_[at][c];
        call(visit, order_[at], as_given);
      } else {
        call(visit, order_[at], kHome);
      }
    }
  }

  /// The cells of a level that hold all that a ball can touch there.
  struct Corner {
    std::array<Neighbours, 3> axis;
    std::array<std::uint64_t, 8> tag;
    std::uint32_t needed;  // bit k: something in cell k may be in reach
    Cell cell(std::size_t k) const { return {axis[0].cell[k & 1], axis[1].cell[k >> 1 & 1], axis[2].cell[k >> 2]}; }
    PeriodicImage image(std::size_t k) const { return {axis[0].image[k & 1], axis[1].image[k >> 1 & 1], axis[2].image[k >> 2]}; }
  };
  /// Of a coarser level than the ball's own some cells can be left out. On its own level nearly all are needed, and a number
  /// of them that changes costs more than it saves: mispredicted branches.
  template <bool kPeriodic, bool kCoarser>
  void find_corner(const Ball& ball, const Cell& finest, std::int32_t level, Corner& corner) const {
    // cells on the lower and on the upper side of each axis
    constexpr std::array<std::array<std::uint32_t, 2>, 3> kCells = {{{0x55, 0xAA}, {0x33, 0xCC}, {0x0F, 0xF0}}};
    const Level& at = levels_[static_cast<std::size_t>(level)];
    const int depth = at.depth;
    corner.needed = 0xFF;
    for (std::size_t c = 0; c < 3; ++c) {
      const std::int64_t half = finest[c] >> (depth_ - depth), upper = (half + 1) >> 1;
      Neighbours& axis = corner.axis[c];
      axis.cell = {upper - 1, upper};
      if constexpr (kCoarser) {
        // how far into the upper cell; the cell on the other side is needed when the border is within reach
        const int a = static_cast<int>(c);
        const double into = ball.centre[a] * inverse_half_[a] - static_cast<double>(upper) * at.cell_halves;
        const bool border_in_reach = std::abs(into) < (ball.radius + at.largest_radius) * inverse_half_[a] + kCellSlack * at.cell_halves;
        corner.needed &= border_in_reach ? 0xFFu : kCells[c][into < 0 ? 0 : 1];
      }
      if constexpr (kPeriodic)
        for (std::size_t k = 0; k < 2; ++k) axis.image[k] = wrap_cell(axis.cell[k], static_cast<int>(c), depth);
    }
    std::array<std::array<HashPart, 2>, 3> part;
    for (std::size_t c = 0; c < 3; ++c)
      for (std::size_t k = 0; k < 2; ++k) part[c][k] = hash_part(c, corner.axis[c].cell[k]);
    for (std::size_t k = 0; k < 8; ++k) {
      if ((corner.needed >> k & 1) == 0) continue;
      corner.tag[k] = join(level, part[0][k & 1], part[1][k >> 1 & 1], part[2][k >> 2]);
      __builtin_prefetch(&slot_at(corner.tag[k] & mask_));
    }
  }

  template <bool kPeriodic, class Visit>
  void search_partners(std::int32_t place, Visit& visit) const {
    const auto here = static_cast<std::size_t>(place);
    const Ball ball = balls_[here];
    const PeriodicImage turns = kPeriodic ? turns_[here] : kHome;
    const Cell finest = finest_halves(ball.centre);
    const std::int32_t own = level_[here];
    std::array<std::int32_t, kDeepest + 1> levels;  // to look into
    std::size_t level_count = 0;
    levels[level_count++] = own;
    for (std::int32_t level = own - 1; level >= 0; --level) {
      levels[level_count] = level;
      level_count += may_hold(finest, level) ? 1 : 0;
    }
    // one level ahead, so that its slots are on their way while this level's balls are tested
    std::array<Corner, 2> corners;
    find_corner<kPeriodic, false>(ball, finest, own, corners[0]);
    for (std::size_t turn = 0; turn < level_count; ++turn) {
      const std::int32_t level = levels[turn];
      if (turn + 1 < level_count) find_corner<kPeriodic, true>(ball, finest, levels[turn + 1], corners[(turn + 1) & 1]);
      const Corner& corner = corners[turn & 1];
      // of two balls of one level, the earlier finds the later
      const std::int32_t least = level == own ? place + 1 : 0;
      for (std::size_t k = 0; k < 8; ++k) {
        if ((corner.needed >> k & 1) == 0) continue;
        const Slot* slot = find_slot(corner.tag[k]);
        if (slot == nullptr) continue;
        visit_touching<kPeriodic>(
            ball, turns, corner.image(k), slot->begin > least ? slot->begin : least, slot->end,
            [&](std::size_t m) { return is_in(m, level, corner.cell(k)); }, visit);
      }
    }
  }

  template <bool kPeriodic, class Visit>
  void search_touching(const Vec3& centre, double radius, Visit& visit) const {
    PeriodicImage turns = kHome;
    const Ball ball{kPeriodic ? wrap(centre, turns) : centre, radius};
    for (std::int32_t index = 0; index < level_count(); ++index) {
      const Level& level = levels_[static_cast<std::size_t>(index)];
      const double reach = radius + level.largest_radius;
      Cell low, high;
      double box = 1;
      for (std::size_t c = 0; c < 3; ++c) {
        const int axis = static_cast<int>(c);
        constexpr double kBeyondAll = 0x1p44;  // half cells: see build
        const double from = (ball.centre[axis] - reach) * inverse_half_[axis], to = (ball.centre[axis] + reach) * inverse_half_[axis];
        low[c] = floor_of(std::fmax(from, -kBeyondAll)) >> (depth_ - level.depth + 1);
        high[c] = floor_of(std::fmin(to, kBeyondAll)) >> (depth_ - level.depth + 1);
        box *= static_cast<double>(high[c] - low[c] + 1);
      }
      if (box > static_cast<double>(level.cell_count)) {
        // a large ball among small ones: fewer cells hold balls than lie in its box
        PeriodicImage first = kHome, last = kHome;
        for (std::size_t c = 0; c < 3; ++c) {
          first[c] = wrap_cell(low[c], static_cast<int>(c), level.depth);
          last[c] = wrap_cell(high[c], static_cast<int>(c), level.depth);
        }
        for (std::int32_t z = first[2]; z <= last[2]; ++z)
          for (std::int32_t y = first[1]; y <= last[1]; ++y)
            for (std::int32_t x = first[0]; x <= last[0]; ++x)
              visit_touching<kPeriodic>(
                  ball, turns, {x, y, z}, level.begin, level.end, [](std::size_t) { return true; }, visit);
        continue;
      }
      for (std::int64_t z = low[2]; z <= high[2]; ++z) {
        for (std::int64_t y = low[1]; y <= high[1]; ++y) {
          for (std::int64_t x = low[0]; x <= high[0]; ++x) {
            Cell cell = {x, y, z};
            PeriodicImage image = kHome;
            if constexpr (kPeriodic)
              for (std::size_t c = 0; c < 3; ++c) image[c] = wrap_cell(cell[c], static_cast<int>(c), level.depth);
            const Slot* slot = find_slot(hash(index, cell));
            if (slot == nullptr) continue;
            visit_touching<kPeriodic>(
                ball, turns, image, slot->begin, slot->end, [&](std::size_t m) { return is_in(m, index, cell); }, visit);
          }
        }
      }
    }
  }

  std::vector<Ball> balls_;
  std::vector<PeriodicImage> turns_;  // periods by which each ball as given lies above where it is wrapped to; empty if not periodic
  std::vector<std::int32_t> order_;   // index of each ball as given
  std::vector<std::int32_t> place_;   // and its inverse
  std::vector<std::int8_t> level_;    // of each ball
  std::vector<Level> levels_;         // that hold balls, coarsest first
  std::vector<SlotLine> table_ = std::vector<SlotLine>(1);  // cells that hold balls: open addressing, at most half full
  std::uint64_t mask_ = 3, hash_seed_ = 0;
  std::vector<std::uint64_t> near_;  // bits of blocks of corners with a cell that holds balls, of all levels but the finest
  std::uint64_t near_mask_ = 0;

  // scratch of build
  struct Key {
    std::uint64_t value;
    std::int32_t ball;
    std::int32_t level;
  };
  std::vector<Key> keys_, keys_other_;
  struct CellStart {
    Cell position;
    std::int32_t level, begin;
  };
  std::vector<CellStart> cells_;

  Vec3 period_, inverse_half_;   // half the width of the finest cells
  Cell cell_count_ = {0, 0, 0};  // coarsest cells along a periodic axis; 0 where not periodic
  int depth_ = 0;                // of the finest level
  bool is_periodic_ = false;
};

}  // namespace scree
