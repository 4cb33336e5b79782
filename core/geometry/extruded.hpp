// Solids along z from a cross-section in the plane, straight or twisted.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "core/geometry/triangle_mesh.hpp"

namespace scree {

/// A cross-section in the plane, in triangles. Lengths in metres.
struct CrossSection {
  std::vector<std::array<double, 2>> points;
  std::vector<std::array<std::int32_t, 3>> triangles;  ///< counter-clockwise
  std::vector<std::vector<std::int32_t>> loops;        ///< borders, the solid to their left: the outer one counter-clockwise
};

/// The solid of this cross-section, from -height / 2 to height / 2, with flat ends. It turns by `turn` [rad] about z on its way up, in
/// `layers` equal steps; counter-clockwise seen from above where turn > 0. Points on a circle about the axis that lie a step apart come to
/// stand above each other: such a border becomes the faces of a prism.
TriangleMesh extruded(const CrossSection& section, double height, double turn = 0, int layers = 1);

}  // namespace scree
