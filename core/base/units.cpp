#include "core/base/units.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <string_view>
#include <vector>

#include "core/base/error.hpp"
#include "core/base/nearest_name.hpp"
#include "core/base/numbers.hpp"

// A unit is a product of powers of symbols: "kg/m^3", "N m", "mm/s^2". Each symbol is a factor to SI and
// five exponents. The radian counts as a dimension of its own, so that "120 Hz" given for a rotation rate
// is refused rather than being wrong by 2 pi.

namespace scree {

namespace {

struct Exponents {
  int kilogram = 0, metre = 0, second = 0, radian = 0, kelvin = 0;
  bool operator==(const Exponents&) const = default;
};

struct Unit {
  double factor = 1.0;
  Exponents exponents;
};

struct Symbol {
  std::string_view name;
  double factor;
  Exponents exponents;
  bool takes_prefix;
};

constexpr std::array kSymbols{
    Symbol{"m", 1.0, {0, 1, 0, 0}, true},
    Symbol{"g", 1e-3, {1, 0, 0, 0}, true},
    Symbol{"t", 1e3, {1, 0, 0, 0}, false},
    Symbol{"s", 1.0, {0, 0, 1, 0}, true},
    Symbol{"min", 60.0, {0, 0, 1, 0}, false},
    Symbol{"h", 3600.0, {0, 0, 1, 0}, false},
    Symbol{"in", 0.0254, {0, 1, 0, 0}, false},
    Symbol{"N", 1.0, {1, 1, -2, 0}, true},
    Symbol{"Pa", 1.0, {1, -1, -2, 0}, true},
    Symbol{"bar", 1e5, {1, -1, -2, 0}, true},
    Symbol{"J", 1.0, {1, 2, -2, 0}, true},
    Symbol{"W", 1.0, {1, 2, -3, 0}, true},
    Symbol{"Hz", 1.0, {0, 0, -1, 0}, true},
    Symbol{"rad", 1.0, {0, 0, 0, 1}, true},
    Symbol{"deg", kPi / 180.0, {0, 0, 0, 1}, false},
    Symbol{"°", kPi / 180.0, {0, 0, 0, 1}, false},
    Symbol{"rev", 2.0 * kPi, {0, 0, 0, 1}, false},
    Symbol{"rpm", 2.0 * kPi / 60.0, {0, 0, -1, 1}, false},
    Symbol{"K", 1.0, {0, 0, 0, 0, 1}, true},
};

struct Prefix {
  std::string_view name;
  double factor;
};
constexpr std::array kPrefixes{Prefix{"p", 1e-12}, Prefix{"n", 1e-9}, Prefix{"u", 1e-6}, Prefix{"µ", 1e-6},
                               Prefix{"μ", 1e-6},  Prefix{"m", 1e-3}, Prefix{"c", 1e-2}, Prefix{"k", 1e3},
                               Prefix{"M", 1e6},   Prefix{"G", 1e9},  Prefix{"T", 1e12}};

struct DimensionFacts {
  Dimension dimension;
  const char* name;     // with article
  const char* unit;     // SI
  const char* example;  // a text that would be accepted
  Exponents exponents;
};
constexpr std::array kDimensions{
    DimensionFacts{Dimension::none, "a number without unit", "", "0.5", {}},
    DimensionFacts{Dimension::length, "a length", "m", "2.5 mm", {0, 1, 0, 0}},
    DimensionFacts{Dimension::time, "a time", "s", "10 us", {0, 0, 1, 0}},
    DimensionFacts{Dimension::mass, "a mass", "kg", "2 kg", {1, 0, 0, 0}},
    DimensionFacts{Dimension::velocity, "a velocity", "m/s", "1.5 m/s", {0, 1, -1, 0}},
    DimensionFacts{Dimension::acceleration, "an acceleration", "m/s^2", "9.81 m/s^2", {0, 1, -2, 0}},
    DimensionFacts{Dimension::angular_velocity, "an angular velocity", "rad/s", "120 rpm", {0, 0, -1, 1}},
    DimensionFacts{Dimension::angle, "an angle", "rad", "30 deg", {0, 0, 0, 1}},
    DimensionFacts{Dimension::frequency, "a frequency", "Hz", "50 Hz", {0, 0, -1, 0}},
    DimensionFacts{Dimension::density, "a density", "kg/m^3", "2700 kg/m^3", {1, -3, 0, 0}},
    DimensionFacts{Dimension::stiffness, "a stiffness", "N/m", "1e6 N/m", {1, 0, -2, 0}},
    DimensionFacts{Dimension::pressure, "a pressure", "Pa", "70 GPa", {1, -1, -2, 0}},
    DimensionFacts{Dimension::force, "a force", "N", "10 N", {1, 1, -2, 0}},
    DimensionFacts{Dimension::stress_per_length, "a stress per length", "Pa/m", "1 GPa/m", {1, -2, -2, 0}},
    DimensionFacts{Dimension::viscosity, "a dynamic viscosity", "Pa s", "1 mPa s", {1, -1, -1, 0}},
    DimensionFacts{Dimension::mass_rate, "a mass per time", "kg/s", "2 kg/s", {1, 0, -1, 0}},
    DimensionFacts{Dimension::energy, "an energy", "J", "0.5 uJ", {1, 2, -2, 0}},
    DimensionFacts{Dimension::surface_energy, "an energy per area", "J/m^2", "50 mJ/m^2", {1, 0, -2, 0}},
    DimensionFacts{Dimension::surface_tension, "a surface tension", "N/m", "72 mN/m", {1, 0, -2, 0}},
    DimensionFacts{Dimension::area, "an area", "m^2", "0.01 m^2", {0, 2, 0, 0}},
    DimensionFacts{Dimension::volume, "a volume", "m^3", "1 mm^3", {0, 3, 0, 0}},
    DimensionFacts{Dimension::torque, "a torque", "N m", "40 N m", {1, 2, -2, 0}},
    DimensionFacts{Dimension::moment_of_inertia, "a moment of inertia", "kg m^2", "0.2 kg m^2", {1, 2, 0, 0}},
    DimensionFacts{Dimension::damping, "a force per velocity", "N s/m", "100 N s/m", {1, 0, -1, 0}},
    DimensionFacts{Dimension::rotational_damping, "a torque per angular velocity", "N m s", "0.5 N m s", {1, 2, -1, 0}},
    DimensionFacts{Dimension::wear_coefficient, "a volume per energy", "m^3/J", "5e-13 m^3/J", {-1, 1, 2, 0}},
    DimensionFacts{Dimension::temperature, "a temperature", "K", "293 K", {0, 0, 0, 0, 1}},
    DimensionFacts{Dimension::power, "a power", "W", "5 W", {1, 2, -3, 0}},
    DimensionFacts{Dimension::heat_capacity, "a heat capacity per mass", "J/(kg K)", "900 J/(kg K)", {0, 2, -2, 0, -1}},
    DimensionFacts{Dimension::conductivity, "a thermal conductivity", "W/(m K)", "42 W/(m K)", {1, 1, -3, 0, -1}},
    DimensionFacts{
        Dimension::heat_transfer, "a heat flow per area and difference of temperature", "W/(m^2 K)", "500 W/(m^2 K)", {1, 0, -3, 0, -1}},
    DimensionFacts{Dimension::strain_rate, "a strain rate", "1/s", "0.1 1/s", {0, 0, -1, 0}},
};

const DimensionFacts& facts_of(Dimension dimension) {
  for (const DimensionFacts& facts : kDimensions) {
    if (facts.dimension == dimension) return facts;
  }
  throw InternalError("units: a dimension without an entry in kDimensions");
}

// "a length" for exponents that have a name, otherwise the SI unit spelt out: "something in kg m^2 s^-2".
std::string name_of(const Exponents& exponents) {
  for (const DimensionFacts& facts : kDimensions) {
    if (facts.exponents == exponents) return facts.name;
  }
  std::string text = "a quantity in";
  const auto add = [&text](const char* symbol, int power) {
    if (power == 1) text += fmt::format(" {}", symbol);
    if (power != 0 && power != 1) text += fmt::format(" {}^{}", symbol, power);
  };
  add("kg", exponents.kilogram);
  add("m", exponents.metre);
  add("s", exponents.second);
  add("rad", exponents.radian);
  add("K", exponents.kelvin);
  return text;
}

// One symbol with or without prefix. Whole names win: "min" is a minute, never a milli-inch.
bool find_symbol(std::string_view word, Unit& unit) {
  for (const Symbol& symbol : kSymbols) {
    if (symbol.name == word) {
      unit = {symbol.factor, symbol.exponents};
      return true;
    }
  }
  for (const Prefix& prefix : kPrefixes) {
    if (!word.starts_with(prefix.name)) continue;
    for (const Symbol& symbol : kSymbols) {
      if (symbol.takes_prefix && symbol.name == word.substr(prefix.name.size())) {
        unit = {prefix.factor * symbol.factor, symbol.exponents};
        return true;
      }
    }
  }
  return false;
}

std::string nearest_unit(std::string_view word) {
  std::vector<std::string> names;
  for (const Symbol& symbol : kSymbols) {
    names.emplace_back(symbol.name);
    if (!symbol.takes_prefix) continue;
    for (const Prefix& prefix : kPrefixes) names.push_back(std::string(prefix.name) + std::string(symbol.name));
  }
  return nearest_name(std::string(word), names);
}

bool is_word(char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (static_cast<unsigned char>(c) >= 0x80); }

// Walks along "kg/m^3" or "1/s". Returns "" or what is wrong with it.
std::string parse_unit(std::string_view text, Unit& unit) {
  unit = {};
  bool after_slash = false, expect_symbol = false, in_brackets = false;
  std::size_t at = 0;
  while (at < text.size()) {
    const char c = text[at];
    if (c == ' ' || c == '*') {
      ++at;
    } else if (c == '/') {
      // after one slash everything divides: J/kg/m is J/(kg m)
      if (expect_symbol) return "two slashes without a unit between them";
      if (in_brackets) return "a slash within brackets";
      after_slash = expect_symbol = true;
      ++at;
    } else if (c == '(' && expect_symbol && !in_brackets) {
      in_brackets = true;
      ++at;
    } else if (c == ')' && in_brackets && !expect_symbol) {
      in_brackets = after_slash = false;
      ++at;
    } else if (c == '1' && at == 0) {  // "1/s"
      ++at;
    } else if (is_word(c)) {
      std::size_t end = at;
      while (end < text.size() && is_word(text[end])) ++end;
      std::string_view word = text.substr(at, end - at);
      int power = 1;
      for (const auto& [mark, value] : {std::pair<std::string_view, int>{"²", 2}, {"³", 3}}) {
        if (word.ends_with(mark)) {
          power = value;
          word.remove_suffix(mark.size());
        }
      }
      at = end;
      if (at < text.size() && (text[at] == '^' || text[at] == '-' || (text[at] >= '0' && text[at] <= '9'))) {
        if (text[at] == '^') ++at;
        const auto [stop, fault] = std::from_chars(text.data() + at, text.data() + text.size(), power);
        if (fault != std::errc{} || power == 0 || std::abs(power) > 9) return "an exponent that is no small whole number";
        at = static_cast<std::size_t>(stop - text.data());
      }
      Unit factor;
      if (!find_symbol(word, factor)) {
        const std::string near = nearest_unit(word);
        return fmt::format("unknown unit '{}'{}", word, near.empty() ? "" : ", did you mean '" + near + "'?");
      }
      if (after_slash) power = -power;
      unit.factor *= std::pow(factor.factor, power);
      unit.exponents.kilogram += power * factor.exponents.kilogram;
      unit.exponents.metre += power * factor.exponents.metre;
      unit.exponents.second += power * factor.exponents.second;
      unit.exponents.radian += power * factor.exponents.radian;
      unit.exponents.kelvin += power * factor.exponents.kelvin;
      expect_symbol = false;
    } else {
      return fmt::format("'{}' is not part of a unit{}", c, c == ',' ? "; decimals have a point" : "");
    }
  }
  if (in_brackets) return "a bracket that is not closed";
  return expect_symbol ? "nothing after the slash" : "";
}

std::string_view trimmed(std::string_view text) {
  const auto first = text.find_first_not_of(" \t\r\n");
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(" \t\r\n") - first + 1);
}

}  // namespace

