// What a pair keeps from step to step besides its candidates: rows of several kinds, each declared once.
//
// A kind is a structure of plain values, a PairKind of it with its columns, and a line in PairState and for_each_kind. Migration,
// checkpoints, state_hash and verify go over kinds and columns, so that nothing else changes with a new one. Both owners of a pair
// hold its state, and compute it from the same bits.
#pragma once

#include <compare>
#include <cstdint>
#include <string_view>
#include <type_traits>
#include <vector>

#include "core/geometry/vec3.hpp"

namespace scree {

struct PairKey {
  std::int64_t a, b;  ///< ids; b is a wall's id for a wall zone
  std::int32_t zone;  ///< -1 for two bodies, else index into SolverScene::zones()
  auto operator<=>(const PairKey&) const = default;
};

/// Friction memory of one feature: spring force on A (A frame) and the stiffness it was built with.
struct FrictionSpring {
  std::int64_t key;
  Vec3 force;        ///< [N]
  double stiffness;  ///< kappa [N/m]; below 0: -kappa of a feature that slides
  Vec3 normal{};     ///< n of the feature, A frame; 0 of what is no spring, and of springs from checkpoints before version 5
};

/// A kind's group in checkpoints, its name in messages, and its columns as action(dataset, unit, field).
/// A row is sorted within its pair by its member `key`.
template <class Row>
struct PairKind;

/// Whether files of earlier versions lack a column. It then is 0, and where it is 0 it does not enter the hash of a state, so that the hash
/// is that of those files. A kind that has such columns names them in its own is_later().
template <class Kind>
constexpr bool is_later_column(std::string_view column) {
  if constexpr (requires { Kind::is_later(column); }) return Kind::is_later(column);
  return false;
}

template <>
struct PairKind<FrictionSpring> {
  static constexpr const char* kGroup = "springs";
  static constexpr const char* kName = "friction springs";
  /// Whether a row is kept when the bodies are no longer near each other: a spring goes with its contact, a bond does not.
  static constexpr bool kLasts = false;
  template <class Action>
  static void visit(Action&& action) {
    action("feature", "", &FrictionSpring::key);
    action("force", "N", &FrictionSpring::force);
    action("stiffness", "N/m", &FrictionSpring::stiffness);
    action("normal", "", &FrictionSpring::normal);
  }
  static constexpr bool is_later(std::string_view column) { return column == "normal"; }
};

/// Force of a contact as it was when the first of its bodies fell asleep (effects/sleep/sleep.hpp): one row, of a pair in contact with a
/// body asleep.
struct KeptForce {
  std::int64_t key;
  Vec3 force;  ///< on A, world [N]
};

template <>
struct PairKind<KeptForce> {
  static constexpr const char* kGroup = "kept_forces";
  static constexpr const char* kName = "kept forces";
  static constexpr bool kLasts = true;  ///< a contact that ends may wake a body, which asks for what it has lost
  template <class Action>
  static void visit(Action&& action) {
    action("key", "", &KeptForce::key);
    action("force", "N", &KeptForce::force);
  }
};

struct PairState {
  std::vector<FrictionSpring> springs;  ///< sorted by key
  std::vector<KeptForce> kept;          ///< one at most; empty but where bodies sleep

  bool empty() const;
  void clear();
  /// Drops the rows of all kinds that do not last. Returns whether any row is left.
  bool keep_lasting();
  std::size_t memory() const;  ///< of the rows [bytes]
};

/// Calls action(rows) with the rows of every kind.
template <class State, class Action>
void for_each_kind(State&& state, Action&& action) {
  action(state.springs);
  action(state.kept);
}

/// The same with two states side by side.
template <class First, class Second, class Action>
void for_each_kind_of_two(First&& first, Second&& second, Action&& action) {
  action(first.springs, second.springs);
  action(first.kept, second.kept);
}

/// The kind of rows such as PairState holds.
template <class Rows>
using KindOf = PairKind<typename std::decay_t<Rows>::value_type>;

/// A row with the pair that it belongs to, as it travels between ranks and into checkpoints.
template <class Row>
struct KeyedRow {
  PairKey key;
  Row row;
};

/// State of a pair that arrived by migration or from a checkpoint and waits for its pair to be listed, or that outlasted its being near.
struct WaitingState {
  PairKey key;
  PairState state;
};

/// Sorts by pair and makes one entry of those of the same pair: two owners may send the same rows, and each kind travels for itself.
void merge(std::vector<WaitingState>& waiting);

/// The rows of one kind of all of them, grouped by pair.
template <class Row>
std::vector<KeyedRow<Row>> keyed_rows(const std::vector<WaitingState>& states) {
  std::vector<KeyedRow<Row>> all;
  for (const WaitingState& s : states) {
    for_each_kind(s.state, [&](const auto& kind) {
      if constexpr (std::is_same_v<typename std::decay_t<decltype(kind)>::value_type, Row>) {
        for (const Row& row : kind) all.push_back({s.key, row});
      }
    });
  }
  return all;
}

/// Appends rows that come grouped by pair.
template <class Row>
void add_rows(const std::vector<KeyedRow<Row>>& rows, std::vector<WaitingState>& waiting) {
  const PairKey* last = nullptr;
  for (const KeyedRow<Row>& r : rows) {
    if (last == nullptr || *last != r.key) waiting.push_back({r.key, {}});
    last = &r.key;
    for_each_kind(waiting.back().state, [&](auto& kind) {
      if constexpr (std::is_same_v<typename std::decay_t<decltype(kind)>::value_type, Row>) kind.push_back(r.row);
    });
  }
}

inline bool PairState::empty() const {
  bool none = true;
  for_each_kind(*this, [&](const auto& rows) { none = none && rows.empty(); });
  return none;
}

inline void PairState::clear() {
  for_each_kind(*this, [](auto& rows) { rows.clear(); });
}

inline bool PairState::keep_lasting() {
  for_each_kind(*this, [](auto& rows) {
    if constexpr (!KindOf<decltype(rows)>::kLasts) rows.clear();
  });
  return !empty();
}

inline std::size_t PairState::memory() const {
  std::size_t bytes = 0;
  for_each_kind(*this, [&](const auto& rows) { bytes += rows.capacity() * sizeof(rows[0]); });
  return bytes;
}

}  // namespace scree
