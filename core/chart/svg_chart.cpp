#include "core/chart/svg_chart.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "core/base/csv.hpp"
#include "core/base/utf8.hpp"

namespace scree {

namespace {

// M. Okabe and K. Ito, Color universal design, 2008; the order puts the pairs that differ most first.
constexpr std::array<const char*, 7> kColours{"#0072B2", "#D55E00", "#009E73", "#CC79A7", "#56B4E9", "#8a6d00", "#333333"};
constexpr std::array<const char*, 7> kDashes{"", "7 3", "2 3", "10 3 2 3", "", "7 3", "2 3"};

constexpr double kWidth = 640, kHeight = 320;
constexpr double kLeft = 74, kRight = 16, kTop = 62, kBottom = 48;  // two rows of legend fit above
constexpr std::size_t kMostPoints = 1500;                           // more than two points a pixel only make the page heavy

struct Prefix {
  double factor;
  std::string text;
};

Prefix prefix_for(double largest, const std::string& unit) {
  if (unit.empty() || !(largest > 0)) return {1, unit};
  static constexpr std::array<const char*, 7> kNames{"n", "µ", "m", "", "k", "M", "G"};
  int thousands = static_cast<int>(std::floor(std::log10(largest) / 3 + 1e-9));
  // "0.5 s" reads better than "500 ms" on an axis that begins at 0
  if (thousands == -1 && largest >= 0.1) thousands = 0;
  thousands = std::clamp(thousands, -3, 3);
  return {std::pow(1000.0, thousands), kNames[static_cast<std::size_t>(thousands + 3)] + unit};
}

std::string axis_text(const std::string& label, const std::string& unit) { return unit.empty() ? label : label + " [" + unit + "]"; }

std::string number(double value, double step) {
  if (std::abs(value) < 1e-9 * std::abs(step)) return "0";
  const double size = std::max(std::abs(value), std::abs(step));
  if (size >= 1e7 || size < 1e-3) return fmt::format("{:.3g}", value);
  const int digits = std::max(0, static_cast<int>(std::ceil(-std::log10(std::abs(step)) - 1e-9)));
  return fmt::format("{:.{}f}", value, digits);
}

std::string power_of_ten(int exponent) { return fmt::format("10<tspan dy=\"-5\" font-size=\"9\">{}</tspan>", exponent); }

/// Keeps the smallest and the largest of each run of points, so that no peak is lost.
ChartLine thinned(const ChartLine& line) {
  if (line.x.size() <= kMostPoints || line.style != ChartLine::Style::line) return line;
  ChartLine result{line.name, {}, {}};
  const std::size_t runs = kMostPoints / 2;
  for (std::size_t r = 0; r < runs; ++r) {
    const std::size_t begin = r * line.x.size() / runs, end = (r + 1) * line.x.size() / runs;
    std::size_t low = begin, high = begin;
    for (std::size_t i = begin; i < end; ++i) {
      if (line.y[i] < line.y[low]) low = i;
      if (line.y[i] > line.y[high]) high = i;
    }
    for (std::size_t i : {std::min(low, high), std::max(low, high)}) {
      result.x.push_back(line.x[i]);
      result.y.push_back(line.y[i]);
    }
  }
  return result;
}

/// Circle, square, triangle, diamond: shapes tell the lines apart where colours do not.
std::string marker(std::size_t line, double x, double y, const char* colour) {
  constexpr double r = 4;
  switch (line % 4) {
    case 0:
      return fmt::format("<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"{}\" fill=\"{}\"/>\n", x, y, r, colour);
    case 1:
      return fmt::format("<rect x=\"{:.1f}\" y=\"{:.1f}\" width=\"{}\" height=\"{}\" fill=\"{}\"/>\n", x - 3.6, y - 3.6, 7.2, 7.2, colour);
    case 2:
      return fmt::format("<path d=\"M{:.1f} {:.1f}l{} {}h{}z\" fill=\"{}\"/>\n", x, y - 1.2 * r, 1.1 * r, 2 * r, -2.2 * r, colour);
    default:
      return fmt::format("<path d=\"M{:.1f} {:.1f}l{} {}l{} {}l{} {}z\" fill=\"{}\"/>\n", x, y - 1.3 * r, 1.3 * r, 1.3 * r, -1.3 * r,
                         1.3 * r, -1.3 * r, -1.3 * r, colour);
  }
}

/// Whether two ends of an axis are one value for its labels: steps between them would be lost to rounding.
bool is_flat(double low, double high) {
  constexpr double kLeastSpan = 1e-9;  // of the values: far above roundoff, far below what a label can show
  return !(high - low > kLeastSpan * std::max(std::abs(low), std::abs(high)));
}

std::string svg_head(const std::string& title, double height) {
  return fmt::format(
      "<svg viewBox=\"0 0 {0} {1}\" role=\"img\" aria-label=\"{2}\" xmlns=\"http://www.w3.org/2000/svg\">\n"
      "<title>{2}</title>\n<text x=\"0\" y=\"18\" class=\"chart-title\">{2}</text>\n",
      kWidth, height, escaped(title));
}

}  // namespace

std::string escaped(const std::string& text) {
  std::string result;
  for (char c : printable(text)) {
    if (c == '<')
      result += "&lt;";
    else if (c == '>')
      result += "&gt;";
    else if (c == '&')
      result += "&amp;";
    else if (c == '"')
      result += "&quot;";
    else if (c == '\'')
      result += "&#39;";
    else
      result += c;
  }
  return result;
}

std::vector<double> round_ticks(double low, double high, int count) {
  if (is_flat(low, high)) return {low};
  const double raw = (high - low) / count;
  const double power = std::pow(10.0, std::floor(std::log10(raw)));
  double step = 10 * power;
  for (double multiple : {1.0, 2.0, 5.0}) {
    if (multiple * power >= raw * (1 - 1e-9)) {
      step = multiple * power;
      break;
    }
  }
  std::vector<double> ticks;
  const double first = std::floor(low / step + 1e-9), last = std::ceil(high / step - 1e-9);
  for (double k = first; k <= last; ++k) ticks.push_back(k * step);
  return ticks;
}

std::string svg_of(const LineChart& chart) {
  // ranges
  double x_low = std::numeric_limits<double>::infinity(), x_high = -x_low, y_low = x_low, y_high = -x_low;
  const auto is_drawn = [&](double x, double y) {
    return std::isfinite(x) && std::isfinite(y) && (!chart.logarithmic || y > 0) && (!chart.logarithmic_x || x > 0);
  };
  const auto spread_at = [](const ChartLine& line, std::size_t i) {
    return i < line.spread.size() && std::isfinite(line.spread[i]) ? line.spread[i] : 0.0;
  };
  for (const ChartLine& line : chart.lines) {
    for (std::size_t i = 0; i < line.x.size(); ++i) {
      if (!is_drawn(line.x[i], line.y[i])) continue;
      x_low = std::min(x_low, line.x[i]);
      x_high = std::max(x_high, line.x[i]);
      const double spread = chart.logarithmic ? 0 : spread_at(line, i);  // half a decade of doubt must not make ten decades of axis
      // what cannot be negative keeps its axis at 0, whatever the doubt
      y_low = std::min(y_low, chart.from_zero && line.y[i] >= 0 ? std::max(0.0, line.y[i] - spread) : line.y[i] - spread);
      y_high = std::max(y_high, line.y[i] + spread);
    }
  }
  std::string svg = svg_head(chart.title, kHeight);
  if (!(x_high >= x_low)) return svg + "<text x=\"0\" y=\"60\" class=\"chart-text\">nothing to draw</text>\n</svg>\n";
  for (const ChartLimit& limit : chart.limits) {
    if (is_drawn(1, limit.y)) {
      y_low = std::min(y_low, limit.y);
      y_high = std::max(y_high, limit.y);
    }
  }
  if (chart.from_zero && !chart.logarithmic) y_low = std::min(0.0, y_low);
  const auto whole_decades = [](double& low, double& high) {
    low = std::pow(10.0, std::floor(std::log10(low) + 1e-12));
    high = std::pow(10.0, std::ceil(std::log10(high) - 1e-12));
    if (high <= low) high = 10 * low;
  };
  if (chart.logarithmic_x) whole_decades(x_low, x_high);
  if (is_flat(x_low, x_high)) x_high = x_low + std::max(1.0, std::abs(x_low));
  const Prefix xp = chart.logarithmic_x ? Prefix{1, chart.x_unit} : prefix_for(std::max(std::abs(x_low), std::abs(x_high)), chart.x_unit);
  const Prefix yp = chart.logarithmic ? Prefix{1, chart.y_unit} : prefix_for(std::max(std::abs(y_low), std::abs(y_high)), chart.y_unit);
  std::vector<double> y_ticks;  // decided once: ticks of the widened axis could be coarser and reach beyond it
  if (chart.logarithmic) {
    constexpr double kMostDecades = 14;  // a value at rounding level must not squeeze the rest
    y_low = std::max(y_low, y_high * std::pow(10.0, -kMostDecades));
    whole_decades(y_low, y_high);
  } else {
    if (is_flat(y_low, y_high)) {
      const double pad = y_high != 0 ? 0.5 * std::abs(y_high) : 1;
      y_low -= chart.from_zero ? 0 : pad;
      y_high += pad;
    }
    y_ticks = round_ticks(y_low / yp.factor, y_high / yp.factor, 5);
    y_low = y_ticks.front() * yp.factor;
    y_high = y_ticks.back() * yp.factor;
  }
  const double width = kWidth - kLeft - kRight, height = kHeight - kTop - kBottom;
  const auto px = [&](double x) {
    const double part = chart.logarithmic_x ? std::log(x / x_low) / std::log(x_high / x_low) : (x - x_low) / (x_high - x_low);
    return kLeft + width * part;
  };
  const auto py = [&](double y) {
    const double part = chart.logarithmic ? std::log(y / y_low) / std::log(y_high / y_low) : (y - y_low) / (y_high - y_low);
    return kTop + height * (1 - part);
  };

  // grid and axes
  const auto level = [&](double y, const std::string& text) {
    svg += fmt::format(
        "<line x1=\"{}\" x2=\"{}\" y1=\"{:.1f}\" y2=\"{:.1f}\" class=\"grid\"/><text x=\"{}\" y=\"{:.1f}\" class=\"tick\" "
        "text-anchor=\"end\">{}</text>\n",
        kLeft, kLeft + width, py(y), py(y), kLeft - 7, py(y) + 4, text);
  };
  if (chart.logarithmic) {
    const int low = static_cast<int>(std::lround(std::log10(y_low))), high = static_cast<int>(std::lround(std::log10(y_high)));
    const int stride = std::max(1, (high - low + 5) / 6);
    for (int e = high; e >= low; e -= stride) level(std::pow(10.0, e), power_of_ten(e));
  } else {
    const double step = y_ticks.size() > 1 ? y_ticks[1] - y_ticks[0] : 1;
    for (double t : y_ticks) level(t * yp.factor, number(t, step));
  }
  const auto mark = [&](double x, const std::string& text) {
    svg += fmt::format(
        "<line x1=\"{0:.1f}\" x2=\"{0:.1f}\" y1=\"{1}\" y2=\"{2}\" class=\"axis\"/><text x=\"{0:.1f}\" y=\"{3}\" class=\"tick\" "
        "text-anchor=\"middle\">{4}</text>\n",
        px(x), kTop + height, kTop + height + 5, kTop + height + 18, text);
  };
  if (chart.logarithmic_x) {
    const int low = static_cast<int>(std::lround(std::log10(x_low))), high = static_cast<int>(std::lround(std::log10(x_high)));
    for (int e = low; e <= high; e += std::max(1, (high - low + 7) / 8)) mark(std::pow(10.0, e), power_of_ten(e));
  } else {
    const std::vector<double> x_ticks = round_ticks(x_low / xp.factor, x_high / xp.factor, 7);
    const double x_step = x_ticks.size() > 1 ? x_ticks[1] - x_ticks[0] : 1;
    for (double t : x_ticks) {
      if (t * xp.factor < x_low - 1e-9 * (x_high - x_low) || t * xp.factor > x_high + 1e-9 * (x_high - x_low)) continue;
      mark(t * xp.factor, number(t, x_step));
    }
  }
  svg += fmt::format("<polyline points=\"{0},{1} {0},{2} {3},{2}\" class=\"axis\"/>\n", kLeft, kTop, kTop + height, kLeft + width);
  svg += fmt::format("<text x=\"{}\" y=\"{}\" class=\"chart-text\" text-anchor=\"middle\">{}</text>\n", kLeft + width / 2, kHeight - 8,
                     escaped(axis_text(chart.x_label, xp.text)));
  svg += fmt::format("<text transform=\"translate(14 {}) rotate(-90)\" class=\"chart-text\" text-anchor=\"middle\">{}</text>\n",
                     kTop + height / 2, escaped(axis_text(chart.y_label, yp.text)));

  for (const ChartLimit& limit : chart.limits) {
    if (!is_drawn(1, limit.y)) continue;
    svg += fmt::format(
        "<line x1=\"{0}\" x2=\"{1}\" y1=\"{2:.1f}\" y2=\"{2:.1f}\" class=\"limit\"/><text x=\"{1}\" y=\"{3:.1f}\" "
        "class=\"limit-text\" text-anchor=\"end\">{4}</text>\n",
        kLeft, kLeft + width, py(limit.y), py(limit.y) - 5, escaped(limit.text));
  }

  // bands, lines and points, then the legend above the frame
  double legend_x = kLeft, legend_y = 42;
  for (std::size_t s = 0; s < chart.lines.size(); ++s) {
    const ChartLine line = thinned(chart.lines[s]);
    const bool has_line = line.style != ChartLine::Style::points, has_points = line.style != ChartLine::Style::line;
    const char* colour = kColours[s % kColours.size()];
    const char* dash = kDashes[s % kDashes.size()];
    const auto y_at = [&](double y) { return py(std::clamp(y, y_low, y_high)); };
    if (!line.spread.empty()) {
      std::string upper, lower;
      for (std::size_t i = 0; i < line.x.size(); ++i) {
        if (!is_drawn(line.x[i], line.y[i])) continue;
        const double spread = spread_at(line, i);
        upper += fmt::format("{:.1f},{:.1f} ", px(line.x[i]), y_at(line.y[i] + spread));
        lower.insert(0, fmt::format("{:.1f},{:.1f} ", px(line.x[i]), y_at(line.y[i] - spread)));
      }
      svg += fmt::format("<polygon points=\"{}{}\" fill=\"{}\" fill-opacity=\"0.22\" stroke=\"none\"/>\n", upper, lower, colour);
    }
    std::string path;
    bool pen_down = false;
    for (std::size_t i = 0; i < line.x.size(); ++i) {
      if (!is_drawn(line.x[i], line.y[i])) {
        pen_down = false;
        continue;
      }
      path += fmt::format("{}{:.1f} {:.1f}", pen_down ? "L" : "M", px(line.x[i]), y_at(line.y[i]));
      pen_down = true;
      if (has_points) svg += marker(s, px(line.x[i]), y_at(line.y[i]), colour);
      if (i < line.labels.size() && !line.labels[i].empty()) {
        const bool left = px(line.x[i]) > kLeft + 100;
        // a ring about the point; the text below and left of it, where a front has nothing else
        svg += fmt::format(
            "<circle cx=\"{0:.1f}\" cy=\"{1:.1f}\" r=\"7.5\" fill=\"none\" stroke=\"#1c2430\" stroke-width=\"1.4\"/><text x=\"{2:.1f}\" "
            "y=\"{3:.1f}\" "
            "class=\"tick\" text-anchor=\"{4}\">{5}</text>\n",
            px(line.x[i]), y_at(line.y[i]), px(line.x[i]) + (left ? -8 : 8), y_at(line.y[i]) + 19, left ? "end" : "start",
            escaped(line.labels[i]));
      }
    }
    if (has_line) {
      svg += fmt::format(
          "<path d=\"{}\" fill=\"none\" stroke=\"{}\" stroke-width=\"1.8\" stroke-linejoin=\"round\" stroke-dasharray=\"{}\"/>\n", path,
          colour, dash);
    }
    if (chart.lines.size() > 1 || !line.spread.empty()) {
      const double long_name = 32 + 8.8 * static_cast<double>(line.name.size()) + 14;  // room for the larger letters on a phone
      if (legend_x > kLeft && legend_x + long_name > kWidth) {
        legend_x = kLeft;
        legend_y += 15;
      }
      if (has_line) {
        svg +=
            fmt::format("<line x1=\"{0}\" x2=\"{1}\" y1=\"{4}\" y2=\"{4}\" stroke=\"{2}\" stroke-width=\"2.4\" stroke-dasharray=\"{3}\"/>",
                        legend_x, legend_x + 26, colour, dash, legend_y);
      }
      if (has_points) svg += marker(s, legend_x + 13, legend_y, colour);
      svg += fmt::format("<text x=\"{}\" y=\"{}\" class=\"chart-text\">{}</text>\n", legend_x + 32, legend_y + 4, escaped(line.name));
      legend_x += long_name;
    }
  }
  return svg + "</svg>\n";
}

namespace {

std::string svg_columns(const BarChart& chart) {
  double largest = 0;
  for (double v : chart.values) largest = std::max(largest, v);
  std::string svg = svg_head(chart.title, kHeight);
  if (!(largest > 0) || chart.names.size() != chart.values.size() + 1)
    return svg + "<text x=\"0\" y=\"60\" class=\"chart-text\">nothing to draw</text>\n</svg>\n";
  const double top = 36, width = kWidth - kLeft - kRight, height = kHeight - top - kBottom;
  const std::vector<double> ticks = round_ticks(0, largest, 5);
  const auto py = [&](double v) { return top + height * (1 - v / ticks.back()); };
  for (double t : ticks) {
    svg += fmt::format(
        "<line x1=\"{}\" x2=\"{}\" y1=\"{:.1f}\" y2=\"{:.1f}\" class=\"grid\"/><text x=\"{}\" y=\"{:.1f}\" class=\"tick\" "
        "text-anchor=\"end\">{}</text>\n",
        kLeft, kLeft + width, py(t), py(t), kLeft - 7, py(t) + 4, number(t, ticks[1]));
  }
  const double column = width / static_cast<double>(chart.values.size());
  for (std::size_t i = 0; i < chart.names.size(); ++i) {
    const double x = kLeft + column * static_cast<double>(i);
    if (i < chart.values.size()) {
      svg += fmt::format("<rect x=\"{:.1f}\" y=\"{:.1f}\" width=\"{:.1f}\" height=\"{:.1f}\" fill=\"{}\"/>\n", x + 1, py(chart.values[i]),
                         column - 2, top + height - py(chart.values[i]), kColours[0]);
    }
    if (!chart.names[i].empty()) {
      svg += fmt::format("<text x=\"{:.1f}\" y=\"{}\" class=\"tick\" text-anchor=\"middle\">{}</text>\n", x, top + height + 18,
                         chart.names[i]);
    }
  }
  svg += fmt::format("<polyline points=\"{0},{1} {0},{2} {3},{2}\" class=\"axis\"/>\n", kLeft, top, top + height, kLeft + width);
  svg += fmt::format("<text x=\"{}\" y=\"{}\" class=\"chart-text\" text-anchor=\"middle\">{}</text>\n", kLeft + width / 2, kHeight - 8,
                     escaped(chart.x_label));
  svg += fmt::format("<text transform=\"translate(14 {}) rotate(-90)\" class=\"chart-text\" text-anchor=\"middle\">{}</text>\n",
                     top + height / 2, escaped(chart.y_label));
  return svg + "</svg>\n";
}

}  // namespace

std::string svg_of(const BarChart& chart) {
  if (chart.vertical) return svg_columns(chart);
  const double row = 26, top = 36, name_width = 120, text_width = 150;
  const double height = top + row * static_cast<double>(chart.values.size()) + 8;
  const double width = kWidth - name_width - text_width;
  double largest = 0;
  for (double v : chart.values) largest = std::max(largest, v);
  std::string svg = svg_head(chart.title, height);
  for (std::size_t i = 0; i < chart.values.size(); ++i) {
    const double y = top + row * static_cast<double>(i);
    const double length = largest > 0 ? width * std::max(0.0, chart.values[i]) / largest : 0;
    svg += fmt::format(
        "<text x=\"{}\" y=\"{}\" class=\"chart-text\" text-anchor=\"end\">{}</text><rect x=\"{}\" y=\"{}\" width=\"{:.1f}\" "
        "height=\"{}\" fill=\"{}\"/><text x=\"{:.1f}\" y=\"{}\" class=\"tick\">{}</text>\n",
        name_width - 10, y + 15, escaped(chart.names[i]), name_width, y + 2, std::max(length, 1.0), row - 8, kColours[0],
        name_width + length + 8, y + 15, escaped(i < chart.texts.size() ? chart.texts[i] : ""));
  }
  return svg + "</svg>\n";
}

std::string csv_of(const LineChart& chart) {
  const auto name = [](const std::string& label, const std::string& unit) { return csv_cell(axis_text(label, unit)); };
  std::string csv = fmt::format("line,{},{},half width\n", name(chart.x_label, chart.x_unit), name(chart.y_label, chart.y_unit));
  for (const ChartLine& line : chart.lines) {
    for (std::size_t i = 0; i < line.x.size(); ++i) {
      if (!std::isfinite(line.y[i])) continue;
      const bool has_spread = i < line.spread.size() && std::isfinite(line.spread[i]);
      csv += fmt::format("{},{:.9g},{:.9g},{}\n", name(line.name, ""), line.x[i], line.y[i],
                         has_spread ? fmt::format("{:.4g}", line.spread[i]) : "");
    }
  }
  return csv;
}

std::string csv_of(const BarChart& chart) {
  std::string csv = "name,value\n";
  for (std::size_t i = 0; i < chart.values.size(); ++i) csv += fmt::format("{},{:.9g}\n", csv_cell(chart.names[i]), chart.values[i]);
  return csv;
}

std::string standalone_svg(const LineChart& chart) {
  // the classes of report_style.hpp that charts use, in the same colours
  constexpr const char* kStyle =
      "<style>.chart-title{font-size:15px;font-weight:600;fill:#1c2430}.chart-text{font-size:12.5px;fill:#37424e}"
      ".tick{font-size:11.5px;fill:#56616f}.grid{stroke:#e4e9ee;stroke-width:1}.axis{stroke:#6b7785;stroke-width:1;fill:none}"
      ".limit{stroke:#b3261e;stroke-width:1.2;stroke-dasharray:6 4}.limit-text{font-size:11.5px;fill:#8c1d17}"
      "text{font-family:system-ui,'Liberation Sans',Arial,sans-serif}</style><rect width=\"100%\" height=\"100%\" fill=\"#ffffff\"/>\n";
  std::string svg = svg_of(chart);
  return svg.insert(svg.find('\n') + 1, kStyle);
}

}  // namespace scree