std::string dimension_name(Dimension dimension) {
  const DimensionFacts& facts = facts_of(dimension);
  return *facts.unit == '\0' ? facts.name : fmt::format("{} [{}]", facts.name, facts.unit);
}

double parse_quantity(const std::string& text, Dimension expected, const std::string& where) {
  const DimensionFacts& facts = facts_of(expected);
  const auto fail = [&](const std::string& found) {
    throw UsageError("{} = \"{}\": {}; expected {}, for instance \"{}\"", where, text, found, dimension_name(expected), facts.example);
  };

  std::string_view rest = trimmed(text);
  if (rest.empty()) fail("an empty text");
  if (rest.front() == '+') rest.remove_prefix(1);
  double value = 0.0;
  const auto [stop, fault] = std::from_chars(rest.data(), rest.data() + rest.size(), value);
  if (fault == std::errc::result_out_of_range) fail("a number beyond the range of double precision");
  if (fault != std::errc{}) fail("no number at its beginning");
  if (!std::isfinite(value)) fail("not a finite number");

  const std::string_view unit_text = trimmed(rest.substr(static_cast<std::size_t>(stop - rest.data())));
  if (unit_text.empty()) return value;     // a bare number is SI
  constexpr double kZeroCelsius = 273.15;  // [K]
  if (expected == Dimension::temperature && (unit_text == "degC" || unit_text == "°C")) return value + kZeroCelsius;
  Unit unit;
  if (const std::string wrong = parse_unit(unit_text, unit); !wrong.empty()) fail(wrong);
  if (unit.exponents != facts.exponents) fail(name_of(unit.exponents));
  return value * unit.factor;
}

