#include "core/base/csv.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>

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

TEST(csv, a_table_is_read_without_comments_and_its_last_line_may_be_torn) {
  const std::string path = (std::filesystem::temp_directory_path() / ("scree_csv_" + std::to_string(getpid()) + ".csv")).string();
  std::ofstream(path) << "step,\"a, b\"\n# units: -,m\n\n1,2\n3\n4,5";
  const std::optional<CsvTable> table = read_csv(path);
  std::filesystem::remove(path);
  ASSERT_TRUE(table);
  EXPECT_EQ(table->header, "step,\"a, b\"");
  EXPECT_EQ(table->column("a, b"), 1u);
  EXPECT_EQ(table->column("c"), 2u);
  ASSERT_EQ(table->rows.size(), 3u);
  EXPECT_EQ(table->rows[0].line, 4u);
  EXPECT_EQ(table->rows[1].cells, std::vector<std::string>{"3"});
  EXPECT_TRUE(table->rows[1].is_ended);
  EXPECT_EQ(table->rows[2].cells, (std::vector<std::string>{"4", "5"}));
  EXPECT_FALSE(table->rows[2].is_ended);
  EXPECT_FALSE(read_csv(path));
}

}  // namespace
}  // namespace scree
