// How long pairs take, where that is asked for.
#pragma once

#include <chrono>
#include <cstdint>
#include <vector>

namespace scree {

/// Times one pair where that is asked for: reading the clock twice takes a tenth of an average pair.
class PairClock {
 public:
  PairClock(std::vector<float>& seconds, std::int32_t pair) : slot_(seconds.empty() ? nullptr : &seconds[static_cast<std::size_t>(pair)]) {
    if (slot_ != nullptr) start_ = Clock::now();
  }
  ~PairClock() {
    if (slot_ != nullptr) *slot_ = std::chrono::duration<float>(Clock::now() - start_).count();
  }
  PairClock(const PairClock&) = delete;
  PairClock& operator=(const PairClock&) = delete;

 private:
  using Clock = std::chrono::steady_clock;
  float* slot_;
  Clock::time_point start_;
};

}  // namespace scree
