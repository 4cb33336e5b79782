// Load maps of walls as densities: what each triangle of a wall bore between two frames, per area and time.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "post/run/run_folder.hpp"

namespace scree {

struct LoadQuantity {
  const char *name, *unit, *title;
};

/// In the order of WallLoads::values. Names are those of cell data for ParaView and of columns.
inline constexpr std::array<LoadQuantity, 7> kLoadQuantities{{
    {"pressure", "Pa", "mean pressure [Pa]"},                     // of the mean force along the triangle's normal
    {"shear", "Pa", "mean shear [Pa]"},                           // of the mean force across it: what goes to and fro cancels
    {"sliding_power", "W/m^2", "sliding work [W/m^2]"},           // of friction on what slid
    {"damping_power", "W/m^2", "lost by damping [W/m^2]"},        // of damping
    {"contact_rate", "1/(m^2 s)", "contacts begun [1/(m^2 s)]"},  // of bodies with the wall
    {"impact_power", "W/m^2", "energy of impacts [W/m^2]"},       // of these contacts as they began
    {"wear_depth", "m", "depth worn off [m]"},                    // along the normal of the triangle as it was; at the later frame
}};

/// Of a wall that has a load map.
struct WallLoads {
  std::size_t wall;          ///< index in the scene
  double time;               ///< that the means are over [s]; 0: they are 0
  Vec3 impulse;              ///< on the whole wall in that time, axes of its mesh [N s]
  std::vector<double> area;  ///< of each triangle [m^2]
  std::vector<Vec3> middle;  ///< of each, frame of the wall [m]
  std::vector<Vec3> push;    ///< impulse on each, axes of the mesh [N s]
  std::array<std::vector<double>, kLoadQuantities.size()> values;
  double total(std::size_t quantity) const;  ///< integral over the area
};

/// in   from, to   frames of one run; a frame without loads (Frame{}) stands for the start of the run
/// Empty where no wall of the scene has a load map. Fails: InputError where a frame's loads are not those of the scene's walls.
std::vector<WallLoads> wall_loads(const Scene& scene, const Frame& from, const Frame& to);

/// A quantity of every triangle of all walls as they are drawn, wall after wall; 0 on walls without a load map.
/// in   triangles   of each wall as drawn
std::vector<double> on_drawn_walls(const std::vector<WallLoads>& loads, std::size_t quantity, const std::vector<std::size_t>& triangles);

/// The value that 99 % of the area that bears anything stays below: the end of a scale of colours that one triangle does not set.
double end_of_scale(const std::vector<WallLoads>& loads, std::size_t quantity);

/// Index of a name in kLoadQuantities, and all names.
std::size_t load_quantity(const std::string& name);
std::vector<std::string> load_names();

bool has_load_maps(const Scene& scene);
bool has_wear(const Scene& scene);
/// Of a wall, since the start [m^3].
double volume_worn(const Wall& wall, const Frame& frame);

/// Tables of a folder of statistics: what each wall bore from frame to frame, and each triangle over all of these frames. Empty without
/// load maps. in   frames   indices, ascending
struct LoadTable {
  std::string name, text;
};
std::vector<LoadTable> load_tables(const Run& run, const std::vector<std::size_t>& frames);

}  // namespace scree
