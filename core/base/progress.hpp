// Progress of a long job: a line with time left on a terminal; otherwise one line per 5 %, at most one in kProgressAfter,
// the first of them then whatever the share, and at least one in ten minutes.
#pragma once

#include <chrono>
#include <functional>
#include <string>

namespace scree {

/// [s] before work speaks, and between two lines in a file. The environment variable SCREE_PROGRESS_AFTER changes it.
inline constexpr double kProgressAfter = 3;
inline constexpr double kRedrawInterval = 0.2;  ///< [s] on a terminal; more often only costs time and flickers
inline constexpr int kLinesInAFile = 20;        ///< one line per 5 %

/// The same, with the environment variable.
double progress_patience();

/// Talks to stderr. One thread, one rank.
class Progress {
 public:
  using Time = std::chrono::steady_clock::time_point;
  /// in   title   "solver"     in   total   work units at the end (> 0)     in   now   for tests
  Progress(std::string title, double total, std::function<Time()> now = std::chrono::steady_clock::now);
  /// Tells how far the work is, with a short text ("t = 0.31 s, 812 contacts"). Cheap when nothing is due.
  void update(double done, const std::string& text);
  /// Ends the line on a terminal.
  void finish(const std::string& text);

 private:
  std::string title_;
  double total_;
  bool terminal_;
  double patience_;            ///< [s]
  int last_step_ = -1;         ///< of 5 %, that was told
  double first_share_ = -1.0;  ///< share of the work that was done before the first update
  std::function<Time()> now_;
  Time start_, last_print_;
};

/// "3 min 12 s", "1 h 04 min", "0.8 s"; from 100 hours "155 days".
std::string format_duration(double seconds);

}  // namespace scree
