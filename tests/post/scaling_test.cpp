// Strong and weak scaling from tables whose every number is known.
#include "post/studies/scaling.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>

#include "core/base/error.hpp"

namespace scree {
namespace {

namespace fs = std::filesystem;

/// A run of 100 steps whose ranks take `busy` seconds each for contacts, wait for the slowest, and had another start before a restart.
std::string make_run(const std::string& name, int threads, const std::vector<double>& busy, int bodies_each) {
  const fs::path folder = fs::path(SCREE_TEST_FOLDER) / "scaling" / (name + ".run");
  fs::create_directories(folder);
  std::ofstream(folder / "run.json") << R"({"format_version": 1, "ranks": )" << busy.size() << R"(, "threads": )" << threads
                                     << R"(, "parallel": {"halo": "overlap", "send": "selected", "cut": "rcb"}})";
  std::ofstream table(folder / "ranks.csv");
  table << "step,rank,bodies,ghosts,neighbours,contacts,computing,t_sort,t_contact,t_twice,t_gather,t_wait,t_agree,t_output,messages,bytes,"
           "renewal_bytes,migrated,body_bytes,ghost_bytes,peak_rss\n# units: -,-\n";
  const double slowest = *std::max_element(busy.begin(), busy.end());
  const auto row = [&](int step, std::size_t r, double share) {
    table << step << "," << r << "," << bodies_each << ",10,1,5," << share * busy[r] << "," << 0.01 * share << "," << share * busy[r] << ","
          << 0.02 * share << "," << 0.03 * share << "," << share * (slowest - busy[r]) << ",0," << 7 * share << ",100," << 5000 * share
          << ",0,0," << 3000 * bodies_each << ",20000,1\n";
  };
  for (std::size_t r = 0; r < busy.size(); ++r) row(50, r, 9);  // before the restart: times begin again after it
  for (std::size_t r = 0; r < busy.size(); ++r) row(100, r, 0.5);
  for (std::size_t r = 0; r < busy.size(); ++r) row(200, r, 1.5);
  return folder.string();
}

TEST(Scaling, reads_the_time_of_a_step_from_the_rows_after_the_last_restart) {
  const ScalingRow row = read_scaling_row(make_run("two", 1, {1.0, 0.6}, 40));
  EXPECT_EQ(row.steps, 100);
  EXPECT_EQ(row.bodies, 80);
  EXPECT_DOUBLE_EQ(row.step_seconds, (1.0 + 0.06) / 100);
  EXPECT_DOUBLE_EQ(row.wait_seconds, 0.4 / 2 / 100);
  EXPECT_NEAR(row.determinism, 2 * 0.06 / (2 * 1.06), 1e-12);
  EXPECT_NEAR(row.imbalance, 1.0 / 0.8, 1e-12);
  EXPECT_DOUBLE_EQ(row.bytes, 50);
  EXPECT_DOUBLE_EQ(row.body_bytes, 3000);
  EXPECT_DOUBLE_EQ(row.ghost_bytes, 2000);
  EXPECT_EQ(row.strategy, "overlap/selected/rcb");
}

TEST(Scaling, writes_a_table_and_both_charts) {
  const std::string folder = (fs::path(SCREE_TEST_FOLDER) / "scaling" / "out").string();
  const std::string table =
      write_scaling({make_run("one", 1, {2.0}, 80), make_run("two", 1, {1.0, 1.0}, 40), make_run("threads", 2, {1.1}, 160)}, folder);
  EXPECT_NE(table.find("two.run,overlap/selected/rcb,80,2,1,100,0.0106,"), std::string::npos) << table;
  const auto text = [&](const std::string& name) {
    std::ifstream stream(folder + "/" + name);
    return std::string(std::istreambuf_iterator<char>(stream), {});
  };
  EXPECT_NE(text("strong.svg").find("80 bodies"), std::string::npos);
  EXPECT_EQ(text("strong.svg").find("160 bodies"), std::string::npos) << "one run makes no line";
  EXPECT_NE(text("weak.svg").find("80 bodies per core"), std::string::npos);
  EXPECT_EQ(text("scaling.csv"), table);
}

TEST(Scaling, refuses_a_run_without_its_tables_and_names_the_file) {
  EXPECT_THROW(read_scaling_row("nowhere.run"), InputError);
  const std::string run = make_run("cut", 1, {1.0}, 40);
  fs::remove(run + "/ranks.csv");
  try {
    read_scaling_row(run);
    FAIL();
  } catch (const InputError& e) {
    EXPECT_NE(std::string(e.what()).find("ranks.csv"), std::string::npos);
  }
}

}  // namespace
}  // namespace scree
