// A scene: all that the solver needs of a case. How it lies in a file: scene_file.hpp.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "core/base/json_record.hpp"
#include "core/geometry/periodic.hpp"
#include "core/geometry/upper_matrix.hpp"
#include "core/storage/body_orientation.hpp"
#include "core/storage/bond.hpp"
#include "core/storage/feed_rate.hpp"
#include "core/storage/scene_words.hpp"
#include "core/storage/shape_file.hpp"
#include "core/storage/size_distribution.hpp"
#include "core/storage/time_table.hpp"
#include "core/storage/wall_motion.hpp"
#include "core/storage/wall_surface.hpp"

namespace scree {

inline constexpr const char* kSceneFormat = "scree-scene";
inline constexpr std::int64_t kSceneFormatVersion = 1;

struct Material {
  std::string name;
  double density = 0;  ///< [kg/m^3], > 0
  double young = 0;    ///< [Pa], 0 when not given
  double poisson = 0;  ///< [-]
  // of scenes with heat
  double heat_capacity = 0;  ///< [J/(kg K)]; 0: not given, of walls alone
  double conductivity = 0;   ///< [W/(m K)]; 0: not given, of walls alone
  double real_young = 0;     ///< [Pa] of the real material: what contacts conduct through follows from it; 0 when not given
  /// Whether it has what the bodies of a scene with heat need.
  bool has_heat() const { return heat_capacity > 0 && conductivity > 0; }
};

/// How two materials meet. Only pairs that can occur are present.
struct MaterialPair {
  std::int32_t a = 0, b = 0;      ///< material indices, a <= b
  double stiffness = 0;           ///< [N/m]; 0: by size, from `modulus`, or the law has none
  double restitution = 1;         ///< [-], from 0 to 1
  double friction = 0;            ///< [-] static
  double friction_sliding = -1;   ///< [-], < 0: as static
  double rolling_friction = 0;    ///< [-] rolling moment at most this times R* times the normal force
  double torsional_friction = 0;  ///< [-] the same for the moment about the normal
  RollingModel rolling_model = RollingModel::elastic_plastic;
  double tangential_ratio = -1;   ///< [-] tangential over normal stiffness, < 0: that of the law
  double tangential_damping = 1;  ///< [-] factor on the tangential damping that goes with restitution
  double restitution_speed = 0;   ///< [m/s] approach speed at which restitution holds (hunt-crossley), 0 when not given
  double layer_modulus = 0;       ///< [Pa] of the elastic layer that the margins are (gather = "area")
  double contact_radius = 0;      ///< [m] R* of the contact (hertz-mindlin, rolling), 0: from the bodies' equivalent spheres
  double pull_off = 0;            ///< [N] what parts a contact (attraction.hpp); 0: `adhesion` says it, or there is no attraction
  double adhesion = 0;            ///< [J/m^2] work of adhesion w
  AdhesionModel adhesion_model = AdhesionModel::jkr;
  double adhesion_range = 0;         ///< [m] over which the attraction acts; 0: from separation_energy
  double separation_energy = 0;      ///< [J] that parts a contact at rest; 0: from adhesion_range
  bool adhesion_hysteresis = false;  ///< JKR's own force: from touch until the neck tears (jkr.hpp)
  double surface_tension = 0;        ///< [N/m] of a liquid bridge; 0: none
  double contact_angle = 0;          ///< [rad] of the liquid on both surfaces
  double bridge_volume = 0;          ///< [m^3]
  BridgeRupture bridge_rupture = BridgeRupture::willett;
  double modulus = 0;              ///< [Pa] see spring()
  double plasticity = 0;           ///< [-] 1 - k1 / k2 of a contact that yields, from 0 to below 1; 0: contacts are elastic
  double adhesive_ratio = 0;       ///< [-] k_adh / k1 of a contact that has yielded
  double contact_conductance = 0;  ///< [W/(m^2 K)] of what lies between both surfaces, of scenes with heat; 0: nothing does

