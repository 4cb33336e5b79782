// The tables of a run on a full disk. What a file may take at most stands in for the disk.
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <unistd.h>

#include <csignal>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "core/base/error.hpp"
#include "solver/run/table.hpp"

namespace scree {
namespace {

std::string text_of(const std::string& path) {
  std::ostringstream text;
  text << std::ifstream(path).rdbuf();
  return text.str();
}

TEST(Table, takes_rows_whole_or_not_at_all_when_the_disk_is_full) {
  const std::string path = (std::filesystem::temp_directory_path() / ("scree_table_" + std::to_string(getpid()) + ".csv")).string();
  start_table(path, "step,value\n", -1);
  append_to_table(path, "1,10\n");
  const std::string before = text_of(path);
  rlimit old{};
  getrlimit(RLIMIT_FSIZE, &old);
  rlimit small = old;
  small.rlim_cur = before.size() + 3;  // room for a part of the next row
  std::signal(SIGXFSZ, SIG_IGN);
  setrlimit(RLIMIT_FSIZE, &small);
  EXPECT_THROW(append_to_table(path, "2,20\n3,30\n"), SystemError);
  setrlimit(RLIMIT_FSIZE, &old);
  EXPECT_EQ(text_of(path), before);
  append_to_table(path, "2,20\n");
  EXPECT_EQ(text_of(path), before + "2,20\n");
  std::filesystem::remove(path);
}

TEST(Table, goes_on_with_the_columns_of_a_newer_version) {
  const std::string path = (std::filesystem::temp_directory_path() / ("scree_newer_" + std::to_string(getpid()) + ".csv")).string();
  std::ofstream(path) << "step,value,old\n# units: -,m,-\n1,10,x\n2,11,y\n3,12,z\n";
  const std::string header = "step,new,value\n# units: -,N,m\n";
  start_table(path, header, 2);
  append_to_table(path, "3,7,12\n");
  EXPECT_EQ(text_of(path), header + "1,,10\n2,,11\n3,7,12\n");
  EXPECT_EQ(read_table(path).rows.size(), 3u);
  std::filesystem::remove(path);
}

TEST(Table, keeps_only_rows_that_are_complete) {
  const std::string path = (std::filesystem::temp_directory_path() / ("scree_torn_" + std::to_string(getpid()) + ".csv")).string();
  const std::string header = "step,value,hash\n# units: -,m,-\n", whole = "1,10,ab\n20,11,cd\n";
  // torn inside its step, inside a value, inside its last cell; a row that lacks a cell in the middle of the file
  for (const std::string torn : {"30", "3", "30,1", "30,12,e", "30,12\n", "x,12,ef\n", "99999999999999999999,12,ef\n"}) {
    std::ofstream(path) << header << whole << torn;
    EXPECT_EQ(read_table(path).rows.size(), 2u) << torn;
    start_table(path, header, 100);
    EXPECT_EQ(text_of(path), header + whole) << torn;
  }
  start_table(path, header, 1);
  EXPECT_EQ(text_of(path), header + "1,10,ab\n");
  std::filesystem::remove(path);
}

}  // namespace
}  // namespace scree
