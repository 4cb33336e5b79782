// The functions of scree_engine.h: exceptions become codes and texts, arrays become spans, and each call runs under the conditions that a
// run needs (call_conditions.hpp).
#include <mpi.h>
#include <omp.h>

#include <atomic>
#include <cstring>
#include <memory>
#include <new>
#include <string>
#include <tuple>

#include "core/base/mpi_session.hpp"
#include "core/base/version.hpp"
#include "core/base/warning_sink.hpp"
#include "solver/engine/call_conditions.hpp"
#include "solver/engine/hosted_run.hpp"
#include "solver/engine/scree_engine.h"

using namespace scree;

struct scree_engine {
  std::unique_ptr<HostedRun> run;
  int threads = 1;
  std::atomic<bool> busy{false};
  std::int64_t contact_count = 0;
  const FrameContacts* contacts = nullptr;
};

struct scree_state {
  std::shared_ptr<const Checkpoint> state;
};

namespace {

thread_local std::string g_error;

int fail(int code, const std::string& text) {
  g_error = text;
  return code;
}

/// Runs an action and maps what it throws.
template <class Action>
int mapped(Action&& action) {
  try {
    return action();
  } catch (const Error& error) {
    return fail(static_cast<int>(error.code()), error.what());
  } catch (const std::bad_alloc&) {
    return fail(SCREE_SYSTEM, "out of memory; use a smaller case or more ranks on more machines");
  } catch (const std::exception& error) {
    return fail(SCREE_INTERNAL, error.what());
  }
}

/// The same of a call to an engine: one at a time, and none from a function of forces.
template <class Action>
int called(scree_engine* engine, const char* what, Action&& action) {
  if (engine == nullptr || engine->run == nullptr) return fail(SCREE_USAGE, std::string(what) + ": there is no engine; open one first");
  if (engine->busy.exchange(true))
    return fail(SCREE_USAGE, std::string(what) +
                                 ": a call of this engine has not returned yet; from another thread wait for it, and within a "
                                 "function of forces only read bodies and facts");
  const int code = mapped([&] {
    const CallConditions conditions(engine->threads);
    return action(*engine->run);
  });
  engine->busy = false;
  return code;
}

int need(bool given, const char* what) { return given ? SCREE_DONE : fail(SCREE_USAGE, std::string(what) + " is NULL"); }

Vec3 vector_at(const double* numbers, std::int64_t row) {
  return numbers == nullptr ? Vec3{} : Vec3{numbers[3 * row], numbers[3 * row + 1], numbers[3 * row + 2]};
}

const char* text_or_empty(const char* text) { return text == nullptr ? "" : text; }

/// Begins MPI where nobody has; it then ends with the process.
void begin_mpi(bool has_comm) {
  int is_ended = 0, is_begun = 0, level = 0;
  MPI_Finalized(&is_ended);
  if (is_ended != 0) throw UsageError("open: MPI has been ended in this process; open the engine before MPI_Finalize");
  MPI_Initialized(&is_begun);
  if (is_begun == 0) {
    if (has_comm) throw UsageError("open: a communicator is given, and MPI is not begun in this process");
    static int argc = 0;
    static char** argv = nullptr;
    static const mpi::Session session(argc, argv);
  }
  MPI_Query_thread(&level);
  if (level < MPI_THREAD_FUNNELED)
    throw SystemError("open: MPI was begun without threads; begin it by MPI_Init_thread with MPI_THREAD_FUNNELED or more");
}

int open_on(const char* scene, MPI_Comm comm, const char* run, const char* restart, int threads, scree_engine** engine) {
  auto made = std::make_unique<scree_engine>();
  const int partner = omp_get_max_threads();
  made->threads = threads > 0 ? threads : partner;
  const CallConditions conditions(made->threads);
  made->run = std::make_unique<HostedRun>(scene, comm, HostedRun::Options{text_or_empty(run), text_or_empty(restart), threads});
  made->threads = omp_get_max_threads();  // as many as the bodies keep busy
  *engine = made.release();
  return SCREE_DONE;
}

template <class Column>
const double* numbers_of(const std::vector<Column>& column) {
  static const double kNone = 0;
  return column.empty() ? &kNone : reinterpret_cast<const double*>(column.data());
}

}  // namespace

int scree_engine_abi(void) { return SCREE_ENGINE_ABI; }
const char* scree_engine_version(void) { return kVersion; }
const char* scree_error(void) { return g_error.c_str(); }

void scree_on_warning(void (*function)(void*, const char*), void* user) {
  if (function == nullptr) return set_warning_sink({});
  set_warning_sink([function, user](const std::string& text) { function(user, text.c_str()); });
}

