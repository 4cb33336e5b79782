#include "core/storage/scene_keys.hpp"

namespace scree {

void run_keys(KeyVisitor& k, Settings& s) {
  k.text({"title", "name of the file", "for plots and reports", kAlways}, s.title);
  k.count({"seed", "", "of all random numbers", kAlways}, s.seed);
  k.vector({"gravity", "`[0, 0, -9.81]`", "", kAlways}, s.gravity, Dimension::acceleration);
}

void time_keys(KeyVisitor& k, Settings& s) {
  k.number({"duration", kRequired, "of the simulation", kAlways}, s.duration, Dimension::time, Range::not_negative);
  k.number(
      {"steps_per_contact", "",
       "the step is the duration of the stiffest contact divided by this number; low restitution needs more steps, 29 at most", kAlways},
      s.steps_per_contact, Dimension::none, Range::positive);
  k.number({"step", "derived", "fixes the step; not together with `steps_per_contact`", kAlways}, s.step, Dimension::time, Range::positive);
  k.boolean({"stop_at_rest", "",
             "ends the run at the first output time at which all bodies rest and no wall moves or will move. Bodies rest if, since the "
             "last wall stopped and at least for the time in which a body falls by its own diameter, their total kinetic energy has stayed "
             "below 1e-6 of the energy of that fall, and the energy of each body below 1e-2 of its own. In a fluid the fall is one in that "
             "fluid, at most at the terminal speed; if a body weighs nothing there, a fall in a void. The run ends also when no body is "
             "left. The log then has at least four rows in the time of such a fall. Needs gravity"},
            s.stop_at_rest);
  k.boolean({"stop_when_empty", "",
             "ends the run at the first output time at which no body is left that is free to move: when a silo has emptied, for instance. "
             "Bodies leave through the sides of a domain with `outside = \"remove\"`, which it needs"},
            s.stop_when_empty);
  k.boolean({"sleep", "", "bodies at rest sleep: they are not computed until a contact disturbs them; see below. Needs gravity"}, s.sleep);
  k.number({"sleep_tolerance", "",
            "of `sleep`: change of force, over the weight of a body, below which the body stays asleep; also the largest net force on a "
            "body at rest"},
           s.sleep_tolerance, Dimension::none, Range::fraction);
  k.word({"step_control", "",
          "`quantised`: the step is halved as often as needed, so that in one step no body moves by more than a fifth of its margin "
          "(rotation counts if it moves the surface outwards) or rotates by more than 0.1 rad, and the present contacts are stable; "
          "`steps.csv` lists every change. `fixed` conserves energy best"},
         s.step_control);
}

void domain_keys(KeyVisitor& k, Domain& d) {
  if (k.when(d.bounded)) {
    k.vector({"min", "none", "a corner; both `min` and `max`, or none", kAlways, true}, d.lower, Dimension::length);
    k.vector({"max", "none", "the opposite corner", kAlways, true}, d.upper, Dimension::length);
  }
  k.word({"outside", "",
          "what happens when a body's centre leaves through a side that is not periodic: the run stops (exit 5); the body is removed and "
          "listed in `removed.csv`; or it is kept and counted",
          kAlways},
         d.outside);
  k.axes({"periodic", "none", "what leaves through one side comes in through the other; needs `min` and `max`", kAlways}, d.periodic);
}

void fluid_keys(KeyVisitor& k, Fluid& f) {
  k.number({"density", kRequired, "each body is lighter by the fluid that it displaces", kAlways}, f.density, Dimension::density,
           Range::positive);
  k.number({"viscosity", kRequired, "dynamic; water has `\"1 mPa s\"`", kAlways}, f.viscosity, Dimension::viscosity, Range::positive);
  k.vector({"velocity", "", "of the fluid, the same everywhere and at all times", kAlways}, f.velocity, Dimension::velocity);
  k.word({"drag", "",
          "drag by sphericity at any Reynolds number, and a moment against rotation (sources and limits in `solver/bodies/fluid.hpp`); or "
          "the limit of both at low Reynolds numbers",
          kAlways},
         f.drag);
}

void heat_keys(KeyVisitor& k, Heat& h) {
  k.number({"temperature", "required, unless each gives its own", "of bodies, populations and inlets without one of their own"},
           h.temperature, Dimension::temperature, Range::positive);
  k.boolean({"friction_heat", "",
             "what damping, friction and rolling resistance of contacts dissipate heats the two bodies, half each; the half of a wall is "
             "counted and leaves the scene"},
            h.friction_heat);
  k.boolean(
      {"frozen", "",
       "bodies and contacts stay as they are at the start (that of `[start]`, for a bed that has settled), and conduction alone sets the "
       "step: hours of conduction in a bed at rest take seconds"},
      h.frozen);
  k.number({"gas_conductivity", "gaps do not conduct",
            "of the gas around bodies: pairs that touch or are less than `gas_range` apart conduct through it; at most a tenth of the "
            "conductivity of any two materials"},
           h.gas_conductivity, Dimension::conductivity, Range::positive);
  k.number({"gas_range", "required with `gas_conductivity`", "widest gap between two surfaces that conducts"}, h.gas_range,
           Dimension::length, Range::positive);
}

void cell_stop_keys(KeyVisitor& k, CellControl& c) {
  k.number({"strain", "none", "of any axis, `ln(h / h_start)`, or of any shear, the integral of L; without its sign"}, c.stop_strain,
           Dimension::none, Range::positive);
  k.number({"stress_error", "none",
            "largest difference of a stress from its target, over the largest target; with `kinetic_ratio`, if given, both at once"},
           c.stop_stress_error, Dimension::none, Range::positive);
  k.number(
      {"kinetic_ratio", "none",
       "kinetic energy of bodies that touch others, over the energy stored in their contacts; with `stress_error`, if given, both at once"},
      c.stop_kinetic_ratio, Dimension::none, Range::positive);
}

void contact_keys(KeyVisitor& k, Settings& s) {
  k.word({"law", "",
          "force law: a linear spring or Hertz's; restitution independent of speed, or (`hunt-crossley`) a force without a jump at touch",
          kAlways},
         s.law);
  k.number(
      {"impact_speed", "derived from the case", "fastest impact expected: the margin follows from it, and the step of `hertz-mindlin`"},
      s.impact_speed, Dimension::velocity, Range::positive);
  k.word({"gather", "",
          "how contacts become a force: one potential per pair of bodies; an elastic layer, pressure over the area where faces are "
          "opposite each other, for conforming faces (needs `margin` and `layer_modulus`; a vertex carries little load, `F ~ d^3`); or one "
          "spring per pair of triangles (for comparison only: stiffness and damping grow with the mesh, "
          "and an edge parallel to a face touches at one of its ends, which rounding chooses)",
          kAlways},
         s.gather);
  k.word({"weights", "",
          "of vertices in `gather = \"potential\"`: those that lie close together count as one (`density`), so that stiffness tends to a "
          "limit "
          "as the mesh of a curved surface is refined; or each counts (`unit`), for comparison"},
         s.weights);
  k.word({"surface", "",
          "where touch begins: at the surfaces as drawn (meshes are moved inwards by their margin and surrounded by a layer of that "
          "thickness: edges and vertices are rounded), or two margins outside them (for comparison: bodies are larger than drawn)"},
         s.surface);
  k.number(
      {"margin", "derived from speed and stiffness",
       "thickness of the layer of each body into which contacts press; with `surface = \"drawn\"` that of the body of median mass, the "
       "others in proportion to their size; 0 where all bodies are analytic spheres; a `barrier` of these needs `surface = \"outside\"`",
       kAlways},
      s.margin, Dimension::length, Range::not_negative);
  k.number(
      {"margin_ratio", "from `margin`", "the margin of each mesh over the radius of the ball of its volume, with `surface = \"drawn\"`"},
      s.margin_ratio, Dimension::none, Range::not_negative);
  k.number({"barrier", "",
            "stiffness of a barrier over that of a contact: from an overlap of a fifth of the margins on its force grows without limit, so "
            "that the moved meshes never meet, at steps that are `sqrt(1 + 24 barrier)` times shorter; 10 doubles the energy that a "
            "contact can take"},
           s.barrier, Dimension::none, Range::not_negative);
  k.word({"on_overlap", "",
          "if a moving wall presses bodies beyond the maximum overlap that their margins allow, the run ends (exit 5); or it continues: "
          "the force grows along the tangent of the law, and log, `run.json` and report give number, depth and place of such contacts. "
          "Bodies then penetrate each other or the wall, so that the result is doubtful. `continue` needs a moving wall and `gather = "
          "\"potential\"`"},
         s.on_overlap);
}

void motion_keys(KeyVisitor& k, Settings& s) {
  k.word({"integrator", "",
          "the first is the one to use: no drift of energy, momentum conserved to rounding; the others are for comparison "
          "(`docs/results/work-precision.md`)",
          kAlways},
         s.integrator);
}

void output_keys(KeyVisitor& k, Settings& s) {
  k.number({"every", "duration / 100", "between frames", {"output_every", true}}, s.output_every, Dimension::time, Range::positive);
  k.boolean({"contacts", "", "in the frames", {"output_contacts", true}}, s.output_contacts);
  k.boolean({"impacts",
             "",
             "in the frames: impact energies and the energy dissipated by contacts, for each pair of materials",
             {"output_impacts"}},
            s.output_impacts);
  k.number({"checkpoint",
            "every 30 min of run time",
            "between checkpoints, in simulated time; 0: one at the end only",
            {"checkpoint_every", true}},
           s.checkpoint_every, Dimension::time, Range::not_negative);
}

void material_keys(KeyVisitor& k, Material& m) {
  k.number({"density", kRequired, "", kAlways}, m.density, Dimension::density, Range::positive);
  k.number({"young", "required for `hertz-mindlin`", "Young's modulus", kAlways}, m.young, Dimension::pressure, Range::positive);
  k.number({"poisson", "", "Poisson's ratio, above -1 and at most 0.5; for `hertz-mindlin`", kAlways}, m.poisson, Dimension::none,
           Range::any);
}

void material_heat_keys(KeyVisitor& k, Material& m) {
  k.number({"heat_capacity", "required of bodies with `[heat]`", "for each mass"}, m.heat_capacity, Dimension::heat_capacity,
           Range::positive);
  k.number({"conductivity", "required of bodies with `[heat]`",
            "for heat; a wall without one does not resist: its contacts are isothermal surfaces"},
           m.conductivity, Dimension::conductivity, Range::positive);
  k.number({"real_young", "none",
            "Young's modulus of the real material, where the contacts of the case are softer. If both materials of a contact have it, the "
            "radius through which heat flows is that of Hertz's contact under the same force, of the real materials (with `poisson`); "
            "otherwise it follows from the overlap of the simulated contact, which is too large"},
           m.real_young, Dimension::pressure, Range::positive);
}

void pair_heat_keys(KeyVisitor& k, MaterialPair& p) {
  k.number(
      {"contact_conductance", "none",
       "with `[heat]`: of what lies between both surfaces (oxide, film, roughness), in series with the contact, for each area of contact"},
      p.contact_conductance, Dimension::heat_transfer, Range::positive);
}

void pair_keys(KeyVisitor& k, MaterialPair& p, const Settings& s) {
  // a Hertz contact and a layer have no stiffness of their own: it comes from the materials
  const bool has_spring = s.law != ContactLaw::hertz_mindlin && s.gather != Gathering::area;
  k.number({"modulus", "none",
            "instead of `stiffness`, a stiffness that depends on size: of one contact, `modulus` times 2 R_a R_b / (R_a + R_b) of the "
            "spheres of equal volume, R_b infinite for a wall, and -R inside of a sphere_inside of radius R. At one impact speed the ratio "
            "of overlap to size is then the same for all sizes, and the step is proportional to the smallest radius"},
           p.modulus, Dimension::pressure, Range::positive);
  k.number({"stiffness", "required, but for `hertz-mindlin` and `area`, or `modulus`", "of one contact", kAlways,
            has_spring && !(p.modulus > 0)},
           p.stiffness, Dimension::stiffness, Range::positive);
  k.number({"restitution", kRequired, "ratio of normal speeds after and before an impact; less than 0.01 is computed as 0.01", kAlways},
           p.restitution, Dimension::none, Range::unit_interval);
  k.number({"restitution_speed", "required for `hunt-crossley` below 1", "approach speed at which `restitution` holds"},
           p.restitution_speed, Dimension::velocity, Range::positive);
  k.number(
      {"plasticity", "none",
       "1 - k1 / k2, from 0 to below 1, of a contact that yields: pressed deeper than before it follows the `law` (k1), and unloads k2 / "
       "k1 times as steeply, so that without other losses and adhesion restitution is the root of 1 - `plasticity` with a linear law; "
       "with `gather = \"potential\"`"},
      p.plasticity, Dimension::none, Range::unit_interval);
  k.number({"adhesive_ratio", "",
            "with `plasticity`: a contact that has yielded pulls, as it is unloaded, by up to this times the force of the `law` at its "
            "overlap (k_adh / k1)"},
           p.adhesive_ratio, Dimension::none, Range::not_negative);
  k.number({"friction", "", "static coefficient", kAlways}, p.friction, Dimension::none, Range::not_negative);
  k.number({"friction_sliding", "as `friction`",
            "from 0 to `friction`: the coefficient of a sliding contact, from the step in which sliding begins until the contact no longer "
            "moves against its spring",
            kAlways},
           p.friction_sliding, Dimension::none, Range::any);
  k.number({"tangential_ratio", "2/7; Mindlin's 3 (1 - poisson) / (2 - poisson)", "tangential stiffness over normal force per overlap"},
           p.tangential_ratio, Dimension::none, Range::not_negative);
  k.number({"tangential_damping", "", "factor on the tangential damping that follows from `restitution`"}, p.tangential_damping,
           Dimension::none, Range::not_negative);
  k.number({"rolling_friction", "", "the rolling moment is at most this number times R* times the normal force", kAlways},
           p.rolling_friction, Dimension::none, Range::not_negative);
  k.number({"torsional_friction", "", "the same for the moment about the normal"}, p.torsional_friction, Dimension::none,
           Range::not_negative);
  k.word(
      {"rolling_model", "", "a spring that yields (type C), or a constant moment (type A), which does not hold a body at rest on a slope"},
      p.rolling_model);
  k.number(
      {"layer_modulus",
       "needed with `gather = \"area\"`, instead of `stiffness`",
       "pressure is this times the overlap over the sum of both margins (one at a mesh wall): a flat contact of area A has the stiffness "
       "`layer_modulus A` over that sum",
       {},
       s.gather == Gathering::area},
      p.layer_modulus, Dimension::pressure, Range::positive);
  k.number({"contact_radius", "of the bodies",
            "R* of `hertz-mindlin`, of rolling and of `adhesion`: 1/R* = 1/R_a + 1/R_b of the spheres of equal volume, R_b infinite for a "
            "wall, and -R inside of a sphere_inside of radius R"},
           p.contact_radius, Dimension::length, Range::positive);
  k.number({"pull_off", "none", "attraction: the force that separates one contact; with `gather = \"potential\"` and any `law`"},
           p.pull_off, Dimension::force, Range::positive);
  k.number({"adhesion", "none",
            "or the work of adhesion w, from which that force follows, with R* of `contact_radius`; with `gather = \"area\"` the work of "
            "separation per area"},
           p.adhesion, Dimension::surface_energy, Range::positive);
  k.word({"adhesion_model", "required with `adhesion`, but for `area`",
          "the force is 3/2 pi w R* (`jkr`, soft large bodies) or 2 pi w R* (`dmt`, hard small ones)"},
         p.adhesion_model);
  k.number({"adhesion_range", "required with attraction, or `separation_energy`",
            "gap beyond touch over which the attraction grows to its full force; neighbour lists become wider by the range. The derived "
            "step crosses the range in two steps at `impact_speed`, or in four at the speed at which the lightest bodies stick, whichever "
            "step is longer"},
           p.adhesion_range, Dimension::length, Range::positive);
  k.number(
      {"separation_energy", "from `adhesion_range`", "work to separate a contact at rest, for any stiffness; the range follows from it"},
      p.separation_energy, Dimension::energy, Range::positive);
  k.boolean({"adhesion_hysteresis", "",
             "with `hertz-mindlin`, `jkr` and analytic spheres only, instead of a range: the JKR force, which begins at touch and ends "
             "where the neck ruptures, beyond touch"},
            p.adhesion_hysteresis);
  k.number(
      {"surface_tension", "none", "of a liquid bridge, which forms at touch and holds until it ruptures; with `gather = \"potential\"`"},
      p.surface_tension, Dimension::surface_tension, Range::positive);
  k.number({"contact_angle", "", "of the liquid, below 90 degrees"}, p.contact_angle, Dimension::angle, Range::not_negative);
  k.number({"bridge_volume", "required with `surface_tension`", "of each bridge"}, p.bridge_volume, Dimension::volume, Range::positive);
  k.word({"bridge_rupture", "",
          "the gap at which a bridge breaks: (1 + contact_angle / 2) (V^(1/3) + 0.1 V^(2/3) / R) (`willett`), or without the last term "
          "(`lian`); R = 2 R*"},
         p.bridge_rupture);
}

}  // namespace scree
