// The engine of Scree for C++ programs: owners, spans and exceptions around the functions of scree_engine.h, which says what each means,
// its units, frame, errors and cost. Header-only: a program needs scree_engine.h, this file and libscree_engine.so (CMake: Scree::engine),
// and any compiler of C++20.
//
//   scree::Engine engine("bed.scene.h5");
//   engine.add_force([](const scree::Engine& e, std::span<double> force, std::span<double>) {
//     const std::span<const double> x = e.reals("position", 3);
//     for (std::size_t i = 0; i < force.size(); ++i) force[i] = -2.0 * x[i];
//   });
//   engine.run_until(0.2);
//
// Not thread-safe; the functions are collective over the ranks of the communicator as scree_engine.h says.
#pragma once

#include <array>
#include <cstdint>
#include <exception>
#include <functional>
#include <memory>
#include <span>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "scree_engine.h"

namespace scree {

/// What a function of the engine throws: its text, and the code of scree_engine.h (SCREE_USAGE, ...; 128 and a number: an interrupted
/// step).
class EngineError : public std::runtime_error {
 public:
  explicit EngineError(int code) : EngineError(code, code >= 128 ? "interrupted" : scree_error()) {}
  EngineError(int code, const std::string& text) : std::runtime_error(text), code_(code) {}
  int code() const { return code_; }

 private:
  int code_;
};

/// A state that Engine::save() kept.
class EngineState {
 public:
  explicit EngineState(scree_state* state) : state_(state, scree_free_state) {}
  const scree_state* get() const { return state_.get(); }

 private:
  std::unique_ptr<scree_state, void (*)(scree_state*)> state_;
};

class Engine {
 public:
  /// Adds to force [N] and torque [N m], 3 numbers a body, all 0 before. An exception ends the step.
  using Force = std::function<void(const Engine&, std::span<double> force, std::span<double> torque)>;

  struct Options {
    const void* comm = nullptr;  ///< address of an MPI_Comm; null: this process alone
    std::string run, restart;    ///< "": none
    int threads = 0;
  };

  explicit Engine(const std::string& scene) : Engine(scene, Options{}) {}
  Engine(const std::string& scene, const Options& options) {
    check(scree_open(scene.c_str(), options.comm, options.run.empty() ? nullptr : options.run.c_str(),
                     options.restart.empty() ? nullptr : options.restart.c_str(), options.threads, &engine_));
  }
  Engine(const Engine&) = delete;
  Engine& operator=(const Engine&) = delete;
  ~Engine() { scree_close(engine_); }
  /// What the destructor does, with its errors. Every other function then throws EngineError; a second close() does nothing.
  void close() { check(scree_close(std::exchange(engine_, nullptr))); }

  void step(std::int64_t n = 1) { check(scree_step(open(), n)); }
  void run_until(double time) { check(scree_run_until(open(), time)); }
  double time() const { return scree_time(open()); }
  double dt() const { return scree_dt(open()); }
  std::int64_t steps() const { return scree_step_count(open()); }
  double duration() const { return scree_duration(open()); }
  bool is_over() const { return scree_is_over(open()) != 0; }

  /// Fields of the bodies of this rank: `width` numbers a body. Valid until the next call that changes the engine.
  std::span<const double> reals(const char* field, std::size_t width) const {
    const double* numbers = scree_reals(open(), field);
    if (numbers == nullptr) throw EngineError(SCREE_USAGE);
    return {numbers, width * body_count()};
  }
  std::span<const std::int64_t> integers(const char* field) const {
    const std::int64_t* numbers = scree_integers(open(), field);
    if (numbers == nullptr) throw EngineError(SCREE_USAGE);
    return {numbers, body_count()};
  }
  std::size_t body_count() const { return static_cast<std::size_t>(scree_body_count(open())); }

  /// Three numbers for each id; torques may be empty.
  void set_wrench(std::span<const std::int64_t> ids, std::span<const double> forces, std::span<const double> torques = {}) {
    if (forces.size() != 3 * ids.size() || (!torques.empty() && torques.size() != 3 * ids.size()))
      throw std::invalid_argument("set_wrench: 3 numbers for each id are needed");
    check(scree_set_wrench(open(), static_cast<std::int64_t>(ids.size()), ids.data(), forces.data(),
                           torques.empty() ? nullptr : torques.data()));
  }
  void clear_wrench() { check(scree_clear_wrench(open(), -1, nullptr)); }
  // Heat, in scenes that have it. One number for each id; without ids, for each body of this rank in the order of reals().
  void set_heat_source(std::span<const std::int64_t> ids, std::span<const double> powers) {
    need_one_each("set_heat_source", ids, powers);
    check(scree_set_heat_source(open(), size_of(powers), data_of(ids), powers.data()));
  }
  void set_medium(std::span<const std::int64_t> ids, std::span<const double> conductances, std::span<const double> temperatures) {
    need_one_each("set_medium", ids, conductances);
    need_one_each("set_medium", ids, temperatures);
    if (conductances.size() != temperatures.size())
      throw std::invalid_argument("set_medium: as many temperatures as conductances are needed");
    check(scree_set_medium(open(), size_of(conductances), data_of(ids), conductances.data(), temperatures.data()));
  }
  void clear_heat() { check(scree_clear_heat(open(), -1, nullptr)); }
  /// [J], of the media since it was last taken.
  std::vector<double> take_medium_heat(std::span<const std::int64_t> ids) {
    std::vector<double> heat(ids.size());
    check(scree_take_medium_heat(open(), size_of(heat), ids.data(), heat.data()));
    return heat;
  }
  scree_heat heat() {
    scree_heat h;
    check(scree_get_heat(open(), &h));
    return h;
  }

