// How a function of scree_engine.h calls a run: exceptions become codes and texts, and each call is made under the conditions that a run
// needs (call_conditions.hpp).
#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <new>
#include <string>

#include "core/base/error.hpp"
#include "solver/engine/call_conditions.hpp"
#include "solver/engine/hosted_run.hpp"
#include "solver/engine/scree_engine.h"

struct scree_engine {
  std::unique_ptr<scree::HostedRun> run;
  int threads = 1;
  std::atomic<bool> busy{false};
  scree::CallConditions* conditions = nullptr;     // of the present call
  std::string force_error;                         // what the present function of forces says of its failure
  const scree::FrameContacts* contacts = nullptr;  // of the last scree_contacts()
};

struct scree_state {
  std::shared_ptr<const scree::HostedRun::State> state;
};

namespace scree {

/// Keeps the text for scree_error().
int fail(int code, const std::string& text);

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
    CallConditions conditions(engine->threads);
    engine->conditions = &conditions;
    return action(*engine->run);
  });
  engine->busy = false;
  return code;
}

/// Calls a function of the partner under the partner's own conditions.
template <class Function>
int call_back(scree_engine* engine, Function&& function) {
  engine->conditions->leave();
  const int result = function();
  engine->conditions->enter();
  return result;
}

inline int need(bool given, const char* what) { return given ? SCREE_DONE : fail(SCREE_USAGE, std::string(what) + " is NULL"); }

inline Vec3 vector_at(const double* numbers, std::int64_t row) {
  return numbers == nullptr ? Vec3{} : Vec3{numbers[3 * row], numbers[3 * row + 1], numbers[3 * row + 2]};
}

inline const char* text_or_empty(const char* text) { return text == nullptr ? "" : text; }

}  // namespace scree
