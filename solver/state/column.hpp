// A column of a table of the run folder.
#pragma once

#include <string>

namespace scree {

/// A column with its cell in one row. A table lists its columns once, for its header and its rows alike.
struct Column {
  std::string name;
  const char* unit;  ///< "-": none
  std::string cell;
};

/// A number as tables write what must be read back bit by bit.
std::string exact(double value);

}  // namespace scree
