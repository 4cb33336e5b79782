// What a pair remembers besides the springs of its features, one structure for each kind.
//
// In memory the rows of all kinds lie in PairState::springs, behind the springs, in the order of their keys: most pairs have one or two of
// them, and a vector for each kind would cost every listed pair 24 bytes and a branch. Nothing else reads the numbers of such a row: it is
// made and read here. Checkpoints have a table for each kind, with the names and units of its numbers (solver/CHECKPOINT_FORMAT.md).
//
// A kind has kKey, of(row) and row().
#pragma once

#include <algorithm>
#include <cstdint>
#include <type_traits>
#include <vector>

#include "core/geometry/vec3.hpp"
#include "solver/contact/pair_state.hpp"

namespace scree {

/// The spring of rolling resistance.
struct RollingSpring {
  static constexpr std::int64_t kKey = std::int64_t{3} << 60;
  Vec3 moment;       ///< on A, in the frame of the pair's springs [N m]
  double stiffness;  ///< [N m/rad]

  static RollingSpring of(const FrictionSpring& row) { return {row.force, row.stiffness}; }
  FrictionSpring row() const { return {kKey, moment, stiffness}; }
};

/// The overlap from which a contact counts that took the place of a bond under pressure.
struct RestOverlap {
  static constexpr std::int64_t kKey = std::int64_t{4} << 60;
  double overlap;  ///< [m]

  static RestOverlap of(const FrictionSpring& row) { return {row.force.x}; }
  FrictionSpring row() const { return {kKey, {overlap, 0, 0}, 0}; }
};

/// What contact/overlap_limit.hpp keeps of a contact deeper than its maximum overlap.
struct DeepShift {
  static constexpr std::int64_t kKey = RestOverlap::kKey | 1;
  Vec3 shift;               ///< of A while contacts are found, frame of B [m]
  std::int64_t passed = 0;  ///< 1: the contact has been beyond its maximum overlap since it began

  static DeepShift of(const FrictionSpring& row) { return {row.force, row.stiffness > 0 ? 1 : 0}; }
  FrictionSpring row() const { return {kKey, shift, passed != 0 ? 1.0 : 0.0}; }
};

/// The two have touched and have a neck (laws/neck.hpp) or a liquid bridge (laws/attraction.hpp).
struct Link {
  static constexpr std::int64_t kKey = std::int64_t{5} << 60;

  static Link of(const FrictionSpring&) { return {}; }
  FrictionSpring row() const { return {kKey, {}, 0}; }
};

/// The dent of a contact that has yielded (laws/plastic.hpp).
struct Dent {
  static constexpr std::int64_t kKey = Link::kKey | 1;
  double depth;  ///< [m]

  static Dent of(const FrictionSpring& row) { return {row.force.x}; }
  FrictionSpring row() const { return {kKey, {depth, 0, 0}, 0}; }
};

/// Where several pieces of a fragment press on the same partner (effects/bonds/shared_damping.hpp): the product of energy and mobility of
/// all contacts that press together, over that of this one. A contact that presses alone has no row.
struct DampingShare {
  static constexpr std::int64_t kKey = std::int64_t{6} << 60;
  double factor = 1;

  static DampingShare of(const FrictionSpring& row) { return {row.force.x}; }
  FrictionSpring row() const { return {kKey, {factor, 0, 0}, 0}; }
};

/// How B was turned against A when the springs were set: the last row.
struct Turn {
  static constexpr std::int64_t kKey = std::int64_t{7} << 60;
  Vec3 imaginary;   ///< x y z of the quaternion
  double real = 1;  ///< its w

