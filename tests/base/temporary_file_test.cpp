#include "core/base/temporary_file.hpp"

#include <gtest/gtest.h>
#include <signal.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <optional>

#include "core/base/child_process.hpp"

namespace scree {
namespace {

namespace fs = std::filesystem;

std::string text_of(const std::string& path) {
  std::ifstream file(path);
  return {std::istreambuf_iterator<char>(file), {}};
}

/// A folder that is empty at the start of a test.
class TemporaryFileTest : public ::testing::Test {
 protected:
  TemporaryFileTest() : folder_(fs::temp_directory_path() / fmt::format("scree_temporary_file_test.{}", getpid())) {
    fs::create_directory(folder_);
  }
  ~TemporaryFileTest() override { fs::remove_all(folder_); }
  std::string path(const char* name) const { return (folder_ / name).string(); }
  std::size_t files() const { return static_cast<std::size_t>(std::distance(fs::directory_iterator(folder_), fs::directory_iterator())); }

 private:
  fs::path folder_;
};

TEST_F(TemporaryFileTest, published_replaces_what_was_there_and_else_leaves_it) {
  std::ofstream(path("table.csv")) << "old";
  {
    TemporaryFile file(path("table.csv"));
    std::ofstream(file.name()) << "new, not published";
    EXPECT_EQ(text_of(path("table.csv")), "old");
  }
  EXPECT_EQ(text_of(path("table.csv")), "old");
  EXPECT_EQ(files(), 1U);
  {
    TemporaryFile file(path("table.csv"));
    std::ofstream(file.name()) << "new";
    file.publish();
  }
  EXPECT_EQ(text_of(path("table.csv")), "new");
  EXPECT_EQ(files(), 1U);
}

TEST_F(TemporaryFileTest, that_was_not_made_or_has_no_folder_is_an_error) {
  TemporaryFile none(path("table.csv"));
  EXPECT_THROW(none.publish(), SystemError);
  EXPECT_FALSE(fs::exists(path("table.csv")));
}

TEST_F(TemporaryFileTest, is_removed_by_each_signal_that_ends_a_process_and_so_is_its_program) {
  for (const int number : {SIGINT, SIGTERM, SIGHUP}) {
    ChildProcess child = ChildProcess::fork([&](int parent) {
      for (const int each : {SIGINT, SIGTERM, SIGHUP}) signal(each, SIG_DFL);  // whatever starts the tests has chosen
      listen_to_interruptions();
      const TemporaryFile file(path("half.csv"));
      std::ofstream(file.name()) << "half";
      const ChildProcess program = ChildProcess::start({"sleep", "60"}, std::nullopt, false);
      const int process = program.process();
      write_exactly(parent, &process, sizeof process);
      while (true) pause();
    });
    int process = 0;
    ASSERT_TRUE(child.read_exactly(&process, sizeof process));
    EXPECT_EQ(files(), 1U);
    EXPECT_EQ(kill(process, 0), 0);
    kill(child.process(), number);
    EXPECT_EQ(child.wait().signal, number);
    EXPECT_EQ(files(), 0U);
    EXPECT_NE(kill(process, 0), 0) << "the program goes on";
  }
}

TEST_F(TemporaryFileTest, of_a_copy_of_the_process_is_removed_with_the_copy_and_that_of_the_process_stays) {
  ChildProcess child = ChildProcess::fork([&](int parent) {
    signal(SIGTERM, SIG_DFL);
    listen_to_interruptions();
    const TemporaryFile file(path("of_the_process.csv"));
    std::ofstream(file.name()) << "half";
    ChildProcess copy = ChildProcess::fork([&](int above) {
      const TemporaryFile own(path("of_the_copy.csv"));
      std::ofstream(own.name()) << "half";
      write_exactly(above, "", 1);
      while (true) pause();
    });
    char ready = 0;
    if (!copy.read_exactly(&ready, 1)) _exit(1);
    const std::size_t before = files();
    kill(copy.process(), SIGTERM);
    copy.wait();
    const std::size_t numbers[2] = {before, files()};
    write_exactly(parent, numbers, sizeof numbers);
  });
  std::size_t numbers[2] = {};
  ASSERT_TRUE(child.read_exactly(numbers, sizeof numbers));
  EXPECT_EQ(numbers[0], 2U);
  EXPECT_EQ(numbers[1], 1U);
}

}  // namespace
}  // namespace scree
