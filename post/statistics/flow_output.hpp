// Tables and charts of what passed the inlets and outlets.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "post/statistics/statistics_data.hpp"

namespace scree {

/// Name and text of each: flow.csv, residence_times.csv and sizes_passed.csv, as far as something passed.
std::vector<std::pair<std::string, std::string>> flow_tables(const Flow& flow);

std::vector<NamedChart> flow_charts(const Flow& flow);

}  // namespace scree
