// main() of the GoogleTest executables that run on several ranks: rank 0 talks, any failure fails all.
#include <gtest/gtest.h>

#include "tests/support/test_run.hpp"

int main(int argc, char** argv) {
  const scree::mpi::Session session(argc, argv);
  scree::mpi::Communicator comm;
  scree::test::g_comm = &comm;
  testing::InitGoogleTest(&argc, argv);
  auto& listeners = testing::UnitTest::GetInstance()->listeners();
  if (comm.rank() != 0) delete listeners.Release(listeners.default_result_printer());
  return static_cast<int>(comm.max(RUN_ALL_TESTS()));
}