  static Turn of(const FrictionSpring& row) { return {row.force, row.stiffness}; }
  static Turn of(const Quat& q) { return {{q.x, q.y, q.z}, q.w}; }
  FrictionSpring row() const { return {kKey, imaginary, real}; }
  Quat quaternion() const { return {real, imaginary.x, imaginary.y, imaginary.z}; }
};

/// Whether a row is the spring of a feature, and whether it is a spring at all.
inline bool is_of_feature(const FrictionSpring& row) { return row.key < RollingSpring::kKey; }
inline bool is_spring(const FrictionSpring& row) { return row.key <= RollingSpring::kKey; }

/// The row of a kind; null: the pair has none.   Cost: the rows behind it.
template <class Kind>
const FrictionSpring* row_of(const std::vector<FrictionSpring>& rows) {
  for (auto row = rows.rbegin(); row != rows.rend() && row->key >= Kind::kKey; ++row) {
    if (row->key == Kind::kKey) return &*row;
  }
  return nullptr;
}

/// What the pair remembers of a kind; where it has no row, what a kind says by default.
template <class Kind>
Kind remembered(const std::vector<FrictionSpring>& rows) {
  const FrictionSpring* const row = row_of<Kind>(rows);
  return row != nullptr ? Kind::of(*row) : Kind{};
}

template <class Kind>
void remember(std::vector<FrictionSpring>& rows, const Kind& kind) {
  const auto at = std::find_if(rows.begin(), rows.end(), [](const FrictionSpring& row) { return row.key >= Kind::kKey; });
  if (at != rows.end() && at->key == Kind::kKey)
    *at = kind.row();
  else
    rows.insert(at, kind.row());
}

template <class Kind>
void forget(std::vector<FrictionSpring>& rows) {
  std::erase_if(rows, [](const FrictionSpring& row) { return row.key == Kind::kKey; });
}

// Their tables in checkpoints: a group, and columns as action(dataset, unit, field).
template <>
struct PairKind<RollingSpring> {
  static constexpr const char* kGroup = "rolling_springs";
  template <class Action>
  static void visit(Action&& action) {
    action("moment", "N m", &RollingSpring::moment);
    action("stiffness", "N m/rad", &RollingSpring::stiffness);
  }
};
template <>
struct PairKind<RestOverlap> {
  static constexpr const char* kGroup = "rest_overlaps";
  template <class Action>
  static void visit(Action&& action) {
    action("overlap", "m", &RestOverlap::overlap);
  }
};
template <>
struct PairKind<DeepShift> {
  static constexpr const char* kGroup = "deep_pairs";
  template <class Action>
  static void visit(Action&& action) {
    action("shift", "m", &DeepShift::shift);
    action("passed", "", &DeepShift::passed);
  }
};
template <>
struct PairKind<Link> {
  static constexpr const char* kGroup = "links";
  template <class Action>
  static void visit(Action&&) {}
};
template <>
struct PairKind<Dent> {
  static constexpr const char* kGroup = "dents";
  template <class Action>
  static void visit(Action&& action) {
    action("depth", "m", &Dent::depth);
  }
};
template <>
struct PairKind<DampingShare> {
  static constexpr const char* kGroup = "damping_shares";
  template <class Action>
  static void visit(Action&& action) {
    action("factor", "", &DampingShare::factor);
  }
};
template <>
struct PairKind<Turn> {
  static constexpr const char* kGroup = "turns";
  template <class Action>
  static void visit(Action&& action) {
    action("imaginary", "", &Turn::imaginary);
    action("real", "", &Turn::real);
  }
};

/// What lies among the springs of a pair and is none of a feature.
template <class Row>
concept RemembersBesideSprings = requires {
  Row::kKey;
};

/// Calls action.operator()<Row>() for every table of a checkpoint.
template <class Action>
void for_each_table(Action&& action) {
  action.template operator()<FrictionSpring>();
  action.template operator()<RollingSpring>();
  action.template operator()<RestOverlap>();
  action.template operator()<DeepShift>();
  action.template operator()<Link>();
  action.template operator()<Dent>();
  action.template operator()<DampingShare>();
  action.template operator()<Turn>();
  action.template operator()<KeptForce>();
}

/// The rows of a table among the states of pairs. Of springs those of features: the others have tables of their own.
template <class Row>
std::vector<KeyedRow<Row>> rows_for_table(const std::vector<WaitingState>& states) {
  if constexpr (std::is_same_v<Row, FrictionSpring>) {
    std::vector<KeyedRow<Row>> rows = keyed_rows<Row>(states);
    std::erase_if(rows, [](const KeyedRow<Row>& r) { return !is_of_feature(r.row); });
    return rows;
  } else if constexpr (RemembersBesideSprings<Row>) {
    std::vector<KeyedRow<Row>> rows;
    for (const WaitingState& s : states) {
      if (const FrictionSpring* row = row_of<Row>(s.state.springs)) rows.push_back({s.key, Row::of(*row)});
    }
    return rows;
  } else {
    return keyed_rows<Row>(states);
  }
}

/// Rows of a table as they lie in the state of a pair.
template <class Row>
auto as_in_state(const std::vector<KeyedRow<Row>>& rows) {
  if constexpr (RemembersBesideSprings<Row>) {
    std::vector<KeyedRow<FrictionSpring>> springs;
    springs.reserve(rows.size());
    for (const KeyedRow<Row>& r : rows) springs.push_back({r.key, r.row.row()});
    return springs;
  } else {
    return rows;
  }
}

}  // namespace scree
