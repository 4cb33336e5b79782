// NAME.run as a whole: the scene it was run from, its frames, its log and its outcome.
// The page of the format is core/storage/RUN_FORMAT.md.
#pragma once

#include <string>
#include <unordered_set>
#include <vector>

#include "core/base/json_record.hpp"
#include "core/storage/frame_file.hpp"
#include "core/storage/scene_file.hpp"

namespace scree {

inline constexpr std::int64_t kRunFormatVersion = 1;

/// log.csv by column name. Text columns (state_hash) read as NaN.
struct LogTable {
  std::vector<std::string> names;
  std::vector<std::vector<double>> columns;
  std::size_t rows() const { return columns.empty() ? 0 : columns.front().size(); }
  bool has(const std::string& name) const;
  /// Throws InputError when there is no such column.
  const std::vector<double>& column(const std::string& name) const;
};

struct Run {
  std::string folder;  ///< as given, without a trailing slash
  std::string name;    ///< "boulders" of boulders.run
  Scene scene;
  std::vector<FrameEntry> frames;    ///< ascending in time, each complete on disk
  LogTable log;                      ///< empty when there is no log.csv
  JsonRecord outcome;                ///< run.json; null while the run is being written or when it was killed
  std::vector<std::string> damaged;  ///< messages of frames that were left out because they cannot be read; see drop_damaged_frames
  std::unordered_set<std::int64_t> boundary_ids;  ///< walls and fixed bodies: no particles

  bool is_finished() const;
  /// Whether a program stepped it (docs/user/engine.md), which may have inserted and removed bodies.
  bool has_program() const;
  /// Bodies that came in and that were taken out so far, of run.json, else of the log.
  double inserted() const;
  double removed() const;
  /// Whether bodies can come in or leave: by inlets and outlets, at the sides of the domain, or because a program had them do so.
  bool lets_in() const;
  bool lets_out() const;
  /// What the user must know before trusting the output; empty for a completed run.
  std::string notice() const;
};

/// Opens a run folder. A run that is still being written is opened with the frames it has so far.
/// Throws InputError when something in it is missing, damaged or of a newer version, with the file named.
Run open_run(const std::string& folder);

/// Takes out of `frames` those that cannot be opened (truncated, missing, no frames), and keeps their messages in `damaged`.
/// A frame of a newer version is not damaged: it stays, and is refused when it is read.
/// Throws InputError when none is left.   Cost: opens every frame.
void drop_damaged_frames(Run& run);

/// Frame by index from 0, checked against the scene. Throws InputError with the file named.
Frame load_frame(const Run& run, std::size_t index, FrameParts parts = FrameParts::all);

/// Turns "--frame N" into an index: the number in the file's name; -1 is the last. Throws UsageError.
std::size_t find_frame(const Run& run, std::int64_t number, const char* option = "--frame");

/// Reads log.csv. An unfinished last line is left out. Throws InputError when it is no such table.
LogTable read_log(const std::string& path);

}  // namespace scree
