// The functions of scree_engine.h: exceptions become codes and texts, arrays become spans, and each call runs under the conditions that a
// run needs (call_conditions.hpp).
#include <mpi.h>
#include <omp.h>

#include <memory>
#include <string>
#include <utility>

#include "core/base/mpi_session.hpp"
#include "core/base/version.hpp"
#include "core/base/warning_sink.hpp"
#include "solver/engine/c_call.hpp"

using namespace scree;

namespace {

thread_local std::string g_error;

}  // namespace

int scree::fail(int code, const std::string& text) {
  g_error = text;
  return code;
}

namespace {

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
  constexpr int kMostThreads = 1024;
  if (threads < 0 || threads > kMostThreads)
    throw UsageError("threads = {}: expected 1 to {}, or 0 for a choice by the number of bodies", threads, kMostThreads);
  auto made = std::make_unique<scree_engine>();
  const int partner = omp_get_max_threads();
  made->threads = threads > 0 ? threads : partner;
  const CallConditions conditions(made->threads);
  made->run = std::make_unique<HostedRun>(scene, comm, HostedRun::Options{text_or_empty(run), text_or_empty(restart), threads});
  made->threads = omp_get_max_threads();  // as many as the bodies keep busy
  *engine = made.release();
  return SCREE_DONE;
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
  forget_warnings();  // those of an engine that was opened before are new for this one
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
  if (engine->busy.exchange(true)) return fail(SCREE_USAGE, "close: a call of this engine has not returned yet; wait for it");
  const int code = mapped([&] {
    const CallConditions conditions(engine->threads);
    engine->run->close();
    return SCREE_DONE;
  });
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
    std::function<int()> poll;
    if (function != nullptr) poll = [engine, function, user] { return call_back(engine, [&] { return function(user); }); };
    run.on_poll(std::move(poll), interval);
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
  const int code = mapped([&] {
    numbers = engine->run->reals(text_or_empty(field));
    return SCREE_DONE;
  });
  if (code == SCREE_DONE && numbers == nullptr)
    fail(SCREE_USAGE, std::string("bodies have no field '") + text_or_empty(field) +
                          "' of real numbers; there are: position, quaternion, velocity, angular_velocity, force, torque, mass, volume, "
                          "diameter, radius, scale, and temperature in a scene with heat");
  return numbers;
}
const int64_t* scree_integers(scree_engine* engine, const char* field) {
  const std::int64_t* numbers = nullptr;
  const int code = mapped([&] {
    numbers = engine->run->integers(text_or_empty(field));
    return SCREE_DONE;
  });
  if (code == SCREE_DONE && numbers == nullptr)
    fail(SCREE_USAGE, std::string("bodies have no field '") + text_or_empty(field) +
                          "' of whole numbers; there are: id, shape, material, fixed, asleep");
  return numbers;
}

