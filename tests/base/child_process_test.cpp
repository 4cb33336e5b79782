#include "core/base/child_process.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <csignal>
#include <cstring>

namespace scree {
namespace {

std::string all_of(ChildProcess& child) {
  std::vector<char> bytes;
  while (child.read(bytes, -1) != ChildProcess::Read::end) {
  }
  return {bytes.begin(), bytes.end()};
}

TEST(ChildProcess, of_a_program_gives_what_it_writes_and_its_exit_code) {
  ChildProcess child =
      ChildProcess::start({"sh", "-c", "echo \"$WORD\"; echo two >&2; exit 3"}, {{"WORD=one", "PATH=/usr/bin:/bin"}}, true);
  EXPECT_EQ(all_of(child), "one\ntwo\n");
  const ProcessEnd end = child.wait();
  EXPECT_EQ(end.code, 3);
  EXPECT_EQ(end.signal, 0);
  EXPECT_FALSE(end.is_success());
}

TEST(ChildProcess, of_a_missing_program_is_refused_with_its_name_and_the_reason) {
  try {
    ChildProcess::start({"scree-no-such-program"}, std::nullopt, false);
    FAIL();
  } catch (const StartError& error) {
    EXPECT_STREQ(error.what(), "cannot start scree-no-such-program: No such file or directory");
    EXPECT_EQ(error.reason(), "No such file or directory");
  }
}

TEST(ChildProcess, that_copies_this_one_writes_to_it_and_its_signal_is_known) {
  ChildProcess child = ChildProcess::fork([](int descriptor) {
    write_exactly(descriptor, "12345", 5);
    raise(SIGKILL);
  });
  char first[3] = {};
  EXPECT_TRUE(child.read_exactly(first, 2));
  EXPECT_STREQ(first, "12");
  EXPECT_EQ(all_of(child), "345");
  EXPECT_FALSE(child.read_exactly(first, 1));
  EXPECT_EQ(child.wait().signal, SIGKILL);
}

TEST(ChildProcess, that_is_no_longer_wanted_is_ended) {
  std::vector<ChildProcess> children;
  for (int i = 0; i < 3; ++i) children.push_back(ChildProcess::fork([](int) { pause(); }));
  std::vector<char> bytes;
  EXPECT_EQ(children[1].read(bytes, 1), ChildProcess::Read::nothing_yet);
  children.clear();  // hangs when one is not
}

TEST(ChildProcess, notices_that_its_reader_has_gone_though_others_are_read) {
  ChildProcess first = ChildProcess::fork([](int descriptor) {
    std::signal(SIGPIPE, SIG_IGN);
    const std::vector<char> block(1 << 20);
    while (write_exactly(descriptor, block.data(), block.size())) {
    }
    _exit(7);
  });
  const ChildProcess second = ChildProcess::fork([](int) { pause(); });
  EXPECT_EQ(first.wait().code, 7);
}

}  // namespace
}  // namespace scree
