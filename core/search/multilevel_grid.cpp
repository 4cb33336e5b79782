#include "core/search/multilevel_grid.hpp"

#include <algorithm>

#include "core/base/error.hpp"

namespace scree {

namespace {

/// Cells are wider than the diameters they hold by this part, so that two balls that touch never lie two cells apart by
/// the rounding of their cells: that is below 2^-12 cells up to kFarthestCell.
constexpr double kCellSlack = 0x1p-10;
constexpr double kFarthestCell = 0x1p40;
/// Periods that a body may have travelled: images are counted in 32 bits.
constexpr double kMostTurns = 0x1p30;
/// Deeper levels than this join it; it has to fit the sort key.
constexpr int kDeepest = 100;
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

Vec3 MultilevelGrid::wrap(Vec3 p, PeriodicImage& image) const {
  for (int c = 0; c < 3; ++c) {
    if (period_[c] <= 0) continue;
    const double turns = std::floor(p[c] / period_[c]);
    p[c] = std::clamp(p[c] - turns * period_[c], 0.0, period_[c]);
    image[static_cast<std::size_t>(c)] = static_cast<std::int32_t>(turns);
  }
  return p;
}

void MultilevelGrid::build(std::span<const Vec3> centres, std::span<const double> radii, const Vec3& period) {
  SCREE_ASSERT(centres.size() == radii.size(), "{} centres, {} radii", centres.size(), radii.size());
  const std::size_t count = centres.size();
  period_ = period;
  is_periodic_ = period.x > 0 || period.y > 0 || period.z > 0;
  levels_.clear();
  blocks_.clear();
  order_.resize(count);
  place_.resize(count);
  level_.resize(count);
  balls_.resize(count);
  image_.clear();
  table_.assign(2, -1);
  mask_ = 1;
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
  coarsest_radius_ = largest;
  const double width = 2 * largest * (1 + kCellSlack);
  double limit = kFarthestCell * width;
  for (int c = 0; c < 3; ++c)
    if (period_[c] > 0) limit = std::min(limit, kMostTurns * period_[c]);
  if (farthest > limit)
    throw InputError("a body has a coordinate of {:.6g} m; expected at most {:.6g} m, where rounding would begin to move bodies of this size "
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
    levels_.push_back({d, 0, 0});
  }
  depth_ = levels_.back().depth;

  // cells; along a periodic axis an even number of them, or one
  for (int c = 0; c < 3; ++c) {
    std::int64_t& cells = cell_count_[static_cast<std::size_t>(c)];
    cells = 0;
    inverse_cell_[c] = std::ldexp(1 / width, depth_);
    if (period_[c] <= 0) continue;
    const auto halves = static_cast<std::int64_t>(period_[c] / (2 * width));
    cells = halves > 0 ? 2 * halves : 1;
    inverse_cell_[c] = std::ldexp(static_cast<double>(cells), depth_) / period_[c];
  }

  // sort by level, then along the curve through the cells
  keys_.resize(count);
  if (is_periodic_) image_.resize(count);
  for (std::size_t i = 0; i < count; ++i) {
    const std::int32_t level = level_at[static_cast<std::size_t>(depth_of(radii[i]))];
    const int depth = levels_[static_cast<std::size_t>(level)].depth;
    PeriodicImage image;
    const Cell finest = finest_cell(is_periodic_ ? wrap(centres[i], image) : centres[i]);
    std::uint64_t curve = 0;
    for (int c = 0; c < 3; ++c) {
      const std::int64_t cell = wrap_cell(finest[static_cast<std::size_t>(c)] >> (depth_ - depth), c, depth);
      curve |= spread(static_cast<std::uint64_t>(cell)) << c;
    }
    keys_[i] = {static_cast<std::uint64_t>(level) << 30 | curve, static_cast<std::int32_t>(i), level};
  }
  sort_balls();
  lay_out_blocks(centres, radii);
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

void MultilevelGrid::lay_out_blocks(std::span<const Vec3> centres, std::span<const double> radii) {
  const auto count = static_cast<std::int32_t>(keys_.size());
  std::vector<std::pair<Cell, std::size_t>> wrapped;  // of the few runs that need it
  const auto cell_at = [&](std::size_t k) {
    const Key& key = keys_[k];
    const int depth = levels_[static_cast<std::size_t>(key.level)].depth;
    PeriodicImage image;
    const Vec3& centre = centres[static_cast<std::size_t>(key.ball)];
    Cell cell = finest_cell(is_periodic_ ? wrap(centre, image) : centre);
    for (int c = 0; c < 3; ++c) {
      std::int64_t& x = cell[static_cast<std::size_t>(c)];
      x = wrap_cell(x >> (depth_ - depth), c, depth);
    }
    return cell;
  };
  const auto block_of = [](const Cell& cell) { return Cell{cell[0] >> 1, cell[1] >> 1, cell[2] >> 1}; };

  // The key holds 10 bits of each coordinate: blocks 1024 cells apart may have come to lie in one run. Part them.
  const auto part_run = [&](std::size_t begin, std::size_t end) {
    bool same = true;
    const Cell first = block_of(cell_at(begin));
    for (std::size_t k = begin + 1; k < end && same; ++k) same = block_of(cell_at(k)) == first;
    if (same) return;
    wrapped.clear();
    for (std::size_t k = begin; k < end; ++k) wrapped.emplace_back(block_of(cell_at(k)), k);
    std::sort(wrapped.begin(), wrapped.end());  // by block; keys of one block stay in their order
    for (std::size_t k = begin; k < end; ++k) keys_other_[k] = keys_[wrapped[k - begin].second];
    std::copy(keys_other_.begin() + static_cast<std::ptrdiff_t>(begin), keys_other_.begin() + static_cast<std::ptrdiff_t>(end),
              keys_.begin() + static_cast<std::ptrdiff_t>(begin));
  };
  for (std::size_t begin = 0; begin < keys_.size();) {
    std::size_t end = begin + 1;
    while (end < keys_.size() && keys_[end].value >> 3 == keys_[begin].value >> 3) ++end;
    part_run(begin, end);
    begin = end;
  }

  for (std::int32_t k = 0; k < count; ++k) {
    const auto at = static_cast<std::size_t>(k);
    const Key& key = keys_[at];
    const auto i = static_cast<std::size_t>(key.ball);
    order_[at] = key.ball;
    place_[i] = k;
    level_[at] = static_cast<std::int8_t>(key.level);
    balls_[at] = {centres[i], radii[i]};
    if (is_periodic_) balls_[at].centre = wrap(centres[i], image_[at]);
    const Cell cell = cell_at(at), block = block_of(cell);
    if (blocks_.empty() || blocks_.back().level != key.level || blocks_.back().position != halves(block)) {
      Level& level = levels_[static_cast<std::size_t>(key.level)];
      if (level.block_count++ == 0) level.first_block = static_cast<std::int32_t>(blocks_.size());
      blocks_.push_back({{}, key.level, halves(block)});
      blocks_.back().start.fill(k);
    }
    // cells come in ascending order: this ball moves the start of all later ones
    const auto in_block = static_cast<std::size_t>((cell[2] & 1) * 4 + (cell[1] & 1) * 2 + (cell[0] & 1));
    for (std::size_t later = in_block + 1; later < 9; ++later) blocks_.back().start[later] = k + 1;
  }

  std::size_t slots = 2;
  while (slots < 2 * blocks_.size()) slots *= 2;
  table_.assign(slots, -1);
  mask_ = slots - 1;
  for (std::size_t b = 0; b < blocks_.size(); ++b) {
    const auto& p = blocks_[b].position;
    Cell position;
    for (std::size_t c = 0; c < 3; ++c)
      position[c] = static_cast<std::int64_t>(static_cast<std::uint64_t>(static_cast<std::uint32_t>(p[3 + c])) << 32 | static_cast<std::uint32_t>(p[c]));
    std::uint64_t slot = hash(blocks_[b].level, position) & mask_;
    while (table_[slot] >= 0) slot = (slot + 1) & mask_;
    table_[slot] = static_cast<std::int32_t>(b);
  }
}

std::size_t MultilevelGrid::memory() const {
  const auto bytes = [](const auto& v) { return v.capacity() * sizeof(v[0]); };
  return bytes(balls_) + bytes(image_) + bytes(order_) + bytes(place_) + bytes(level_) + bytes(blocks_) + bytes(levels_) + bytes(table_) +
         bytes(keys_) + bytes(keys_other_);
}

}  // namespace scree
