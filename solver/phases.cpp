#include "solver/phases.hpp"

namespace scree {

const char* phase_name(Phase phase) {
  switch (phase) {
    case Phase::search: return "search";
    case Phase::distance: return "contact";
    case Phase::integrate: return "integrate";
    case Phase::halo: return "halo";
    case Phase::migrate: return "migrate";
    case Phase::output: return "output";
    case Phase::count: break;
  }
  return "unknown";
}

}  // namespace scree
