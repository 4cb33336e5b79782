// The section of the report on a periodic cell that deforms ([cell] of a case).
#pragma once

#include <string>

#include "post/run/run_folder.hpp"

namespace scree {

/// Stress against strain, strains, the path of mean stress and deviator, and the solid fraction, by the rows of the log. HTML.
std::string cell_section(const Run& run);

}  // namespace scree