int scree_open(const char* scene, const void* comm, const char* run, const char* restart, int threads, scree_engine** engine) {
  if (engine == nullptr || scene == nullptr)
    return fail(SCREE_USAGE, "open: a scene file and a place for the engine are needed; one is NULL");
  *engine = nullptr;
  return mapped([&] {
    begin_mpi(comm != nullptr);
    const MPI_Comm on = comm == nullptr ? MPI_COMM_SELF : *static_cast<const MPI_Comm*>(comm);
    if (on == MPI_COMM_NULL) throw UsageError("open: the communicator is MPI_COMM_NULL; give one that this process belongs to");
    return open_on(scene, on, run, restart, threads, engine);
  });
}

int scree_open_fortran(const char* scene, int comm, const char* run, const char* restart, int threads, scree_engine** engine) {
  const MPI_Comm on = MPI_Comm_f2c(comm);
  return scree_open(scene, &on, run, restart, threads, engine);
}

int scree_close(scree_engine* engine) {
  if (engine == nullptr) return SCREE_DONE;
  const int code = called(engine, "close", [](HostedRun& run) {
    run.close();
    return SCREE_DONE;
  });
  if (engine->busy) return code;  // of another thread
  int is_ended = 0;
  MPI_Finalized(&is_ended);
  if (is_ended == 0)
    delete engine;
  else
    engine->run.release();  // communicators are gone with MPI
  return code;
}

int scree_step(scree_engine* engine, int64_t n) {
  return called(engine, "step", [&](HostedRun& run) { return run.step(n); });
}
int scree_run_until(scree_engine* engine, double time) {
  return called(engine, "run_until", [&](HostedRun& run) { return run.run_until(time); });
}
int scree_on_poll(scree_engine* engine, int (*function)(void*), double interval, void* user) {
  return called(engine, "on_poll", [&](HostedRun& run) {
    run.on_poll(
        function == nullptr ? std::function<int()>() : [function, user] { return function(user); }, interval);
    return SCREE_DONE;
  });
}

double scree_time(const scree_engine* engine) { return engine->run->time(); }
double scree_dt(const scree_engine* engine) { return engine->run->dt(); }
int64_t scree_step_count(const scree_engine* engine) { return engine->run->step_count(); }
double scree_duration(const scree_engine* engine) { return engine->run->scene().settings.duration; }
int scree_is_over(const scree_engine* engine) { return engine->run->is_over() ? 1 : 0; }
double scree_gravity(const scree_engine* engine, int component) {
  return component < 0 || component > 2 ? 0 : engine->run->scene().settings.gravity[component];
}
int scree_shape_count(const scree_engine* engine) { return static_cast<int>(engine->run->scene().shapes.size()); }
const char* scree_shape_name(const scree_engine* engine, int shape) {
  const auto& shapes = engine->run->scene().shapes;
  return shape < 0 || static_cast<std::size_t>(shape) >= shapes.size() ? nullptr : shapes[static_cast<std::size_t>(shape)].name.c_str();
}
int scree_material_count(const scree_engine* engine) { return static_cast<int>(engine->run->scene().materials.size()); }
const char* scree_material_name(const scree_engine* engine, int material) {
  const auto& materials = engine->run->scene().materials;
  return material < 0 || static_cast<std::size_t>(material) >= materials.size()
             ? nullptr
             : materials[static_cast<std::size_t>(material)].name.c_str();
}

int64_t scree_body_count(const scree_engine* engine) { return engine->run->body_count(); }
const double* scree_reals(scree_engine* engine, const char* field) {
  const double* numbers = nullptr;
  mapped([&] {
    numbers = engine->run->reals(text_or_empty(field));
    return SCREE_DONE;
  });
  if (numbers == nullptr)
    fail(SCREE_USAGE, std::string("bodies have no field '") + text_or_empty(field) +
                          "' of real numbers; there are: position, quaternion, velocity, angular_velocity, force, torque, mass, volume, "
                          "diameter, radius, scale, and temperature in a scene with heat");
  return numbers;
}
const int64_t* scree_integers(scree_engine* engine, const char* field) {
  const std::int64_t* numbers = nullptr;
  mapped([&] {
    numbers = engine->run->integers(text_or_empty(field));
    return SCREE_DONE;
  });
  if (numbers == nullptr)
    fail(SCREE_USAGE, std::string("bodies have no field '") + text_or_empty(field) +
                          "' of whole numbers; there are: id, shape, material, fixed, asleep");
  return numbers;
}

