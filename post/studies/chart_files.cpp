#include "post/studies/chart_files.hpp"

#include <unistd.h>

#include <cstdlib>
#include <filesystem>

#include "core/base/child_process.hpp"
#include "core/base/error.hpp"
#include "core/base/temporary_file.hpp"
#include "core/storage/h5.hpp"
#include "post/run/output_file.hpp"

namespace scree {

namespace {

const char* const kConverter = "rsvg-convert";

bool on_path(const std::string& program) {
  const char* path = std::getenv("PATH");
  std::string rest = path != nullptr ? path : "";
  while (!rest.empty()) {
    const std::size_t end = rest.find(':');
    if (access((rest.substr(0, end) + "/" + program).c_str(), X_OK) == 0) return true;
    rest = end == std::string::npos ? "" : rest.substr(end + 1);
  }
  return false;
}

bool run_program(std::vector<std::string> words) {
  try {
    return ChildProcess::start(std::move(words), std::nullopt, false).wait().is_success();
  } catch (const SystemError&) {
    return false;
  }
}

}  // namespace

std::string png_obstacle() {
  return on_path(kConverter)
             ? ""
             : fmt::format("charts are written as SVG only: {} is not installed (Debian: apt-get install librsvg2-bin)", kConverter);
}

std::vector<std::string> write_chart(const std::string& folder, const std::string& name, const LineChart& chart) {
  const std::string svg = folder + "/" + name + ".svg", png = folder + "/" + name + ".png";
  h5::write_text_file(svg, standalone_svg(chart));
  if (!png_obstacle().empty()) return {name + ".svg"};
  TemporaryFile temporary(png);
  if (!run_program({kConverter, "--zoom=2", "--format=png", "--output=" + temporary.name(), svg}))
    throw SystemError("{} could not turn {} into {}; is the disk full?", kConverter, svg, png);
  temporary.publish();
  return {name + ".svg", name + ".png"};
}

}  // namespace scree
