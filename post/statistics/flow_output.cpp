#include "post/statistics/flow_output.hpp"

#include <algorithm>
#include <cmath>

#include "core/base/csv.hpp"

namespace scree {

namespace {

/// Every n-th point and the last, so that a curve of many bodies stays a curve of some hundred points.
ShareCurve thinned(const ShareCurve& curve) {
  constexpr std::size_t kPoints = 500;
  const std::size_t stride = curve.value.size() / kPoints + 1;
  ShareCurve few;
  for (std::size_t k = 0; k < curve.value.size(); ++k) {
    if (k % stride != 0 && k + 1 != curve.value.size()) continue;
    few.value.push_back(curve.value[k]);
    few.share.push_back(curve.share[k]);
  }
  return few;
}

bool has_passed(const Flow& flow) {
  return std::any_of(flow.gates.begin(), flow.gates.end(), [](const Gate& g) { return !g.passed.empty(); });
}

}  // namespace

std::vector<std::pair<std::string, std::string>> flow_tables(const Flow& flow) {
  if (!has_passed(flow)) return {};
  std::string rates = "time,gate,mass,mass_flow\n# units: s,-,kg,kg/s\n", sizes = "diameter,gate,share\n# units: m,-,-\n",
              times = "residence_time,gate,density,share\n# units: s,-,1/s,-\n";
  bool leaves = false;
  for (const Gate& gate : flow.gates) {
    const std::string name = csv_cell(gate.name);
    for (std::size_t k = 0; k < flow.times.size(); ++k)
      rates += fmt::format("{:.9g},{},{:.9g},{:.9g}\n", flow.times[k], name, gate.cumulative[k], gate.rate[k]);
    const ShareCurve curve = thinned(share_curve(gate, &Passage::diameter));
    for (std::size_t k = 0; k < curve.value.size(); ++k) sizes += fmt::format("{:.9g},{},{:.9g}\n", curve.value[k], name, curve.share[k]);
    const Density density = residence_density(gate);
    for (std::size_t k = 0; k < density.end.size(); ++k)
      times += fmt::format("{:.9g},{},{:.9g},{:.9g}\n", density.end[k], name, density.value[k], density.share[k]);
    leaves = leaves || !density.end.empty();
  }
  std::vector<std::pair<std::string, std::string>> tables{{"flow.csv", rates}, {"sizes_passed.csv", sizes}};
  if (leaves) tables.emplace_back("residence_times.csv", times);
  return tables;
}

std::vector<NamedChart> flow_charts(const Flow& flow) {
  if (!has_passed(flow)) return {};
  NamedChart rate{"flow", "flow.csv", {"Mass flow", "time", "s", "mass per time [kg/s]", "", false, true, {}, {}}};
  NamedChart times{"residence_times",
                   "residence_times.csv",
                   {"Residence times", "time since a body came in", "s", "share of the mass per time [1/s]", "", false, true, {}, {}}};
  NamedChart sizes{"sizes_passed",
                   "sizes_passed.csv",
                   {"Sizes of what passed", "diameter of equal volume", "m", "share of the mass that is finer", "", false, true, {}, {}}};
  bool sizes_differ = false;
  for (const Gate& gate : flow.gates) {
    if (gate.passed.empty()) continue;
    std::vector<double> middle = flow.times;
    for (double& t : middle) t -= 0.5 * flow.width;
    rate.chart.lines.push_back({gate.name, middle, gate.rate});
    const Density density = residence_density(gate);
    middle = density.end;
    for (double& t : middle) t -= 0.5 * density.width;
    if (!middle.empty()) times.chart.lines.push_back({gate.name, middle, density.value});
    const ShareCurve curve = thinned(share_curve(gate, &Passage::diameter));
    sizes_differ = sizes_differ || curve.value.size() > 1;
    sizes.chart.lines.push_back({gate.name, curve.value, curve.share});
  }
  std::vector<NamedChart> charts{std::move(rate)};
  if (!times.chart.lines.empty()) charts.push_back(std::move(times));
  if (sizes_differ) charts.push_back(std::move(sizes));
  return charts;
}

}  // namespace scree