  /// Of a contact with the radius R* [N/m]. By size it is modulus times 2 R_a R_b / (R_a + R_b), R_b infinite for a wall: overlaps over
  /// radii are then the same for all sizes at one speed, and a step goes with the radius.   Source: convention of Yade and PFC.
  double spring(double radius) const { return stiffness + 2 * modulus * radius; }
};

/// E* [Pa] of two materials: 1/E* = sum of (1 - poisson^2) / young.
double effective_modulus(const Material& a, const Material& b);
/// G* [Pa] of two materials: 1/G* = sum of 2 (2 - poisson) (1 + poisson) / young.
double effective_shear_modulus(const Material& a, const Material& b);
/// Greatest overlap [m] of an elastic Hertz impact: (15 m v^2 / (16 E* sqrt(R*)))^(2/5).
double hertz_impact_overlap(double modulus, double radius, double mass, double speed);

/// One row of a BodyTable: a body that moves, placed by itself and at rest, unless said otherwise.
struct BodyRow {
  std::int64_t id = 0;
  std::int32_t shape = 0, material = 0;
  double scale = 1;
  Vec3 position;
  Quat orientation;
  Vec3 velocity, angular_velocity;
  bool fixed = false, lock_rotation = false;
  std::int32_t population = -1;
  double temperature = 0;  ///< [K], of scenes with heat
  double heat_source = 0;  ///< [W], the same
  std::int32_t heat_table = -1;
};

/// Bodies, one row each. Orientation and position are those of the mesh as the user knows it.
struct BodyTable {
  std::vector<std::int64_t> id;               ///< global, never reused
  std::vector<std::int32_t> shape, material;  ///< indices into shapes and materials
  std::vector<double> scale;                  ///< of the shape, > 0
  std::vector<Vec3> position;                 ///< centre of mass, world [m]
  std::vector<Quat> orientation;              ///< unit, w x y z, mesh axes to world
  std::vector<Vec3> velocity;                 ///< [m/s], world
  std::vector<Vec3> angular_velocity;         ///< [rad/s], world
  std::vector<std::uint8_t> fixed;            ///< 1: does not move
  std::vector<std::uint8_t> lock_rotation;    ///< 1: translates only
  std::vector<std::int32_t> population;       ///< index of its [[populations]] entry, -1 for [[bodies]]
  std::vector<std::int32_t> owner;            ///< rank of the pre-partition; empty when not partitioned
  // of scenes with heat; may be empty in others
  std::vector<double> temperature;       ///< [K]
  std::vector<double> heat_source;       ///< power given to the body at all times [W]
  std::vector<std::int32_t> heat_table;  ///< index into Heat::source_tables, whose power is given as well; -1: none

