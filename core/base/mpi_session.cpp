#include "core/base/mpi_session.hpp"

#include <mpi.h>

#include <cstdlib>

#include "core/base/error.hpp"

namespace scree::mpi {

Session::Session(int& argc, char**& argv) {
  // Open MPI asks hwloc for the hardware, whose plugin for GL knocks at the X displays :0 to :9: where one that is not ours wants a key,
  // the X library prints "Authorization required" for each. Nothing here needs to know of displays. What the user has set stays.
  setenv("HWLOC_COMPONENTS", "-gl", 0);
  int provided = 0;
  MPI_Init_thread(&argc, &argv, MPI_THREAD_FUNNELED, &provided);
  if (provided < MPI_THREAD_FUNNELED) throw SystemError("this MPI library does not allow threads (MPI_THREAD_FUNNELED)");
}

Session::~Session() {
  int finalized = 0;
  MPI_Finalized(&finalized);
  if (!finalized) MPI_Finalize();
}

}  // namespace scree::mpi
