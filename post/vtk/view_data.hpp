// What the 3D view of report.html draws, as JSON with base64 arrays: small enough to stand in the page.
#pragma once

#include <optional>
#include <string>

#include "core/base/json_record.hpp"
#include "post/run/within.hpp"

namespace scree {

/// What a view of several frames has to hold. Of one frame: nothing is given.
struct ViewExtent {
  std::optional<Box3> room{};  ///< that the camera shows, and that walls without an end are drawn for; else of the bodies within
  std::size_t most = 0;        ///< bodies at one time
};

/// One frame for the view, the camera on the bodies that are within: meshes of the shapes, places of all bodies, walls, the strongest
/// contacts.
///
/// How: positions are float32 relative to the middle, so that a scene far from the origin keeps its digits. Shapes are drawn
/// coarser (vertices merged on a grid) when all bodies together have more than two million triangles.
/// Size: 46 bytes a body and 28 a contact line, times 4/3; 10^5 bodies make 6 MB.
JsonRecord view_data(const Run& run, const Frame& frame, const Within& within, const ViewExtent& extent = {});

/// Bytes as base64.
std::string base64(const std::string& bytes);

}  // namespace scree
