#include "post/report/played_frames.hpp"

#include <algorithm>
#include <cstring>
#include <type_traits>

#include "core/base/error.hpp"
#include "core/storage/h5.hpp"
#include "post/report/player_code.hpp"
#include "post/run/contact_network.hpp"

namespace scree {

namespace {

/// What precedes the bodies and walls of a frame on their way from the process that read it.
struct Header {
  std::int64_t number = 0;
  double time = 0;
  Box3 room;
  std::size_t bodies = 0, walls = 0;
};
static_assert(std::is_trivially_copyable_v<Header> && std::is_trivially_copyable_v<PlayedBody> && std::is_trivially_copyable_v<WallPlace>);

template <class T>
void append(std::string& bytes, const T* values, std::size_t count) {
  if (count > 0) bytes.append(reinterpret_cast<const char*>(values), count * sizeof(T));
}

std::string bytes_of_frame(const PlayedFrame& frame) {
  const Header header{frame.number, frame.time, frame.room, frame.bodies.size(), frame.walls.size()};
  std::string bytes;
  append(bytes, &header, 1);
  append(bytes, frame.bodies.data(), frame.bodies.size());
  append(bytes, frame.walls.data(), frame.walls.size());
  return bytes;
}

template <class T>
void take(const char*& from, T* values, std::size_t count) {
  if (count > 0) std::memcpy(values, from, count * sizeof(T));
  from += count * sizeof(T);
}

PlayedFrame frame_of(const std::string& bytes) {
  const char* from = bytes.data();
  Header header;
  take(from, &header, 1);
  PlayedFrame frame{header.number, header.time, header.room, {}, {}};
  frame.bodies.resize(header.bodies);
  frame.walls.resize(header.walls);
  take(from, frame.bodies.data(), header.bodies);
  take(from, frame.walls.data(), header.walls);
  return frame;
}

PlayedFrame read_frame(const Run& run, std::size_t index, const Within& within) {
  const bool has_contacts = run.scene.settings.output_contacts;
  const Frame given = load_frame(run, index, has_contacts ? FrameParts::all : FrameParts::bodies);
  const Frame inside = within.part_of(run, given);
  const Frame& frame = within.is_equipment() ? given : inside;
  const FrameBodies& b = frame.bodies;
  PlayedFrame played{given.number, given.time, {}, {}, wall_places(frame, run.scene)};
  if (inside.bodies.size() > 0) played.room = seen_room(inside, run.scene);
  const std::vector<std::int32_t> touching = line_counts(network_of(frame, periodicity_of(run.scene, frame)), b.size());
  const std::vector<std::uint8_t> is_inside = within.rows(run, frame);
  for (std::size_t i = 0; i < b.size(); ++i) {
    played.bodies.push_back({b.id[i], b.shape[i], b.material[i], b.scale[i], b.position[i], b.velocity[i], normalised(b.orientation[i]),
                             b.has_temperature ? b.temperature[i] : 0, touching[i], is_inside[i] != 0});
  }
  return played;
}

/// Bytes that each frame takes; without opening its columns, of which only the number of rows matters here.
std::vector<std::size_t> sizes_of_frames(const Run& run) {
  const Scene& scene = run.scene;
  const std::size_t table = scene.bodies.size() + static_cast<std::size_t>(run.inserted());
  const auto moving = static_cast<std::size_t>(std::count_if(
      scene.walls.begin(), scene.walls.end(), [](const Wall& wall) { return wall.motion.is_prescribed() || wall.motion.drive(); }));
  std::vector<std::size_t> sizes;
  for (const FrameEntry& entry : run.frames) {
    std::size_t bodies = table;
    try {
      bodies = static_cast<std::size_t>(h5::File(entry.path).root().open_group("VTKHDF/PointData").row_count("id"));
    } catch (const InputError&) {
      // named when it is read, or left out then
    }
    sizes.push_back(packed_size(scene, bodies, std::max(table, bodies), moving));
  }
  return sizes;
}

}  // namespace

std::vector<std::size_t> thinned(const std::vector<std::size_t>& bytes, std::size_t chosen, std::size_t limit) {
  const std::size_t all = bytes.size();
  if (all < 2) return {};
  const auto spread = [&](std::size_t count) {
    std::vector<std::size_t> frames{chosen};
    for (std::size_t i = 0; i < count; ++i) frames.push_back((i * (all - 1) + (count - 1) / 2) / (count - 1));
    std::sort(frames.begin(), frames.end());
    frames.erase(std::unique(frames.begin(), frames.end()), frames.end());
    return frames;
  };
  std::size_t total = 0;
  for (const std::size_t b : bytes) total += b;
  // frames of equal size would fit at a share of limit over total; where they differ, the search begins at twice as many
  std::size_t count = total <= limit ? all
                                     : std::min(all, 2 + static_cast<std::size_t>(2.0 * static_cast<double>(all) *
                                                                                  static_cast<double>(limit) / static_cast<double>(total)));
  for (; count >= 2; --count) {
    const std::vector<std::size_t> frames = spread(count);
    std::size_t sum = 0;
    for (const std::size_t f : frames) sum += bytes[f];
    if (sum <= limit) return frames;
  }
  return {};
}

PlayedRun read_played_frames(const Run& run, std::size_t chosen, const Within& within, const FramePool& pool, std::size_t limit) {
  PlayedRun played;
  played.frames_of_run = run.frames.size();
  const std::vector<std::size_t> sizes = sizes_of_frames(run);
  for (const std::size_t size : sizes) played.bytes_of_all += size;
  const std::vector<std::size_t> frames = thinned(sizes, chosen, limit);
  const auto add = [&](std::size_t index, const std::string& bytes) {
    if (index == chosen) played.chosen = played.frames.size();
    played.frames.push_back(frame_of(bytes));
    const PlayedFrame& frame = played.frames.back();
    played.most = std::max(played.most, frame.bodies.size());
    if (frame.room.is_empty()) return;
    played.room.add(frame.room.lower);
    played.room.add(frame.room.upper);
  };
  if (frames.size() > 1)
    played.skipped = for_each_frame(
                         frames, pool, [&](std::size_t f) { return bytes_of_frame(read_frame(run, f, within)); }, add)
                         .skipped;
  if (played.frames.size() < 2) played.frames.clear();  // the others are damaged
  if (played.room.is_empty()) played.room = room_of({}, run.scene);
  return played;
}

}  // namespace scree
