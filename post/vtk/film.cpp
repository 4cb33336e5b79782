#include "post/vtk/film.hpp"

#include <cmath>
#include <cstdio>
#include <map>
#include <numbers>
#include <optional>

#include "core/base/child_process.hpp"
#include "core/base/error.hpp"
#include "core/base/long_work.hpp"
#include "core/base/temporary_file.hpp"
#include "core/picture/display.hpp"
#include "post/vtk/picture.hpp"
#include "post/vtk/vtk_threads.hpp"

namespace scree {

namespace {

/// What ffmpeg is to make. mp4 and webm halve the resolution of colours, so that their sizes are even.
/// Quality: crf 18 of x264 and 24 of VP9 show no blocks on smooth shading; a file is a third larger than with their defaults.
/// A gif has 256 colours: a palette for each picture, since one for all of them would keep all of them in memory.
std::vector<std::string> words_of_format(const std::string& path) {
  if (path.ends_with(".mp4")) {
    return {"-c:v", "libx264", "-crf", "18", "-preset", "medium", "-pix_fmt", "yuv420p", "-movflags", "+faststart", "-f", "mp4"};
  }
  if (path.ends_with(".webm"))
    return {"-c:v", "libvpx-vp9", "-crf", "24", "-b:v", "0", "-row-mt", "1", "-pix_fmt", "yuv420p", "-f", "webm"};
  return {"-filter_complex", "split[a][b];[a]palettegen=stats_mode=single[p];[b][p]paletteuse=new=1:dither=sierra2_4a", "-f", "gif"};
}

/// ffmpeg, fed with pictures.
class Encoder {
 public:
  Encoder(const std::string& path, int width, int height, double rate)
      : temporary_(path), child_(start(path, temporary_.name(), width, height, rate, says_)) {}

  void add(const std::string& rgb) {
    if (!child_.feed(rgb.data(), rgb.size())) finish();
  }
  /// Waits until the film is written and gives it its name.
  void finish() {
    child_.end_feed();
    const ProcessEnd end = child_.wait();
    if (!end.is_success()) {
      std::string text = says_.text();
      while (!text.empty() && text.back() == '\n') text.pop_back();
      throw SystemError("cannot write {}: ffmpeg ended with {}: {}", temporary_.path(),
                        end.signal != 0 ? fmt::format("signal {}", end.signal) : fmt::format("exit code {}", end.code), text);
    }
    temporary_.publish();
  }

 private:
  static ChildProcess start(const std::string& path, const std::string& temporary, int width, int height, double rate,
                            const MemoryFile& says) {
    std::vector<std::string> words{"ffmpeg",
                                   "-hide_banner",
                                   "-xerror",
                                   "-loglevel",
                                   "error",
                                   "-nostats",
                                   "-y",
                                   "-f",
                                   "rawvideo",
                                   "-pix_fmt",
                                   "rgb24",
                                   "-s:v",
                                   fmt::format("{}x{}", width, height),
                                   "-r",
                                   fmt::format("{}", rate),
                                   "-i",
                                   "pipe:0",
                                   "-an"};
    for (const std::string& word : words_of_format(path)) words.push_back(word);
    words.push_back("file:" + temporary);
    try {
      return ChildProcess::start_fed(words, says.descriptor());
    } catch (const StartError& error) {
      throw SystemError("cannot make a film: {}; install the package ffmpeg (./setup does)", error.what());
    }
  }

