#include "core/storage/bond.hpp"

#include <cmath>

#include "core/storage/json_object.hpp"

namespace scree {

namespace {

/// Calls action(dataset, unit, member) for the numbers of a bond.
template <class Action>
void for_each_number(Action&& action) {
  action("area", "m^2", &Bond::area);
  action("moment_1", "m^4", &Bond::moment_1);
  action("moment_2", "m^4", &Bond::moment_2);
  action("height", "m", &Bond::height);
  action("rim_radius", "m", &Bond::rim_radius);
  action("normal_stiffness", "N/m^3", &Bond::normal_stiffness);
  action("tangential_stiffness", "N/m^3", &Bond::tangential_stiffness);
  action("tension", "Pa", &Bond::tension);
  action("cohesion", "Pa", &Bond::cohesion);
  action("friction", "", &Bond::friction);
  action("fracture_energy", "J/m^2", &Bond::fracture_energy);
  action("damping", "", &Bond::damping);
}

template <class Value>
std::vector<Value> column(const std::vector<Bond>& bonds, Value Bond::*member) {
  std::vector<Value> values;
  for (const Bond& bond : bonds) values.push_back(bond.*member);
  return values;
}

bool is_unit(const Quat& q) { return std::abs(norm(q) - 1) <= kUnitTolerance; }

}  // namespace

void write_bonds(const h5::Group& group, const std::vector<Bond>& bonds) {
  group.write_array("a", column(bonds, &Bond::a), 1, "");
  group.write_array("b", column(bonds, &Bond::b), 1, "");
  group.write_array("point_a", column(bonds, &Bond::point_a), "m");
  group.write_array("point_b", column(bonds, &Bond::point_b), "m");
  group.write_array("frame_a", column(bonds, &Bond::frame_a), "");
  group.write_array("frame_b", column(bonds, &Bond::frame_b), "");
  for_each_number(
      [&](const char* name, const char* unit, double Bond::*member) { group.write_array(name, column(bonds, member), 1, unit); });
}

std::vector<Bond> read_bonds(const h5::Group& group) {
  const auto a = group.read_array<std::int64_t>("a", 1);
  std::vector<Bond> bonds(a.size());
  const auto fill = [&](const char* name, const auto& values, auto member) {
    if (values.size() != bonds.size())
      throw InputError("{}/{}: {} rows found, {} expected; the file is damaged", group.path(), name, values.size(), bonds.size());
    for (std::size_t i = 0; i < bonds.size(); ++i) bonds[i].*member = values[i];
  };
  fill("a", a, &Bond::a);
  fill("b", group.read_array<std::int64_t>("b", 1), &Bond::b);
  fill("point_a", group.read_vectors("point_a"), &Bond::point_a);
  fill("point_b", group.read_vectors("point_b"), &Bond::point_b);
  fill("frame_a", group.read_quaternions("frame_a"), &Bond::frame_a);
  fill("frame_b", group.read_quaternions("frame_b"), &Bond::frame_b);
  for_each_number([&](const char* name, const char*, double Bond::*member) { fill(name, group.read_array<double>(name, 1), member); });
  for (std::size_t i = 0; i < bonds.size(); ++i) {
    const Bond& bond = bonds[i];
    bool is_right = bond.a < bond.b && is_finite(bond.point_a) && is_finite(bond.point_b) && is_unit(bond.frame_a) && is_unit(bond.frame_b);
    for_each_number(
        [&](const char*, const char*, double Bond::*member) { is_right = is_right && bond.*member >= 0 && std::isfinite(bond.*member); });
    is_right = is_right && bond.area > 0 && bond.height > 0 && bond.normal_stiffness > 0;
    if (!is_right)
      throw InputError("{}: bond {} of bodies {} and {} cannot be right; the file is damaged", group.path(), i, bond.a, bond.b);
  }
  return bonds;
}

}  // namespace scree
