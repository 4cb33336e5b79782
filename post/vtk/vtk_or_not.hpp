// What needs VTK, behind functions that every build has: a build without VTK says so instead.
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "post/run/frame_pool.hpp"
#include "post/run/run_folder.hpp"
#include "post/vtk/paraview.hpp"
#include "post/vtk/vtk_export.hpp"

namespace scree {

/// A plane; what lies on the side that `normal` points to is cut away.
struct Cut {
  Vec3 point, normal;
};

struct PictureOptions {
  int width = 1280, height = 960;  ///< [pixels]
  bool walls = true;
  bool time = false;                                 ///< written into the corner
  bool legend = true;                                ///< of kinds, where there are two or more, and of numbers
  bool network = false;                              ///< contact forces as tubes, bodies as ghosts
  std::string bonds{};                               ///< of bond_quantity_names: faces of bonds by it, bodies as ghosts
  double apart = 0;                                  ///< fragments moved from the middle of their parent by this share of their way
  std::string colour = "shape";                      ///< of bodies: one of body_colour_names
  std::string load{};                                ///< of load_names: walls by their load maps since the start, without bodies
  std::optional<std::pair<double, double>> range{};  ///< of the scale of numbers; else from 0, or the smallest, to the largest
  std::optional<Vec3> from{}, at{}, up{};            ///< direction to the camera, point it looks at [m], up; else chosen to show all
  std::string within{};                              ///< bodies that are seen, see Within::named; empty: the camera shows the equipment
  double zoom = 1;                                   ///< 2: twice as near
  std::optional<std::pair<int, double>> cut{};       ///< axis and place [m] of a plane: what lies before it is cut away
};

struct FilmOptions {
  PictureOptions picture;
  std::vector<std::size_t> frames;  ///< indices, ascending
  double rate = 25;                 ///< frames of the run in a second of film
  double turn = 0;                  ///< [degrees] that the camera goes about what it looks at in the whole film
  FramePool pool{};
};

/// "VTK 9.1.0" or "no VTK".
std::string vtk_version();
/// Throws UsageError with what to do when this build has no VTK.
void require_vtk();
/// Why no picture can be drawn (no VTK, no X display) and what to do, or "".
std::string picture_obstacle();
/// Returns what the picture does not show, for the user; empty: nothing.
std::string make_picture(const Run& run, std::size_t frame_index, const std::string& path, const PictureOptions& options);
/// Returns what to tell the user: how long the film is.
std::string make_film(const Run& run, const std::string& path, const FilmOptions& options, std::vector<std::string>& skipped);
/// Returns what to tell the user: what was written and how to open it.
std::string make_paraview_files(const Run& run, const ParaviewOptions& options, std::vector<std::string>& skipped);
std::string make_vtk_files(const Run& run, const VtkOptions& options, std::vector<std::string>& skipped);

}  // namespace scree
