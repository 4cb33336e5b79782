// main of the tests that run on several ranks: MPI around GoogleTest, and one voice for the result.
#include <gtest/gtest.h>
#include <mpi.h>

#include "core/base/mpi_session.hpp"

int main(int argc, char** argv) {
  const scree::mpi::Session session(argc, argv);
  testing::InitGoogleTest(&argc, argv);
  const int mine = RUN_ALL_TESTS();
  int worst = 0;
  MPI_Allreduce(&mine, &worst, 1, MPI_INT, MPI_MAX, MPI_COMM_WORLD);
  return worst;
}
