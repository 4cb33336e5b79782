#include "post/report/player_data.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <map>
#include <nlohmann/json.hpp>
#include <tuple>

#include "core/base/utf8.hpp"
#include "post/report/player_code.hpp"
#include "post/vtk/view_data.hpp"

namespace scree {

namespace {

constexpr double kTemperatureSteps = 65535;

/// A body that is the same in all frames. An id that comes again as another shape, after a break, is another row.
using BodyKey = std::tuple<std::int64_t, std::int32_t, std::int32_t, double>;
BodyKey key_of(const PlayedBody& b) { return {b.id, b.shape, b.material, b.scale}; }

void put(std::string& bytes, std::uint32_t value, int count) {
  for (int k = 0; k < count; ++k) bytes += static_cast<char>((value >> (8 * k)) & 255U);
}

/// The upper 24 bits of a float32, rounded: 5 digits at any size, so that a body nearly at rest still has a speed.
std::uint32_t upper_bits(double value) { return (std::bit_cast<std::uint32_t>(static_cast<float>(value)) + 0x80U) >> 8; }

/// Ends of a scale of colours: of the bodies inside, and whether any other is beyond them.
struct Scale {
  double low = std::numeric_limits<double>::infinity(), high = -low;
  double lowest = low, highest = high;
  void add(double value, bool counts) {
    lowest = std::min(lowest, value);
    highest = std::max(highest, value);
    if (!counts) return;
    low = std::min(low, value);
    high = std::max(high, value);
  }
  nlohmann::json json() const {
    if (!(low <= high)) return {0, 0, false};
    return {low, high, lowest < low || highest > high};
  }
};

struct Scales {
  Scale speed, height, temperature;
};

Scales scales_of(const PlayedRun& played) {
  Scales s;
  s.speed.add(0, true);  // a speed is compared with rest
  for (const PlayedFrame& frame : played.frames) {
    for (const PlayedBody& b : frame.bodies) {
      s.speed.add(length(b.velocity), b.is_inside);
      s.height.add(b.position.z, b.is_inside);
      s.temperature.add(b.temperature, b.is_inside);
    }
  }
  return s;
}

double angle_between(const Quat& a, const Quat& b) {
  const Quat d = a * conjugate(b);
  return 2 * std::atan2(length({d.x, d.y, d.z}), std::abs(d.w));
}

/// Packs bodies one after the other, and keeps how far each is from what the page makes of it.
struct Packer {
  const Scene& scene;
  PlaceCode places;
  Vec3 centre;
  double coldest, temperature_step;
  std::string bytes{};
  PlayerError error{};

