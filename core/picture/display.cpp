#include "core/picture/display.hpp"

#include <dlfcn.h>
#include <fmt/format.h>
#include <sys/random.h>

#include <array>
#include <chrono>
#include <cstdlib>
#include <memory>

#include "core/base/child_process.hpp"

namespace scree {

namespace {

constexpr int kStartTime = 60'000;  ///< [ms] for Xvfb; a loaded machine takes some seconds
constexpr int kEndTime = 5'000;     ///< [ms] for it to remove its lock and its socket; then it is killed
constexpr int kNotFound = 127;      ///< exit code of a program that does not exist

/// True when the X server that DISPLAY names answers.
bool display_answers() {
  void* library = dlopen("libX11.so.6", RTLD_NOW | RTLD_LOCAL);
  if (library == nullptr) return false;
  using Open = void* (*)(const char*);
  using Close = int (*)(void*);
  const auto open_display = reinterpret_cast<Open>(dlsym(library, "XOpenDisplay"));
  const auto close_display = reinterpret_cast<Close>(dlsym(library, "XCloseDisplay"));
  if (open_display == nullptr || close_display == nullptr) return false;
  void* display = open_display(nullptr);
  if (display != nullptr) close_display(display);
  return display != nullptr;  // the library stays loaded: X11 does not like to be unloaded
}

/// An entry of a file of X authority for any host and any display: whoever has it may draw.
/// Source: libXau, Xauth.h and AuWrite.c: numbers of two bytes, the larger first, each text after its length.
std::string cookie_entry() {
  std::array<unsigned char, 16> cookie{};
  if (getrandom(cookie.data(), cookie.size(), 0) != static_cast<ssize_t>(cookie.size()))
    throw SystemError("no random numbers for a cookie");
  const std::string name = "MIT-MAGIC-COOKIE-1";
  constexpr const char* kFamilyWild = "\xff\xff";
  std::string entry = kFamilyWild;
  const auto add = [&entry](const std::string& text) {
    entry += static_cast<char>(text.size() >> 8);
    entry += static_cast<char>(text.size() & 0xff);
    entry += text;
  };
  add("");  // of any host
  add("");  // of any number
  add(name);
  add({cookie.begin(), cookie.end()});
  return entry;
}

std::string end_of(std::string text) {
  constexpr std::size_t kMax = 400;  // characters of what Xvfb wrote: the reason stands at its end
  while (!text.empty() && (text.back() == '\n' || text.back() == ' ')) text.pop_back();
  return text.size() > kMax ? "... " + text.substr(text.size() - kMax) : text;
}

/// An Xvfb of this process.
class OwnDisplay {
 public:
  /// Starts it and waits until it can be drawn on; `obstacle` then tells whether that went well.
  OwnDisplay() {
    const std::string entry = cookie_entry();
    if (!write_exactly(cookie_.descriptor(), entry.data(), entry.size())) throw SystemError("cannot write a cookie");
    server_ = std::make_unique<ChildProcess>(
        ChildProcess::serve({"Xvfb", "-displayfd", std::to_string(ChildProcess::kServerOutput), "-screen", "0", "1280x1024x24", "-noreset",
                             "-nolisten", "tcp", "-auth", fmt::format("/proc/self/fd/{}", ChildProcess::kServerOutput + 1)},
                            says_.descriptor(), {cookie_.descriptor()}));
    const std::string number = number_of_display();
    if (!obstacle_.empty()) return;
    setenv("XAUTHORITY", fmt::format("/proc/self/fd/{}", cookie_.descriptor()).c_str(), 1);
    setenv("DISPLAY", (":" + number).c_str(), 1);
    if (!display_answers())
      obstacle_ = fmt::format("Xvfb was started as display :{}, which does not answer; {}", number, end_of(says_.text()));
  }
  ~OwnDisplay() {
    if (server_) server_->end(kEndTime);
  }
  OwnDisplay(const OwnDisplay&) = delete;
  OwnDisplay& operator=(const OwnDisplay&) = delete;

  const std::string& obstacle() const { return obstacle_; }

 private:
  std::string number_of_display() {
    std::vector<char> number;
    const auto start = std::chrono::steady_clock::now();
    while (number.empty() || number.back() != '\n') {
      const auto waited = std::chrono::duration_cast<std::chrono::milliseconds>(std::chrono::steady_clock::now() - start).count();
      if (waited > kStartTime) {
        obstacle_ = fmt::format("Xvfb did not start within {} s; it wrote: {}", kStartTime / 1000, end_of(says_.text()));
        return "";
      }
      if (server_->read(number, static_cast<int>(kStartTime - waited)) != ChildProcess::Read::end) continue;
      const ProcessEnd end = server_->wait();
      server_.reset();
      obstacle_ = end.code == kNotFound ? "Xvfb, which stands in for one, is missing; install the package xvfb (./setup does)"
                                        : fmt::format("Xvfb, which stands in for one, did not start; it wrote: {}", end_of(says_.text()));
      return "";
    }
    number.pop_back();
    return {number.begin(), number.end()};
  }

  MemoryFile cookie_, says_;
  std::unique_ptr<ChildProcess> server_;
  std::string obstacle_;
};

}  // namespace

std::string display_obstacle() {
  const char* display = std::getenv("DISPLAY");
  const bool is_named = display != nullptr && *display != '\0';
  if (is_named && display_answers()) return "";
  const std::string why = is_named ? fmt::format("the X display {} does not answer", display) : "no X display (DISPLAY is not set)";
  static std::unique_ptr<OwnDisplay> own;  // ends with this process
  try {
    own.reset();
    own = std::make_unique<OwnDisplay>();
  } catch (const SystemError& error) {
    return fmt::format("{}, and none could be started: {}", why, error.what());
  }
  return own->obstacle().empty() ? "" : fmt::format("{}; {}", why, own->obstacle());
}

}  // namespace scree
