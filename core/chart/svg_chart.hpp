// Charts as plain SVG text: axes with units, round ticks, a legend, colours that the colour-blind can tell apart.
// No X display, no library, nothing fetched.
#pragma once

#include <string>
#include <vector>

namespace scree {

/// One line of a chart. Points that are not finite, or not > 0 on a logarithmic axis, break the line.
struct ChartLine {
  std::string name;
  std::vector<double> x, y;
  std::vector<double> spread{};  ///< half width of a band about y; empty: none
  enum class Style { line, points, points_and_line } style = Style::line;
  std::vector<std::string> labels{};  ///< a text beside each point; empty: none
};

struct ChartLimit {
  double y = 0;
  std::string text;
};

struct LineChart {
  std::string title;
  std::string x_label, x_unit;  ///< the unit gets a prefix that makes the numbers short
  std::string y_label, y_unit;  ///< empty: no unit and no prefix
  bool logarithmic = false;     ///< y axis
  bool from_zero = false;       ///< y axis starts at 0
  std::vector<ChartLine> lines;
  std::vector<ChartLimit> limits;  ///< dashed level lines with a text
  bool logarithmic_x = false;      ///< the unit then gets no prefix
};
std::string svg_of(const LineChart& chart);

struct BarChart {
  std::string title;
  std::string x_label;
  std::vector<std::string> names;
  std::vector<double> values;
  std::vector<std::string> texts;  ///< beside each bar
  bool vertical = false;           ///< columns of a histogram; `names` are then texts at the bin edges, one more than values, or empty
  std::string y_label;
};
std::string svg_of(const BarChart& chart);

/// The numbers of a chart as CSV: line, x, y and, where there is one, the half width of the band.
std::string csv_of(const LineChart& chart);
std::string csv_of(const BarChart& chart);

/// A chart with its colours and fonts inside, on white: for a file of its own, outside report.html.
std::string standalone_svg(const LineChart& chart);

/// Text with <, >, & and quotes escaped for HTML and SVG.
std::string escaped(const std::string& text);

/// Round tick values that cover [low, high], about `count` of them.
std::vector<double> round_ticks(double low, double high, int count);

}  // namespace scree
