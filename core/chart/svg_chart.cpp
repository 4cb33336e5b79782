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
constexpr std::size_t kMaxPoints = 1500;                            // more than two points a pixel only make the page heavy

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
  if (line.x.size() <= kMaxPoints || line.style != ChartLine::Style::line) return line;
  ChartLine result{line.name, {}, {}};
  const std::size_t runs = kMaxPoints / 2;
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
  constexpr double kMinSpan = 1e-9;  // of the values: far above roundoff, far below what a label can show
  return !(high - low > kMinSpan * std::max(std::abs(low), std::abs(high)));
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

namespace {

/// What a line chart shows of its plane, and where on the page.
class Plane {
 public:
  explicit Plane(const LineChart& chart) : chart_(chart) {
    find_ranges();
    if (!is_empty()) choose_axes();
  }

  bool is_empty() const { return !(x_high_ >= x_low_); }
  bool shows(double x, double y) const {
    return std::isfinite(x) && std::isfinite(y) && (!chart_.logarithmic || y > 0) && (!chart_.logarithmic_x || x > 0);
  }
  double px(double x) const {
    const double part = chart_.logarithmic_x ? std::log(x / x_low_) / std::log(x_high_ / x_low_) : (x - x_low_) / (x_high_ - x_low_);
    return kLeft + width() * part;
  }
  double py(double y) const {
    const double part = chart_.logarithmic ? std::log(y / y_low_) / std::log(y_high_ / y_low_) : (y - y_low_) / (y_high_ - y_low_);
    return kTop + height() * (1 - part);
  }
  double py_within(double y) const { return py(std::clamp(y, y_low_, y_high_)); }
  static double width() { return kWidth - kLeft - kRight; }
  static double height() { return kHeight - kTop - kBottom; }

  std::string axes() const;

 private:
  void find_ranges();
  void choose_axes();
  std::string levels() const;
  std::string marks() const;

