// Sizes asked and got, side by side: of whole bodies, also where these start as pieces.
#pragma once

#include <string>

#include "decomposer/packing/build_scene.hpp"

namespace scree {

/// One line for each population whose sizes are distributed: distance of Kolmogorov and Smirnov, and diameters at 10, 50, 90 %.
std::string sizes_text(const Case& c, const PackingReport& report);
/// A table: population, by (number or mass), diameter [m], asked, got (shares that are finer).
std::string sizes_table(const Case& c, const PackingReport& report);
/// The same as a chart, for a file of its own.
std::string sizes_chart(const Case& c, const PackingReport& report);

}  // namespace scree
