// case.toml as a person wrote it, checked and in SI: its sections.
#pragma once

#include <algorithm>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/geometry/triangle_mesh.hpp"
#include "core/storage/body_orientation.hpp"
#include "core/storage/scene.hpp"
#include "core/storage/size_distribution.hpp"
#include "decomposer/case/wall_forms.hpp"

namespace scree {

/// [shapes.NAME]
struct CaseShape {
  std::string name, where;
  std::string file;          ///< path as it can be opened; empty for an analytic sphere
  std::string name_in_file;  ///< which of several shapes; empty when the file holds one
  double sphere_radius = 0;  ///< [m]
  double cell_size = 0;      ///< [m], 0: none
  std::string pieces;        ///< file of the pieces that its bodies start as; empty: as a whole
  std::int64_t cells = 0;    ///< in place of a file, how many cells it is cut into; 0: none
  std::int64_t cut_seed = 1;
  bool cut_evenly = true;
  bool falls_apart() const { return !pieces.empty() || cells > 0; }
};

/// [[bonds]]: what holds the pieces of bodies of one material, or bodies placed face to face.
struct CaseBond {
  std::string where;
  std::int32_t material = -1;                   ///< of bodies whose pieces it holds; -1: it holds bodies
  std::int32_t between_a = -1, between_b = -1;  ///< of the bodies that it holds
  double distance = 0;                          ///< [m] that faces may be apart
  double young = 0;                             ///< [Pa]
  double tangential_ratio = 0.25;               ///< [-] k_t / k_n
  double tension = kNeverBreaks;                ///< [Pa]
  double cohesion = kNeverBreaks;               ///< [Pa]
  double friction_angle = 0;                    ///< [rad]
  double fracture_energy = kNeverBreaks;        ///< [J/m^2]
  double weibull_modulus = 0;                   ///< [-] of the strengths; 0: all alike
  double damping = 0;                           ///< [-] share of critical damping
};

/// [[bodies]]
struct CaseBody {
  std::string where;
  std::int32_t shape = 0, material = 0;
  Vec3 position, velocity, angular_velocity;
  Quat orientation;
  double scale = 1;
  bool fixed = false, lock_rotation = false;
  Vec3 force;                               ///< [N] at all times, world
  double temperature = 0, heat_source = 0;  ///< [K], [W] of scenes with heat
  std::int32_t heat_table = -1;             ///< the same: index into Heat::source_tables
};

/// A part of space, such as where a population may lie: one of these.
struct CaseRegion {
  std::optional<Wall> shape;  ///< inside of a box, cylinder or sphere
  std::string file;           ///< closed mesh
  std::int32_t wall = -1;     ///< inside of one of the walls
};

enum class PackingMethod { random, lattice, settle, compact };
template <>
inline constexpr auto kWordsOf<PackingMethod> = std::to_array<Word<PackingMethod>>({{PackingMethod::random, "random"},
                                                                                    {PackingMethod::lattice, "lattice"},
                                                                                    {PackingMethod::settle, "settle"},
                                                                                    {PackingMethod::compact, "compact"}});

/// Bodies that are drawn, of a population or of an inlet.
struct CaseSource {
  std::string where;
  std::vector<std::pair<std::int32_t, double>> shares;  ///< shape and its share; shares sum to 1
  bool shares_by_mass = false;                          ///< else by number
  std::int32_t material = 0;
  std::optional<SizeDistribution> size;  ///< of the equivalent sphere; none: shapes as they are
  CaseRegion region;
  BodyOrientation orientation;
  Vec3 velocity, angular_velocity;
  double temperature = 0;  ///< [K] of scenes with heat
};

/// [[populations]]
struct CasePopulation : CaseSource {
  enum class Amount { count, mass, solid_fraction, fill };
  Amount amount = Amount::count;
  double value = 0;  ///< count [-], mass [kg] or solid fraction of the region [-]
  PackingMethod method = PackingMethod::random;
  double jitter = 0.5;           ///< lattice: share of the free room of a cell that is used
  double heat_source = 0;        ///< [W] of each body, of scenes with heat
  std::int32_t heat_table = -1;  ///< the same: index into Heat::source_tables
};

/// [[inlets]]: what it draws, and an Inlet without its region, shares and size.
struct CaseInlet : CaseSource {
  std::string name;
  Inlet inlet;
};

/// [[outlets]]
struct CaseOutlet {
  std::string where, name;
  CaseRegion region;
  std::int32_t to = -1;  ///< inlet through which bodies come in again
};

/// [[walls]]: a Wall without its id and shape index, and where its mesh comes from.
struct CaseWall {
  std::string where;
  Wall wall;
  std::string file;              ///< of a mesh wall, unless it is made from numbers
  std::optional<WallForm> form;  ///< of a mesh wall that is
};

struct CasePair {
  std::string where;
  MaterialPair pair;
  bool friction_given = false;
};

/// [start]
struct CaseStart {
  std::string where;
  std::string run;                                             ///< folder, as it can be opened
  std::int64_t checkpoint = -1, frame = -1;                    ///< step and number; both -1: the last checkpoint
  std::vector<std::pair<std::string, std::string>> materials;  ///< of the run, and what they are called here
  bool goes_on = false;                                        ///< this case goes on where the run ended
  std::optional<CaseRegion> leave_out;                         ///< whose bodies stay behind
};

/// What becomes of bodies of [[bodies]] that start too close to each other or to a wall.
enum class Relax {
  none,     ///< overlaps are refused, what is pressed starts as it is
  shallow,  ///< parted where that moves no body further than two margins, refused otherwise
  all       ///< parted, however far that is
};

struct Case {
  Case() { settings.surface = TouchAt::drawn; }
  std::string path;
  std::string text;    ///< word for word, or written again when keys were changed
  std::string sha256;  ///< of the file as it lies on the disk, whatever was changed on the command line
  Settings settings;
  bool margin_given = false, surface_given = false;
  std::optional<UsageError> no_wall_moves;  ///< what is wrong where none does
  Relax relax = Relax::shallow;
  std::optional<CaseStart> start;
  std::vector<CaseShape> shapes;
  std::vector<Material> materials;
  std::vector<CasePair> pairs;
  std::vector<CaseBody> bodies;
  std::vector<CasePopulation> populations;
  std::vector<CaseWall> walls;
  std::vector<CaseInlet> inlets;
  std::vector<CaseOutlet> outlets;
  std::vector<CaseBond> bonds;
};

/// Whether something may end the fall of a body: a wall, a fixed body, or what comes from a run.
inline bool has_support(const Case& c) {
  return c.start || !c.walls.empty() || std::any_of(c.bodies.begin(), c.bodies.end(), [](const CaseBody& b) { return b.fixed; });
}

}  // namespace scree
