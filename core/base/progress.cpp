#include "core/base/progress.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace scree {

namespace {
constexpr double kMaxInAFile = 600;  ///< [s] after which the next one comes at the latest
}  // namespace

double progress_patience() {
  const char* text = std::getenv("SCREE_PROGRESS_AFTER");
  return text != nullptr ? std::max(0.0, std::atof(text)) : kProgressAfter;
}

Progress::Progress(std::string title, double total, std::function<Time()> now)
    : title_(std::move(title)),
      total_(total),
      terminal_(isatty(STDERR_FILENO) != 0),
      patience_(progress_patience()),
      now_(std::move(now)),
      start_(now_()),
      last_print_(start_) {}

void Progress::update(double done, const std::string& text) {
  const double share = total_ > 0.0 ? std::clamp(done / total_, 0.0, 1.0) : 1.0;
  if (first_share_ < 0.0) first_share_ = share;
  const Time now = now_();
  const double silent = std::chrono::duration<double>(now - last_print_).count();
  if (terminal_) {
    if (silent < kRedrawInterval) return;
  } else {
    const int step = static_cast<int>(std::floor(share * kLinesInAFile + 1e-9));
    if (silent < patience_ || (step <= last_step_ && silent < kMaxInAFile)) return;
    last_step_ = step;
  }
  last_print_ = now;
  std::string left;
  if (share > first_share_) {
    // a restarted run begins with part of the work done: only what was done here tells the speed
    const double elapsed = std::chrono::duration<double>(now - start_).count();
    left = ", " + format_duration(elapsed * (1.0 - share) / (share - first_share_)) + " left";
  }
  const std::string line = fmt::format("{}: {:3.0f} %  {}{}", title_, 100.0 * share, text, left);
  std::fprintf(stderr, terminal_ ? "\r\033[K%s" : "%s\n", line.c_str());
  std::fflush(stderr);
}

void Progress::finish(const std::string& text) {
  const double elapsed = std::chrono::duration<double>(now_() - start_).count();
  std::fprintf(stderr, "%s%s: %s in %s\n", terminal_ ? "\r\033[K" : "", title_.c_str(), text.c_str(), format_duration(elapsed).c_str());
  std::fflush(stderr);
}

std::string format_duration(double seconds) {
  if (!(seconds >= 0.0) || !std::isfinite(seconds)) return "unknown time";
  if (seconds < 9.95) return fmt::format("{:.1f} s", seconds);
  const auto whole = static_cast<long long>(std::llround(seconds));
  if (whole < 60) return fmt::format("{} s", whole);
  if (whole < 3600) return fmt::format("{} min {:02} s", whole / 60, whole % 60);
  if (whole < 100 * 3600) return fmt::format("{} h {:02} min", whole / 3600, whole % 3600 / 60);
  return fmt::format("{:.0f} days", seconds / 86400);
}

}  // namespace scree
