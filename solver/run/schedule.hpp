// When the outputs of a run are due.
#pragma once

#include <algorithm>
#include <cstdint>

#include "core/storage/scene_file.hpp"

namespace scree {

/// All in steps, counted from the start of the run: a restart writes at the same steps.
struct Schedule {
  std::int64_t last = 0;        ///< the run ends with it
  std::int64_t frame = 1;       ///< between frames
  std::int64_t log = 1;         ///< between rows of the log
  std::int64_t checkpoint = 0;  ///< between checkpoints; 0: none by steps
  double checkpoint_clock = 0;  ///< wall time between checkpoints [s]; 0: none by the clock

  bool is_frame_due(std::int64_t step) const { return step % frame == 0 || step == last; }
  bool is_row_due(std::int64_t step) const { return step % log == 0 || step == last; }
  bool is_checkpoint_due(std::int64_t step) const { return checkpoint > 0 && step % checkpoint == 0; }
  /// The first step after `step` after which something may be written.
  std::int64_t next_output(std::int64_t step) const {
    const auto next = [step](std::int64_t every) { return (step / every + 1) * every; };
    const std::int64_t of_both = std::min(next(frame), next(log));
    return std::min({last, of_both, checkpoint > 0 ? next(checkpoint) : last});
  }
  /// Of the frame at a step; the last one may come before a whole interval is over.
  std::int64_t frame_number(std::int64_t step) const { return (step + frame - 1) / frame; }
};

/// in   step_size      [s]
/// in   longest_row    time that may lie between two rows of the log at most [s]
/// in   by_clock       wall time between the checkpoints of a case that says nothing of them [s]; 0: none
Schedule make_schedule(const Settings& settings, double step_size, double longest_row, double by_clock);

}  // namespace scree
