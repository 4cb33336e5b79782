// Charts as files: SVG always, PNG where rsvg-convert (Debian: librsvg2-bin) is installed.
#pragma once

#include <string>
#include <vector>

#include "core/chart/svg_chart.hpp"

namespace scree {

/// Writes NAME.svg and, where it can, NAME.png, twice the size of the SVG, which prints at 200 dots an inch on a half page.
/// Returns the names of the files that were written.
/// Fails: SystemError.
std::vector<std::string> write_chart(const std::string& folder, const std::string& name, const LineChart& chart);

/// Why no PNG is written, or "".
std::string png_obstacle();

}  // namespace scree
