#include "core/base/child_process.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <csignal>
#include <cstring>
#include <fstream>

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

TEST(ChildProcess, that_serves_has_its_descriptors_and_is_asked_to_end) {
  MemoryFile says, given;
  ASSERT_TRUE(write_exactly(given.descriptor(), "word", 4));
  ChildProcess child =
      ChildProcess::serve({"sh", "-c",
                           "echo said; cat /proc/self/fd/4 >&3; cat; echo end >&3; trap 'echo asked; exit' TERM; exec 3>&-; "
                           "while :; do sleep 0.01; done"},
                          says.descriptor(), {given.descriptor()});
  EXPECT_EQ(all_of(child), "wordend\n");  // and its stdin was empty
  child.end(10'000);
  EXPECT_EQ(says.text(), "said\nasked\n");
}

TEST(ChildProcess, that_serves_and_does_not_end_when_asked_is_killed) {
  MemoryFile says;
  ChildProcess child = ChildProcess::serve({"sh", "-c", "trap '' TERM; echo >&3; while :; do sleep 0.01; done"}, says.descriptor(), {});
  char line = 0;
  ASSERT_TRUE(child.read_exactly(&line, 1));
  child.end(50);  // hangs when it is not
}

// What it serves is killed, so that nothing of it can end the server.
TEST(ChildProcess, that_serves_ends_with_what_it_serves) {
  ChildProcess served = ChildProcess::fork([](int output) {
    MemoryFile says;
    ChildProcess server = ChildProcess::serve({"sh", "-c", "echo $$ >&3; exec sleep 60"}, says.descriptor(), {});
    std::vector<char> number;
    while (number.empty() || number.back() != '\n') server.read(number, -1);
    write_exactly(output, number.data(), number.size());
    raise(SIGKILL);
  });
  const std::string number = all_of(served);
  ASSERT_FALSE(number.empty());
  const pid_t server = std::stoi(number);
  const auto is_there = [server] {  // one that nobody waits for stays as a zombie where no init takes it
    std::ifstream stat(fmt::format("/proc/{}/stat", server));
    std::string id, name, state;
    return static_cast<bool>(stat >> id >> name >> state) && state != "Z";
  };
  for (int i = 0; i < 500 && is_there(); ++i) usleep(10'000);
  EXPECT_FALSE(is_there());
}

TEST(ChildProcess, that_serves_and_is_missing_ends_with_127) {
  MemoryFile says;
  EXPECT_EQ(ChildProcess::serve({"scree-no-such-program"}, says.descriptor(), {}).wait().code, 127);
}

TEST(ChildProcess, that_is_fed_reads_it_all_and_one_that_has_gone_is_noticed) {
  MemoryFile says;
  ChildProcess child = ChildProcess::start_fed({"wc", "-c"}, says.descriptor());
  const std::vector<char> block(1 << 20);
  for (int i = 0; i < 3; ++i) EXPECT_TRUE(child.feed(block.data(), block.size()));
  child.end_feed();
  EXPECT_TRUE(child.wait().is_success());
  EXPECT_EQ(std::stoi(says.text()), 3 << 20);
  ChildProcess deaf = ChildProcess::start_fed({"true"}, says.descriptor());
  while (deaf.feed(block.data(), block.size())) {
  }
  EXPECT_TRUE(deaf.wait().is_success());
}

}  // namespace
}  // namespace scree