  MemoryFile says_;
  TemporaryFile temporary_;
  ChildProcess child_;  ///< ended before the file is removed
};

/// The camera, gone by an angle [rad] about `up`.
View turned(View view, double angle) {
  const Vec3 k = view.up, v = view.from;  // Rodrigues
  view.from = normalised(std::cos(angle) * v + std::sin(angle) * cross(k, v) + (1 - std::cos(angle)) * dot(k, v) * k);
  return view;
}

/// What the frames have in common.
Stage stage_of(const Run& run, const FilmOptions& options, std::vector<std::size_t>& frames, std::vector<std::string>& skipped,
               LongWork& work) {
  Stage stage(run, options.picture);
  std::vector<std::size_t> readable;
  const FramePoolResult read = for_each_frame(
      frames, options.pool,
      [&](std::size_t f) {
        Stage one = stage;
        one.room = Box3{};
        one.range.reset();
        one.add(run, load_frame(run, f), options.picture);
        std::vector<double> numbers{one.room.lower.x, one.room.lower.y, one.room.lower.z,
                                    one.room.upper.x, one.room.upper.y, one.room.upper.z};
        if (one.range) numbers.insert(numbers.end(), {one.range->first, one.range->second});
        return bytes_of(numbers);
      },
      [&](std::size_t f, const std::string& bytes) {
        const std::vector<double> n = doubles_of(bytes);
        readable.push_back(f);
        work.advance();
        stage.room.add(Vec3{n[0], n[1], n[2]});
        stage.room.add(Vec3{n[3], n[4], n[5]});
        if (n.size() < 8) return;
        stage.range =
            stage.range ? std::pair{std::min(stage.range->first, n[6]), std::max(stage.range->second, n[7])} : std::pair{n[6], n[7]};
      });
  frames = readable;
  skipped = read.skipped;
  return stage;
}

/// How fast a film shows a run.
std::string speed_text(double speed) {
  constexpr double kSame = 0.005;
  if (std::abs(speed - 1) < kSame) return "as fast as it happens";
  return speed > 1 ? fmt::format("{:.3g} times as fast as it happens", speed)
                   : fmt::format("{:.3g} times slower than it happens", 1 / speed);
}

}  // namespace

std::string write_film(const Run& run, const std::string& path, const FilmOptions& options, std::vector<std::string>& skipped) {
  keep_vtk_to_one_thread();
  const PictureOptions& look = options.picture;
  if (!path.ends_with(".gif") && (look.width % 2 != 0 || look.height % 2 != 0))
    throw UsageError("--size {} {}: the numbers of a film are even, for instance {} {}", look.width, look.height,
                     look.width + look.width % 2, look.height + look.height % 2);
  // known before the work is done
  if (const std::string reason = display_obstacle(); !reason.empty()) throw SystemError("cannot make a film: {}", reason);
  Encoder film(path, look.width, look.height, options.rate);

  std::vector<std::size_t> frames = options.frames;
  LongWork work("film", 2.0 * static_cast<double>(frames.size()));
  const Stage stage = stage_of(run, options, frames, skipped, work);
  if (frames.empty()) throw InputError("{}: no frame of it can be read", run.folder);
  const std::string unseen = words_of_unseen(run, frames, stage.within, {options.pool.jobs, false});
  const View first = camera_of(stage, run.scene.settings.gravity, look);
  const std::optional<Cut> cut = cut_of(first, look);
  std::map<std::size_t, double> angle;
  for (std::size_t i = 0; i < frames.size(); ++i)
    angle[frames[i]] = options.turn * std::numbers::pi / 180 * static_cast<double>(i) / static_cast<double>(frames.size());
  std::size_t drawn = 0;
  for_each_frame(
      frames, {options.pool.jobs, false},
      [&](std::size_t f) {
        const Image image = draw_frame(run, load_frame(run, f), look, stage, turned(first, angle[f]), cut);
        return std::string(image.rgb.begin(), image.rgb.end());
      },
      [&](std::size_t f, const std::string& rgb) {
        film.add(rgb);
        ++drawn;
        work.update(static_cast<double>(options.frames.size() + drawn), fmt::format("t = {:.4g} s", run.frames[f].time));
      });
  film.finish();
  const double length = static_cast<double>(frames.size()) / options.rate;
  const double simulated = run.frames[frames.back()].time - run.frames[frames.front()].time;
  std::string text = fmt::format("{} frames, {:.4g} s of film", frames.size(), length);
  if (frames.size() > 1 && simulated > 0)
    text += fmt::format(" for {:.4g} s of the run: {}", simulated,
                        speed_text(simulated * options.rate / static_cast<double>(frames.size() - 1)));
  if (!unseen.empty()) text += "\n" + unseen;
  return text;
}

}  // namespace scree