  std::size_t size() const { return id.size(); }
  /// Appends a row; the table must have no owners.
  void add(const BodyRow& row);
  /// Row i, without its owner.
  BodyRow row(std::size_t i) const;
};

/// What a wall is to the heat of the bodies that touch it.
struct WallHeat {
  WallHeatKind kind = WallHeatKind::adiabatic;
  TimeTable temperature = TimeTable::constant(0);  ///< isothermal: of the wall; exchange: outside [K]
  TimeTable flux = TimeTable::constant(0);         ///< flux: given to the bodies that touch, all together [W]; below 0: taken
  double coefficient = 0;                          ///< exchange: from outside to the contact, for each area of contact [W/(m^2 K)]
  bool has_temperature() const { return kind == WallHeatKind::isothermal || kind == WallHeatKind::exchange; }
};

/// A wall: fixed or driven, with the same contact law as a body.
struct Wall {
  std::int64_t id = 0;
  std::string name;
  WallKind kind = WallKind::plane;
  std::int32_t material = 0;
  Vec3 point, normal{0, 0, 1};  ///< plane: a point and the unit normal towards the particles
  Vec3 lower, upper;            ///< box_inside: opposite corners [m]
  Vec3 axis_start, axis_end;    ///< cylinder_inside: ends of the axis (closed by plane lids there) [m]
  double radius = 0;            ///< cylinder_inside, sphere_inside (centre is `point`) [m]
  std::int32_t shape = -1;      ///< mesh: index into shapes
  double scale = 1;             ///< mesh
  double cell_size = 0;         ///< mesh: contacts of one body further apart than this do not share stiffness [m]; 0: one potential
  Vec3 position;                ///< mesh: where the origin of its file is placed [m]
  Quat orientation;             ///< mesh
  WallMotion motion;
  WallSurface surface;
  bool load_map = false;  ///< mesh: what bodies do to each triangle is summed up and written to frames
  double wear = 0;        ///< mesh with a load map: volume worn off per sliding work [m^3/J]; 0: none
  double wear_every = 0;  ///< [s] of the run after which its vertices recede, again and again
  WallHeat heat;          ///< of scenes with heat
};

/// Why no body sleeps that touches the wall (time.sleep), whether it moves or not; null: no reason.
inline const char* sleep_blocker(const Wall& wall) {
  return wall.load_map ? "has a load map" : wall.motion.drive() ? "answers to force" : nullptr;
}

/// Why a wall cannot be in a scene whose bodies stay as they are (heat.frozen); null: no reason.
inline const char* frozen_blocker(const Wall& wall) {
  return wall.motion.drive()                           ? "answers to force"
         : wall.motion.moves() || wall.surface.moves() ? "moves"
         : wall.load_map                               ? "has a load map"
                                                       : nullptr;
}

/// A part of space: what a wall of that kind would hold (box_inside, cylinder_inside, sphere_inside), or the inside of a closed mesh. Only
/// what gives the wall its place is used; it does not move.
using RegionShape = Wall;

/// Takes bodies out of the run: those whose centres are in its region.
struct Outlet {
  std::string name;
  RegionShape region;
  std::int32_t to = -1;  ///< index of the inlet through which they come in again; -1: none
};

/// Lets bodies into the run, at the places in its region where they find room (solver/step/inlets.hpp).
struct Inlet {
  struct Share {
    std::int32_t shape = 0;
    double share = 1;  ///< of the number of bodies
  };
  std::string name;
  RegionShape region;         ///< holds each body wholly as it comes in
  std::vector<Share> shares;  ///< sum to 1
  std::int32_t material = 0;
  std::optional<SizeDistribution> size;  ///< diameter of the sphere of equal volume; none: shapes as they are
  BodyOrientation orientation;
  Vec3 velocity, angular_velocity;  ///< with which they come in [m/s], [rad/s]
  double temperature = 0;           ///< the same [K]; of scenes with heat
  FeedRate rate;
  double start = 0, stop = 1e300;  ///< [s]
  double limit = 1e300;            ///< of the mass [kg]
  std::int64_t count = -1;         ///< of the bodies; -1: no limit
  WhenFull when_full = WhenFull::wait;

