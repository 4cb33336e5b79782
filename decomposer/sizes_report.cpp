#include "decomposer/sizes_report.hpp"

#include <algorithm>

#include "core/base/units.hpp"
#include "core/chart/svg_chart.hpp"

namespace scree {

namespace {

/// Calls visit(population, distribution, diameters) for each population that has sizes to compare.
template <class Visit>
void for_each_sized(const Case& c, const PackingReport& report, Visit&& visit) {
  for (std::size_t k = 0; k < c.populations.size(); ++k) {
    const CasePopulation& p = c.populations[k];
    if (k >= report.diameters.size() || !p.size || !(p.size->min < p.size->max)) continue;
    const std::vector<double>& diameters = report.diameters[k];
    if (!diameters.empty()) visit(k, *p.size, diameters);
  }
}

const char* measure_of(const SizeDistribution& d) { return d.by_mass ? "mass" : "number"; }

/// About a hundred diameters with the shares asked and got.
template <class Row>
void for_each_row(const SizeDistribution& d, const std::vector<double>& diameters, Row&& row) {
  const std::vector<double> shares = shares_of(diameters, d.by_mass);
  constexpr int kRows = 100;
  for (int i = 0; i <= kRows; ++i) {
    const double x = d.min + (d.max - d.min) * i / kRows;
    const auto finer = std::upper_bound(diameters.begin(), diameters.end(), x) - diameters.begin();
    row(x, d.share(x), finer == 0 ? 0 : shares[static_cast<std::size_t>(finer - 1)]);
  }
}

}  // namespace

std::string sizes_text(const Case& c, const PackingReport& report) {
  std::string text;
  for_each_sized(c, report, [&](std::size_t k, const SizeDistribution& d, const std::vector<double>& diameters) {
    const SizeComparison s = compare_sizes(d, diameters);
    const auto metres = [](double value) { return format_quantity(value, Dimension::length); };
    text += fmt::format(
        "sizes {:<12} by {}: {:.2f} % off at most (Kolmogorov-Smirnov); requested d10, d50, d90 {}, {}, {}, obtained {}, {}, {}\n", k,
        measure_of(d), 100 * s.kolmogorov_smirnov, metres(s.asked[0]), metres(s.asked[1]), metres(s.asked[2]), metres(s.got[0]),
        metres(s.got[1]), metres(s.got[2]));
    constexpr double kNotable = 0.01;  // of all: what one body takes then explains a good part of the difference
    if (d.by_mass && s.largest_share > kNotable) {
      text +=
          fmt::format("                   the largest body alone has {:.2f} % of the mass: with more bodies the difference is smaller\n",
                      100 * s.largest_share);
    }
  });
  return text;
}

std::string sizes_table(const Case& c, const PackingReport& report) {
  std::string text = "population,by,diameter,asked,got\n";
  for_each_sized(c, report, [&](std::size_t k, const SizeDistribution& d, const std::vector<double>& diameters) {
    for_each_row(d, diameters, [&](double x, double asked, double got) {
      text += fmt::format("{},{},{:.6g},{:.6f},{:.6f}\n", k, measure_of(d), x, asked, got);
    });
  });
  return text;
}

std::string sizes_chart(const Case& c, const PackingReport& report) {
  LineChart chart;
  chart.title = "Requested and obtained sizes";
  chart.x_label = "diameter of the sphere of equal volume";
  chart.x_unit = std::string(1, 'm');
  chart.y_label = "share that is finer";
  chart.from_zero = true;
  for_each_sized(c, report, [&](std::size_t k, const SizeDistribution& d, const std::vector<double>& diameters) {
    ChartLine asked, got;
    asked.name = fmt::format("population {} requested, by {}", k, measure_of(d));
    got.name = fmt::format("population {} got", k);
    for_each_row(d, diameters, [&](double x, double share, double share_got) {
      asked.x.push_back(x);
      asked.y.push_back(share);
      got.x.push_back(x);
      got.y.push_back(share_got);
    });
    chart.lines.push_back(asked);
    chart.lines.push_back(got);
  });
  return standalone_svg(chart);
}

}  // namespace scree
