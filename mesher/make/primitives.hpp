// Shapes from closed formulas: no meshing library, the same triangles on every machine.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "core/geometry/triangle_mesh.hpp"

namespace scree {

/// Unit icosphere, vertices on the sphere: 20 * 4^level triangles.
TriangleMesh icosphere(int level);

/// Platonic solid of edge 1 about the origin: tetrahedron, cube, octahedron, dodecahedron or icosahedron.
TriangleMesh platonic_solid(const std::string& name);

/// Ellipsoid of these semi-axes [m]: an icosphere, stretched.
TriangleMesh ellipsoid(const Vec3& semi_axes, int level);

/// Superellipsoid |x/a|^(2/e) + |y/b|^(2/e))^(e/n) + |z/c|^(2/n) = 1, e and n in (0, 2]: 1 is an ellipsoid, towards 0 a box.
/// Source: A. Barr, Superquadrics and angle-preserving transformations, IEEE CG&A 1 (1981) 11.
TriangleMesh superellipsoid(const Vec3& semi_axes, double e, double n, int level);

/// Torus about z: ring radius, tube radius [m]; n steps around, m around the tube.
TriangleMesh torus(double ring, double tube, int n, int m);

/// Solid of revolution about z. profile: (r, z) from below to above, r = 0 at both ends or cut flat there.
TriangleMesh revolved(const std::vector<std::array<double, 2>>& profile, int sectors);

/// Cylinder of `height` between two hemispheres, along z.
TriangleMesh capsule(double radius, double height, int sectors);

/// Cone along z from radius `lower` to radius `upper` (0: a tip), its centre of height at the origin.
TriangleMesh cone(double lower, double upper, double height, int sectors);

/// Tablet along z: a band of `height` between two equal caps of depth `cup`. Without a bevel the caps are parts of a sphere (biconvex:
/// volume pi radius^2 height + pi cup (3 radius^2 + cup^2) / 3); with one, `bevel` wide, they are flat with a bevelled edge (volume of two
/// frustums). Needs cup <= radius and bevel < radius. `rings` of the round part of a cap.
TriangleMesh tablet(double radius, double height, double cup, double bevel, int sectors, int rings);

/// A round rod along a path of points, closed by flat ends: hooks, staples, U. Neighbouring pieces must not turn by more
/// than a right angle, and bends must be wider than the rod.
TriangleMesh rod(const std::vector<Vec3>& path, double radius, int sectors);

/// Path of a U: two legs of `leg` a distance `width` apart, joined by an arc; of a hook: a U with one leg twice as long.
std::vector<Vec3> u_path(double width, double left_leg, double right_leg, int steps);

}  // namespace scree
