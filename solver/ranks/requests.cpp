#include "solver/ranks/requests.hpp"

#include <csignal>

namespace scree {

namespace {

volatile std::sig_atomic_t g_signal = 0;

extern "C" void note_signal(int number) { g_signal = number; }

}  // namespace

void catch_signals() {
  for (const int number : {SIGINT, SIGTERM, SIGUSR1}) std::signal(number, note_signal);
  std::signal(SIGXFSZ, SIG_IGN);  // a file over the limit of its size is an error of the write, reported with its name
}

bool Requests::is_signal_caught() const { return deaf_steps_ == 0 && (stop_ != 0 || g_signal != 0); }

void Requests::fill(StepReport& mine) const {
  mine.signal = stop_ != 0 ? stop_ : g_signal;
  mine.checkpoint = asked_;
}

void Requests::hear(const StepReport& all) {
  signal_ = deaf_steps_ > 0 ? 0 : static_cast<int>(all.signal);
  if (deaf_steps_ > 0) --deaf_steps_;
  heard_ = all.checkpoint;
}

void Requests::stopped() {
  constexpr int kStepsAhead = 2;
  signal_ = stop_ = 0;
  deaf_steps_ = kStepsAhead;
}

}  // namespace scree
