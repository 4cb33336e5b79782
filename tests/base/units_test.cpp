#include "core/base/units.hpp"

#include <gtest/gtest.h>

#include <numbers>

#include "core/base/error.hpp"

namespace scree {

// ctest shows these as the names of parametrised tests.
static void PrintTo(Dimension dimension, std::ostream* out) { *out << dimension_name(dimension); }

namespace {

constexpr double kPi = std::numbers::pi;

double quantity(const std::string& text, Dimension dimension) { return parse_quantity(text, dimension, "case.toml:14: key"); }

std::string complaint(const std::string& text, Dimension dimension) {
  try {
    quantity(text, dimension);
  } catch (const UsageError& error) {
    return error.what();
  }
  return "accepted";
}

// Expected values are the definitions of the units (SI brochure, 9th edition); the inch is 25.4 mm exactly.
struct Row {
  const char* text;
  Dimension dimension;
  double si;
};
void PrintTo(const Row& row, std::ostream* out) { *out << row.text; }

class EveryUnit : public testing::TestWithParam<Row> {};

TEST_P(EveryUnit, is_turned_into_si) {
  const Row& row = GetParam();
  EXPECT_NEAR(quantity(row.text, row.dimension), row.si, 4e-16 * std::abs(row.si)) << row.text;
}

INSTANTIATE_TEST_SUITE_P(
    units, EveryUnit,
    testing::Values(
        Row{"0.5", Dimension::none, 0.5}, Row{"2.5 mm", Dimension::length, 2.5e-3}, Row{"2.5mm", Dimension::length, 2.5e-3},
        Row{"  12 cm ", Dimension::length, 0.12}, Row{"3 µm", Dimension::length, 3e-6}, Row{"1 in", Dimension::length, 0.0254},
        Row{"-4 km", Dimension::length, -4000.0}, Row{"+1 m", Dimension::length, 1.0}, Row{"10 us", Dimension::time, 10e-6},
        Row{"2 min", Dimension::time, 120.0}, Row{"1 h", Dimension::time, 3600.0}, Row{"13 ms", Dimension::time, 13e-3},
        Row{"2 kg", Dimension::mass, 2.0}, Row{"36 t/h", Dimension::mass_rate, 10.0}, Row{"50 /s", Dimension::frequency, 50.0},
        Row{"5 g", Dimension::mass, 5e-3}, Row{"5 mg", Dimension::mass, 5e-6}, Row{"1.5 t", Dimension::mass, 1500.0},
        Row{"36 km/h", Dimension::velocity, 10.0}, Row{"1.5 m/s", Dimension::velocity, 1.5},
        Row{"9.81 m/s^2", Dimension::acceleration, 9.81}, Row{"9.81 m/s²", Dimension::acceleration, 9.81},
        Row{"9.81 m s^-2", Dimension::acceleration, 9.81}, Row{"9.81 m/s/s", Dimension::acceleration, 9.81},
        Row{"120 rpm", Dimension::angular_velocity, 4.0 * kPi}, Row{"180 deg/s", Dimension::angular_velocity, kPi},
        Row{"3 rad/s", Dimension::angular_velocity, 3.0}, Row{"2 rev/min", Dimension::angular_velocity, kPi / 15.0},
        Row{"30 deg", Dimension::angle, kPi / 6.0}, Row{"30°", Dimension::angle, kPi / 6.0}, Row{"1 rad", Dimension::angle, 1.0},
        Row{"50 Hz", Dimension::frequency, 50.0}, Row{"50 1/s", Dimension::frequency, 50.0}, Row{"2 kHz", Dimension::frequency, 2000.0},
        Row{"2700 kg/m^3", Dimension::density, 2700.0}, Row{"2.7 g/cm^3", Dimension::density, 2700.0},
        Row{"2.7 t/m3", Dimension::density, 2700.0}, Row{"1e6 N/m", Dimension::stiffness, 1e6},
        Row{"1.2 MN/m", Dimension::stiffness, 1.2e6}, Row{"4 N/mm", Dimension::stiffness, 4000.0}, Row{"70 GPa", Dimension::pressure, 70e9},
        Row{"3 bar", Dimension::pressure, 3e5}, Row{"5 N/mm^2", Dimension::pressure, 5e6}, Row{"10 N", Dimension::force, 10.0},
        Row{"2 kN", Dimension::force, 2000.0}, Row{"1 GPa/m", Dimension::stress_per_length, 1e9},
        Row{"1 mPa s", Dimension::viscosity, 1e-3}, Row{"1 g/m/s", Dimension::viscosity, 1e-3}, Row{"0.5 uJ", Dimension::energy, 5e-7},
        Row{"50 mJ/m^2", Dimension::surface_energy, 0.05}, Row{"72 mN/m", Dimension::surface_energy, 0.072},
        Row{"36 cm^2", Dimension::area, 0.0036}, Row{"2 mm^3", Dimension::volume, 2e-9}, Row{"72 mN/m", Dimension::surface_tension, 0.072},
        Row{"40 N m", Dimension::torque, 40.0}, Row{"2 g cm^2", Dimension::moment_of_inertia, 2e-7},
        Row{"3 N s/m", Dimension::damping, 3.0}, Row{"5 mN m s", Dimension::rotational_damping, 0.005},
        Row{"20 degC", Dimension::temperature, 293.15}, Row{"-20 °C", Dimension::temperature, 253.15},
        Row{"300 K", Dimension::temperature, 300.0}, Row{"2 kW", Dimension::power, 2000.0},
        Row{"0.9 kJ/(kg K)", Dimension::heat_capacity, 900.0}, Row{"0.9 J/g/K", Dimension::heat_capacity, 900.0},
        Row{"42 W/(m K)", Dimension::conductivity, 42.0}, Row{"0.4 W/(cm K)", Dimension::conductivity, 40.0},
        Row{"5 W/(m^2 K)", Dimension::heat_transfer, 5.0}, Row{"2 kg/(s)", Dimension::mass_rate, 2.0}));

class EveryDimension : public testing::TestWithParam<Dimension> {};

TEST_P(EveryDimension, accepts_a_bare_number_as_si_and_its_own_example) {
  EXPECT_EQ(quantity("1.25e-3", GetParam()), 1.25e-3);
  // the example that the message offers must itself be accepted
  const std::string text = complaint("1 kg^7", GetParam());
  const auto begin = text.find("for instance \"") + 14;
  EXPECT_NO_THROW(quantity(text.substr(begin, text.find('"', begin) - begin), GetParam())) << text;
}

TEST_P(EveryDimension, survives_being_formatted_and_read_again) {
  for (const double value : {1.234e-7, 4.5e-3, 0.9999, 1.0, 7.25, 999.9, 1000.0, 123400.0, 8.8e9}) {
    EXPECT_NEAR(quantity(format_quantity(value, GetParam()), GetParam()), value, 5e-4 * value);
    EXPECT_NEAR(quantity(format_quantity(-value, GetParam()), GetParam()), -value, 5e-4 * value);
  }
}

INSTANTIATE_TEST_SUITE_P(units, EveryDimension,
                         testing::Values(Dimension::none, Dimension::length, Dimension::time, Dimension::mass, Dimension::velocity,
                                         Dimension::acceleration, Dimension::angular_velocity, Dimension::angle, Dimension::frequency,
                                         Dimension::density, Dimension::stiffness, Dimension::pressure, Dimension::force,
                                         Dimension::stress_per_length, Dimension::viscosity, Dimension::energy, Dimension::surface_energy,
                                         Dimension::surface_tension, Dimension::area, Dimension::volume, Dimension::torque,
                                         Dimension::moment_of_inertia, Dimension::damping, Dimension::rotational_damping,
                                         Dimension::mass_rate, Dimension::temperature, Dimension::power, Dimension::heat_capacity,
                                         Dimension::conductivity, Dimension::heat_transfer));

TEST(units, a_wrong_dimension_is_refused_naming_place_found_expected_and_example) {
  const std::string text = complaint("0.5 m", Dimension::density);
  EXPECT_NE(text.find("case.toml:14: key = \"0.5 m\""), std::string::npos) << text;
  EXPECT_NE(text.find("a length"), std::string::npos) << text;
  EXPECT_NE(text.find("a density [kg/m^3]"), std::string::npos) << text;
  EXPECT_NE(text.find("2700 kg/m^3"), std::string::npos) << text;
}

TEST(units, a_unit_where_none_belongs_is_refused) {
  const std::string text = complaint("0.5 m", Dimension::none);
  EXPECT_NE(text.find("a length"), std::string::npos) << text;
  EXPECT_NE(text.find("without unit"), std::string::npos) << text;
}

TEST(units, a_frequency_is_no_angular_velocity) {
  EXPECT_NE(complaint("2 Hz", Dimension::angular_velocity).find("a frequency"), std::string::npos);
  EXPECT_NE(complaint("120 rpm", Dimension::frequency).find("an angular velocity"), std::string::npos);
}

TEST(units, a_dimension_without_a_name_is_spelt_out) {
  EXPECT_NE(complaint("3 W/m", Dimension::force).find("kg m s^-3"), std::string::npos);
  EXPECT_NE(complaint("3 K/m", Dimension::force).find("m^-1 K"), std::string::npos);
}

TEST(units, an_unknown_unit_is_refused_naming_the_nearest) {
  EXPECT_NE(complaint("3 mmm", Dimension::length).find("unknown unit 'mmm', did you mean 'mm'?"), std::string::npos)
      << complaint("3 mmm", Dimension::length);
  EXPECT_NE(complaint("3 Gpa", Dimension::pressure).find("did you mean 'GPa'"), std::string::npos);
}

TEST(units, text_that_is_no_quantity_is_refused) {
  for (const char* text : {"",       "  ",     "mm",     "five mm", "nan",    "inf mm",  "1e999 m",   "1 m/",   "1 m//s", "1 m^0",  "1 m^x",
                           "1 m; 2", "0x10 m", "1,5 mm", "1 m/(",   "1 m/(s", "1 m (s)", "1 m/(s/s)", "1 m/()", "1 m)",   "20 degC"}) {
    EXPECT_NE(complaint(text, Dimension::length), "accepted") << text;
  }
}

TEST(units, values_are_written_in_the_prefix_that_reads_best) {
  EXPECT_EQ(format_quantity(2.5e-3, Dimension::length), "2.5 mm");
  EXPECT_EQ(format_quantity(13e-6, Dimension::time), "13 us");
  EXPECT_EQ(format_quantity(1.2e6, Dimension::stiffness), "1.2 MN/m");
  EXPECT_EQ(format_quantity(70e9, Dimension::pressure), "70 GPa");
  EXPECT_EQ(format_quantity(0.012, Dimension::mass), "12 g");
  EXPECT_EQ(format_quantity(2.0, Dimension::mass), "2 kg");
  EXPECT_EQ(format_quantity(3600.0, Dimension::time), "3600 s");
  EXPECT_EQ(format_quantity(0.0, Dimension::length), "0 m");
  EXPECT_EQ(format_quantity(0.99996, Dimension::length), "1 m");
  EXPECT_EQ(format_quantity(2700.0, Dimension::density), "2700 kg/m^3");
}

TEST(units, every_dimension_has_a_name_with_its_unit) {
  EXPECT_EQ(dimension_name(Dimension::length), "a length [m]");
  EXPECT_EQ(dimension_name(Dimension::angular_velocity), "an angular velocity [rad/s]");
}

}  // namespace
}  // namespace scree
