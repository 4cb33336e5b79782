// What a call into the engine needs of the process, and puts back: the number of threads, the rounding of floating-point numbers, and how
// denormal numbers are treated. A partner that rounds upwards, or flushes denormal numbers to zero, would change bits of the run.
#pragma once

#include <cfenv>
#include <vector>

namespace scree {

/// Sets them for this thread and for the threads that it starts, as a run of scree-solver has them; the destructor puts back those of the
/// caller. Cost: two starts of the threads (10 us) where there is more than one; else 0.1 us.
class CallConditions {
 public:
  /// in   threads   that the call may start
  explicit CallConditions(int threads);
  ~CallConditions();
  /// For a call back to the caller on this thread: its conditions, then those of the call again.
  void leave();
  void enter();
  CallConditions(const CallConditions&) = delete;
  CallConditions& operator=(const CallConditions&) = delete;

 private:
  int threads_before_, is_dynamic_before_, threads_;
  std::vector<std::fenv_t> environments_;  // of each thread
};

}  // namespace scree
