// Writes the made-up run of the tests: scree_make_sample_run FOLDER.run [BODIES FRAMES [come-and-go]]
#include <string>

#include "core/base/mpi_session.hpp"
#include "tests/post/sample_run.hpp"

int main(int argc, char** argv) {
  if (argc != 2 && argc != 4 && argc != 5) return 2;
  const scree::mpi::Session session(argc, argv);
  const std::size_t bodies = argc > 2 ? std::stoul(argv[2]) : 12;
  scree::test::write_sample_run(argv[1], bodies, argc > 2 ? std::stoi(argv[3]) : 3, argc > 4);
  return 0;
}
