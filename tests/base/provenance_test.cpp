#include "core/base/provenance.hpp"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <cstdio>
#include <filesystem>
#include <fstream>
#include <regex>

#include "core/base/error.hpp"
#include "core/base/long_work.hpp"
#include "core/base/progress.hpp"
#include "core/base/version.hpp"

namespace scree {
namespace {

// FIPS 180-2, appendix B.1, and the digest of the empty message.
constexpr const char* kHashOfAbc = "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad";
constexpr const char* kHashOfNothing = "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855";
// FIPS 180-2, appendix B.3: one million times the letter a (longer than the read buffer).
constexpr const char* kHashOfAMillionA = "cdc76e5c9914fb9281a1c7e284d73e67f1809a48a497200e046d39ccc7112cd0";

TEST(sha256, of_known_messages_is_as_published) {
  EXPECT_EQ(sha256_of_bytes("abc", 3), kHashOfAbc);
  EXPECT_EQ(sha256_of_bytes("", 0), kHashOfNothing);
}

TEST(sha256, of_a_file_is_that_of_its_bytes) {
  const std::filesystem::path path = std::filesystem::path(testing::TempDir()) / "scree_sha256_test.bin";
  std::ofstream(path, std::ios::binary) << std::string(1000000, 'a');
  EXPECT_EQ(sha256_of_file(path.string()), kHashOfAMillionA);
  std::filesystem::remove(path);
  EXPECT_THROW(sha256_of_file(path.string()), SystemError);
}

TEST(provenance, records_what_was_done_with_which_build_on_which_inputs) {
  Provenance provenance;
  provenance.format = "scree-shape";
  provenance.format_version = 3;
  provenance.tool = "scree-mesher";
  provenance.command = {"scree-mesher", "import", "rock.stl"};
  provenance.seed = 7;
  provenance.ranks = 2;
  provenance.inputs = {{"rock.stl", kHashOfAbc, nullptr}, {"a.shape.h5", kHashOfNothing, nlohmann::json{{"tool", "scree-mesher"}}}};
  const nlohmann::json record = provenance_record(provenance);
  EXPECT_EQ(record.at("format"), "scree-shape");
  EXPECT_EQ(record.at("format_version"), 3);
  EXPECT_EQ(record.at("command").at(2), "rock.stl");
  EXPECT_EQ(record.at("tool_version"), kVersion);
  EXPECT_EQ(record.at("git"), kGitHash);
  EXPECT_EQ(record.at("seed"), 7);
  EXPECT_EQ(record.at("ranks"), 2);
  EXPECT_EQ(record.at("inputs").at(0).at("sha256"), kHashOfAbc);
  EXPECT_EQ(record.at("inputs").at(1).at("history").at("tool"), "scree-mesher");
  EXPECT_TRUE(std::regex_match(record.at("utc").get<std::string>(), std::regex(R"(\d{4}-\d\d-\d\dT\d\d:\d\d:\d\dZ)")));
}

// Lines of a job of so many seconds, which tells how far it is a thousand times.
std::string told(double seconds) {
  Progress::Time now{};
  testing::internal::CaptureStderr();
  {
    Progress progress("solver", 1000.0, [&] { return now; });
    for (int step = 0; step <= 1000; ++step) {
      now = Progress::Time{} +
            std::chrono::duration_cast<std::chrono::steady_clock::duration>(std::chrono::duration<double>(seconds * step / 1000));
      progress.update(step, "busy");
    }
  }
  return testing::internal::GetCapturedStderr();
}

TEST(progress, writes_one_line_per_five_percent_when_nobody_watches) {
  const auto lines = [](const std::string& text) { return std::count(text.begin(), text.end(), '\n'); };
  const std::string text = told(100);
  EXPECT_EQ(lines(text), 21) << text;  // after three seconds, at 5 % or as soon as may be, 10 %, ... 100 %
  EXPECT_EQ(text.find('\r'), std::string::npos);
  EXPECT_NE(text.find("solver:   3 %  busy, 1 min 37 s left"), std::string::npos) << text;
  EXPECT_EQ(told(2.9), "") << "what takes no time";
  EXPECT_EQ(lines(told(10)), 3) << "one in three seconds, at the next 5 %";
  const std::string day = told(86400);
  EXPECT_EQ(day.find("solver:   0 %  busy, 23 h 58 min left\n"), 0u) << day.substr(0, 200);
  EXPECT_GT(lines(day), 86400 / 700) << "one in ten minutes, and each 5 %";
  EXPECT_LT(lines(day), 86400 / 600 + 20);
}

TEST(progress, long_work_speaks_when_it_takes_long_and_is_silent_else) {
  const auto lines_of = [](const char* after, double total, const std::function<void(LongWork&)>& work) {
    setenv("SCREE_PROGRESS_AFTER", after, 1);
    testing::internal::CaptureStderr();
    {
      LongWork outer("settle", total);
      work(outer);
    }
    unsetenv("SCREE_PROGRESS_AFTER");
    return testing::internal::GetCapturedStderr();
  };
  const auto hundred = [](LongWork& work) {
    for (int i = 1; i <= 100; ++i) {
      work.update(i, fmt::format("{} of 100 bodies", i));
      LongWork inner("check", 2);  // work inside other work
      inner.advance();
    }
  };
  EXPECT_EQ(lines_of("0", 100, hundred), "") << "before main asked for it";
  print_progress(true);
  EXPECT_EQ(lines_of("3600", 100, hundred), "");
  const std::string text = lines_of("0", 100, hundred);
  EXPECT_EQ(std::count(text.begin(), text.end(), '\n'), 22) << text;  // the first, every 5 %, and the end
  EXPECT_NE(text.find("settle:  40 %  40 of 100 bodies, 0.0 s left\n"), std::string::npos) << text;
  EXPECT_NE(text.find("settle: done in 0.0 s\n"), std::string::npos) << text;
  EXPECT_EQ(text.find("check"), std::string::npos);
  EXPECT_NE(lines_of("0", 0, [](LongWork& work) { work.update(0, "3 holes"); }).find("settle:  3 holes, 0.0 s so far\n"),
            std::string::npos);
  const std::string still = lines_of("0", 0, [](LongWork& work) {
    for (int i = 0; i < 5; ++i) work.update(0, i < 4 ? "3 bodies come to rest" : "2 bodies come to rest");
  });
  EXPECT_EQ(std::count(still.begin(), still.end(), '\n'), 3) << "a line that does not change is there once\n" << still;
  print_progress(false);
}

TEST(progress, writes_durations_as_people_say_them) {
  EXPECT_EQ(format_duration(0.84), "0.8 s");
  EXPECT_EQ(format_duration(42.2), "42 s");
  EXPECT_EQ(format_duration(192.0), "3 min 12 s");
  EXPECT_EQ(format_duration(3840.0), "1 h 04 min");
  EXPECT_EQ(format_duration(59.7), "1 min 00 s");
  EXPECT_EQ(format_duration(99 * 3600.0 + 60), "99 h 01 min");
  EXPECT_EQ(format_duration(13391880.0), "155 days");
}

}  // namespace
}  // namespace scree