  /// Returns a number for remove_force(). The function lives until then.   in   name   in messages and run.json; "": its number
  int add_force(Force force, std::int64_t every = 1, const std::string& name = "") {
    auto added = std::make_unique<Call>(Call{this, std::move(force), {}, 0});
    const int code =
        scree_add_named_force(open(), name.empty() ? nullptr : name.c_str(), &Engine::call, every, added.get(), &added->number);
    if (added->error) std::rethrow_exception(added->error);  // it is called once at once
    check(code);
    forces_.push_back(std::move(added));
    return forces_.back()->number;
  }
  void remove_force(int number) {
    check(scree_remove_force(open(), number));
    std::erase_if(forces_, [number](const auto& call) { return call->number == number; });
  }

  int wall(const std::string& name) const {
    for (int w = 0; w < scree_wall_count(open()); ++w)
      if (name == scree_wall_name(open(), w)) return w;
    throw std::invalid_argument("the scene has no wall '" + name + "'");
  }
  /// Force and torque about the world's origin, 6 numbers a wall.
  std::vector<double> wall_loads() {
    std::vector<double> loads(6 * static_cast<std::size_t>(scree_wall_count(open())));
    check(scree_wall_loads(open(), loads.data()));
    return loads;
  }

  scree_energies energies() {
    scree_energies e;
    check(scree_get_energies(open(), &e));
    return e;
  }
  std::string state_hash() {
    std::array<char, 33> text{};
    check(scree_state_hash(open(), text.data()));
    return text.data();
  }

  EngineState save() {
    scree_state* state = nullptr;
    check(scree_save(open(), &state));
    return EngineState(state);
  }
  void restore(const EngineState& state) { check(scree_restore(open(), state.get())); }
  void write_checkpoint(const std::string& folder) { check(scree_write_checkpoint(open(), folder.c_str())); }
  void write_frame(const std::string& path) { check(scree_write_frame(open(), path.c_str())); }

  /// in   temperatures   of each body [K], in scenes with heat; empty: that of the case
  std::vector<std::int64_t> insert(std::span<const scree_new_body> bodies, std::span<const double> temperatures = {}) {
    if (!temperatures.empty() && temperatures.size() != bodies.size())
      throw std::invalid_argument("insert: one temperature for each body is needed");
    std::vector<std::int64_t> ids(bodies.size());
    check(scree_insert_with_temperature(open(), size_of(bodies), bodies.data(), temperatures.empty() ? nullptr : temperatures.data(),
                                        ids.data()));
    return ids;
  }
  void remove(std::span<const std::int64_t> ids) { check(scree_remove(open(), static_cast<std::int64_t>(ids.size()), ids.data())); }

  /// For what this class does not have. Null after close().
  scree_engine* get() const { return engine_; }

 private:
  scree_engine* open() const {
    if (engine_ == nullptr) throw EngineError(SCREE_USAGE, "the engine is closed; open another one");
    return engine_;
  }
  template <class Items>
  static std::int64_t size_of(const Items& items) {
    return static_cast<std::int64_t>(items.size());
  }
  static const std::int64_t* data_of(std::span<const std::int64_t> ids) { return ids.empty() ? nullptr : ids.data(); }
  static void need_one_each(const char* what, std::span<const std::int64_t> ids, std::span<const double> numbers) {
    if (!ids.empty() && ids.size() != numbers.size()) throw std::invalid_argument(std::string(what) + ": one number for each id is needed");
  }
  struct Call {
    Engine* engine;
    Force force;
    std::exception_ptr error;
    int number;
  };
  static int call(void* user, scree_engine* engine, std::int64_t count, double* force, double* torque) {
    auto* const self = static_cast<Call*>(user);
    const auto numbers = 3 * static_cast<std::size_t>(count);
    try {
      self->force(*self->engine, {force, numbers}, {torque, numbers});
      return 0;
    } catch (const std::exception& error) {
      scree_force_failed(engine, error.what());
      self->error = std::current_exception();
      return 1;
    } catch (...) {
      self->error = std::current_exception();
      return 1;
    }
  }
  /// Throws what a function of forces threw, else EngineError.
  void check(int code) {
    if (code == SCREE_DONE) return;
    for (const auto& call : forces_)
      if (call->error) std::rethrow_exception(std::exchange(call->error, nullptr));
    throw EngineError(code);
  }

  scree_engine* engine_ = nullptr;
  std::vector<std::unique_ptr<Call>> forces_;
};

}  // namespace scree
