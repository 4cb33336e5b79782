#include "core/base/error.hpp"

#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <map>
#include <mutex>
#include <new>
#include <utility>

#include "core/base/interruption.hpp"
#include "core/base/warning_sink.hpp"

namespace scree {

namespace {

bool may_colour() { return isatty(STDERR_FILENO) != 0 && std::getenv("NO_COLOR") == nullptr; }

void print_message(const std::string& tool, const char* kind, const char* colour, const std::string& text) {
  if (may_colour()) {
    std::fprintf(stderr, "%s: \033[%sm%s:\033[0m %s\n", tool.c_str(), colour, kind, text.c_str());
  } else {
    std::fprintf(stderr, "%s: %s: %s\n", tool.c_str(), kind, text.c_str());
  }
}

}  // namespace

int run_main(const std::string& tool, const std::function<int()>& body) {
  listen_to_interruptions();
  try {
    return body();
  } catch (const Error& error) {
    print_message(tool, "error", "31", error.what());
    return static_cast<int>(error.code());
  } catch (const std::bad_alloc&) {
    print_message(tool, "error", "31", "out of memory; use a smaller case or more ranks on more machines");
    return static_cast<int>(ExitCode::system);
  } catch (const std::filesystem::filesystem_error& error) {
    print_message(tool, "error", "31", fmt::format("cannot use {}: {}", error.path1().string(), error.code().message()));
    return static_cast<int>(ExitCode::system);
  } catch (const std::exception& error) {
    print_message(tool, "internal error", "31", error.what());
    return static_cast<int>(ExitCode::internal);
  } catch (const std::string& error) {
    print_message(tool, "error", "31", error);
    return static_cast<int>(ExitCode::bad_data);
  }
}

namespace {

std::mutex g_warnings;
std::map<std::string, long> g_counts;
std::function<void(const std::string&)> g_sink;

}  // namespace

void warn_once(const std::string& tool, const std::string& text) {
  std::function<void(const std::string&)> sink;
  {
    const std::lock_guard lock(g_warnings);
    if (g_counts[text]++ != 0) return;
    sink = g_sink;
  }
  sink ? sink(text) : print_message(tool, "warning", "33", text);
}

void set_warning_sink(std::function<void(const std::string& text)> sink) {
  const std::lock_guard lock(g_warnings);
  g_sink = std::move(sink);
}

void forget_warnings() {
  const std::lock_guard lock(g_warnings);
  g_counts.clear();
}

namespace detail {
void assertion_failed(const char* condition, const char* file, int line, const std::string& values) {
  std::string message = fmt::format("{}:{}: assertion failed: {}", file, line, condition);
  if (!values.empty()) message += " (" + values + ")";
  if (const char* rank = std::getenv("OMPI_COMM_WORLD_RANK")) message += fmt::format(" on rank {}", rank);
  throw InternalError(message + "; this is a defect of Scree, please report it with the case");
}
}  // namespace detail

}  // namespace scree
