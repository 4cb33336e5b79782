#include "solver/phases.hpp"

#include <ctime>

namespace scree {

const char* phase_name(Phase phase) {
  switch (phase) {
    case Phase::search:
      return "search";
    case Phase::sort:
      return "sort";
    case Phase::contact:
      return "contact";
    case Phase::duplicated:
      return "twice";
    case Phase::sum:
      return "gather";
    case Phase::integrate:
      return "integrate";
    case Phase::halo:
      return "halo";
    case Phase::wait:
      return "wait";
    case Phase::agree:
      return "agree";
    case Phase::migrate:
      return "migrate";
    case Phase::output:
      return "output";
    case Phase::count:
      break;
  }
  return "unknown";
}

double thread_seconds() {
  timespec t{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

}  // namespace scree
