// Progress of a long job: a line with time left on a terminal, one line per 5 % otherwise.
#pragma once

#include <chrono>
#include <string>

namespace scree {

/// Talks to stderr. One thread, one rank.
class Progress {
 public:
  /// in   title   "solver"     in   total   work units at the end (> 0)
  Progress(std::string title, double total);
  /// Tells how far the work is, with a short text ("t = 0.31 s, 812 contacts"). Cheap when nothing is due.
  void update(double done, const std::string& text);
  /// Ends the line on a terminal.
  void finish(const std::string& text);

 private:
  std::string title_;
  double total_;
  bool terminal_;
  int last_step_ = -1;
  double first_share_ = -1.0;  ///< share of the work that was done before the first update
  std::chrono::steady_clock::time_point start_, last_print_;
};

/// "3 min 12 s", "1 h 04 min", "0.8 s".
std::string format_duration(double seconds);

}  // namespace scree
