#include "core/base/mpi_session.hpp"

#include <mpi.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <utility>
#include <vector>

#include "core/base/error.hpp"

namespace scree::mpi {

namespace {

/// Whether mpirun, srun or another launcher of several processes started this one (Open MPI, PMIx, PMI-1 and -2).
bool has_launcher() {
  constexpr std::array kRanks{"OMPI_COMM_WORLD_RANK", "PMIX_RANK", "PMI_RANK"};
  return std::any_of(kRanks.begin(), kRanks.end(), [](const char* name) { return std::getenv(name) != nullptr; });
}

/// Settings of Open MPI for a process that is alone, while it starts. No search for networks, no daemon beside it (which only
/// MPI_Comm_spawn needs), and no folder of a session, which all processes without a daemon would share, and the first to end would take
/// from the others: these took most of the time of a tool that has little to do. What the user has set stays. Programs that this one
/// starts later, mpirun among them, do not inherit the settings.
class AloneAtStart {
 public:
  AloneAtStart() {
    if (has_launcher()) return;
    for (const auto& [name, value] :
         {std::pair{"OMPI_MCA_pml", "ob1"}, std::pair{"OMPI_MCA_btl", "self"}, std::pair{"OMPI_MCA_ess_singleton_isolated", "1"},
          std::pair{"OMPI_MCA_orte_create_session_dirs", "0"}}) {
      if (std::getenv(name) == nullptr && setenv(name, value, 0) == 0) set_.push_back(name);
    }
    // Without a folder of a session the shared file pointers of Open MPI that live in shared memory print an error for each file that is
    // opened, and are left out. Nothing here uses shared file pointers. They are chosen as files are opened: the setting stays.
    setenv("OMPI_MCA_sharedfp", "^sm", 0);
  }
  ~AloneAtStart() {
    for (const char* name : set_) unsetenv(name);
  }
  AloneAtStart(const AloneAtStart&) = delete;
  AloneAtStart& operator=(const AloneAtStart&) = delete;

 private:
  std::vector<const char*> set_;
};

}  // namespace

Session::Session(int& argc, char**& argv) {
  // Open MPI asks hwloc for the hardware, whose plugin for GL knocks at the X displays :0 to :9: where one that is not ours wants a key,
  // the X library prints "Authorization required" for each. Nothing here needs to know of displays. What the user has set stays.
  setenv("HWLOC_COMPONENTS", "-gl", 0);
  const AloneAtStart settings;
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