int scree_set_wrench(scree_engine* engine, int64_t n, const int64_t* ids, const double* forces, const double* torques) {
  if (n < 0 || (n > 0 && (ids == nullptr || forces == nullptr)))
    return fail(SCREE_USAGE, "set_wrench: ids and forces of n >= 0 bodies are needed");
  return called(engine, "set_wrench", [&](HostedRun& run) {
    std::vector<WrenchOnBody> mine;
    for (std::int64_t k = 0; k < n; ++k) mine.push_back({ids[k], {vector_at(forces, k), vector_at(torques, k)}});
    run.hold(mine);
    return SCREE_DONE;
  });
}
int scree_clear_wrench(scree_engine* engine, int64_t n, const int64_t* ids) {
  return called(engine, "clear_wrench", [&](HostedRun& run) {
    run.release(ids == nullptr ? std::nullopt : std::optional(std::vector<std::int64_t>(ids, ids + std::max<std::int64_t>(0, n))));
    return SCREE_DONE;
  });
}
int scree_add_force(scree_engine* engine, scree_force_function function, int64_t every, void* user, int* number) {
  if (function == nullptr || number == nullptr) return fail(SCREE_USAGE, "add_force: the function or the place for its number is NULL");
  return called(engine, "add_force", [&](HostedRun& run) {
    *number = run.add_force(
        [engine, function, user](std::span<Vec3> force, std::span<Vec3> torque) {
          const int result = function(user, engine, static_cast<std::int64_t>(force.size()), reinterpret_cast<double*>(force.data()),
                                      reinterpret_cast<double*>(torque.data()));
          if (result != 0) throw UsageError("a function of outer forces failed: it gave {}", result);
        },
        every);
    return SCREE_DONE;
  });
}
int scree_remove_force(scree_engine* engine, int number) {
  return called(engine, "remove_force", [&](HostedRun& run) {
    run.remove_force(number);
    return SCREE_DONE;
  });
}

int scree_wall_count(const scree_engine* engine) { return static_cast<int>(engine->run->scene().walls.size()); }
const char* scree_wall_name(const scree_engine* engine, int wall) {
  const auto& walls = engine->run->scene().walls;
  return wall < 0 || static_cast<std::size_t>(wall) >= walls.size() ? nullptr : walls[static_cast<std::size_t>(wall)].name.c_str();
}
int scree_wall_loads(scree_engine* engine, double* loads) {
  if (const int code = need(loads != nullptr, "wall_loads: the place for the loads"); code != SCREE_DONE) return code;
  return called(engine, "wall_loads", [&](HostedRun& run) {
    const auto all = run.wall_loads();
    for (std::size_t w = 0; w < all.size(); ++w) std::copy(all[w].begin(), all[w].end(), loads + 6 * w);
    return SCREE_DONE;
  });
}
int scree_wall_state(scree_engine* engine, int wall, double* state) {
  if (wall < 0 || wall >= scree_wall_count(engine) || state == nullptr)
    return fail(SCREE_USAGE, "wall_state: the scene has no wall of this number");
  const auto numbers = engine->run->wall_state(static_cast<std::size_t>(wall));
  std::copy(numbers.begin(), numbers.end(), state);
  return SCREE_DONE;
}

int scree_drive_wall(scree_engine* engine, int wall, double rate) {
  if (wall < 0 || wall >= scree_wall_count(engine)) return fail(SCREE_USAGE, "drive_wall: the scene has no wall of this number");
  return called(engine, "drive_wall", [&](HostedRun& run) {
    run.drive_wall(static_cast<std::size_t>(wall), rate);
    return SCREE_DONE;
  });
}
int scree_wall_way(scree_engine* engine, int wall, double* way, double* rate) {
  if (wall < 0 || wall >= scree_wall_count(engine) || way == nullptr || rate == nullptr)
    return fail(SCREE_USAGE, "wall_way: the scene has no wall of this number, or a place for a number is NULL");
  return mapped([&] {
    std::tie(*way, *rate) = engine->run->wall_way(static_cast<std::size_t>(wall));
    return SCREE_DONE;
  });
}

