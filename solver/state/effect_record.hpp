// What an effect keeps for a restart, as a checkpoint holds it: arrays of numbers. Checkpoint and `verify` go over them and
// know no effect by its name.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "solver/ranks/exact_sum.hpp"

namespace scree {

/// An array of rows in a checkpoint.
struct ArrayFormat {
  const char* name;        ///< of the dataset
  const char* unit;        ///< "": none
  std::int64_t width = 1;  ///< numbers in a row
  bool is_real = true;     ///< doubles; else 64-bit integers
  bool is_later = false;   ///< checkpoints of earlier versions lack it: it is empty then
};

/// The numbers of one array, row after row: the vector that its format names, the other is empty.
struct StateArray {
  std::vector<double> reals = {};
  std::vector<std::int64_t> integers = {};
  bool operator==(const StateArray&) const = default;
};

/// One array for each of the format of the effect; empty: nothing to keep.
using EffectRecord = std::vector<StateArray>;

// An array that is one exact sum, the same on every rank.
ArrayFormat sum_format(const char* name);
StateArray array_of(const ExactSum& sum);
/// Throws InputError for another number of words.
ExactSum sum_of(const StateArray& array);

/// How an effect lies in a checkpoint.
struct EffectFormat {
  const char* group = "";    ///< of its arrays; "": they lie at the top of the file
  const char* differs = "";  ///< what `verify` says where two records are not the same
  std::vector<ArrayFormat> arrays = {};
  /// Says more than that of two records (recorded, found); "": no more. Null: nothing.
  std::string (*difference)(const EffectRecord&, const EffectRecord&) = nullptr;

  /// A checkpoint of the scene may be without it.
  bool is_optional = false;

  /// What a message calls it.
  std::string name() const { return *group != 0 ? group : arrays.front().name; }
};

}  // namespace scree
