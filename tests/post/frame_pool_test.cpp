// Work shared out over processes: order, errors and damage.
#include "post/run/frame_pool.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <csignal>
#include <numeric>
#include <set>

#include "core/base/error.hpp"

namespace scree {
namespace {

std::vector<std::size_t> first(std::size_t n) {
  std::vector<std::size_t> all(n);
  std::iota(all.begin(), all.end(), std::size_t{0});
  return all;
}

TEST(FramePool, results_come_in_order_whatever_the_number_of_processes) {
  for (const int jobs : {1, 2, 3, 7}) {
    std::vector<std::size_t> seen;
    std::set<double> processes;
    for_each_frame(
        first(20), {jobs, false},
        [](std::size_t f) {
          if (f % 3 == 0) usleep(3000);  // some are slow
          return bytes_of({static_cast<double>(f * f), static_cast<double>(getpid())});
        },
        [&](std::size_t f, const std::string& bytes) {
          const std::vector<double> values = doubles_of(bytes);
          EXPECT_EQ(values[0], static_cast<double>(f * f));
          processes.insert(values[1]);
          seen.push_back(f);
        });
    EXPECT_EQ(seen, first(20));
    EXPECT_EQ(processes.size(), static_cast<std::size_t>(jobs));
    EXPECT_EQ(processes.contains(getpid()), jobs == 1);
  }
}

TEST(FramePool, an_error_keeps_its_kind_and_text_and_is_the_first_in_order) {
  for (const int jobs : {1, 3}) {
    std::size_t last = 0;
    try {
      for_each_frame(
          first(9), {jobs, false},
          [](std::size_t f) -> std::string {
            if (f == 7) throw SystemError("disk of {}", f);
            if (f == 4) throw InputError("frame {} is broken", f);
            return "";
          },
          [&](std::size_t f, const std::string&) { last = f; });
      FAIL() << "nothing was thrown";
    } catch (const InputError& error) {
      EXPECT_STREQ(error.what(), "frame 4 is broken");
    }
    EXPECT_EQ(last, 3u);
  }
}

TEST(FramePool, damaged_frames_are_left_out_only_when_asked_and_named) {
  for (const int jobs : {1, 2}) {
    std::vector<std::size_t> seen;
    const FramePoolResult result = for_each_frame(
        first(5), {jobs, true},
        [](std::size_t f) -> std::string {
          if (f == 1) throw InputError("frame_000001.hdf is cut short");
          return "";
        },
        [&](std::size_t f, const std::string&) { seen.push_back(f); });
    EXPECT_EQ(seen, (std::vector<std::size_t>{0, 2, 3, 4}));
    EXPECT_EQ(result.skipped, std::vector<std::string>{"frame_000001.hdf is cut short"});
  }
}

TEST(FramePool, a_process_that_dies_is_an_error_and_not_a_wait) {
  const auto work = [] {
    for_each_frame(
        first(4), {2, true},
        [](std::size_t f) -> std::string {
          if (f == 2) kill(getpid(), SIGKILL);
          return "";
        },
        [](std::size_t, const std::string&) {});
  };
  EXPECT_THROW(work(), SystemError);
}

TEST(FramePool, large_results_pass_through_the_pipes) {
  std::size_t bytes = 0;
  for_each_frame(
      first(6), {2, false}, [](std::size_t f) { return std::string(1000000 + f, 'x'); },
      [&](std::size_t, const std::string& text) { bytes += text.size(); });
  EXPECT_EQ(bytes, 6000000u + 15u);
}

}  // namespace
}  // namespace scree
