#include "core/base/long_work.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <exception>

#include "core/base/progress.hpp"

namespace scree {

namespace {

constexpr double kLongestSilence = 600;  ///< [s] in a file, however slow the work is

bool prints = false;
int depth = 0;

double seconds_now() { return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count(); }

bool on_terminal() { return isatty(STDERR_FILENO) != 0; }

}  // namespace

void print_progress(bool on) { prints = on; }

LongWork::LongWork(std::string name, double total)
    : name_(std::move(name)),
      total_(total),
      speaks_(prints && depth == 0),
      start_(seconds_now()),
      next_(start_ + progress_patience()),
      last_(start_) {
  ++depth;
}

LongWork::~LongWork() {
  --depth;
  if (!has_spoken_) return;
  if (on_terminal()) std::fputs("\r\033[K", stderr);
  // work that failed is told by the error
  if (std::uncaught_exceptions() == 0)
    std::fprintf(stderr, "%s: done in %s\n", name_.c_str(), format_duration(seconds_now() - start_).c_str());
  std::fflush(stderr);
}

void LongWork::update(double done, const std::string& text) {
  done_ = done;
  if (!speaks_) return;
  const double now = seconds_now();
  if (now < next_) return;
  print(now, text);
}

void LongWork::print(double now, const std::string& text) {
  const double share = total_ > 0 ? std::clamp(done_ / total_, 0.0, 1.0) : 0;
  if (!on_terminal()) {
    const int step = static_cast<int>(std::floor(share * kLinesInAFile + 1e-9));
    if (total_ > 0 && has_spoken_ && step <= last_step_ && now - last_ < kLongestSilence) return;
    // without a total, a line that says the same again is a sign of life only
    if (total_ <= 0 && has_spoken_ && !text.empty() && text == last_text_ && now - last_ < kLongestSilence) return;
    last_step_ = step;
    last_text_ = text;
  }
  // without a total the silence grows with the work, so that a night does not fill a file
  const double pause = on_terminal() ? kRedrawInterval
                       : total_ > 0  ? progress_patience()
                                     : std::max(progress_patience(), std::min(now - start_, kLongestSilence));
  next_ = now + pause;
  last_ = now;
  has_spoken_ = true;
  std::string line = name_ + ":";
  if (total_ > 0) line += fmt::format(" {:3.0f} %", 100 * share);
  if (!text.empty()) line += "  " + text;
  line += total_ > 0 && share > 0 ? fmt::format(", {} left", format_duration((now - start_) * (1 - share) / share))
                                  : fmt::format(", {} so far", format_duration(now - start_));
  std::fprintf(stderr, on_terminal() ? "\r\033[K%s" : "%s\n", line.c_str());
  std::fflush(stderr);
}

}  // namespace scree
