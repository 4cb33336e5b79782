#include "core/base/csv.hpp"

#include <gtest/gtest.h>

namespace scree {
namespace {

TEST(csv, a_cell_comes_back_as_it_was_whatever_is_in_it) {
  const std::vector<std::string> cells{"plain", "a, b", "say \"a\"", "\"", "", "#1", "b\xe4ll", " x ", ",", "\"\"", "a\rb"};
  std::string line;
  for (const std::string& cell : cells) {
    if (&cell != &cells.front()) line += ',';
    line += csv_cell(cell);
  }
  EXPECT_EQ(csv_cells(line), cells) << line;
  EXPECT_EQ(csv_cells(line + "\r"), cells) << line;
}

TEST(csv, what_needs_no_quotes_has_none) {
  EXPECT_EQ(csv_cell("two words"), "two words");
  EXPECT_EQ(csv_cell("floor, left \"a\""), "\"floor, left \"\"a\"\"\"");
  EXPECT_EQ(csv_cells(""), std::vector<std::string>{""});
}

}  // namespace
}  // namespace scree
