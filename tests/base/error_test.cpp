#include "core/base/error.hpp"

#include <gtest/gtest.h>

#include <new>
#include <stdexcept>

namespace scree {
namespace {

// What run_main prints on stderr for a body that throws, and the code it returns.
template <class Thrown>
std::pair<int, std::string> outcome_of(const Thrown& thrown) {
  testing::internal::CaptureStderr();
  const int code = run_main("scree-test", [&]() -> int { throw thrown; });
  return {code, testing::internal::GetCapturedStderr()};
}

TEST(run_main, gives_each_kind_of_error_its_exit_code) {
  EXPECT_EQ(run_main("scree-test", [] { return 0; }), 0);
  EXPECT_EQ(run_main("scree-test", [] { return 143; }), 143);  // 128 + SIGTERM, decided by the body
  EXPECT_EQ(outcome_of(InternalError("x")).first, 1);
  EXPECT_EQ(outcome_of(UsageError("x")).first, 2);
  EXPECT_EQ(outcome_of(InputError("x")).first, 3);
  EXPECT_EQ(outcome_of(SystemError("x")).first, 4);
  EXPECT_EQ(outcome_of(RunInvalid("x")).first, 5);
  EXPECT_EQ(outcome_of(std::bad_alloc()).first, 4);
  EXPECT_EQ(outcome_of(std::logic_error("x")).first, 1);
  EXPECT_EQ(outcome_of(std::string("a text, as gmsh throws")).first, 3);
}

TEST(run_main, prints_the_tool_and_the_text_and_nothing_else) {
  EXPECT_EQ(outcome_of(InputError("rock.stl: {} open edges", 3)).second, "scree-test: error: rock.stl: 3 open edges\n");
}

TEST(warn_once, prints_the_same_text_only_the_first_time) {
  testing::internal::CaptureStderr();
  for (int i = 0; i < 3; ++i) warn_once("scree-test", "the skin is thin");
  warn_once("scree-test", "another matter");
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "scree-test: warning: the skin is thin\nscree-test: warning: another matter\n");
}

TEST(assertion, names_condition_place_and_values) {
  const int bodies = -1;
  try {
    SCREE_ASSERT(bodies >= 0, "bodies = {}", bodies);
    FAIL() << "the assertion did not fire";
  } catch (const InternalError& error) {
    const std::string text = error.what();
    EXPECT_NE(text.find("bodies >= 0"), std::string::npos) << text;
    EXPECT_NE(text.find("error_test.cpp"), std::string::npos) << text;
    EXPECT_NE(text.find("bodies = -1"), std::string::npos) << text;
  }
}

}  // namespace
}  // namespace scree
