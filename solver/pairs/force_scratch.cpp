#include "solver/pairs/force_scratch.hpp"

#include <omp.h>

namespace scree {

ForceScratch::ForceScratch() {
  for (int t = 0; t < omp_get_max_threads(); ++t) distance.push_back(make_mesh_distance_scratch());
}

}  // namespace scree
