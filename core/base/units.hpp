// Numbers with units: "2.5 mm", "120 rpm", "10 us". A bare number is SI. Everything inside Scree is SI.
#pragma once

#include <string>

namespace scree {

enum class Dimension {
  none,
  length,
  time,
  mass,
  velocity,
  acceleration,
  angular_velocity,
  angle,
  frequency,
  density,
  stiffness,
  pressure,
  force,
  stress_per_length,
  viscosity,
  mass_rate,
  energy,
  surface_energy,
  surface_tension,
  area,
  volume,
  torque,
  moment_of_inertia,
  damping,
  rotational_damping,
  wear_coefficient,
  temperature,
  power,
  heat_capacity,
  conductivity,
  heat_transfer,
  strain_rate
};

/// "a length [m]", for messages.
std::string dimension_name(Dimension dimension);

/// SI value of a text such as "2.5 mm".
///
/// in   where   what the text belongs to, for the message: "case.toml:14: materials.rock.density"
/// A temperature may be given in degrees Celsius, "20 degC" or "20 °C"; its value is in kelvin.
/// Fails: throws UsageError when the text is no number with a known unit, or has another dimension; the
/// message says what was found and what was expected, with an example.
double parse_quantity(const std::string& text, Dimension expected, const std::string& where);

/// "2.5 mm", "13 us", "1.2 MN/m": a value in the prefix that reads best, three or four digits.
std::string format_quantity(double value, Dimension dimension);

/// The same of a length.
inline std::string metres(double value) { return format_quantity(value, Dimension::length); }

}  // namespace scree
