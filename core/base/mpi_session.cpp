#include "core/base/mpi_session.hpp"

#include <mpi.h>

#include "core/base/error.hpp"

namespace scree::mpi {

Session::Session(int& argc, char**& argv) {
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
