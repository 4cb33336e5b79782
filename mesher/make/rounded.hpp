// Solids whose edges and corners are rounded.
#pragma once

#include "core/geometry/triangle_mesh.hpp"

namespace scree {

/// A box or Platonic solid, closed and with its centre at the origin, whose edges and corners are rounded with `radius` [m]: the sum of a
/// smaller solid and a ball, which lies within the sharp one and shares the middles of its faces. Arcs are cut into steps of at most
/// `edge_length` [m], with vertices on the rounding, so that the volume is below that of Steiner's formula by an error of second order.
/// Throws UsageError where the radius is not below that of the largest ball inside.
/// Source: J. Steiner, Monatsberichte der Berliner Akademie (1840) 114.
TriangleMesh rounded(const TriangleMesh& solid, double radius, double edge_length);

}  // namespace scree
