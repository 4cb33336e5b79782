// Progress of long work, told from where the work is done.
//
// Work that can take more than some seconds makes a LongWork and says now and then how far it is. Nothing is printed until main has
// called print_progress(), and nothing by work that is done within kProgressAfter: what takes no time says nothing. Of pieces of work
// inside each other the outermost speaks. On a terminal a line renews itself; elsewhere a line is written at every 5 %, at most one
// in kProgressAfter and at least one in ten minutes.
#pragma once

#include <string>

namespace scree {

/// Lets long work print to stderr from now on, or no longer: a child process that shares the work of its parent is silent.
void print_progress(bool on);

/// One thread: that of main.
class LongWork {
 public:
  /// in   name   "settle"     in   total   units of work at the end; <= 0: not known, the time is told alone
  LongWork(std::string name, double total);
  ~LongWork();
  LongWork(const LongWork&) = delete;
  LongWork& operator=(const LongWork&) = delete;

  /// How far the work is, with a short text ("12 of 40 bodies poured"). Costs a look at the clock when nothing is due.
  void update(double done, const std::string& text = "");
  /// The same for units that are counted one by one.
  void advance(double by = 1) { update(done_ + by); }

 private:
  void print(double now, const std::string& text);

  std::string name_;
  double total_, done_ = 0;
  bool speaks_;  ///< the outermost work, in a tool that prints progress
  bool has_spoken_ = false;
  double start_ = 0, next_ = 0;  ///< [s] on the steady clock: the beginning, and when a line is due again
  double last_ = 0;              ///< [s] of the last line
  int last_step_ = 0;            ///< of 5 %, in the last line
  std::string last_text_;        ///< of the last line
};

}  // namespace scree
