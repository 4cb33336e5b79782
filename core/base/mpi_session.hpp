// MPI from the first line of a tool to its last.
#pragma once

namespace scree::mpi {

/// MPI_Init and MPI_Finalize. The first local of main(): what uses MPI lives in it, threads may be started, and this one calls MPI alone.
/// Fails: throws SystemError when the library does not allow threads.
class Session {
 public:
  Session(int& argc, char**& argv);
  ~Session();
  Session(const Session&) = delete;
  Session& operator=(const Session&) = delete;
};

}  // namespace scree::mpi
