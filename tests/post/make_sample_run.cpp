// Writes the made-up run of the tests: scree_make_sample_run FOLDER.run
#include "tests/post/sample_run.hpp"

int main(int argc, char** argv) {
  if (argc != 2) return 2;
  MPI_Init(&argc, &argv);
  scree::test::write_sample_run(argv[1]);
  MPI_Finalize();
  return 0;
}