int scree_set_wrench(scree_engine* engine, int64_t n, const int64_t* ids, const double* forces, const double* torques) {
  return called(engine, "set_wrench", [&](HostedRun& run) {
    run.check(n >= 0 && (n == 0 || (ids != nullptr && forces != nullptr)), "set_wrench: ids and forces of n >= 0 bodies are needed");
    std::vector<WrenchOnBody> mine;
    mine.reserve(static_cast<std::size_t>(n));
    for (std::int64_t k = 0; k < n; ++k) mine.push_back({ids[k], {vector_at(forces, k), vector_at(torques, k)}});
    run.hold(mine);
    return SCREE_DONE;
  });
}
int scree_clear_wrench(scree_engine* engine, int64_t n, const int64_t* ids) {
  return called(engine, "clear_wrench", [&](HostedRun& run) {
    run.check(n <= 0 || ids != nullptr, "clear_wrench: the ids of n bodies are needed; n = -1: all bodies");
    run.release(n < 0 ? std::nullopt : std::optional(std::vector<std::int64_t>(ids, ids + n)));
    return SCREE_DONE;
  });
}
int scree_add_force(scree_engine* engine, scree_force_function function, int64_t every, void* user, int* number) {
  return scree_add_named_force(engine, nullptr, function, every, user, number);
}
int scree_add_named_force(scree_engine* engine, const char* name, scree_force_function function, int64_t every, void* user, int* number) {
  return called(engine, "add_force", [&](HostedRun& run) {
    run.check(function != nullptr && number != nullptr, "add_force: the function or the place for its number is NULL");
    const std::string words = name == nullptr ? "a force function" : std::string("the force function ") + name;
    *number = run.add_force(
        [engine, function, user, words](std::span<Vec3> force, std::span<Vec3> torque) {
          engine->force_error.clear();
          const int result = call_back(engine, [&] {
            return function(user, engine, static_cast<std::int64_t>(force.size()), reinterpret_cast<double*>(force.data()),
                            reinterpret_cast<double*>(torque.data()));
          });
          if (result == 0) return;
          throw UsageError("step {}: {} failed: {}", engine->run->step_count(), words,
                           engine->force_error.empty() ? fmt::format("it returned {}", result) : engine->force_error);
        },
        every, text_or_empty(name));
    return SCREE_DONE;
  });
}
void scree_force_failed(scree_engine* engine, const char* text) { engine->force_error = text_or_empty(text); }
int scree_remove_force(scree_engine* engine, int number) {
  return called(engine, "remove_force", [&](HostedRun& run) {
    run.remove_force(number);
    return SCREE_DONE;
  });
}

namespace {

/// The ids of a call; those of the bodies of this rank where none are given. Throws UsageError on every rank.
std::vector<std::int64_t> named_or_own(HostedRun& run, int64_t n, const int64_t* ids, bool has_numbers, const char* text) {
  run.check(n >= 0 && (n == 0 || has_numbers) && (ids != nullptr || n == run.body_count() || n == 0), text);
  const std::int64_t* const known = ids != nullptr ? ids : run.integers("id");
  return {known, known + n};
}

}  // namespace

int scree_set_heat_source(scree_engine* engine, int64_t n, const int64_t* ids, const double* powers) {
  return called(engine, "set_heat_source", [&](HostedRun& run) {
    const auto named =
        named_or_own(run, n, ids, powers != nullptr,
                     "set_heat_source: ids and powers of n >= 0 bodies are needed; without ids, n is the number of bodies of the rank");
    std::vector<SourceOfBody> mine;
    for (std::size_t k = 0; k < named.size(); ++k) mine.push_back({named[k], powers[k]});
    run.hold_heat(mine);
    return SCREE_DONE;
  });
}
int scree_set_medium(scree_engine* engine, int64_t n, const int64_t* ids, const double* conductances, const double* temperatures) {
  return called(engine, "set_medium", [&](HostedRun& run) {
    const auto named =
        named_or_own(run, n, ids, conductances != nullptr && temperatures != nullptr,
                     "set_medium: ids, conductances and temperatures of n >= 0 bodies are needed; without ids, n is the number of "
                     "bodies of the rank");
    std::vector<MediumOfBody> mine;
    for (std::size_t k = 0; k < named.size(); ++k) mine.push_back({named[k], conductances[k], temperatures[k]});
    run.hold_heat(mine);
    return SCREE_DONE;
  });
}
int scree_clear_heat(scree_engine* engine, int64_t n, const int64_t* ids) {
  return called(engine, "clear_heat", [&](HostedRun& run) {
    run.check(n <= 0 || ids != nullptr, "clear_heat: the ids of n bodies are needed; n = -1: all bodies");
    run.release_heat(n < 0 ? std::nullopt : std::optional(std::vector<std::int64_t>(ids, ids + n)));
    return SCREE_DONE;
  });
}
int scree_take_medium_heat(scree_engine* engine, int64_t n, const int64_t* ids, double* heat) {
  return called(engine, "take_medium_heat", [&](HostedRun& run) {
    const auto named =
        named_or_own(run, n, ids, heat != nullptr,
                     "take_medium_heat: ids of n >= 0 bodies and a place for their heat are needed; without ids, n is the number of "
                     "bodies of the rank");
    const std::vector<double> taken = run.take_medium_heat(named);
    std::copy(taken.begin(), taken.end(), heat);
    return SCREE_DONE;
  });
}
