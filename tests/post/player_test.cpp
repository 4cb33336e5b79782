// The frames that report.html plays: which of them, how exact, and how large. A second reader of the packed block, written from the page of
// player_code.hpp, unpacks what the page would.
#include "post/report/player_data.hpp"

#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <nlohmann/json.hpp>
#include <random>

#include "core/base/error.hpp"
#include "post/report/player_code.hpp"
#include "post/report/view_section.hpp"
#include "tests/post/sample_run.hpp"

namespace scree {
namespace {

double angle_between(const Quat& a, const Quat& b) {
  const Quat d = a * conjugate(b);
  return 2 * std::atan2(length({d.x, d.y, d.z}), std::abs(d.w));
}

Quat random_turn(std::mt19937& random) {
  std::normal_distribution<double> normal;
  return normalised(Quat{normal(random), normal(random), normal(random), normal(random)});
}

std::string bytes_of_base64(const std::string& text) {
  const std::string letters = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string bytes;
  std::uint32_t group = 0;
  int bits = 0;
  for (const char c : text) {
    if (c == '=') break;
    group = group << 6 | static_cast<std::uint32_t>(letters.find(c));
    bits += 6;
    if (bits < 8) continue;
    bits -= 8;
    bytes += static_cast<char>((group >> bits) & 255U);
  }
  return bytes;
}

template <class T>
std::vector<T> values_of(const nlohmann::json& text) {
  const std::string bytes = bytes_of_base64(text.get<std::string>());
  std::vector<T> values(bytes.size() / sizeof(T));
  std::memcpy(values.data(), bytes.data(), values.size() * sizeof(T));
  return values;
}

/// Reads the packed frames of a page.
struct Reader {
  const nlohmann::json& data;
  std::string bytes = bytes_of_base64(data["block"].get<std::string>());
  std::vector<double> id = values_of<double>(data["table"]["id"]);
  std::vector<float> scale = values_of<float>(data["table"]["scale"]);
  std::vector<std::uint32_t> shape = values_of<std::uint32_t>(data["table"]["shape"]);
  std::size_t at = 0;

  std::uint32_t number(int count) {
    std::uint32_t value = 0;
    for (int k = 0; k < count; ++k) value |= static_cast<std::uint32_t>(static_cast<unsigned char>(bytes.at(at++))) << (8 * k);
    return value;
  }

