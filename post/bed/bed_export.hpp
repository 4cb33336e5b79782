// A packed bed as files for programs of fluid flow, heat and reaction: surface, void fractions, contacts.
#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "post/run/region.hpp"
#include "post/run/run_folder.hpp"

namespace scree {

struct BedOptions {
  std::string folder;
  std::int64_t frame = -1;          ///< number as in the name of the file, -1 the last
  bool parted = true;               ///< caps are cut off where bodies touch; else bodies are written as they are
  double gap = 0.01;                ///< between surfaces, over the diameter of the smaller body (PartingOptions)
  int ball_level = 3;               ///< of an analytic ball: 20 * 4^level triangles
  double cell = 0;                  ///< [m] edge of the cells of the void fraction; 0: a tenth of the mean diameter
  int rings = 0;                    ///< of the radial void fraction; 0: a twentieth of the mean diameter wide
  std::optional<Region> container;  ///< default: the wall or the periodic sides
  std::string within;               ///< see Within::named
};

struct BedResult {
  std::vector<std::string> files;  ///< names in the folder
  std::vector<std::string> notes;  ///< what the user must know, one line each
  std::string summary;             ///< lines for a terminal
  nlohmann::json numbers;          ///< as in bed.json
};

/// Writes bed.stl (the particles), walls.stl (walls and fixed bodies), void_fraction.vti, radial_void_fraction.csv (in a cylinder),
/// contacts.csv and bodies.csv (of a run that kept contacts), bed.json.
/// Fails: UsageError (no particle in the frame; a grid of more than 10^8 cells), InputError (a damaged frame), SystemError.
/// Cost: see part_bodies and SolidGrid; one frame and its triangles in memory.
BedResult export_bed(const Run& run, const BedOptions& options);

}  // namespace scree
