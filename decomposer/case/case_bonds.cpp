#include <algorithm>
#include <numbers>

#include "decomposer/case/case_sections.hpp"

namespace scree {

namespace {

/// What the numbers of a section must fulfil together.
void check_bond(const CaseTable& t, const CaseBond& b) {
  if (t.has("cohesion") && !t.has("tension"))
    throw t.error("cohesion", "goes with tension: a bond that shear alone breaks would hold any pull");
  if (t.has("friction_angle") && !t.has("cohesion")) throw t.error("friction_angle", "goes with cohesion, which it adds to under pressure");
  if (!(b.friction_angle < 0.5 * std::numbers::pi)) throw t.error("friction_angle", "expected an angle below 90 degrees");
  if (t.has("strength_scatter") && !t.has("tension") && !t.has("fracture_energy"))
    throw t.error("strength_scatter", "scatters tension, cohesion and fracture_energy; none of them is given");
  if (!(b.damping <= 1)) throw t.error("damping", "expected a value from 0 to 1, the critical damping");
}

void bond_section(CaseKeys& k, Case& c) {
  CaseBond b;
  const CaseTable* t = k.table();
  std::vector<std::string> between;
  const std::string what = k.one_of({"within", "between"});
  k.reference({"within", "or `between`", "material of bodies whose shape has `pieces`"}, b.material, names_of_materials(c), "material");
  k.texts({"between", "or `within`", "two materials: bodies of `[[bodies]]` and `[[populations]]` that lie face to face"}, between);
  k.number({"distance", "faces that touch", "of `between`: faces that are this far apart, or less, are bonded"}, b.distance,
           Dimension::length, Range::positive);
  if (t != nullptr && what == "between") {
    if (between.size() != 2) throw t->error("between", "expected two material names, for instance [\"brick\", \"brick\"]");
    b.between_a = t->find_name("between", between[0], names_of_materials(c), "material");
    b.between_b = t->find_name("between", between[1], names_of_materials(c), "material");
    if (b.between_a > b.between_b) std::swap(b.between_a, b.between_b);
  }
  if (t != nullptr && what == "within" && t->has("distance")) throw t->error("distance", "goes with between; pieces share their faces");
  k.number({"young", kRequired,
            "of the bonded material: stress over displacement of a face is `young` over the distance of its cells' points, or of the "
            "centres of both bodies along its normal"},
           b.young, Dimension::pressure, Range::positive);
  k.number({"tangential_ratio", "", "shear stiffness over normal stiffness; sets Poisson's ratio (1 - ratio) / (4 + ratio), about"},
           b.tangential_ratio, Dimension::none, Range::positive);
  k.number({"tension", "never breaks", "normal stress at the rim of a face, bending included, at which the bond breaks"}, b.tension,
           Dimension::pressure, Range::positive);
  k.number({"cohesion", "never breaks in shear", "shear stress at which the bond breaks without pressure"}, b.cohesion, Dimension::pressure,
           Range::positive);
  k.number({"friction_angle", "", "pressure times its tangent adds to `cohesion`"}, b.friction_angle, Dimension::angle,
           Range::not_negative);
  k.number(
      {"fracture_energy", "none", "energy of opening and sliding per area at which a bond breaks; in addition to or instead of stresses"},
      b.fracture_energy, Dimension::surface_energy, Range::positive);
  k.section({"strength_scatter", "none, all alike", "strengths of bonds are drawn; those given are the means"}, [&](CaseKeys& below) {
    below.number({"weibull_modulus", kRequired, "of stresses; energies scale with the square of stresses"}, b.weibull_modulus,
                 Dimension::none, Range::positive);
  });
  k.number({"damping", "", "share of critical damping of each motion of two pieces"}, b.damping, Dimension::none, Range::not_negative);
  if (t == nullptr) return;
  b.where = t->where();
  check_bond(*t, b);
  for (const CaseBond& other : c.bonds) {
    if (what == "within" && other.material == b.material) throw t->error("within", "is given twice; first at " + other.where);
    if (what == "between" && other.between_a == b.between_a && other.between_b == b.between_b)
      throw t->error("between", "is given twice; first at " + other.where);
  }
  if (c.settings.sleep) {
    throw t->error("", "does not go with time.sleep: bodies would sleep through what their bonds do; leave out one of both");
  }
  c.bonds.push_back(b);
}

}  // namespace

void bond_sections(CaseKeys& k, Case& c) {
  k.sections({"bonds"}, [&](CaseKeys& below) { bond_section(below, c); });
}

}  // namespace scree
