// Importers may crash, hang or eat memory: the tool must outlive them.
#include "mesher/io/sandbox.hpp"

#include <gtest/gtest.h>

#include <chrono>
#include <csignal>
#include <thread>

#include "core/base/error.hpp"

namespace scree {
namespace {

std::string message_of(const std::function<std::vector<char>()>& work, const ChildLimits& limits = {}) {
  try {
    run_in_child("reading rock.stl", work, limits);
  } catch (const InputError& error) {
    return error.what();
  }
  return "no InputError";
}

#define EXPECT_SAYS(text, words) EXPECT_NE((text).find(words), std::string::npos) << "looked for '" << (words) << "' in\n" << (text)

TEST(Sandbox, bytes_of_any_number_come_back) {
  for (std::size_t size : {std::size_t{0}, std::size_t{1}, std::size_t{70000}, std::size_t{5000000}}) {
    std::vector<char> sent(size);
    for (std::size_t i = 0; i < size; ++i) sent[i] = static_cast<char>(i * 7);
    EXPECT_EQ(run_in_child("test", [&] { return sent; }), sent);
  }
}

TEST(Sandbox, an_error_in_the_child_arrives_with_its_own_words) {
  EXPECT_EQ(message_of([]() -> std::vector<char> { throw InputError("rock.stl: no facets"); }), "rock.stl: no facets");
}

TEST(Sandbox, a_crash_of_the_child_is_bad_input) {
  const std::string message = message_of([]() -> std::vector<char> {
    std::raise(SIGKILL);
    return {};
  });
  EXPECT_SAYS(message, "reading rock.stl: the importer crashed with signal 9");
}

TEST(Sandbox, a_child_that_hangs_is_ended) {
  const auto start = std::chrono::steady_clock::now();
  const std::string message = message_of(
      []() -> std::vector<char> {
        std::this_thread::sleep_for(std::chrono::seconds(30));
        return {};
      },
      {.memory_bytes = std::size_t{8} << 30, .seconds = 1});
  EXPECT_SAYS(message, "did not end within 1 s");
  EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::seconds(10));
}

TEST(Sandbox, a_child_that_computes_for_too_long_is_ended) {
  const auto start = std::chrono::steady_clock::now();
  const std::string message = message_of(
      []() -> std::vector<char> {
        volatile unsigned count = 0;
        for (;;) count = count + 1;
      },
      {.memory_bytes = std::size_t{8} << 30, .seconds = 60, .cpu_seconds = 0.25});
  EXPECT_SAYS(message, "did not end within 0.25 s of computing");
  EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::seconds(30));
}

TEST(Sandbox, a_child_that_asks_for_too_much_memory_is_refused) {
  if (!child_memory_is_limited()) GTEST_SKIP() << "no memory limit under this sanitizer";
  const std::string message =
      message_of([] { return std::vector<char>(std::size_t{3} << 30, 'x'); }, {.memory_bytes = std::size_t{1} << 30, .seconds = 60});
  EXPECT_SAYS(message, "ran out of memory at 1 GiB");
}

}  // namespace
}  // namespace scree
