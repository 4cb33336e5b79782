// What the reader of a case asked of its tables: the case language as it is read, for its schema (schema/print_reads.cpp).
#pragma once

#include <string>
#include <vector>

#include "core/base/units.hpp"

namespace scree {

/// Range that a number must lie in, with the words for it.
enum class Range { any, positive, not_negative, unit_interval, fraction };

struct CaseRead {
  enum class Kind {
    allowed,
    number,
    integer,
    boolean,
    text,
    word,
    vector,
    numbers,
    vectors,
    texts,
    corners,
    table,
    tables,
    named_tables,
    named_numbers
  };
  std::string table;  ///< "pairs[]", "materials.*", "walls[].shape"; "" for the whole file
  std::string key;
  Kind kind = Kind::allowed;              ///< allowed: the key may stand there, whatever it holds
  Dimension dimension = Dimension::none;  ///< of numbers and vectors
  Range range = Range::any;               ///< of numbers
  std::vector<std::string> words;         ///< of a word: those that this version knows
};
using CaseReads = std::vector<CaseRead>;

}  // namespace scree