  /// What it should have let in by a time: [kg], or a number of bodies; the limits included.
  double owed(double time) const;
};

/// Scale at which a shape has a diameter of a distribution; 1 where there is none, and shapes are as they are.
inline double scale_of(const std::optional<SizeDistribution>& size, const Shape& shape, double diameter) {
  return size ? diameter / shape.equivalent_diameter() : 1;
}

/// The scales between which those of a shape lie.
struct ScaleRange {
  double smallest, largest;
};
inline ScaleRange scales_of(const std::optional<SizeDistribution>& size, const Shape& shape) {
  return {scale_of(size, shape, size ? size->min : 0), scale_of(size, shape, size ? size->max : 0)};
}

struct Domain {
  bool bounded = false;
  Vec3 lower, upper;  ///< [m], when bounded
  std::array<bool, 3> periodic{false, false, false};
  Vec3 shear;  ///< h_yz, h_xz, h_xy of a cell that a run left sheared [m] (geometry/periodic.hpp)
  Outside outside = Outside::stop;
};

inline Periodicity periodicity_of(const Domain& d) {
  const Periodicity box(d.lower, d.upper, d.periodic);
  return d.shear == Vec3{} ? box : Periodicity::at_corner(d.lower, box.period(), d.shear);
}

/// A fluid around all bodies; it moves as given, whatever the bodies do.
struct Fluid {
  double density = 0;    ///< [kg/m^3], > 0
  double viscosity = 0;  ///< dynamic [Pa s], > 0
  Vec3 velocity;         ///< [m/s], the same everywhere
  Drag drag = Drag::haider_levenspiel;
};

/// Biot number up to which one temperature stands for a body: errors of the flow are about this share.
inline constexpr double kLargestBiot = 0.1;

/// The gas in gaps conducts less than a solid by at least this factor: a body that conducts less has no one temperature (with twelve
/// contacts its Biot number is above 0.1 from 20 down), and the formula of the gap ends at 7 (effects/heat/conductance.hpp).
inline constexpr double kSolidOverGas = 10;

/// Bodies have temperatures, and contacts conduct.
struct Heat {
  double temperature = 0;                  ///< [K] of bodies that are not given theirs; 0: all are
  bool friction_heat = false;              ///< what contacts dissipate heats their bodies
  bool frozen = false;                     ///< bodies and contacts stay as they are; conduction alone sets the step
  double gas_conductivity = 0;             ///< of the gas in gaps [W/(m K)]; 0: gaps do not conduct
  double gas_range = 0;                    ///< widest gap that conducts [m]
  std::vector<TimeTable> source_tables{};  ///< power of each body that has one of them [W]
  bool has_gas() const { return gas_conductivity > 0; }
};

/// How a periodic cell deforms, by its components (geometry/upper_matrix.hpp): at a given rate, or so that it has a given stress.
/// Compression is positive, and of a shear what such a stress goes with: -L. A component that has neither stays.
struct CellControl {
  std::array<TimeTable, 6> strain_rate{};  ///< -L [1/s] over the time of the run; no rows: none is asked for
  UpperMatrix stress;                      ///< [Pa], where one is asked for
  std::array<bool, 6> is_stress_asked{};
  double stop_strain = 0;         ///< of any component that ends the run; 0: none
  double stop_stress_error = 0;   ///< the same with stop_kinetic_ratio: of all with a stress, over the largest of them
  double stop_kinetic_ratio = 0;  ///< kinetic energy of bodies that touch, over that of contacts
  bool by_stress(int component) const { return is_stress_asked[static_cast<std::size_t>(component)]; }
  bool any_by_stress() const { return std::find(is_stress_asked.begin(), is_stress_asked.end(), true) != is_stress_asked.end(); }
  const TimeTable& rate(int component) const { return strain_rate[static_cast<std::size_t>(component)]; }
  bool by_rate(int component) const { return rate(component).least() != 0 || rate(component).largest() != 0; }
  bool changes(int component) const { return by_stress(component) || by_rate(component); }
  bool shears() const { return changes(3) || changes(4) || changes(5); }
};

/// Settings, as the case file gives them; SI.
struct Settings {
  std::string title;
  std::uint64_t seed = 0;
  Vec3 gravity;         ///< [m/s^2]
  double duration = 0;  ///< [s]
  double steps_per_contact = 30;
  double step = 0;  ///< [s], 0: derived
  StepControl step_control = StepControl::fixed;
  bool stop_at_rest = false;      ///< end at the first output time at which all bodies rest
  bool stop_when_empty = false;   ///< end at the first output time at which no body is left that is free to move
  bool sleep = false;             ///< bodies at rest are not computed until something disturbs them
  double sleep_tolerance = 1e-3;  ///< [-] of its weight: a change of force that a body at rest does not answer to
  Domain domain;
  std::optional<Fluid> fluid;       ///< none: bodies move in a void
  std::optional<Heat> heat;         ///< none: bodies have no temperature
  std::optional<CellControl> cell;  ///< none: the domain stays as it is
  ContactLaw law = ContactLaw::linear;
  Gathering gather = Gathering::potential;
  VertexWeights weights = VertexWeights::density;
  double barrier = 0;  ///< [-] stiffness of the barrier over that of a contact; 0: none
  OnOverlap on_overlap = OnOverlap::stop;
  double impact_speed = 0;  ///< [m/s] of the fastest impact expected; 0 when not known
  TouchAt surface = TouchAt::outside;
  double margin = 0;        ///< [m] surface = outside: of each body; 0 means contact at touch, allowed for analytic pairs only
  double margin_ratio = 0;  ///< [-] surface = drawn: margin of a mesh over the radius of the ball of its volume
  Integrator integrator = Integrator::kdk_dlm;
  double output_every = 0;  ///< [s]
  bool output_contacts = true;
  bool output_impacts = false;      ///< record impacts and what contacts dissipate, by pair of materials
  double checkpoint_every = 0;      ///< [s], 0: by the clock, or only at the end
  bool checkpoint_by_clock = true;  ///< of the machine, when checkpoint_every is 0

