// The tables of a run on a full disk. What a file may take at most stands in for the disk.
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <unistd.h>

#include <csignal>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "core/base/error.hpp"
#include "solver/run_log.hpp"

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

}  // namespace
}  // namespace scree
