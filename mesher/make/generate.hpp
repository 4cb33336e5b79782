// Generated shapes: sphere, box and cylinder, meshed by gmsh on OpenCASCADE geometry.
#pragma once

#include <string>

#include "core/geometry/triangle_mesh.hpp"

namespace scree {

/// True when this build has gmsh. Without it only box_mesh and analytic spheres can be generated.
bool has_gmsh();
/// Version of its programming interface, "4.8.0"; "" in a build without gmsh.
std::string gmsh_version();

/// Triangulated ball about the origin, vertices on the sphere.
///
/// in   radius, edge_length   [m], > 0; the volume falls short of the ball's by about 0.3 (edge_length /
/// radius)^2 Fails: InputError with gmsh's own words; UsageError in a build without gmsh. Limits: gmsh keeps
/// global state, so one mesh at a time and one thread.
TriangleMesh generate_sphere(double radius, double edge_length);

/// Box about the origin, its faces meshed with the given edge length (box_mesh has 12 triangles).
TriangleMesh generate_box(const Vec3& size, double edge_length);

/// Cylinder about the origin along z. The side is made of plane strips from end to end (layers of strips when
/// `layers` > 1), so that the solid is convex; free meshing of the side would ripple it.
TriangleMesh generate_cylinder(double radius, double height, double edge_length, int layers);

}  // namespace scree
