// Writes the made-up run of the tests: scree_make_sample_run FOLDER.run
#include "core/base/mpi_session.hpp"
#include "tests/post/sample_run.hpp"

int main(int argc, char** argv) {
  if (argc != 2) return 2;
  const scree::mpi::Session session(argc, argv);
  scree::test::write_sample_run(argv[1]);
  return 0;
}
