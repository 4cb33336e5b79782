// Runs that differ by what was put into them, and fronts of error against time that are drawn by hand.
#include "post/studies/compare.hpp"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <cmath>
#include <sstream>

#include "core/base/error.hpp"
#include "post/studies/error_vs_time.hpp"
#include "tests/post/sample_run.hpp"

namespace scree {
namespace {

namespace fs = std::filesystem;

fs::path folder_of_test() { return fs::path(SCREE_TEST_FOLDER) / testing::UnitTest::GetInstance()->current_test_info()->name(); }

std::string text_of(const fs::path& path) {
  std::stringstream text;
  text << std::ifstream(path).rdbuf();
  return text.str();
}

/// The sample with every body shifted along x by shift(t) and turned about z by the same in radians.
void write_shifted(const fs::path& folder, const std::function<double(double)>& shift, double friction) {
  test::write_sample_run(folder);
  Scene scene = test::sample_scene(12);
  scene.pairs[0].friction = friction;
  write_scene_file((folder / "scene.h5").string(), scene);
  for (int n = 0; n < 3; ++n) {
    Frame frame = test::sample_frame(scene, n, 0.1 * n);
    for (std::size_t i = 0; i < frame.bodies.size(); ++i) {
      frame.bodies.position[i].x += shift(frame.time);
      frame.bodies.orientation[i] = quaternion_of(Vec3{0, 0, 1}, shift(frame.time)) * frame.bodies.orientation[i];
    }
    write_frame_file(MPI_COMM_SELF, (folder / fmt::format("frame_{:06}.hdf", n)).string(), frame);
  }
}

TEST(Compare, a_copy_is_the_same_bit_by_bit) {
  const fs::path folder = folder_of_test();
  test::write_sample_run(folder / "a.run");
  test::write_sample_run(folder / "b.run");
  const std::vector<scree::Run> runs{open_run((folder / "a.run").string()), open_run((folder / "b.run").string())};
  EXPECT_TRUE(setting_differences(runs).empty());
  const TrajectoryComparison t = compare_trajectories(runs[0], runs[1], {2, false});
  EXPECT_TRUE(t.identical());
  EXPECT_EQ(t.frames.size(), 3u);
  const Comparison c = compare_runs(runs, (folder / "out").string(), {1, false});
  EXPECT_NE(c.text.find("settings: no difference"), std::string::npos) << c.text;
  EXPECT_NE(c.text.find("bit by bit"), std::string::npos) << c.text;
}

TEST(Compare, settings_distances_and_growth_are_those_that_were_put_in) {
  const fs::path folder = folder_of_test();
  const auto shift = [](double t) { return 1e-6 * std::exp(20 * t); };
  test::write_sample_run(folder / "a.run");
  write_shifted(folder / "b.run", shift, 0.7);
  const std::vector<scree::Run> runs{open_run((folder / "a.run").string()), open_run((folder / "b.run").string())};
  const std::vector<SettingDifference> settings = setting_differences(runs);
  ASSERT_EQ(settings.size(), 1u);
  EXPECT_NE(settings[0].key.find("friction"), std::string::npos);
  EXPECT_EQ(settings[0].values, (std::vector<std::string>{"0.4", "0.7"}));
  const TrajectoryComparison t = compare_trajectories(runs[0], runs[1], {1, false});
  EXPECT_FALSE(t.identical());
  for (const Divergence& d : t.frames) {
    EXPECT_NEAR(d.rms, shift(d.time), 1e-12);
    EXPECT_NEAR(d.largest_angle, shift(d.time), 1e-12);
    EXPECT_EQ(d.bodies, 12u);
  }
  EXPECT_NEAR(t.growth_rate, 20, 1e-6);
  const Comparison c = compare_runs(runs, (folder / "out").string(), {1, false});
  for (const char* file : {"settings.csv", "statistics.csv", "divergence.csv", "divergence.svg", "comparison.json"})
    EXPECT_TRUE(fs::exists(folder / "out" / file)) << file;
  const nlohmann::json json = nlohmann::json::parse(text_of(folder / "out" / "comparison.json"));
  EXPECT_NEAR(json["trajectories"][0]["growth_rate"].get<double>(), 20, 1e-6);
  EXPECT_EQ(json["statistics"]["particle_count"]["apart"], false);
}

TEST(ErrorVsTime, the_front_holds_what_nothing_beats) {
  std::vector<StudyRow> rows{{"a", "", 1, 1e-1}, {"b", "", 2, 1e-2}, {"c", "", 3, 5e-2},
                             {"d", "", 4, 1e-3}, {"e", "", 2, 2e-2}, {"f", "", 5, 1e-3}};
  mark_front(rows);
  std::string front;
  for (const StudyRow& row : rows) front += row.on_front ? row.choice : "";
  EXPECT_EQ(front, "abd");
  EXPECT_EQ(best_for(rows, 1e-2), 1);
  EXPECT_EQ(best_for(rows, 5e-3), 3);
  EXPECT_EQ(best_for(rows, 1e-4), -1);
}

TEST(ErrorVsTime, a_study_gives_its_fronts_its_best_choices_and_a_chart) {
  const fs::path folder = folder_of_test();
  fs::create_directories(folder);
  std::ofstream(folder / "errors.csv")
      << "case,integrator,step,wall_median,error_traj,error_e\n"
         "# units: -,-,s,s,-,-\n"
         "top,euler,1e-3,0.1,-0.5,\ntop,euler,1e-4,1,0.05,\ntop,kdk-dlm,1e-3,0.2,0.001,\ntop,kdk-dlm,1e-4,2,1e-5,\nlone,euler,1e-3,1,1,\n";
  ErrorVsTimeOptions options;
  options.files = {(folder / "errors.csv").string()};
  options.folder = (folder / "out").string();
  options.targets = {0.1, 1e-6};
  const ErrorVsTimeResult result = write_error_vs_time(options);
  EXPECT_NE(result.text.find("top: error_traj <= 0.1: kdk-dlm, step 1e-3 (0.2 s, error 0.001)"), std::string::npos) << result.text;
  EXPECT_NE(result.text.find("no choice reaches it; the least is 1e-05"), std::string::npos) << result.text;
  EXPECT_NE(text_of(folder / "out" / "fronts.csv").find("top,error_traj,0.05,-,1,no,\"euler, step 1e-4\""), std::string::npos);
  EXPECT_NE(text_of(folder / "out" / "top-error_traj.svg").find("best for 0.1"), std::string::npos);
  EXPECT_FALSE(fs::exists(folder / "out" / "lone-error_traj.svg")) << "one run makes no front";
}

TEST(ErrorVsTime, what_is_no_table_of_a_study_is_named_with_its_line) {
  const fs::path folder = folder_of_test();
  fs::create_directories(folder);
  const auto message_of = [&](const std::string& content) {
    std::ofstream(folder / "errors.csv") << content;
    try {
      ErrorVsTimeOptions options;
      options.files = {(folder / "errors.csv").string()};
      options.folder = (folder / "out").string();
      write_error_vs_time(options);
    } catch (const InputError& error) {
      return std::string(error.what());
    }
    return std::string("nothing was thrown");
  };
  EXPECT_NE(message_of("time,error\n").find("errors.csv:1"), std::string::npos);
  EXPECT_NE(message_of("case,wall_median,error_e\na,1\n").find("errors.csv:2: 2 values found, 3 expected"), std::string::npos);
  EXPECT_NE(message_of("case,wall_median,error_e\na,1,0.1\na,fast,0.2\n").find("errors.csv:3: wall_median = 'fast'"), std::string::npos);
  EXPECT_NE(message_of("case,wall_median,error_e\na,1,0.1\n").find("at least two"), std::string::npos);
}

}  // namespace
}  // namespace scree
