// What a run knows of an inlet besides its bodies: the same on every rank, and part of a checkpoint. What it owes by now follows from the
// time, its rate and this.
#pragma once

#include <cstdint>
#include <vector>

namespace scree {

/// A body between an outlet and the inlet through which it comes in again.
struct TransitBody {
  std::int64_t id;
  std::int32_t shape, material;
  double scale;
  std::uint8_t lock_rotation;
  bool operator==(const TransitBody&) const = default;
};

struct InletState {
  std::int64_t count = 0;          ///< new bodies that it let in: the number of the next one
  double mass = 0;                 ///< of these [kg], summed in their order
  std::int64_t returned = 0;       ///< bodies that came in again
  std::int64_t is_blocked = 0;     ///< 1: the next body found no room when it last looked
  std::int64_t blocked_looks = 0;  ///< how often it found none
  double first_blocked = -1;       ///< when it first found none [s]; < 0: never
  std::vector<TransitBody> queue;  ///< bodies that wait to come in again, in this order
  bool operator==(const InletState&) const = default;
};

}  // namespace scree