std::string format_quantity(double value, Dimension dimension) {
  // of these a prefix would stand before a power or before a kilogram
  constexpr std::array kWithoutPrefix{Dimension::none,          Dimension::density,          Dimension::angle,
                                      Dimension::area,          Dimension::volume,           Dimension::moment_of_inertia,
                                      Dimension::mass_rate,     Dimension::angular_velocity, Dimension::temperature,
                                      Dimension::heat_capacity, Dimension::conductivity,     Dimension::heat_transfer,
                                      Dimension::strain_rate};
  if (value == 0.0 || !std::isfinite(value) || std::find(kWithoutPrefix.begin(), kWithoutPrefix.end(), dimension) != kWithoutPrefix.end()) {
    const char* unit = facts_of(dimension).unit;
    return *unit == '\0' ? fmt::format("{:.4g}", value) : fmt::format("{:.4g} {}", value, unit);
  }
  const char* const unit = dimension == Dimension::mass ? "g" : facts_of(dimension).unit;  // the kilogram already carries a prefix
  double scaled = value;
  if (dimension == Dimension::mass) {
    if (std::abs(value) >= 999.95) return fmt::format("{:.4g} t", value * 1e-3);
    if (std::abs(value) >= 0.99995) return fmt::format("{:.4g} kg", value);
    scaled = value * 1e3;
  }
  struct Step {
    const char* name;
    double factor;
  };
  // largest prefix whose number is at least 1 after rounding to four digits
  for (const Step step : {Step{"T", 1e12}, {"G", 1e9}, {"M", 1e6}, {"k", 1e3}, {"", 1.0}, {"m", 1e-3}, {"u", 1e-6}, {"n", 1e-9}}) {
    if (step.factor > 1.0 && dimension == Dimension::time) continue;  // kiloseconds are in no use
    if (std::abs(scaled) >= 0.99995 * step.factor) {
      return fmt::format("{:.4g} {}{}", scaled / step.factor, step.name, unit);
    }
  }
  return fmt::format("{:.4g} {}", value, facts_of(dimension).unit);
}

}  // namespace scree
