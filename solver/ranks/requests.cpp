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

void Requests::fill(StepReport& mine) const {
  mine.signal = g_signal;
  mine.checkpoint = asked_;
}

void Requests::hear(const StepReport& all) {
  signal_ = static_cast<int>(all.signal);
  heard_ = all.checkpoint;
}

}  // namespace scree
