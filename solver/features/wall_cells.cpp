#include "solver/features/wall_cells.hpp"

#include <algorithm>
#include <cmath>

namespace scree {

namespace {

/// Along one axis at most two cells share a place: `low` with 1 - upper, `low` + 1 with upper.
struct AxisShare {
  std::int64_t low;
  double upper, slope;  ///< slope of upper [1/m]
};

AxisShare share_of(double x, double side) {
  constexpr double kFlat = 0.5;  // part of the side where one cell has everything
  const double u = x / side - 0.5;
  AxisShare share{static_cast<std::int64_t>(std::floor(u)), 0, 0};
  const double t = (u - static_cast<double>(share.low) - 0.5 * kFlat) / (1 - kFlat);
  if (t >= 1) share.upper = 1;
  if (t > 0 && t < 1) {
    share.upper = t * t * (3 - 2 * t);
    share.slope = 6 * t * (1 - t) / ((1 - kFlat) * side);
  }
  return share;
}

/// Place that a feature's weight is taken at, frame of the side with the cells [m]; whether it moves against them, and then the
/// point in A's frame about which A's motion turns it.
struct Anchor {
  Vec3 place, arm;
  bool moves;
};

Anchor anchor_of(const PairBody& a, const PairBody& b, bool cells_on_a, const ContactFeature& f) {
  const PairBody &held = cells_on_a ? a : b, &moving = cells_on_a ? b : a;
  const auto from_moving = [&](const Vec3& p) {
    const Vec3 place = rotate_inverse(held.q, moving.x + rotate(moving.q, p) - held.x);
    return Anchor{place, cells_on_a ? place : p, true};
  };
  if (moving.shape != nullptr && moving.shape->kind == ShapeKind::sphere) return from_moving({});
  const auto [kind, i, j] = indices_of_key(f.key);
  const std::int64_t corner_of_moving = cells_on_a ? kCornerOfB : kCornerOfA;
  if (kind == corner_of_moving) return from_moving(moving.scale * moving.shape->corner(i));
  if (kind == 1 - corner_of_moving) return {held.scale * held.shape->corner(i), {}, false};
  const ShapeEdge edge = held.shape->edge(cells_on_a ? i : j);
  return {held.scale * (edge.start + 0.5 * edge.along), {}, false};
}

/// Those of the cells of one side.
void add_shares(const PairBody& a, const PairBody& b, double size, bool cells_on_a, const std::vector<ContactFeature>& features,
                std::vector<CellShare>& shares) {
  for (std::size_t f = 0; f < features.size(); ++f) {
    const Anchor anchor = anchor_of(a, b, cells_on_a, features[f]);
    const AxisShare axis[3] = {share_of(anchor.place.x, size), share_of(anchor.place.y, size), share_of(anchor.place.z, size)};
    for (int corner = 0; corner < 8; ++corner) {
      double weight[3];
      Vec3 slope;
      std::int64_t cell = cells_on_a ? 1 : 0;  // the highest bit tells cells of A from those of B
      for (int k = 0; k < 3; ++k) {
        const bool up = ((corner >> k) & 1) != 0;
        weight[k] = up ? axis[k].upper : 1 - axis[k].upper;
        slope[k] = up ? axis[k].slope : -axis[k].slope;
        // 2^20 cells to either side of the wall's origin
        cell = (cell << 21) | ((axis[k].low + (up ? 1 : 0) + (std::int64_t{1} << 20)) & ((std::int64_t{1} << 21) - 1));
      }
      CellShare share{cell, static_cast<std::int32_t>(f), weight[0] * weight[1] * weight[2], {}};
      // U is proportional to the weight: less than this is below rounding, and its powers would overflow
      constexpr double kWeightCutoff = 1e-16;
      if (!(share.weight > kWeightCutoff)) continue;
      if (anchor.moves) {
        const Vec3 gradient{slope.x * weight[1] * weight[2], weight[0] * slope.y * weight[2], weight[0] * weight[1] * slope.z};
        // in the frame of A what A does to a point of B is the opposite of a motion
        share.gradient.force = cells_on_a ? -gradient : rotate_inverse(a.q, rotate(b.q, gradient));
        share.gradient.couple = cross(anchor.arm, share.gradient.force);
      }
      shares.push_back(share);
    }
  }
}

}  // namespace

void find_cell_shares(const PairBody& a, const PairBody& b, double size, CellSide side, const std::vector<ContactFeature>& features,
                      std::vector<CellShare>& shares) {
  shares.clear();
  if (side != CellSide::b) add_shares(a, b, size, true, features, shares);
  if (side != CellSide::a) add_shares(a, b, size, false, features, shares);
  std::sort(shares.begin(), shares.end(),
            [](const CellShare& l, const CellShare& r) { return l.cell != r.cell ? l.cell < r.cell : l.feature < r.feature; });
}

}  // namespace scree