  std::vector<PlayedBody> frame(std::size_t k) {
    const std::size_t count = data["frames"][k][2], rows = id.size();
    std::vector<bool> present(rows, true);
    if (count < rows) {
      for (std::size_t row = 0; row < rows; row += 8) {
        const std::uint32_t bits = number(1);
        for (std::size_t j = row; j < std::min(rows, row + 8); ++j) present[j] = ((bits >> (j - row)) & 1U) != 0;
      }
    }
    std::vector<PlayedBody> bodies;
    for (std::size_t row = 0; row < rows; ++row) {
      if (!present[row]) continue;
      PlayedBody b;
      b.id = static_cast<std::int64_t>(id[row]);
      b.shape = shape[row];
      b.scale = scale[row];
      for (int c = 0; c < 3; ++c) b.position[c] = data["lower"][c].get<double>() + number(3) * data["step"][c].get<double>();
      std::array<std::uint16_t, 3> turn{};
      for (std::uint16_t& word : turn) word = static_cast<std::uint16_t>(number(2));
      b.orientation = turn_of(turn);
      for (int c = 0; c < 3; ++c) b.velocity[c] = std::bit_cast<float>(number(3) << 8);
      if (data["heat"].get<bool>()) b.temperature = data["coldest"].get<double>() + number(2) * data["temperatureStep"].get<double>();
      if (data["contacts"].get<bool>()) b.touching = static_cast<std::int32_t>(number(2));
      bodies.push_back(b);
    }
    EXPECT_EQ(bodies.size(), count);
    return bodies;
  }
};

/// Four frames: none, bodies 0 to 5, bodies 3 to 9, and bodies 3 to 9 of which 9 has another size.
PlayedRun come_and_go() {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> uniform(-1, 1);
  PlayedRun played;
  played.frames_of_run = 4;
  for (const auto& [first, last] : {std::pair{0, 0}, {0, 6}, {3, 10}, {3, 10}}) {
    PlayedFrame frame;
    frame.number = static_cast<std::int64_t>(played.frames.size());
    frame.time = 0.5 * static_cast<double>(frame.number);
    frame.walls = {{{0, 0, 1}, {}}, {{0, 0, 1 - frame.time}, quaternion_of(Vec3{0, 0, 1}, frame.time)}};
    for (int i = first; i < last; ++i) {
      PlayedBody b;
      b.id = 100 + i;
      b.shape = i % 3;
      b.scale = i == 9 && frame.number == 3 ? 0.5 : 1;
      b.position = {uniform(random), 100 * uniform(random), 1e-3 * uniform(random)};
      b.velocity = {uniform(random), 1e-9 * uniform(random), 1e6 * uniform(random)};
      b.orientation = random_turn(random);
      b.temperature = 300 + 20 * uniform(random);
      b.touching = i;
      b.is_inside = i != 5;
      frame.bodies.push_back(b);
    }
    played.frames.push_back(frame);
  }
  return played;
}

TEST(Player, places_come_back_within_half_a_step) {
  std::mt19937 random(1);
  const Box3 box{{-3, 10, 1e-6}, {5, 1e4, 2e-6}};
  const PlaceCode code = PlaceCode::of(box);
  for (int i = 0; i < 20000; ++i) {
    Vec3 x;
    for (int k = 0; k < 3; ++k) x[k] = std::uniform_real_distribution<double>(box.lower[k], box.upper[k])(random);
    const Vec3 y = code.place(code.code(x));
    for (int k = 0; k < 3; ++k) EXPECT_LE(std::abs(x[k] - y[k]), 0.5 * code.step[k] * (1 + 1e-6));
  }
  for (int k = 0; k < 3; ++k) {
    EXPECT_EQ(code.place(code.code(box.lower))[k], box.lower[k]);
    EXPECT_NEAR(code.place(code.code(box.upper))[k], box.upper[k], 1e-15 * std::abs(box.upper[k]));
    EXPECT_NEAR(code.step[k] * 16777215, box.extent()[k], 1e-9 * box.extent()[k]);
  }
  // one body that does not move has no box
  const PlaceCode one = PlaceCode::of({{1, 2, 3}, {1, 2, 3}});
  EXPECT_EQ(one.place(one.code({1, 2, 3})), (Vec3{1, 2, 3}));
}

TEST(Player, orientations_come_back_within_a_hundredth_of_a_degree) {
  // half a step of sqrt(2) / 32767 in each of three components, twice that with the fourth, twice that as an angle
  const double bound = 4 * std::sqrt(3.0) * std::sqrt(2.0) / 32767 / 2;
  EXPECT_LT(bound, 0.01 * std::numbers::pi / 180);
  std::mt19937 random(2);
  double largest = 0;
  for (int i = 0; i < 50000; ++i) {
    const Quat q = random_turn(random);
    largest = std::max(largest, angle_between(q, turn_of(turn_code(q))));
    EXPECT_EQ(turn_code(q), turn_code({-q.w, -q.x, -q.y, -q.z}));  // the same orientation
  }
  EXPECT_LT(largest, bound);
  EXPECT_GT(largest, 0.2 * bound);
  const double h = std::sqrt(0.5);
  for (const Quat& q : {Quat{1, 0, 0, 0}, Quat{0, 1, 0, 0}, Quat{0, 0, -1, 0}, Quat{0, 0, 0, 1}, Quat{h, h, 0, 0}, Quat{0, -h, 0, h},
                        Quat{0.5, -0.5, 0.5, -0.5}})
    EXPECT_LT(angle_between(q, turn_of(turn_code(q))), bound);
}

TEST(Player, bodies_that_come_and_go_are_in_the_frames_that_they_exist_in) {
  Scene scene = test::sample_scene(3);
  scene.settings.heat.emplace();
  scene.settings.output_contacts = true;
  const PlayedRun played = come_and_go();
  const Vec3 centre{1, 2, 3};
  const PlayerData packed = player_data(scene, played, centre);
  Reader reader{*packed.json};
  EXPECT_EQ(reader.id.size(), 11U) << "body 109 is two rows: it has two sizes";
  double distance = 0, angle = 0;
  for (std::size_t f = 0; f < played.frames.size(); ++f) {
    const std::vector<PlayedBody> found = reader.frame(f);
    const std::vector<PlayedBody>& bodies = played.frames[f].bodies;
    ASSERT_EQ(found.size(), bodies.size()) << f;
    for (std::size_t i = 0; i < bodies.size(); ++i) {
      EXPECT_EQ(found[i].id, bodies[i].id);
      EXPECT_EQ(found[i].shape, bodies[i].shape);
      EXPECT_EQ(found[i].scale, bodies[i].scale);
      EXPECT_EQ(found[i].touching, bodies[i].touching);
      EXPECT_NEAR(found[i].temperature, bodies[i].temperature, 40.0 / 65535 / 2);
      for (int k = 0; k < 3; ++k) EXPECT_NEAR(found[i].velocity[k], bodies[i].velocity[k], std::abs(bodies[i].velocity[k]) / 65536);
      Vec3 drawn;
      for (int k = 0; k < 3; ++k) drawn[k] = centre[k] + static_cast<double>(static_cast<float>(found[i].position[k] - centre[k]));
      distance = std::max(distance, length(drawn - bodies[i].position));
      angle = std::max(angle, angle_between(found[i].orientation, bodies[i].orientation));
    }
  }
  EXPECT_EQ(reader.at, reader.bytes.size()) << "nothing is left in the block";
  EXPECT_EQ(packed.bytes, reader.bytes.size());
  EXPECT_NEAR(packed.error.distance, distance, 1e-12);
  EXPECT_NEAR(packed.error.angle, angle, 1e-12);
  EXPECT_GT(packed.error.distance, 1e-7) << "the box is 200 m wide";
  EXPECT_LT(packed.error.distance, 1e-4);
  EXPECT_DOUBLE_EQ(packed.error.smallest_diameter, 0.5 * scene.shapes[0].equivalent_diameter());
  std::size_t sum = 0;
  for (const PlayedFrame& frame : played.frames) sum += packed_size(scene, frame.bodies.size(), 11, 0);
  EXPECT_EQ(packed.bytes, sum);
}

TEST(Player, walls_that_move_have_their_place_in_each_frame) {
  const PlayerData packed = player_data(test::sample_scene(3), come_and_go(), {});
  EXPECT_EQ((*packed.json)["moving"], nlohmann::json::array({1}));
  const std::vector<double> places = values_of<double>((*packed.json)["wallPlaces"]);
  ASSERT_EQ(places.size(), 4U * 7);
  EXPECT_EQ(places[7 * 3 + 2], 1 - 1.5);
  EXPECT_EQ(places[7 * 3 + 5], std::sin(0.75));
  EXPECT_EQ(places[7 * 3 + 6], std::cos(0.75));
}

TEST(Player, one_scale_of_colours_holds_for_all_frames) {
  const PlayedRun played = come_and_go();
  const PlayerData packed = player_data(test::sample_scene(3), played, {});
  double fastest = 0, of_all = 0, lowest = 1e9;
  for (const PlayedFrame& frame : played.frames) {
    for (const PlayedBody& b : frame.bodies) {
      of_all = std::max(of_all, length(b.velocity));
      if (!b.is_inside) continue;
      fastest = std::max(fastest, length(b.velocity));
      lowest = std::min(lowest, b.position.z);
    }
  }
  const nlohmann::json& scales = (*packed.json)["scales"];
  EXPECT_EQ(scales["speed"], (nlohmann::json{0.0, fastest, of_all > fastest}));
  EXPECT_EQ(scales["height"][0], lowest);
  EXPECT_FALSE(scales.contains("temperature")) << "the scene has no heat";
}

TEST(Player, frames_that_do_not_fit_are_thinned_evenly_with_first_last_and_chosen) {
  const std::vector<std::size_t> bytes(101, 1000);
  EXPECT_EQ(thinned(bytes, 100, 101000).size(), 101U);
  for (const std::size_t limit : {100999U, 50000U, 12345U, 3000U}) {
    const std::vector<std::size_t> frames = thinned(bytes, 37, limit);
    ASSERT_FALSE(frames.empty()) << limit;
    EXPECT_EQ(frames.front(), 0U);
    EXPECT_EQ(frames.back(), 100U);
    EXPECT_TRUE(std::find(frames.begin(), frames.end(), 37U) != frames.end()) << limit;
    EXPECT_LE(frames.size() * 1000, limit);
    EXPECT_GE((frames.size() + 2) * 1000, limit / 1000 * 1000) << "no more are left out than have to be";
    const double step = 100.0 / static_cast<double>(frames.size() - 2);
    for (std::size_t i = 1; i < frames.size(); ++i) EXPECT_LE(static_cast<double>(frames[i] - frames[i - 1]), step + 1) << limit;
  }
  EXPECT_EQ(thinned(bytes, 37, 3000), (std::vector<std::size_t>{0, 37, 100}));
  EXPECT_TRUE(thinned(bytes, 37, 2999).empty()) << "not even three fit";
  EXPECT_EQ(thinned(bytes, 0, 2000), (std::vector<std::size_t>{0, 100}));
  EXPECT_TRUE(thinned({1000}, 0, 1000000).empty()) << "one frame does not move";
  EXPECT_EQ(thinned({1000, 1000}, 1, 1000000), (std::vector<std::size_t>{0, 1}));
  // bodies come in: later frames are larger
  std::vector<std::size_t> growing;
  for (std::size_t i = 0; i < 500; ++i) growing.push_back(10 * i);
  const std::vector<std::size_t> some = thinned(growing, 499, 300000);
  std::size_t sum = 0;
  for (const std::size_t f : some) sum += growing[f];
  EXPECT_LE(sum, 300000U);
  EXPECT_GT(sum, 280000U);
}

std::size_t count_of(const std::string& text, const std::string& what) {
  std::size_t count = 0;
  for (std::size_t at = text.find(what); at != std::string::npos; at = text.find(what, at + 1)) ++count;
  return count;
}

std::string folder(const char* name) { return std::string(SCREE_TEST_FOLDER) + "/player/" + name + "/sample.run"; }

TEST(Player, view_of_200_bodies_in_100_frames_is_below_2_MB) {
  const scree::Run run = open_run(test::write_sample_run(folder("large"), 200, 100));
  const ViewSection view = view_section(run, 99, "", {1, false});
  EXPECT_LT(view.html.size(), 2000000U);  // the pictures and charts of the page have the other 8 MB
  EXPECT_NE(view.html.find("All 100 frames are played."), std::string::npos);
  EXPECT_EQ((*view.numbers)["frames"], 100);
  EXPECT_LT((*view.numbers)["position_error"].get<double>(), 1e-4 * (*view.numbers)["smallest_diameter"].get<double>());
}

TEST(Player, a_run_of_one_frame_has_no_controls_for_playing) {
  const scree::Run one = open_run(test::write_sample_run(folder("one"), 12, 1));
  const ViewSection view = view_section(one, 0, "", {1, false});
  for (const char* part : {"\"player\":", "class=\"player\"", "allFrames", "class=\"note\"", "name=\"play\""})
    EXPECT_EQ(count_of(view.html, part), 0U) << part;
  EXPECT_EQ(count_of(view.html, "name=\"cut\""), 1U);
  const scree::Run three = open_run(test::write_sample_run(folder("three"), 12, 3));
  const ViewSection plays = view_section(three, 1, "", {1, false});
  for (const char* part : {"\"player\":", "class=\"player\"", "class=\"note\"", "name=\"play\""})
    EXPECT_EQ(count_of(plays.html, part), 1U) << part;
}

TEST(Player, what_is_not_played_is_said) {
  const scree::Run run = open_run(test::write_sample_run(folder("thinned"), 12, 9));
  const std::size_t frame = packed_size(run.scene, 12, 12, 1);
  const ViewSection some = view_section(run, 2, "", {1, false}, 4 * frame);
  EXPECT_NE(some.html.find("4 of 9 frames are played, spread evenly"), std::string::npos);
  EXPECT_EQ((*some.numbers)["frames"], 4);
  EXPECT_EQ((*some.numbers)["frames_of_run"], 9);
  EXPECT_LE((*some.numbers)["bytes"].get<std::size_t>(), 4 * frame);
  const ViewSection none = view_section(run, 2, "", {1, false}, 3 * frame - 1);
  EXPECT_NE(none.html.find("The 9 frames are not played"), std::string::npos);
  EXPECT_EQ(count_of(none.html, "class=\"player\""), 0U);
  EXPECT_EQ(count_of(view_section(run, 2, "", {1, false}).html, "All 9 frames are played."), 1U);
}

TEST(Player, damaged_frames_are_left_out_and_counted) {
  const scree::Run run = open_run(test::write_sample_run(folder("damaged"), 12, 5));
  std::filesystem::resize_file(run.frames[2].path, std::filesystem::file_size(run.frames[2].path) / 2);
  EXPECT_THROW(view_section(run, 4, "", {1, false}), InputError);
  const ViewSection view = view_section(run, 4, "", {1, true});
  ASSERT_EQ(view.skipped.size(), 1U);
  EXPECT_NE(view.skipped[0].find("frame_000002"), std::string::npos) << view.skipped[0];
  EXPECT_NE(view.html.find("4 of 5 frames are played"), std::string::npos);
  EXPECT_NE(view.html.find("1 damaged frame is left out"), std::string::npos);
}

TEST(Player, frames_are_read_as_the_run_has_them) {
  const scree::Run run = open_run(test::write_sample_run(folder("read"), 12, 5));
  const PlayedRun played = read_played_frames(run, 3, Within::named(run, ""), {1, false}, kPlayerLimit);
  ASSERT_EQ(played.frames.size(), 5U);
  EXPECT_EQ(played.chosen, 3U);
  EXPECT_EQ(played.most, 12U);
  const Frame frame = load_frame(run, 3);
  for (std::size_t i = 0; i < 12; ++i) {
    EXPECT_EQ(played.frames[3].bodies[i].position, frame.bodies.position[i]);
    EXPECT_EQ(played.frames[3].bodies[i].velocity, frame.bodies.velocity[i]);
    EXPECT_EQ(played.frames[3].walls[1].position, frame.walls.position[1]);
    EXPECT_TRUE(played.room.lower.x < frame.bodies.position[i].x && frame.bodies.position[i].x < played.room.upper.x);
  }
  // three of 12 bodies: what the limit holds is played, with the frame of the pictures
  const PlayedRun some = read_played_frames(run, 3, Within::named(run, ""), {1, false}, 3 * packed_size(run.scene, 12, 12, 1));
  ASSERT_EQ(some.frames.size(), 3U);
  EXPECT_EQ(some.frames[some.chosen].number, 3);
  EXPECT_EQ(some.frames.front().number, 0);
  EXPECT_EQ(some.frames.back().number, 4);
  EXPECT_EQ(some.frames_of_run, 5U);
  EXPECT_TRUE(read_played_frames(run, 3, Within::named(run, ""), {1, false}, 100).frames.empty());
}

}  // namespace
}  // namespace scree
