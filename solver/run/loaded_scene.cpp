#include "solver/run/loaded_scene.hpp"

#include "core/base/provenance.hpp"
#include "core/storage/collective_file.hpp"
#include "solver/scene/origin.hpp"

namespace scree {

LoadedScene load_scene(const mpi::Communicator& comm, const std::string& path) {
  LoadedScene loaded;
  loaded.path = path;
  const auto read = [&] {
    loaded.scene = read_scene_file(path);
    loaded.start = read_start_state(path, loaded.scene.bodies.size());
    loaded.sha256 = sha256_of_file(path);
    loaded.origin = choose_origin(loaded.scene);
    move_scene(loaded.scene, loaded.origin);
    loaded.prepared = std::make_unique<SolverScene>(loaded.scene);
  };
  mpi::on_root(comm, read);
  // each other rank reads for itself, perhaps on another machine: what fails there, or is another file, all must know of
  const std::string sha256 = broadcast_text(comm.get(), loaded.sha256);
  mpi::on_all(comm, [&] {
    if (comm.rank() == 0) return;
    try {
      read();
    } catch (const Error& e) {
      throw Error(e.code(), fmt::format("{} (rank {}; rank 0 can read it)", e.what(), comm.rank()));
    }
    if (loaded.sha256 != sha256)
      throw InputError("{}: rank {} finds another file of this name than rank 0; use a path that is the same everywhere", path,
                       comm.rank());
  });
  return loaded;
}

}  // namespace scree