  double frame_interval() const { return output_every > 0 ? output_every : duration / 100; }  ///< [s]
};

/// What of the settings asks for bodies that move, and cannot be combined with heat.frozen: its key; null: nothing.
inline const char* frozen_blocker(const Settings& s) {
  return s.heat && s.heat->friction_heat            ? "heat.friction_heat"
         : s.sleep                                  ? "time.sleep"
         : s.stop_at_rest                           ? "time.stop_at_rest"
         : s.stop_when_empty                        ? "time.stop_when_empty"
         : s.step_control == StepControl::quantised ? "time.step_control"
         : s.output_impacts                         ? "output.impacts"
         : s.fluid                                  ? "a table [fluid]"
                                                    : nullptr;
}

struct Scene;
/// What a cell that deforms does not go with: its key, and why; null: nothing.
struct CellBlocker {
  const char* key = nullptr;
  const char* why = "";
};
CellBlocker cell_blocker(const Settings& s);
/// Of a wall; null: it is one of the two planes that a cell which is not periodic along z lies between.
const char* cell_blocker(const Domain& cell, const Wall& wall);
/// Of all that a scene has.
CellBlocker cell_blocker(const Scene& scene);

/// The pre-partition. Owners are with the bodies; a recursive coordinate bisection has one leaf box per rank too.
struct Partition {
  std::int32_t ranks = 0;          ///< 0: not partitioned
  std::string method = "rcb";      ///< see CutMethod
  std::vector<Vec3> lower, upper;  ///< ranks x 3 [m], rcb only; outer sides are +-1e300
  double predicted_imbalance = 1;  ///< largest over mean predicted work
};

/// A force that acts on a body at all times, at its centre and in a fixed direction.
struct BodyForce {
  std::int64_t id = 0;
  Vec3 force;  ///< [N], world
};

struct Scene {
  Settings settings;
  std::vector<Shape> shapes;
  std::vector<Material> materials;
  std::vector<MaterialPair> pairs;
  std::vector<Wall> walls;
  std::vector<Inlet> inlets;
  std::vector<Outlet> outlets;
  BodyTable bodies;
  std::vector<BodyForce> forces;  ///< by id; of few bodies, mostly of none
  std::vector<Bond> bonds;
  Partition partition;
  JsonRecord provenance;

  /// Properties of a material pair in either order; throws InputError when it is missing.
  const MaterialPair& pair(std::int32_t a, std::int32_t b) const;
  /// Whether balls, whose contacts with each other and with analytic walls have the radius for a maximum overlap, are in a scene with
  /// meshes, whose contacts have their margins.
  bool balls_touch_beside_meshes() const;
  /// Mass of a body [kg]: density times scaled volume.
  double mass(std::size_t body) const;
  /// The same of a body of one of the scene's shapes and materials, before it is one of the scene's bodies.
  double mass(std::int32_t shape, std::int32_t material, double scale) const;
};

}  // namespace scree
