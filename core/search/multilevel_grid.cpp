#include "core/search/multilevel_grid.hpp"

#include <algorithm>

#include "core/base/error.hpp"

namespace scree {

namespace {

/// Farther out than this many of the coarsest cells, rounding would begin to move balls between cells.
constexpr double kFarthestCell = 0x1p40;
/// Periods that a body may have travelled: images are counted in 32 bits.
constexpr double kMaxTurns = 0x1p30;
/// The low 10 bits of x, two zeros between one another.
std::uint64_t spread(std::uint64_t x) {
  x &= 0x3FF;
  x = (x | (x << 16)) & 0x30000FF;
  x = (x | (x << 8)) & 0x300F00F;
  x = (x | (x << 4)) & 0x30C30C3;
  x = (x | (x << 2)) & 0x9249249;
  return x;
}

}  // namespace

void MultilevelGrid::check_period(double largest_radius) const {
  static constexpr const char* kAxis[] = {"x", "y", "z"};
  for (int c = 0; c < 3; ++c) {
    if (period_[c] > 0 && 4 * largest_radius > period_[c])
      throw InputError(
          "periodic axis {}: the period is {:.6g} m, but a body with its margin and skin is {:.6g} m wide; expected at most half the "
          "period, so that no two bodies touch in two images; make the domain longer or the bodies smaller",
          kAxis[c], period_[c], 2 * largest_radius);
  }
}

Vec3 MultilevelGrid::wrap(Vec3 p, PeriodicImage& turns) const {
  for (int c = 0; c < 3; ++c) {
    if (period_[c] <= 0) continue;
    double whole = std::floor(p[c] / period_[c]);
    p[c] -= whole * period_[c];
    // the rounding of the quotient or of the difference may leave it just outside
    if (p[c] < 0) {
      p[c] += period_[c];
      whole -= 1;
    }
    if (p[c] >= period_[c]) {
      p[c] = 0;
      whole += 1;
    }
    turns[static_cast<std::size_t>(c)] = static_cast<std::int32_t>(whole);
  }
  return p;
}

void MultilevelGrid::build(std::span<const Vec3> centres, std::span<const double> radii, const Vec3& period) {
  SCREE_ASSERT(centres.size() == radii.size(), "{} centres, {} radii", centres.size(), radii.size());
  const std::size_t count = centres.size();
  period_ = period;
  is_periodic_ = period.x > 0 || period.y > 0 || period.z > 0;
  levels_.clear();
  cells_.clear();
  order_.resize(count);
  place_.resize(count);
  level_.resize(count);
  balls_.resize(count);
  turns_.clear();
  table_.assign(1, SlotLine{});
  mask_ = 3;
  if (count == 0) return;

  double smallest = radii[0], largest = radii[0], farthest = 0;
  for (std::size_t i = 0; i < count; ++i) {
    SCREE_ASSERT(std::isfinite(radii[i]) && is_finite(centres[i]), "ball {}", i);
    smallest = std::min(smallest, radii[i]);
    largest = std::max(largest, radii[i]);
    for (int c = 0; c < 3; ++c) farthest = std::max(farthest, std::abs(centres[i][c]));
  }
  SCREE_ASSERT(smallest > 0, "smallest radius {}", smallest);
  check_period(largest);

  // depths, as many as the sizes need and the rounding of the cells allows
  const double width = 4 * largest * (1 + kCellSlack);
  double limit = kFarthestCell * width;
  for (int c = 0; c < 3; ++c)
    if (period_[c] > 0) limit = std::min(limit, kMaxTurns * period_[c]);
  if (farthest > limit)
    throw InputError(
        "a body has a coordinate of {:.6g} m; expected at most {:.6g} m, where rounding would begin to move bodies of this size "
        "(largest: {:.6g} m wide) between cells; look for a body that escaped",
        farthest, limit, 2 * largest);
  for (int c = 0; c < 3; ++c) farthest = std::max(farthest, period_[c]);
  const int allowed = farthest > 0 ? std::ilogb(kFarthestCell * width / farthest) : kDeepest;
  const auto depth_of = [&](double r) { return std::min({std::ilogb(largest / r), allowed, kDeepest}); };

  // levels: the depths that have balls
  std::array<std::int32_t, kDeepest + 1> level_at;
  level_at.fill(-1);
  for (const double r : radii) level_at[static_cast<std::size_t>(depth_of(r))] = 0;
  for (int d = 0; d <= kDeepest; ++d) {
    if (level_at[static_cast<std::size_t>(d)] < 0) continue;
    level_at[static_cast<std::size_t>(d)] = static_cast<std::int32_t>(levels_.size());
    levels_.emplace_back().depth = d;
  }
  depth_ = levels_.back().depth;
  for (Level& level : levels_) {
    level.largest_radius = std::ldexp(largest, -level.depth);
    level.cell_halves = std::ldexp(2.0, depth_ - level.depth);
  }

  // cells; along a periodic axis a whole number of them
  for (int c = 0; c < 3; ++c) {
    std::int64_t& cells = cell_count_[static_cast<std::size_t>(c)];
    cells = 0;
    inverse_half_[c] = std::ldexp(1 / width, depth_ + 1);
    if (period_[c] <= 0) continue;
    cells = std::max<std::int64_t>(1, static_cast<std::int64_t>(period_[c] / width));
    inverse_half_[c] = std::ldexp(static_cast<double>(cells), depth_ + 1) / period_[c];
  }

  // sort by level, then along the curve through the cells
  keys_.resize(count);
  if (is_periodic_) turns_.resize(count);
  for (std::size_t i = 0; i < count; ++i) {
    const std::int32_t level = level_at[static_cast<std::size_t>(depth_of(radii[i]))];
    PeriodicImage turns;
    const Cell cell =
        cell_of(finest_halves(is_periodic_ ? wrap(centres[i], turns) : centres[i]), levels_[static_cast<std::size_t>(level)].depth);
    std::uint64_t curve = 0;
    for (std::size_t c = 0; c < 3; ++c) curve |= spread(static_cast<std::uint64_t>(cell[c])) << c;
    keys_[i] = {static_cast<std::uint64_t>(level) << 30 | curve, static_cast<std::int32_t>(i), level};
  }
  sort_balls();
  lay_out_cells(centres, radii);
}

/// Radix sort by key; stable, so equal for equal input.
void MultilevelGrid::sort_balls() {
  constexpr int kBits = 37, kDigit = 10;
  constexpr std::uint64_t kMask = (1u << kDigit) - 1;
  static_assert(kDeepest < 1 << (kBits - 30));
  keys_other_.resize(keys_.size());
  for (int shift = 0; shift < kBits; shift += kDigit) {
    std::array<std::int32_t, kMask + 1> start{};
    for (const Key& key : keys_) ++start[static_cast<std::size_t>(key.value >> shift & kMask)];
    if (start[static_cast<std::size_t>(keys_[0].value >> shift & kMask)] == static_cast<std::int32_t>(keys_.size())) continue;
    std::int32_t sum = 0;
    for (std::int32_t& s : start) sum += std::exchange(s, sum);
    for (const Key& key : keys_) keys_other_[static_cast<std::size_t>(start[static_cast<std::size_t>(key.value >> shift & kMask)]++)] = key;
    keys_.swap(keys_other_);
  }
}

void MultilevelGrid::lay_out_cells(std::span<const Vec3> centres, std::span<const double> radii) {
  std::vector<std::pair<Cell, Key>> run;
  const auto place_at = [&](std::size_t k) {
    const auto i = static_cast<std::size_t>(keys_[k].ball);
    if (constexpr std::size_t kAhead = 16; k + kAhead < keys_.size()) {
      const auto later = static_cast<std::size_t>(keys_[k + kAhead].ball);
      __builtin_prefetch(&centres[later]);
      __builtin_prefetch(&radii[later]);
      __builtin_prefetch(&place_[later], 1);
    }
    order_[k] = keys_[k].ball;
    place_[i] = static_cast<std::int32_t>(k);
    level_[k] = static_cast<std::int8_t>(keys_[k].level);
    balls_[k] = {is_periodic_ ? wrap(centres[i], turns_[k]) : centres[i], radii[i]};
    return cell_of(finest_halves(balls_[k].centre), levels_[static_cast<std::size_t>(keys_[k].level)].depth);
  };
  for (std::size_t begin = 0, end = 0; begin < keys_.size(); begin = end) {
    // A run of equal keys is one cell: or several, 1024 cells apart, since a key holds 10 bits of each coordinate.
    const Cell first = place_at(begin);
    bool same = true;
    for (end = begin + 1; end < keys_.size() && keys_[end].value == keys_[begin].value; ++end) same = (place_at(end) == first) && same;
    if (!same) {
      run.clear();
      for (std::size_t k = begin; k < end; ++k) run.emplace_back(place_at(k), keys_[k]);
      std::sort(run.begin(), run.end(),
                [](const auto& l, const auto& r) { return l.first != r.first ? l.first < r.first : l.second.ball < r.second.ball; });
      for (std::size_t k = begin; k < end; ++k) keys_[k] = run[k - begin].second;
    }
    for (std::size_t k = begin; k < end; ++k) {
      const Cell cell = same ? first : place_at(k);
      if (k == begin || (!same && cell != cells_.back().position)) {
        const auto here = static_cast<std::int32_t>(k);
        Level& level = levels_[static_cast<std::size_t>(keys_[k].level)];
        if (level.cell_count++ == 0) level.begin = here;
        cells_.push_back({cell, keys_[k].level, here});
      }
      levels_[static_cast<std::size_t>(keys_[k].level)].end = static_cast<std::int32_t>(k) + 1;
    }
  }

  std::size_t slots = 4;
  while (slots < 2 * cells_.size()) slots *= 2;
  mask_ = slots - 1;
  const auto fill_table = [&] {
    table_.assign(slots / 4, SlotLine{});
    for (std::size_t k = 0; k < cells_.size(); ++k) {
      const std::uint64_t tag = hash(cells_[k].level, cells_[k].position);
      std::uint64_t slot = tag & mask_;
      while (slot_at(slot).end > 0) {
        if (slot_at(slot).tag == tag) return false;
        slot = (slot + 1) & mask_;
      }
      slot_at(slot) = {tag, cells_[k].begin, k + 1 < cells_.size() ? cells_[k + 1].begin : static_cast<std::int32_t>(keys_.size())};
    }
    return true;
  };
  // two cells with one tag of 64 bits: hardly ever, but then another hash must serve
  for (hash_seed_ = 0; !fill_table();) hash_seed_ += 1000;
  mark_neighbourhoods();
}

void MultilevelGrid::mark_neighbourhoods() {
  // only finer levels ask
  const std::size_t asked = cells_.size() - static_cast<std::size_t>(levels_.back().cell_count);
  // a cell sets 3.4 bits on average: at 16 bits a cell, a fifth is set
  constexpr std::size_t kBitsPerCell = 16;
  std::size_t words = 1;
  while (64 * words < kBitsPerCell * asked) words *= 2;
  near_.assign(words, 0);
  near_mask_ = 64 * words - 1;
  for (std::size_t k = 0; k < asked; ++k) {
    const CellStart& cell = cells_[k];
    // its two corners on each axis, once where they share a block; on a periodic axis the first and the last are one
    std::array<std::array<std::int64_t, 4>, 3> corner;
    std::array<std::size_t, 3> count;
    for (std::size_t c = 0; c < 3; ++c) {
      const std::int64_t x = cell.position[c], n = cell_count(static_cast<int>(c), levels_[static_cast<std::size_t>(cell.level)].depth);
      count[c] = 0;
      corner[c][count[c]++] = x;
      if ((x & 1) != 0) corner[c][count[c]++] = x + 1;
      if (n > 0 && x == 0) corner[c][count[c]++] = n;
      if (n > 0 && x == n - 1) corner[c][count[c]++] = 0;
    }
    for (std::size_t z = 0; z < count[2]; ++z)
      for (std::size_t y = 0; y < count[1]; ++y)
        for (std::size_t x = 0; x < count[0]; ++x) {
          const std::uint64_t bit = block_bit(cell.level, {corner[0][x], corner[1][y], corner[2][z]});
          near_[static_cast<std::size_t>(bit >> 6)] |= std::uint64_t{1} << (bit & 63);
        }
  }
}

std::size_t MultilevelGrid::memory() const {
  const auto bytes = [](const auto& v) { return v.capacity() * sizeof(v[0]); };
  return bytes(balls_) + bytes(turns_) + bytes(order_) + bytes(place_) + bytes(level_) + bytes(cells_) + bytes(levels_) + bytes(table_) +
         bytes(near_) + bytes(keys_) + bytes(keys_other_);
}

}  // namespace scree
