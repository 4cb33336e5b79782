// Tables, verdicts and the report from a run that was made up by hand, whole and spoilt.
#include "post/run/run_folder.hpp"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <cstdlib>
#include <cstring>
#include <regex>
#include <sstream>

#include "core/chart/svg_chart.hpp"
#include "post/report/report.hpp"
#include "post/report/verdicts.hpp"
#include "post/run/provenance_chain.hpp"
#include "post/statistics/tables.hpp"
#include "tests/post/sample_run.hpp"

namespace scree {
namespace {

namespace fs = std::filesystem;

class RunFolder : public testing::Test {
 protected:
  void SetUp() override {
    const std::string name = testing::UnitTest::GetInstance()->current_test_info()->name();
    folder = fs::path(SCREE_TEST_FOLDER) / name / "sample.run";
    test::write_sample_run(folder);
  }
  std::string beside(const std::string& name) const { return (folder.parent_path() / name).string(); }
  std::string message_of(const std::function<void()>& action) const {
    try {
      action();
    } catch (const InputError& error) {
      return error.what();
    }
    return "nothing was thrown";
  }
  fs::path folder;
};

std::string text_of(const fs::path& path) {
  std::ifstream stream(path);
  std::stringstream text;
  text << stream.rdbuf();
  return text.str();
}

std::vector<std::vector<double>> numbers_of(const std::string& path, std::string& header) {
  std::ifstream stream(path);
  std::getline(stream, header);
  std::vector<std::vector<double>> rows;
  for (std::string line; std::getline(stream, line);) {
    rows.emplace_back();
    std::stringstream words(line);
    for (std::string word; std::getline(words, word, ',');) rows.back().push_back(std::strtod(word.c_str(), nullptr));
  }
  return rows;
}

TEST_F(RunFolder, the_bodies_table_gives_back_every_bit) {
  const auto run = open_run(folder.string());
  write_bodies_table(run, beside("bodies.csv"));
  std::string header;
  const auto rows = numbers_of(beside("bodies.csv"), header);
  EXPECT_EQ(header, "time,id,x,y,z,vx,vy,vz,qw,qx,qy,qz,wx,wy,wz");
  ASSERT_EQ(rows.size(), 36u);
  const Scene scene = test::sample_scene(12);
  for (std::size_t r = 0; r < rows.size(); ++r) {
    const double time = 0.1 * static_cast<double>(static_cast<int>(r / 12));
    const Frame expected = test::sample_frame(scene, 0, time);
    const std::size_t i = r % 12;
    const Vec3 &x = expected.bodies.position[i], &v = expected.bodies.velocity[i], &w = expected.bodies.angular_velocity[i];
    const Quat& q = expected.bodies.orientation[i];
    EXPECT_EQ(rows[r],
              (std::vector<double>{time, static_cast<double>(i), x.x, x.y, x.z, v.x, v.y, v.z, q.w, q.x, q.y, q.z, w.x, w.y, w.z}));
  }
}

TEST_F(RunFolder, the_contacts_table_has_the_agreed_columns_and_every_bit) {
  write_contacts_table(open_run(folder.string()), beside("contacts.csv"));
  std::string header;
  const auto rows = numbers_of(beside("contacts.csv"), header);
  EXPECT_EQ(header, "time,body_a,body_b,feature,x,y,z,nx,ny,nz,depth,fn,ftx,fty,ftz");
  ASSERT_EQ(rows.size(), 22u);  // none in the first frame, 11 in each of two
  const Vec3 n = normalised(Vec3{1, 3, 2});
  EXPECT_EQ(rows[3], (std::vector<double>{0.1, 3, 4, 9, 0.1, 0.2, 1.0 / 3.0, n.x, n.y, n.z, 1e-4, 4, 0, 0, 0}));
}

TEST_F(RunFolder, a_run_without_run_json_is_read_and_said_to_be_unfinished) {
  fs::remove(folder / "run.json");
  const auto run = open_run(folder.string());
  EXPECT_FALSE(run.is_finished());
  EXPECT_NE(run.notice().find("still being written"), std::string::npos);
  EXPECT_EQ(run.frames.size(), 3u);
  write_report(run, beside("report.html"), {});
  EXPECT_NE(text_of(beside("report.html")).find("not finished"), std::string::npos);
}

TEST_F(RunFolder, a_half_written_last_line_of_the_log_is_left_out) {
  std::ofstream(folder / "log.csv", std::ios::app) << "300,0.3,1,";
  EXPECT_EQ(open_run(folder.string()).log.rows(), 3u);
  std::ofstream(folder / "log.csv") << test::log_header()
                                    << "0,0,0,0,20,0,0,0,0,0,0,0,1,0,0,0,aa\n100,0.1,8,2,5,0.5,0,4.5,0,0,12,0.3,1.2,0.5,2.5,1000,b";
  EXPECT_EQ(open_run(folder.string()).log.rows(), 1u) << "a line without its end may be cut inside a number";
}

TEST_F(RunFolder, a_broken_line_inside_the_log_is_an_error_with_its_number) {
  std::ofstream(folder / "log.csv") << test::log_header() << "0,0,0\n100,0.1,8,2,5,0.5,0,4.5,0,0,12,0.3,1.2,0.5,2.5,1000,bb\n";
  EXPECT_NE(message_of([&] { open_run(folder.string()); }).find("log.csv:3"), std::string::npos);
}

TEST_F(RunFolder, a_truncated_frame_is_named) {
  fs::resize_file(folder / "frame_000001.hdf", fs::file_size(folder / "frame_000001.hdf") / 2);
  const auto run = open_run(folder.string());
  EXPECT_NE(message_of([&] { write_bodies_table(run, beside("bodies.csv")); }).find("frame_000001.hdf"), std::string::npos);
  EXPECT_FALSE(fs::exists(beside("bodies.csv"))) << "a table that is not whole must not be there";
}

TEST_F(RunFolder, a_newer_run_is_refused_with_both_versions) {
  std::ofstream(folder / "run.json") << R"({"format": "scree-run", "format_version": 2})";
  const std::string message = message_of([&] { open_run(folder.string()); });
  EXPECT_NE(message.find("version 2"), std::string::npos) << message;
  EXPECT_NE(message.find("up to version 1"), std::string::npos) << message;
}

TEST_F(RunFolder, a_missing_folder_scene_or_frame_list_is_named) {
  EXPECT_NE(message_of([&] { open_run(beside("nowhere.run")); }).find("nowhere.run"), std::string::npos);
  fs::remove(folder / "frames.hdf.series");
  EXPECT_NE(message_of([&] { open_run(folder.string()); }).find("frames.hdf.series"), std::string::npos);
  fs::remove(folder / "scene.h5");
  EXPECT_NE(message_of([&] { open_run(folder.string()); }).find("scene.h5"), std::string::npos);
}

TEST_F(RunFolder, a_frame_that_does_not_fit_the_scene_is_refused) {
  Scene scene = test::sample_scene(12);
  scene.shapes.resize(1);
  std::fill(scene.bodies.shape.begin(), scene.bodies.shape.end(), 0);
  write_scene_file((folder / "scene.h5").string(), scene);
  const auto run = open_run(folder.string());
  EXPECT_NE(message_of([&] { load_frame(run, 0); }).find("do not belong together"), std::string::npos);
}

TEST_F(RunFolder, frames_are_found_by_the_number_in_their_name) {
  const auto run = open_run(folder.string());
  EXPECT_EQ(find_frame(run, 1), 1u);
  EXPECT_EQ(find_frame(run, -1), 2u);
  EXPECT_THROW(find_frame(run, 7), UsageError);
}

// verdicts: limits of the project's acceptance on a log whose extremes are known

const Verdict& verdict(const std::vector<Verdict>& all, const std::string& question) {
  for (const Verdict& v : all) {
    if (v.question == question) return v;
  }
  throw std::runtime_error("no verdict on " + question);
}

TEST_F(RunFolder, a_sound_run_is_judged_good_throughout) {
  const std::vector<Verdict> all = judge(open_run(folder.string()));
  for (const Verdict& v : all) EXPECT_EQ(v.judgement, Judgement::good) << v.question << ": " << v.answer;
  EXPECT_EQ(verdict(all, "Step margin").answer, "0.05 of the critical step");
  EXPECT_EQ(verdict(all, "Energy balance").answer, "closed to 0 %");  // 0.05 J, a tenth of what its contacts hold, and none at the end
  EXPECT_EQ(verdict(all, "Contact overlap").answer, "at most 0.250 of the margin");
  EXPECT_EQ(verdict(all, "Came to rest").answer, "yes");  // 1e-7 J of a peak of 10 J
}

TEST_F(RunFolder, a_file_that_is_missing_or_changed_is_told_in_the_verdicts) {
  fs::remove(beside("my rock.stl"));
  const Verdict missing = verdict(judge(open_run(folder.string())), "Files behind the run");
  EXPECT_EQ(missing.judgement, Judgement::doubtful);
  EXPECT_EQ(missing.answer, "2 of 3 as they were");
  EXPECT_NE(missing.evidence.find("my rock.stl"), std::string::npos) << missing.evidence;
  std::ofstream(beside("rock.shape.h5")) << "another rock";
  const Verdict changed = verdict(judge(open_run(folder.string())), "Files behind the run");
  EXPECT_EQ(changed.judgement, Judgement::bad);
  EXPECT_NE(changed.evidence.find("changed since"), std::string::npos) << changed.evidence;
}

TEST_F(RunFolder, a_frame_that_was_left_out_is_told_in_the_verdicts) {
  fs::resize_file(folder / "frame_000001.hdf", 3000);
  auto run = open_run(folder.string());
  drop_damaged_frames(run);
  EXPECT_EQ(run.frames.size(), 2u);
  const Verdict v = verdict(judge(run), "Frames");
  EXPECT_EQ(v.answer, "1 of 3 left out");
  EXPECT_NE(v.evidence.find("frame_000001.hdf"), std::string::npos) << v.evidence;
}

TEST_F(RunFolder, the_page_and_its_json_tell_the_same_numbers) {
  const ReportResult result = write_report(open_run(folder.string()), beside("report.html"), {});
  const std::string html = text_of(beside("report.html"));
  EXPECT_NE(html.find("Waited for cores"), std::string::npos);
  EXPECT_EQ((*result.numbers)["cost"]["slowdown"], 12.0);
  const nlohmann::json& all = (*result.numbers)["statistics"]["groups"]["all"];
  for (const char* name : {"coordination_number", "mean_normal_force", "fabric_zz", "solid_fraction"}) {
    const std::string cell = fmt::format("{}</td><td class=\"n\">{:.5g}<", name, all[name]["mean"].get<double>());
    EXPECT_NE(html.find(cell), std::string::npos) << cell;
  }
  for (const nlohmann::json& v : (*result.numbers)["verdicts"])
    EXPECT_NE(html.find(escaped(v["answer"].get<std::string>())), std::string::npos) << v;
  EXPECT_EQ((*result.numbers)["files"].size(), 3u);
}

TEST_F(RunFolder, each_fault_spoils_its_own_verdict) {
  std::ofstream(folder / "log.csv") << test::sample_log(-2.0, 1e-3, 1.25);  // 10 %, moving, surfaces met
  Scene scene = test::sample_scene(12);
  scene.shapes[1].verdict = nlohmann::json{{"solid", false}};
  write_scene_file((folder / "scene.h5").string(), scene);
  nlohmann::json outcome = test::sample_outcome(scene, test::sample_frame(scene, 0, 0));
  outcome["outcome"] = "invalid";
  outcome["lost_bodies"] = 2;
  std::ofstream(folder / "run.json") << outcome;
  const std::vector<Verdict> all = judge(open_run(folder.string()));
  EXPECT_EQ(verdict(all, "Outcome").judgement, Judgement::bad);
  EXPECT_EQ(verdict(all, "Energy balance").judgement, Judgement::bad);
  EXPECT_EQ(verdict(all, "Contact overlap").judgement, Judgement::bad);
  EXPECT_EQ(verdict(all, "Came to rest").judgement, Judgement::information);
  EXPECT_EQ(verdict(all, "Lost bodies").judgement, Judgement::bad);
  EXPECT_EQ(verdict(all, "Mesh certificates").judgement, Judgement::bad);
}

TEST_F(RunFolder, a_solid_with_triangles_that_cross_is_not_said_to_be_without) {
  EXPECT_NE(verdict(judge(open_run(folder.string())), "Mesh certificates").evidence.find("without crossing surfaces"), std::string::npos);
  Scene scene = test::sample_scene(12);
  scene.shapes[0].verdict = nlohmann::json{{"solid", true}, {"watertight", true}, {"self_intersections", 6}};
  write_scene_file((folder / "scene.h5").string(), scene);
  const Verdict v = verdict(judge(open_run(folder.string())), "Mesh certificates");
  EXPECT_EQ(v.judgement, Judgement::doubtful);
  EXPECT_EQ(v.answer, "3 of 3 solid, with triangles that cross");
  EXPECT_EQ(v.evidence.find("without crossing"), std::string::npos) << v.evidence;
  EXPECT_NE(v.evidence.find("box (6 pairs)"), std::string::npos) << v.evidence;
  EXPECT_NE(v.evidence.find("scree-mesher repair"), std::string::npos) << v.evidence;
}

TEST_F(RunFolder, a_step_is_judged_by_what_it_costs_and_the_cure_is_named) {
  const auto judged = [&](double ratio, double steps, double given = 0) {
    Scene scene = test::sample_scene(12);
    scene.settings.steps_per_contact = steps;
    scene.settings.step = given;
    write_scene_file((folder / "scene.h5").string(), scene);
    nlohmann::json outcome = test::sample_outcome(scene, test::sample_frame(scene, 0, 0));
    outcome["step_size"] = 1e-3;
    outcome["critical_step"] = 1e-3 / ratio;
    std::ofstream(folder / "run.json") << outcome;
    return verdict(judge(open_run(folder.string())), "Step margin");
  };
  // a grain among many neighbours with the 12 steps of the ready cases
  const Verdict ready = judged(0.82, 12);
  EXPECT_EQ(ready.judgement, Judgement::good);
  EXPECT_NE(ready.evidence.find("errs by up to 16.8 %"), std::string::npos) << ready.evidence;
  EXPECT_NE(ready.evidence.find("takes 12 steps or more: its restitution errs by up to 0.01."), std::string::npos) << ready.evidence;
  EXPECT_EQ(ready.evidence.find("steps_per_contact"), std::string::npos) << ready.evidence;
  const Verdict coarse = judged(1.1, 12);
  EXPECT_EQ(coarse.judgement, Judgement::doubtful);
  EXPECT_NE(coarse.evidence.find("give time.steps_per_contact = 15."), std::string::npos) << coarse.evidence;
  EXPECT_EQ(judged(1.4, 12).judgement, Judgement::bad);
  const Verdict few = judged(0.25, 6);  // stable, but single impacts miss the 2.3e-2 of the validation plan
  EXPECT_EQ(few.judgement, Judgement::doubtful);
  EXPECT_NE(few.evidence.find("give time.steps_per_contact = 8."), std::string::npos) << few.evidence;
  const Verdict given = judged(1.2, 30, 1e-3);
  EXPECT_NE(given.evidence.find("give time.step = 0.00075 s"), std::string::npos) << given.evidence;
  EXPECT_EQ(given.evidence.find("An impact takes"), std::string::npos) << given.evidence;
  EXPECT_NEAR(restitution_error(12), 0.012, 1e-12);
  EXPECT_NEAR(restitution_error(16), std::sqrt(0.012 * 0.006), 1e-3);
}

TEST_F(RunFolder, an_inlet_that_had_no_room_is_doubtful) {
  const Scene scene = test::sample_scene(12);
  const auto judged = [&](double missing) {
    write_scene_file((folder / "scene.h5").string(), scene);
    std::ofstream(folder / "run.json") << test::sample_outcome(scene, test::sample_frame(scene, 0, 0));
    scree::Run run = open_run(folder.string());
    (*run.outcome)["inlets"] = {
        {{"bodies", 3}, {"mass", 0.02}, {"owed", 1.0}, {"shortfall", missing}, {"times_blocked", missing > 0 ? 2673 : 0}},
        {{"bodies", 7}, {"mass", 0.1}, {"owed", 7}, {"shortfall", 0}, {"times_blocked", 1}}};
    run.scene.inlets.resize(2);
    run.scene.inlets[0].name = "feed";
    run.scene.inlets[1].name = "dust";
    run.scene.inlets[1].rate.by_number = true;
    return verdict(judge(run), "Inlets");
  };
  const Verdict blocked = judged(0.98), met = judged(0), nearly = judged(0.005);
  EXPECT_EQ(blocked.judgement, Judgement::doubtful);
  EXPECT_EQ(blocked.answer, "98 % of 'feed' found no room");
  EXPECT_NE(blocked.evidence.find("0.98 of 1 kg found no room by the end, and 2673 times there was none"), std::string::npos)
      << blocked.evidence;
  EXPECT_EQ(met.judgement, Judgement::good);
  EXPECT_EQ(met.answer, "all came in that was due");
  EXPECT_EQ(nearly.judgement, Judgement::good);
  EXPECT_EQ(nearly.answer, "0.5 % of 'feed' found no room");
}

TEST_F(RunFolder, walls_that_answer_to_force_are_judged_by_the_force_that_they_hold) {
  const auto judged = [&](double force, double way, const nlohmann::json& note) {
    Scene scene = test::sample_scene(12);
    scene.walls[1].motion = {};
    scene.walls[1].motion.kind = Servo{.direction = {0, 0, -1}, .force = 100, .max_speed = 0.1, .stroke = {-0.5, 0.2}};
    write_scene_file((folder / "scene.h5").string(), scene);
    const std::string wall = fmt::format("wall{}_", scene.walls[1].id);
    std::string log = "step,time", units = "# units: -,s";
    for (const char* name : {"force_x", "force_y", "force_z", "torque_x", "torque_y", "torque_z"}) {
      log += "," + wall + name;
      units += ",N";
    }
    log += ",kinetic_translational,kinetic_rotational,potential\n" + units + ",J,J,J\n";
    for (int i = 0; i <= 20; ++i) log += fmt::format("{},{},0,0,{},0,0,0,0,0,0\n", i, 0.01 * i, i < 18 ? 0 : force);
    std::ofstream(folder / "log.csv") << log;
    nlohmann::json outcome = test::sample_outcome(scene, test::sample_frame(scene, 0, 0));
    outcome["drives"] = {{{"wall", scene.walls[1].id},
                          {"name", "lid"},
                          {"kind", "servo"},
                          {"way", way},
                          {"rate", 0},
                          {"force", -force},
                          {"at_end", way == 0.2 ? nlohmann::json("highest") : nlohmann::json()},
                          {"asked", 100},
                          {"note", note}}};
    std::ofstream(folder / "run.json") << outcome;
    return verdict(judge(open_run(folder.string())), "Walls under force");
  };
  const Verdict held = judged(100.02, 0.0324, nullptr);  // the log's force is on the wall: upward, against its direction
  EXPECT_EQ(held.judgement, Judgement::good) << held.evidence;
  EXPECT_EQ(held.answer, "1 of 1 servo holds the force requested");
  EXPECT_EQ(held.evidence,
            "'lid' (servo) ends 32.4 mm from where it was placed; it presses with 100 N of 100 N requested (100 N on average over the last "
            "tenth of the run).");
  const Verdict idle = judged(0, 0.05, "wall 'lid': its servo touches nothing");
  EXPECT_EQ(idle.judgement, Judgement::doubtful);
  EXPECT_NE(idle.evidence.find("it touches nothing"), std::string::npos) << idle.evidence;
  const Verdict stopped = judged(30, 0.2, "wall 'lid': its servo is at the end of its way");
  EXPECT_EQ(stopped.judgement, Judgement::doubtful);
  EXPECT_NE(stopped.evidence.find("at the highest end of its way; it presses with 30 N of 100 N requested"), std::string::npos)
      << stopped.evidence;
  EXPECT_EQ(judged(80, 0.1, nullptr).judgement, Judgement::doubtful) << "its bed still gives way";
}

TEST_F(RunFolder, rest_is_judged_where_the_case_asks_for_it) {
  const auto verdict_of = [&](bool asked, const nlohmann::json& rested) {
    Scene scene = test::sample_scene(12);
    scene.settings.stop_at_rest = asked;
    write_scene_file((folder / "scene.h5").string(), scene);
    std::ofstream(folder / "log.csv") << test::sample_log(0.05, 1e-3, 0.25);  // 1e-4 of the peak
    nlohmann::json outcome = test::sample_outcome(scene, test::sample_frame(scene, 0, 0));
    if (!rested.is_null()) outcome["came_to_rest"] = rested;
    std::ofstream(folder / "run.json") << outcome;
    return verdict(judge(open_run(folder.string())), "Came to rest");
  };
  EXPECT_EQ(verdict_of(false, nullptr).answer, "no; the case does not require it");
  EXPECT_EQ(verdict_of(false, nullptr).judgement, Judgement::information);
  EXPECT_EQ(verdict_of(true, true).answer, "yes, after 0.2 s");
  EXPECT_EQ(verdict_of(true, true).judgement, Judgement::good);
  EXPECT_EQ(verdict_of(true, false).answer, "no, still moving at the end of the duration");
  EXPECT_EQ(verdict_of(true, false).judgement, Judgement::doubtful);
  EXPECT_EQ(verdict_of(true, nullptr).answer, "known at the end");  // a run in progress, or of a solver that did not tell
}

TEST_F(RunFolder, the_energy_is_judged_by_what_lasts_and_against_what_is_in_play) {
  const auto judged = [&](const std::string& rows) {
    std::ofstream(folder / "log.csv") << test::log_header() + rows;
    return verdict(judge(open_run(folder.string())), "Energy balance");
  };
  // columns: step, time, kinetic (2), potential, elastic (2), dissipated, wall work, error, ...
  const std::string rest = ",1,0.1,1,1,0,0,aa\n";
  // a ball that falls 1 J, presses in a contact (the step's error: 3.7 % of its energy) and flies on with .2 % more
  const std::string bounce = "0,0,0,0,1,0,0,0,0,0" + rest + "1,1,1,0,0,0,0,0,0,0.0005" + rest + "2,2,0.05,0,0,0.913,0,0,0,-0.037" + rest;
  EXPECT_EQ(judged(bounce + "3,3,1,0,0,0,0,0,0,0.002" + rest).answer, "closed to 0.2 %");
  EXPECT_EQ(judged(bounce + "3,3,1,0,0,0,0,0,0,0.002" + rest).judgement, Judgement::good);
  EXPECT_NE(judged(bounce + "3,3,1,0,0,0,0,0,0,0.002" + rest).evidence.find("3.7 %"), std::string::npos);
  EXPECT_EQ(judged(bounce + "3,3,1,0,0,0,0,0,0,0.1" + rest).judgement, Judgement::bad);  // it lasts
  EXPECT_EQ(judged(bounce).judgement, Judgement::doubtful);                              // as it ends, it counts
  EXPECT_EQ(judged("0,0,1,0,0,0,0,0,0,0" + rest + "1,1,1,0,0,0.1,0,0,0,0.5" + rest + "2,2,1,0,0,0,0,0,0,0" + rest).judgement,
            Judgement::bad);  // no contact explains it
  // nothing moves: rounding of the potential energy of 1 J against 1e-22 J of motion
  EXPECT_EQ(judged("0,0,0,0,1,0,0,0,0,0" + rest + "1,1,1e-22,0,1,0,0,0,0,1.5e-17" + rest).judgement, Judgement::good);
}

TEST_F(RunFolder, bodies_that_fall_past_a_plate_are_told) {
  Scene scene = test::sample_scene(12);
  scene.shapes.push_back(make_surface("plate", box_mesh({0.3, 0.3, 0.01})));
  scene.walls.resize(1);
  scene.walls[0].kind = WallKind::mesh;
  scene.walls[0].shape = 3;
  const auto judged = [&](double height, bool with_floor) {
    Scene changed = scene;
    if (with_floor) {
      changed.walls.push_back(Wall{});
      changed.walls.back().id = changed.walls[0].id + 1;
      changed.walls.back().point = {0, 0, -100};
    }
    write_scene_file((folder / "scene.h5").string(), changed);
    Frame frame = test::sample_frame(changed, 2, 0.2);
    for (std::size_t i = 0; i < 11; ++i) frame.bodies.position[i].z = height;
    write_frame_file(MPI_COMM_SELF, (folder / "frame_000002.hdf").string(), frame);
    return verdict(judge(open_run(folder.string())), "Lost bodies");
  };
  EXPECT_EQ(judged(-5, false).answer, "11 of 12 fall below all walls");
  EXPECT_EQ(judged(-5, false).judgement, Judgement::doubtful);
  EXPECT_EQ(judged(-5, true).answer, "none");  // a floor far below holds them
  EXPECT_EQ(judged(0.05, false).answer, "none");
  EXPECT_EQ(judged(0.05, false).judgement, Judgement::good);
}

// the page

TEST_F(RunFolder, the_report_needs_nothing_from_outside) {
  write_report(open_run(folder.string()), beside("report.html"), {});
  const std::string html = text_of(beside("report.html"));
  EXPECT_EQ(html.find("src=\"http"), std::string::npos);
  EXPECT_EQ(html.find("href=\"http"), std::string::npos);
  EXPECT_EQ(html.find("url("), std::string::npos);
  EXPECT_EQ(html.find("<script src"), std::string::npos);
  EXPECT_EQ(html.find("fetch("), std::string::npos);
  for (const char* not_a_number : {" nan", ">nan", "-nan", "\"nan", ">inf", " inf "})
    EXPECT_EQ(html.find(not_a_number), std::string::npos) << not_a_number;
}

TEST_F(RunFolder, the_report_escapes_what_the_user_wrote) {
  write_report(open_run(folder.string()), beside("report.html"), {});
  const std::string html = text_of(beside("report.html"));
  EXPECT_EQ(html.find("<sample>"), std::string::npos);
  EXPECT_NE(html.find("a &lt;sample&gt; &amp; its report"), std::string::npos);
}

TEST_F(RunFolder, the_report_tells_the_chain_down_to_the_first_hash_and_how_to_repeat_it) {
  write_report(open_run(folder.string()), beside("report.html"), {});
  const std::string html = text_of(beside("report.html"));
  for (const char* content : {"solid rock", "shapes of rock", "a scene"}) {
    EXPECT_NE(html.find("sha256 " + sha256_of_bytes(content, std::strlen(content))), std::string::npos) << content;
  }
  EXPECT_NE(html.find("mpirun -n 2 scree-solver sample.scene.h5 -o sample.run"), std::string::npos);
  EXPECT_NE(html.find("cafe0123"), std::string::npos);
}

TEST_F(RunFolder, commands_come_in_the_order_in_which_they_must_be_given) {
  const Frame frame = load_frame(open_run(folder.string()), 0);
  EXPECT_EQ(commands_of(frame.provenance),
            (std::vector<std::string>{"scree-mesher import 'my rock.stl' -o rock.shape.h5",
                                      "scree-decomposer pack sample.toml -o sample.scene.h5",
                                      "OMP_NUM_THREADS=1 mpirun -n 2 scree-solver sample.scene.h5 -o sample.run"}));
}

TEST(ProvenanceChain, a_continued_run_is_repeated_from_its_start) {
  nlohmann::json record = {{"tool", "scree-solver"}, {"ranks", 4}, {"threads", 2}};
  for (const nlohmann::json& restart : {nlohmann::json{"--restart", "latest"}, nlohmann::json{"--restart=latest"}}) {
    record["command"] = {"scree-solver", "a.scene.h5"};
    for (const nlohmann::json& w : restart) record["command"].push_back(w);
    record["command"].push_back("-o");
    record["command"].push_back("a.run");
    EXPECT_EQ(commands_of(record), (std::vector<std::string>{"OMP_NUM_THREADS=2 mpirun -n 4 scree-solver a.scene.h5 -o a.run"}));
  }
}

TEST(SvgChart, ticks_are_round_and_cover_the_range) {
  EXPECT_EQ(round_ticks(0, 10, 5), (std::vector<double>{0, 2, 4, 6, 8, 10}));
  EXPECT_EQ(round_ticks(-3, 47, 5), (std::vector<double>{-10, 0, 10, 20, 30, 40, 50}));
  EXPECT_EQ(round_ticks(2, 2, 5), (std::vector<double>{2}));
  // a span of one rounding: a loop over such steps would never end
  EXPECT_EQ(round_ticks(0.3, 0.30000000000000004, 5), (std::vector<double>{0.3}));
}

TEST(SvgChart, no_tick_lies_outside_the_frame) {
  for (double low = -3; low < 1; low += 0.13) {
    for (double high = low + 0.07; high < 3; high += 0.31) {
      const std::string svg = svg_of(LineChart{"t", "x", "", "y", "", false, false, {{"a", {0, 1}, {low, high}}}, {}});
      std::vector<double> levels;  // of the lines of the grid, in pixels from the top
      for (std::size_t at = svg.find("class=\"grid\""); at != std::string::npos; at = svg.find("class=\"grid\"", at + 1)) {
        levels.push_back(std::stod(svg.substr(svg.rfind("y1=\"", at) + 4)));
      }
      ASSERT_GE(levels.size(), 2u);
      // the axis is drawn from its upper end to its lower one
      std::smatch axis;
      ASSERT_TRUE(std::regex_search(svg, axis, std::regex("polyline points=\"[0-9.]+,([0-9.]+) [0-9.]+,([0-9.]+) ")));
      for (double y : levels) {
        EXPECT_GE(y, std::stod(axis[1]) - 0.1) << low << " to " << high;
        EXPECT_LE(y, std::stod(axis[2]) + 0.1) << low << " to " << high;
      }
    }
  }
}

TEST(SvgChart, a_chart_without_finite_points_says_so) {
  const double nan = std::nan("");
  EXPECT_NE(svg_of(LineChart{"t", "x", "s", "y", "J", false, false, {{"l", {nan, 1}, {1, nan}}}, {}}).find("nothing to draw"),
            std::string::npos);
  EXPECT_NE(svg_of(LineChart{"t", "x", "s", "y", "J", true, false, {{"l", {0, 1}, {0, -1}}}, {}}).find("nothing to draw"),
            std::string::npos);
}

TEST(SvgChart, a_long_line_keeps_its_peak) {
  ChartLine line{"l", {}, {}};
  for (int i = 0; i < 100000; ++i) {
    line.x.push_back(i);
    line.y.push_back(i == 54321 ? 1 : 0);
  }
  const std::string svg = svg_of(LineChart{"t", "x", "", "y", "", false, true, {line}, {}});
  EXPECT_LT(svg.size(), 60000u);
  EXPECT_NE(svg.find(" 62.0"), std::string::npos) << "the top of the frame is at 62: the peak must reach it";
}

}  // namespace
}  // namespace scree
