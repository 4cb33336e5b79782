// Broad phase: which balls come close, at a cost per ball that does not depend on how many there are and
// hardly on how different their sizes are. Some axes may be periodic.
//
// Levels by radius, cell ratio 2. A ball is inserted once, at its own level, whose cells are at least as wide as its
// diameter, and searches its own and all coarser levels: 27 cells in each. Cells are hashed, so the domain has no
// bounds and coordinates may be negative.
// Source: Ogarko & Luding, Comput. Phys. Commun. 183 (2012) 931; Krijgsman, Ogarko & Luding, CPM 1 (2014) 357.
//
// Layout. What is hashed is a block of 2 x 2 x 2 cells, one cache line; 27 cells lie in 8 blocks. Balls are sorted
// along a Z-order curve of the cells, so that balls which meet lie close in memory, whatever order they came in:
//
//   table    hash -> block       open addressing, 4 bytes a slot, at most half full
//   blocks   where, and for its 8 cells the range of balls: start[4 z + 2 y + x] .. start[4 z + 2 y + x + 1]
//   balls    centre and radius, cell by cell
//
// Departure from the source: cells are anchored at the largest radius instead of the smallest, so that balls of
// one size get cells of just their diameter.
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
  /// Cost: O(N), about 60 ns a ball.   Memory: 40 bytes a ball, 72 a block that is not empty, kept between builds.
  void build(std::span<const Vec3> centres, std::span<const double> radii, const Vec3& period = {});

  /// Calls visit(j, image), or visit(j), for balls j that touch ball i in that image: over all i every touching
  /// pair is visited exactly once, from the smaller ball or, between balls of one level, from either. image is
  /// relative to the centres as given; all zero when nothing is periodic.
  /// Cost: least when i runs through order(), since then neighbours are in cache.   Threads: const, safe.
  template <class Visit>
  void for_each_partner(std::int32_t i, Visit&& visit) const {
    if (is_periodic_) {
      search_partners<true>(i, visit);
    } else {
      search_partners<false>(i, visit);
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
    Vec3 centre;  // wrapped into [0, period] on periodic axes
    double radius;
  };
  struct alignas(64) Block {
    std::array<std::int32_t, 9> start;
    std::int32_t level;
    std::array<std::int32_t, 6> position;  // low and high halves
  };
  struct Level {
    int depth;  // cells are the coarsest ones divided by 2^depth
    std::int32_t first_block, block_count;
  };
  /// Part of one block along one axis.
  struct Span {
    std::int64_t block;
    std::int32_t first, last;
  };
  struct Spans {
    std::array<Span, 2> span;
    int count;
  };

  static constexpr PeriodicImage kHome = {0, 0, 0};

  void check_period(double largest_radius) const;
  void sort_balls();
  void lay_out_blocks(std::span<const Vec3> centres, std::span<const double> radii);
  std::int64_t cell_count(int axis, int depth) const { return cell_count_[static_cast<std::size_t>(axis)] << depth; }

  /// Wraps a point into the period; image is how many periods it lay above.
  Vec3 wrap(Vec3 p, PeriodicImage& image) const;
  static std::int64_t floor_of(double x) {
    const auto i = static_cast<std::int64_t>(x);
    return i - (x < static_cast<double>(i) ? 1 : 0);
  }
  /// Cell of a wrapped point at the finest depth, not wrapped itself. That of depth d: shifted by depth_ - d.
  Cell finest_cell(const Vec3& p) const {
    return {floor_of(p.x * inverse_cell_.x), floor_of(p.y * inverse_cell_.y), floor_of(p.z * inverse_cell_.z)};
  }
  std::int64_t wrap_cell(std::int64_t c, int axis, int depth) const {
    const std::int64_t n = cell_count(axis, depth);
    if (n == 0) return c;
    const std::int64_t rest = c % n;
    return rest < 0 ? rest + n : rest;
  }

  /// Blocks that hold the cells c - 1 .. c + 1 of an axis, and which of their cells those are.
  Spans neighbours(std::int64_t c, int axis, int depth) const {
    const std::int64_t n = cell_count(axis, depth), b = c >> 1;
    if (n == 1 || n == 2) return {{{{0, 0, static_cast<std::int32_t>(n) - 1}, {}}}, 1};
    if ((c & 1) == 0) {
      const std::int64_t before = n > 0 && b == 0 ? n / 2 - 1 : b - 1;
      return {{{{before, 1, 1}, {b, 0, 1}}}, 2};
    }
    const std::int64_t after = n > 0 && b + 1 == n / 2 ? 0 : b + 1;
    return {{{{b, 0, 1}, {after, 0, 0}}}, 2};
  }

  static std::uint64_t hash(int level, const Cell& block) {
    std::uint64_t h = static_cast<std::uint64_t>(level) * 0x9E3779B97F4A7C15ull;
    for (const std::int64_t v : block) {
      h ^= static_cast<std::uint64_t>(v);
      h *= 0xBF58476D1CE4E5B9ull;
      h ^= h >> 29;
    }
    return h ^ (h >> 32);
  }
  static std::array<std::int32_t, 6> halves(const Cell& c) {
    std::array<std::int32_t, 6> h;
    for (std::size_t k = 0; k < 3; ++k) {
      h[k] = static_cast<std::int32_t>(static_cast<std::uint32_t>(c[k]));
      h[3 + k] = static_cast<std::int32_t>(c[k] >> 32);
    }
    return h;
  }
  const Block* find_block(std::int32_t level, const Cell& position) const {
    for (std::uint64_t slot = hash(level, position) & mask_;; slot = (slot + 1) & mask_) {
      const std::int32_t index = table_[static_cast<std::size_t>(slot)];
      if (index < 0) return nullptr;
      const Block& block = blocks_[static_cast<std::size_t>(index)];
      if (block.level == level && block.position == halves(position)) return &block;
    }
  }

  /// Visits those of the balls begin .. end that touch the given one.
  template <bool kPeriodic, class Visit>
  void visit_touching(const Ball& ball, const PeriodicImage& ball_image, std::int32_t begin, std::int32_t end, Visit& visit) const {
    for (std::int32_t m = begin; m < end; ++m) {
      const auto at = static_cast<std::size_t>(m);
      const Ball& other = balls_[at];
      Vec3 between = ball.centre - other.centre;
      PeriodicImage image = kHome;
      if constexpr (kPeriodic) {
        // both are wrapped: the nearest image is one of three
        for (int c = 0; c < 3; ++c) {
          if (period_[c] <= 0) continue;
          const int nearest = between[c] > 0.5 * period_[c] ? 1 : (between[c] < -0.5 * period_[c] ? -1 : 0);
          between[c] -= nearest * period_[c];
          image[static_cast<std::size_t>(c)] = nearest;
        }
      }
      const double reach = ball.radius + other.radius;
      if (!(squared_length(between) < reach * reach)) continue;
      if constexpr (kPeriodic)
        for (std::size_t c = 0; c < 3; ++c) image[c] += ball_image[c] - image_[at][c];
      if constexpr (std::is_invocable_v<Visit&, std::int32_t, const PeriodicImage&>) {
        visit(order_[at], image);
      } else {
        visit(order_[at]);
      }
    }
  }

  template <bool kPeriodic, class Visit>
  void search_partners(std::int32_t i, Visit& visit) const {
    const std::int32_t place = place_[static_cast<std::size_t>(i)];
    const auto here = static_cast<std::size_t>(place);
    const Ball ball = balls_[here];
    const PeriodicImage image = kPeriodic ? image_[here] : kHome;
    const Cell finest = finest_cell(ball.centre);
    const std::int32_t own = level_[here];
    for (std::int32_t level = own; level >= 0; --level) {
      const int depth = levels_[static_cast<std::size_t>(level)].depth;
      std::array<Spans, 3> spans;
      for (std::size_t c = 0; c < 3; ++c) {
        const int axis = static_cast<int>(c);
        const std::int64_t cell = finest[c] >> (depth_ - depth);
        spans[c] = neighbours(kPeriodic ? wrap_cell(cell, axis, depth) : cell, axis, depth);
      }
      for (int k = 0; k < spans[2].count; ++k) {
        const Span& z = spans[2].span[static_cast<std::size_t>(k)];
        for (int m = 0; m < spans[1].count; ++m) {
          const Span& y = spans[1].span[static_cast<std::size_t>(m)];
          for (int n = 0; n < spans[0].count; ++n) {
            const Span& x = spans[0].span[static_cast<std::size_t>(n)];
            const Block* block = find_block(level, {x.block, y.block, z.block});
            if (block == nullptr) continue;
            // of two balls of one level, the earlier finds the later
            const std::int32_t least = level == own ? place + 1 : 0;
            if (block->start[8] <= least) continue;
            for (std::int32_t row_z = z.first; row_z <= z.last; ++row_z) {
              for (std::int32_t row_y = y.first; row_y <= y.last; ++row_y) {
                const auto row = static_cast<std::size_t>(4 * row_z + 2 * row_y);
                const std::int32_t begin = block->start[row + static_cast<std::size_t>(x.first)];
                visit_touching<kPeriodic>(ball, image, begin > least ? begin : least,
                                          block->start[row + static_cast<std::size_t>(x.last) + 1], visit);
              }
            }
          }
        }
      }
    }
  }

  template <bool kPeriodic, class Visit>
  void search_touching(const Vec3& centre, double radius, Visit& visit) const {
    PeriodicImage image = kHome;
    const Ball ball{kPeriodic ? wrap(centre, image) : centre, radius};
    for (std::int32_t index = 0; index < level_count(); ++index) {
      const Level& level = levels_[static_cast<std::size_t>(index)];
      // blocks around the ball; as many as there are balls' blocks at most
      const double reach = radius + std::ldexp(coarsest_radius_, -level.depth);
      Cell low, high;
      double box = 1;
      for (std::size_t c = 0; c < 3; ++c) {
        const int axis = static_cast<int>(c);
        const double from = (ball.centre[axis] - reach) * inverse_cell_[axis], to = (ball.centre[axis] + reach) * inverse_cell_[axis];
        // beyond this no ball can be: see build
        constexpr double kFarthest = 0x1p44;
        const int shift = depth_ - level.depth + 1;
        low[c] = floor_of(std::fmax(from, -kFarthest)) >> shift;
        high[c] = floor_of(std::fmin(to, kFarthest)) >> shift;
        const std::int64_t n = (cell_count(axis, level.depth) + 1) / 2;
        if (n > 0 && high[c] - low[c] + 1 >= n) {
          low[c] = 0;
          high[c] = n - 1;
        }
        box *= static_cast<double>(high[c] - low[c] + 1);
      }
      if (box > static_cast<double>(level.block_count)) {
        for (std::int32_t b = level.first_block; b < level.first_block + level.block_count; ++b) {
          const Block& block = blocks_[static_cast<std::size_t>(b)];
          visit_touching<kPeriodic>(ball, image, block.start[0], block.start[8], visit);
        }
        continue;
      }
      for (std::int64_t z = low[2]; z <= high[2]; ++z) {
        for (std::int64_t y = low[1]; y <= high[1]; ++y) {
          for (std::int64_t x = low[0]; x <= high[0]; ++x) {
            const Block* block = find_block(index, wrap_block({x, y, z}, level.depth));
            if (block != nullptr) visit_touching<kPeriodic>(ball, image, block->start[0], block->start[8], visit);
          }
        }
      }
    }
  }
  Cell wrap_block(Cell block, int depth) const {
    for (int axis = 0; axis < 3; ++axis) {
      const std::int64_t n = (cell_count(axis, depth) + 1) / 2;
      std::int64_t& b = block[static_cast<std::size_t>(axis)];
      if (n > 0) b = ((b % n) + n) % n;
    }
    return block;
  }

  std::vector<Ball> balls_;
  std::vector<PeriodicImage> image_;     // of each ball, as given, relative to where it is wrapped to; empty if not periodic
  std::vector<std::int32_t> order_;      // index of each ball as given
  std::vector<std::int32_t> place_;      // and its inverse
  std::vector<std::int8_t> level_;       // of each ball
  std::vector<Block> blocks_;            // level by level
  std::vector<Level> levels_;            // coarsest first
  std::vector<std::int32_t> table_ = {-1, -1};
  std::uint64_t mask_ = 1;

  // scratch of build
  struct Key {
    std::uint64_t value;
    std::int32_t ball;
    std::int32_t level;
  };
  std::vector<Key> keys_, keys_other_;

  Vec3 period_, inverse_cell_;           // of the finest cells
  Cell cell_count_ = {0, 0, 0};          // coarsest cells along a periodic axis: 1 or even; 0 where not periodic
  double coarsest_radius_ = 0;
  int depth_ = 0;                        // of the finest level
  bool is_periodic_ = false;
};

}  // namespace scree