  void add(const PlayedBody& b) {
    const std::array<std::uint32_t, 3> place = places.code(b.position);
    const std::array<std::uint16_t, 3> turn = turn_code(b.orientation);
    for (const std::uint32_t p : place) put(bytes, p, 3);
    for (const std::uint16_t t : turn) put(bytes, t, 2);
    for (int k = 0; k < 3; ++k) put(bytes, upper_bits(b.velocity[k]), 3);
    if (scene.settings.heat)
      put(bytes, temperature_step > 0 ? static_cast<std::uint32_t>(std::lround((b.temperature - coldest) / temperature_step)) : 0, 2);
    if (scene.settings.output_contacts) put(bytes, static_cast<std::uint32_t>(std::min(b.touching, 65535)), 2);
    const Vec3 unpacked = places.place(place);
    Vec3 drawn;
    for (int k = 0; k < 3; ++k) drawn[k] = centre[k] + static_cast<double>(static_cast<float>(unpacked[k] - centre[k]));
    error.distance = std::max(error.distance, length(drawn - b.position));
    error.angle = std::max(error.angle, angle_between(b.orientation, turn_of(turn)));
  }
};

template <class T>
std::string text_of(const std::vector<T>& values) {
  return base64(std::string(reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T)));
}

nlohmann::json table_json(const std::map<BodyKey, std::size_t>& table) {
  std::vector<double> id;
  std::vector<std::uint32_t> shape;  // pieces of bodies may be more than 65 535 shapes
  std::vector<std::uint16_t> material;
  std::vector<float> scale;
  for (const auto& [key, row] : table) {
    id.push_back(static_cast<double>(std::get<0>(key)));
    shape.push_back(static_cast<std::uint32_t>(std::get<1>(key)));
    material.push_back(static_cast<std::uint16_t>(std::get<2>(key)));
    scale.push_back(static_cast<float>(std::get<3>(key)));
  }
  return {
      {"count", table.size()}, {"id", text_of(id)}, {"shape", text_of(shape)}, {"material", text_of(material)}, {"scale", text_of(scale)}};
}

/// Which bodies of the table a frame has: nothing where it has all of them, else a bit for each, the lowest first.
void add_presence(std::string& bytes, const PlayedFrame& frame, const std::map<BodyKey, std::size_t>& table) {
  if (frame.bodies.size() == table.size()) return;
  std::string bits((table.size() + 7) / 8, '\0');
  for (const PlayedBody& b : frame.bodies) {
    const std::size_t row = table.at(key_of(b));
    bits[row / 8] = static_cast<char>(static_cast<unsigned char>(bits[row / 8]) | (1U << (row % 8)));
  }
  bytes += bits;
}

/// Places in each frame of the walls that move.
void add_walls(nlohmann::json& data, const PlayedRun& played) {
  const std::vector<WallPlace>& first = played.frames.front().walls;
  std::vector<std::size_t> moving;
  for (std::size_t w = 0; w < first.size(); ++w) {
    const bool moves = std::any_of(played.frames.begin(), played.frames.end(), [&](const PlayedFrame& f) {
      return f.walls[w].position != first[w].position || f.walls[w].orientation != first[w].orientation;
    });
    if (moves) moving.push_back(w);
  }
  std::vector<double> places;
  for (const PlayedFrame& frame : played.frames) {
    for (const std::size_t w : moving) {
      const auto& [x, q] = frame.walls[w];
      places.insert(places.end(), {x.x, x.y, x.z, q.x, q.y, q.z, q.w});
    }
  }
  data["moving"] = moving;
  data["wallPlaces"] = text_of(places);
}

}  // namespace

PlayerData player_data(const Scene& scene, const PlayedRun& played, const Vec3& centre) {
  Box3 box;
  std::map<BodyKey, std::size_t> table;
  Scale warmth;
  for (const PlayedFrame& frame : played.frames) {
    for (const PlayedBody& b : frame.bodies) {
      box.add(b.position);
      table.emplace(key_of(b), 0);
      warmth.add(b.temperature, true);
    }
  }
  std::size_t rows = 0;
  for (auto& [key, row] : table) row = rows++;

  const double coldest = table.empty() ? 0 : warmth.low, range = table.empty() ? 0 : warmth.high - warmth.low;
  Packer packer{scene, PlaceCode::of(box), centre, coldest, range / kTemperatureSteps};
  nlohmann::json frames = nlohmann::json::array();
  for (const PlayedFrame& frame : played.frames) {
    frames.push_back({frame.number, frame.time, frame.bodies.size()});
    add_presence(packer.bytes, frame, table);
    for (const PlayedBody& b : frame.bodies) packer.add(b);
  }
  for (const auto& [key, row] : table) {
    const double diameter = std::get<3>(key) * scene.shapes[static_cast<std::size_t>(std::get<1>(key))].equivalent_diameter();
    if (row == 0 || diameter < packer.error.smallest_diameter) packer.error.smallest_diameter = diameter;
  }

  const auto list = [](const Vec3& v) { return nlohmann::json{v.x, v.y, v.z}; };
  const Scales scales = scales_of(played);
  nlohmann::json data = {{"frames", frames},
                         {"framesOfRun", played.frames_of_run},
                         {"chosen", played.chosen},
                         {"table", table_json(table)},
                         {"lower", list(packer.places.lower)},
                         {"step", list(packer.places.step)},
                         {"heat", scene.settings.heat.has_value()},
                         {"contacts", scene.settings.output_contacts},
                         {"coldest", coldest},
                         {"temperatureStep", packer.temperature_step},
                         {"scales", {{"speed", scales.speed.json()}, {"height", scales.height.json()}}},
                         {"block", base64(packer.bytes)}};
  if (scene.settings.heat) data["scales"]["temperature"] = scales.temperature.json();
  add_walls(data, played);
  return {data, packer.error, packer.bytes.size()};
}

}  // namespace scree