int scree_get_energies(scree_engine* engine, scree_energies* to) {
  if (const int code = need(to != nullptr, "energies: the place for them"); code != SCREE_DONE) return code;
  return called(engine, "energies", [&](HostedRun& run) {
    const Energies e = run.energies();
    *to = {e.translational, e.rotational, e.potential, e.elastic, e.tangential_elastic, e.dissipated, e.wall_work,
           e.outer_work,    e.removed,    e.arrived,   e.bond,    e.fracture,           e.slept,      e.balance()};
    return SCREE_DONE;
  });
}
int scree_state_hash(scree_engine* engine, char* text33) {
  if (const int code = need(text33 != nullptr, "state_hash: the place for the text"); code != SCREE_DONE) return code;
  return called(engine, "state_hash", [&](HostedRun& run) {
    const std::string hash = run.state_hash();
    constexpr std::size_t kDigits = 32;
    std::memcpy(text33, hash.c_str(), kDigits + 1);
    return SCREE_DONE;
  });
}
int scree_critical_step(scree_engine* engine, double* step) {
  if (const int code = need(step != nullptr, "critical_step: the place for it"); code != SCREE_DONE) return code;
  return called(engine, "critical_step", [&](HostedRun& run) {
    *step = run.critical_step();
    return SCREE_DONE;
  });
}
int scree_contacts(scree_engine* engine, int64_t* count) {
  if (const int code = need(count != nullptr, "contacts: the place for their number"); code != SCREE_DONE) return code;
  return called(engine, "contacts", [&](HostedRun& run) {
    engine->contacts = &run.collect_contacts();
    *count = static_cast<std::int64_t>(engine->contacts->size());
    return SCREE_DONE;
  });
}
const double* scree_contact_reals(const scree_engine* engine, const char* field) {
  const std::string name = text_or_empty(field);
  if (engine->contacts != nullptr) {
    const FrameContacts& c = *engine->contacts;
    if (name == "overlap") return numbers_of(c.overlap);
    if (name == "margin") return numbers_of(c.margin);
    if (name == "normal_force") return numbers_of(c.normal_force);
    if (name == "point") return numbers_of(c.point);
    if (name == "normal") return numbers_of(c.normal);
    if (name == "tangential_force") return numbers_of(c.tangential_force);
  }
  fail(SCREE_USAGE, "contacts have no field '" + name + "' of real numbers, or were not collected by scree_contacts()");
  return nullptr;
}
const int64_t* scree_contact_integers(const scree_engine* engine, const char* field) {
  static const std::int64_t kNone = 0;
  const std::string name = text_or_empty(field);
  if (engine->contacts != nullptr) {
    const FrameContacts& c = *engine->contacts;
    const auto* column = name == "body_a" ? &c.body_a : name == "body_b" ? &c.body_b : name == "feature" ? &c.feature : nullptr;
    if (column != nullptr) return column->empty() ? &kNone : column->data();
  }
  fail(SCREE_USAGE, "contacts have no field '" + name + "' of whole numbers, or were not collected by scree_contacts()");
  return nullptr;
}

int scree_save(scree_engine* engine, scree_state** state) {
  if (const int code = need(state != nullptr, "save: the place for the state"); code != SCREE_DONE) return code;
  *state = nullptr;
  return called(engine, "save", [&](HostedRun& run) {
    *state = new scree_state{run.save()};
    return SCREE_DONE;
  });
}
int scree_restore(scree_engine* engine, const scree_state* state) {
  if (const int code = need(state != nullptr, "restore: the state"); code != SCREE_DONE) return code;
  return called(engine, "restore", [&](HostedRun& run) {
    run.restore(*state->state);
    return SCREE_DONE;
  });
}
void scree_free_state(scree_state* state) { delete state; }
int scree_write_checkpoint(scree_engine* engine, const char* folder) {
  if (const int code = need(folder != nullptr, "write_checkpoint: the folder"); code != SCREE_DONE) return code;
  return called(engine, "write_checkpoint", [&](HostedRun& run) {
    run.write_checkpoint(folder);
    return SCREE_DONE;
  });
}
int scree_write_frame(scree_engine* engine, const char* path) {
  if (const int code = need(path != nullptr, "write_frame: the path"); code != SCREE_DONE) return code;
  return called(engine, "write_frame", [&](HostedRun& run) {
    run.write_frame(path);
    return SCREE_DONE;
  });
}

int scree_insert(scree_engine* engine, int64_t n, const scree_new_body* bodies, int64_t* ids) {
  if (n < 0 || (n > 0 && (bodies == nullptr || ids == nullptr)))
    return fail(SCREE_USAGE, "insert: n >= 0 bodies and a place for their ids are needed");
  return called(engine, "insert", [&](HostedRun& run) {
    std::vector<NewBody> mine;
    for (std::int64_t k = 0; k < n; ++k) {
      const scree_new_body& b = bodies[k];
      mine.push_back({text_or_empty(b.shape), text_or_empty(b.material), vector_at(b.position, 0),
                      Quat{b.quaternion[0], b.quaternion[1], b.quaternion[2], b.quaternion[3]}, vector_at(b.velocity, 0),
                      vector_at(b.angular_velocity, 0), b.scale});
    }
    const std::vector<std::int64_t> given = run.insert(mine);
    std::copy(given.begin(), given.end(), ids);
    return SCREE_DONE;
  });
}
int scree_remove(scree_engine* engine, int64_t n, const int64_t* ids) {
  if (n < 0 || (n > 0 && ids == nullptr)) return fail(SCREE_USAGE, "remove: n >= 0 ids are needed");
  return called(engine, "remove", [&](HostedRun& run) {
    run.remove(std::vector<std::int64_t>(ids, ids + n));
    return SCREE_DONE;
  });
}