  const LineChart& chart_;
  double x_low_ = std::numeric_limits<double>::infinity(), x_high_ = -x_low_, y_low_ = x_low_, y_high_ = -x_low_;
  Prefix xp_{}, yp_{};
  std::vector<double> y_ticks_;  // decided once: ticks of the widened axis could be coarser and reach beyond it
};

double spread_at(const ChartLine& line, std::size_t i) {
  return i < line.spread.size() && std::isfinite(line.spread[i]) ? line.spread[i] : 0.0;
}

void Plane::find_ranges() {
  for (const ChartLine& line : chart_.lines) {
    for (std::size_t i = 0; i < line.x.size(); ++i) {
      if (!shows(line.x[i], line.y[i])) continue;
      x_low_ = std::min(x_low_, line.x[i]);
      x_high_ = std::max(x_high_, line.x[i]);
      const double spread = chart_.logarithmic ? 0 : spread_at(line, i);  // half a decade of doubt must not make ten decades of axis
      // a quantity that cannot be negative keeps its axis at 0, whatever the doubt
      y_low_ = std::min(y_low_, chart_.from_zero && line.y[i] >= 0 ? std::max(0.0, line.y[i] - spread) : line.y[i] - spread);
      y_high_ = std::max(y_high_, line.y[i] + spread);
    }
  }
  for (const ChartLimit& limit : chart_.limits) {
    if (is_empty() || !shows(1, limit.y)) continue;
    y_low_ = std::min(y_low_, limit.y);
    y_high_ = std::max(y_high_, limit.y);
  }
}

void Plane::choose_axes() {
  if (chart_.from_zero && !chart_.logarithmic) y_low_ = std::min(0.0, y_low_);
  const auto whole_decades = [](double& low, double& high) {
    low = std::pow(10.0, std::floor(std::log10(low) + 1e-12));
    high = std::pow(10.0, std::ceil(std::log10(high) - 1e-12));
    if (high <= low) high = 10 * low;
  };
  if (chart_.logarithmic_x) whole_decades(x_low_, x_high_);
  if (is_flat(x_low_, x_high_)) x_high_ = x_low_ + std::max(1.0, std::abs(x_low_));
  xp_ = chart_.logarithmic_x ? Prefix{1, chart_.x_unit} : prefix_for(std::max(std::abs(x_low_), std::abs(x_high_)), chart_.x_unit);
  yp_ = chart_.logarithmic ? Prefix{1, chart_.y_unit} : prefix_for(std::max(std::abs(y_low_), std::abs(y_high_)), chart_.y_unit);
  if (chart_.logarithmic) {
    constexpr double kMaxDecades = 14;  // a value at rounding level must not squeeze the rest
    y_low_ = std::max(y_low_, y_high_ * std::pow(10.0, -kMaxDecades));
    whole_decades(y_low_, y_high_);
    return;
  }
  if (is_flat(y_low_, y_high_)) {
    const double pad = y_high_ != 0 ? 0.5 * std::abs(y_high_) : 1;
    y_low_ -= chart_.from_zero ? 0 : pad;
    y_high_ += pad;
  }
  y_ticks_ = round_ticks(y_low_ / yp_.factor, y_high_ / yp_.factor, 5);
  y_low_ = y_ticks_.front() * yp_.factor;
  y_high_ = y_ticks_.back() * yp_.factor;
}

/// Lines of the grid with the values of y.
std::string Plane::levels() const {
  std::string svg;
  const auto level = [&](double y, const std::string& text) {
    svg += fmt::format(
        "<line x1=\"{}\" x2=\"{}\" y1=\"{:.1f}\" y2=\"{:.1f}\" class=\"grid\"/><text x=\"{}\" y=\"{:.1f}\" class=\"tick\" "
        "text-anchor=\"end\">{}</text>\n",
        kLeft, kLeft + width(), py(y), py(y), kLeft - 7, py(y) + 4, text);
  };
  if (chart_.logarithmic) {
    const int low = static_cast<int>(std::lround(std::log10(y_low_))), high = static_cast<int>(std::lround(std::log10(y_high_)));
    const int stride = std::max(1, (high - low + 5) / 6);
    for (int e = high; e >= low; e -= stride) level(std::pow(10.0, e), power_of_ten(e));
  } else {
    const double step = y_ticks_.size() > 1 ? y_ticks_[1] - y_ticks_[0] : 1;
    for (double t : y_ticks_) level(t * yp_.factor, number(t, step));
  }
  return svg;
}

/// Marks of the lower axis with the values of x.
std::string Plane::marks() const {
  std::string svg;
  const auto mark = [&](double x, const std::string& text) {
    svg += fmt::format(
        "<line x1=\"{0:.1f}\" x2=\"{0:.1f}\" y1=\"{1}\" y2=\"{2}\" class=\"axis\"/><text x=\"{0:.1f}\" y=\"{3}\" class=\"tick\" "
        "text-anchor=\"middle\">{4}</text>\n",
        px(x), kTop + height(), kTop + height() + 5, kTop + height() + 18, text);
  };
  if (chart_.logarithmic_x) {
    const int low = static_cast<int>(std::lround(std::log10(x_low_))), high = static_cast<int>(std::lround(std::log10(x_high_)));
    for (int e = low; e <= high; e += std::max(1, (high - low + 7) / 8)) mark(std::pow(10.0, e), power_of_ten(e));
    return svg;
  }
  const std::vector<double> x_ticks = round_ticks(x_low_ / xp_.factor, x_high_ / xp_.factor, 7);
  const double x_step = x_ticks.size() > 1 ? x_ticks[1] - x_ticks[0] : 1;
  for (double t : x_ticks) {
    if (t * xp_.factor < x_low_ - 1e-9 * (x_high_ - x_low_) || t * xp_.factor > x_high_ + 1e-9 * (x_high_ - x_low_)) continue;
    mark(t * xp_.factor, number(t, x_step));
  }
  return svg;
}

std::string Plane::axes() const {
  std::string svg = levels() + marks();
  svg += fmt::format("<polyline points=\"{0},{1} {0},{2} {3},{2}\" class=\"axis\"/>\n", kLeft, kTop, kTop + height(), kLeft + width());
  svg += fmt::format("<text x=\"{}\" y=\"{}\" class=\"chart-text\" text-anchor=\"middle\">{}</text>\n", kLeft + width() / 2, kHeight - 8,
                     escaped(axis_text(chart_.x_label, xp_.text)));
  svg += fmt::format("<text transform=\"translate(14 {}) rotate(-90)\" class=\"chart-text\" text-anchor=\"middle\">{}</text>\n",
                     kTop + height() / 2, escaped(axis_text(chart_.y_label, yp_.text)));
  for (const ChartLimit& limit : chart_.limits) {
    if (!shows(1, limit.y)) continue;
    svg += fmt::format(
        "<line x1=\"{0}\" x2=\"{1}\" y1=\"{2:.1f}\" y2=\"{2:.1f}\" class=\"limit\"/><text x=\"{1}\" y=\"{3:.1f}\" "
        "class=\"limit-text\" text-anchor=\"end\">{4}</text>\n",
        kLeft, kLeft + width(), py(limit.y), py(limit.y) - 5, escaped(limit.text));
  }
  return svg;
}

/// How a line is drawn.
struct Pen {
  std::size_t number;
  const char *colour, *dash;
  bool has_line, has_points;
};

/// The band of doubt about a line.
std::string band_of(const ChartLine& line, const Pen& pen, const Plane& plane) {
  if (line.spread.empty()) return "";
  std::string upper, lower;
  for (std::size_t i = 0; i < line.x.size(); ++i) {
    if (!plane.shows(line.x[i], line.y[i])) continue;
    const double spread = spread_at(line, i);
    upper += fmt::format("{:.1f},{:.1f} ", plane.px(line.x[i]), plane.py_within(line.y[i] + spread));
    lower.insert(0, fmt::format("{:.1f},{:.1f} ", plane.px(line.x[i]), plane.py_within(line.y[i] - spread)));
  }
  return fmt::format("<polygon points=\"{}{}\" fill=\"{}\" fill-opacity=\"0.22\" stroke=\"none\"/>\n", upper, lower, pen.colour);
}

/// Points with their labels, and the line through them.
std::string curve_of(const ChartLine& line, const Pen& pen, const Plane& plane) {
  std::string svg, path;
  bool pen_down = false;
  for (std::size_t i = 0; i < line.x.size(); ++i) {
    if (!plane.shows(line.x[i], line.y[i])) {
      pen_down = false;
      continue;
    }
    const double x = plane.px(line.x[i]), y = plane.py_within(line.y[i]);
    path += fmt::format("{}{:.1f} {:.1f}", pen_down ? "L" : "M", x, y);
    pen_down = true;
    if (pen.has_points) svg += marker(pen.number, x, y, pen.colour);
    if (i < line.labels.size() && !line.labels[i].empty()) {
      const bool left = x > kLeft + 100;
      // a ring about the point; the text below and left of it, where a front has nothing else
      svg += fmt::format(
          "<circle cx=\"{0:.1f}\" cy=\"{1:.1f}\" r=\"7.5\" fill=\"none\" stroke=\"#1c2430\" stroke-width=\"1.4\"/><text x=\"{2:.1f}\" "
          "y=\"{3:.1f}\" "
          "class=\"tick\" text-anchor=\"{4}\">{5}</text>\n",
          x, y, x + (left ? -8 : 8), y + 19, left ? "end" : "start", escaped(line.labels[i]));
    }
  }
  if (!pen.has_line) return svg;
  return svg + fmt::format(
                   "<path d=\"{}\" fill=\"none\" stroke=\"{}\" stroke-width=\"1.8\" stroke-linejoin=\"round\" stroke-dasharray=\"{}\"/>\n",
                   path, pen.colour, pen.dash);
}

/// Entries of the legend above the frame, row after row.
class Legend {
 public:
  std::string entry(const ChartLine& line, const Pen& pen) {
    const double long_name = 32 + 8.8 * static_cast<double>(line.name.size()) + 14;  // room for the larger letters on a phone
    if (x_ > kLeft && x_ + long_name > kWidth) {
      x_ = kLeft;
      y_ += 15;
    }
    std::string svg;
    if (pen.has_line) {
      svg += fmt::format("<line x1=\"{0}\" x2=\"{1}\" y1=\"{4}\" y2=\"{4}\" stroke=\"{2}\" stroke-width=\"2.4\" stroke-dasharray=\"{3}\"/>",
                         x_, x_ + 26, pen.colour, pen.dash, y_);
    }
    if (pen.has_points) svg += marker(pen.number, x_ + 13, y_, pen.colour);
    svg += fmt::format("<text x=\"{}\" y=\"{}\" class=\"chart-text\">{}</text>\n", x_ + 32, y_ + 4, escaped(line.name));
    x_ += long_name;
    return svg;
  }

 private:
  double x_ = kLeft, y_ = 42;
};

}  // namespace

std::string svg_of(const LineChart& chart) {
  const Plane plane(chart);
  std::string svg = svg_head(chart.title, kHeight);
  if (plane.is_empty()) return svg + "<text x=\"0\" y=\"60\" class=\"chart-text\">nothing to draw</text>\n</svg>\n";
  svg += plane.axes();
  Legend legend;
  for (std::size_t s = 0; s < chart.lines.size(); ++s) {
    const ChartLine line = thinned(chart.lines[s]);
    const Pen pen{s, kColours[s % kColours.size()], kDashes[s % kDashes.size()], line.style != ChartLine::Style::points,
                  line.style != ChartLine::Style::line};
    svg += band_of(line, pen, plane);
    svg += curve_of(line, pen, plane);
    if (chart.lines.size() > 1 || !line.spread.empty()) svg += legend.entry(line, pen);
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
