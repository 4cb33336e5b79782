// Every quantity of a frame, once. Structures, writer, reader, sorting, selection of bodies, verify, CSV tables and ParaView files go over
// these tables, and so does the solver when it fills them (solver/run/make_frame.cpp).
//
// A new quantity of a body that a column of solver/bodies/body_columns.hpp holds is one line here; any other is one line here and one where
// it is computed: make_frame.cpp for bodies and walls, append_contacts() in the solver for contacts. RUN_FORMAT.md lists it.
//
//   stored(type, name, member, path, unit, csv, uses, what it is)     a copy of a column `member` of the solver's bodies
//   computed(type, name, path, unit, csv, uses, what it is)
//
// path   in the file; old files keep their names
// csv    columns of its components in the tables of scree-post, "": it is not in them
// uses   see FrameUse below
#pragma once

namespace scree {

/// What besides frame files has a column.
enum FrameUse : unsigned {
  kFileOnly = 0,
  kInParaView = 1,   ///< files of bodies and of contacts for ParaView
  kOnSurfaces = 2,   ///< every triangle of a body, in ParaView files of surfaces
  kOfThisRun = 4,    ///< of how a run was shared out: verify does not compare it
  kAddedLater = 16,  ///< older files do not have it: zeros
  kOfHeat = 8,       ///< of scenes with heat: files of others do not have it (FrameBodies::has)
};

}  // namespace scree

// clang-format off
/// In the order of the CSV tables.
#define SCREE_FRAME_BODIES(stored, computed) \
  stored(std::int64_t, id, id, "VTKHDF/PointData/id", "", "id", kInParaView | kOnSurfaces, "global, unique") \
  stored(std::int32_t, shape, shape, "VTKHDF/PointData/shape", "", "", kInParaView | kOnSurfaces, "index into the scene's shapes") \
  stored(std::int32_t, material, material, "VTKHDF/PointData/material", "", "", kInParaView | kOnSurfaces, "index into its materials") \
  computed(std::int32_t, rank, "VTKHDF/PointData/rank", "", "", kInParaView | kOnSurfaces | kOfThisRun, "owner") \
  stored(double, scale, scale, "VTKHDF/PointData/scale", "", "", kInParaView, "of the shape") \
  computed(Vec3, position, "VTKHDF/Points", "m", "x,y,z", kFileOnly, "centre of mass, world") \
  stored(Vec3, velocity, v, "VTKHDF/PointData/velocity", "m/s", "vx,vy,vz", kInParaView | kOnSurfaces, "world") \
  computed(Quat, orientation, "VTKHDF/PointData/quat", "", "qw,qx,qy,qz", kInParaView, "mesh axes to world, w x y z") \
  stored(Vec3, angular_velocity, w, "VTKHDF/PointData/angular_velocity", "rad/s", "wx,wy,wz", kInParaView, "world") \
  stored(double, temperature, temperature, "VTKHDF/PointData/temperature", "K", "temperature", kInParaView | kOnSurfaces | kOfHeat, \
         "of the whole body; of scenes with heat")

/// a < b, normal from b to a, force on a: column(type, name, path, unit, csv, uses, what it is)
#define SCREE_FRAME_CONTACTS(column) \
  column(std::int64_t, body_a, "contacts/body_a", "", "body_a", kInParaView, "id") \
  column(std::int64_t, body_b, "contacts/body_b", "", "body_b", kInParaView, "id; a wall has one too") \
  column(std::int64_t, feature, "contacts/feature", "", "feature", kFileOnly, "key, unique within the body pair") \
  column(Vec3, point, "contacts/point", "m", "x,y,z", kFileOnly, "world") \
  column(Vec3, normal, "contacts/normal", "", "nx,ny,nz", kInParaView, "unit") \
  column(double, overlap, "contacts/depth", "m", "depth", kInParaView, "margin sum minus gap") \
  column(double, margin, "contacts/margin", "m", "", kFileOnly, "margin sum") \
  column(double, normal_force, "contacts/normal_force", "N", "fn", kInParaView, "on a along the normal") \
  column(Vec3, tangential_force, "contacts/tangential_force", "N", "ftx,fty,ftz", kInParaView, "on a")

/// Bonds that hold, of scenes that have some: column(type, name, path, unit, csv, uses, what it is)
#define SCREE_FRAME_BONDS(column) \
  column(std::int64_t, bond, "bonds/bond", "", "bond", kInParaView, "row of the scene's bonds") \
  column(Vec3, force, "bonds/force", "N", "fx,fy,fz", kInParaView, "on a") \
  column(double, energy, "bonds/energy", "J", "energy", kInParaView, "") \
  column(double, load, "bonds/load", "", "load", kInParaView, "share of what it holds; breaks at 1")

/// column(type, name, path, unit, csv, uses, what it is)
#define SCREE_FRAME_WALLS(column) \
  column(std::int64_t, id, "walls/id", "", "", kFileOnly, "as in the scene") \
  column(Vec3, position, "walls/position", "m", "", kFileOnly, "displacement of the wall's frame") \
  column(Quat, orientation, "walls/orientation", "", "", kFileOnly, "of the wall's frame") \
  column(Vec3, force, "walls/force", "N", "", kFileOnly, "on the wall") \
  column(Vec3, torque, "walls/torque", "N m", "", kFileOnly, "on the wall, about the world origin")

/// Of each triangle of the walls that have a load map, in the order of the walls and of their meshes; sums since the start of the run, so
/// that what happened between two frames is their difference: column(type, name, path, unit, csv, uses, what it is)
#define SCREE_FRAME_LOADS(column) \
  column(std::int64_t, wall, "loads/wall", "", "wall", kFileOnly, "id") \
  column(std::int32_t, triangle, "loads/triangle", "", "triangle", kFileOnly, "number in the mesh of the wall") \
  column(Vec3, impulse, "loads/impulse", "N s", "impulse_x,impulse_y,impulse_z", kFileOnly, "on it, axes of the wall's mesh") \
  column(double, sliding_work, "loads/sliding_work", "J", "sliding_work", kFileOnly, "of friction on what slid over it") \
  column(double, damping_work, "loads/damping_work", "J", "damping_work", kFileOnly, "lost along the normal") \
  column(double, contacts, "loads/contacts", "", "contacts", kFileOnly, "of bodies with the wall that began there") \
  column(double, impact_energy, "loads/impact_energy", "J", "impact_energy", kFileOnly, "of such contacts as they began")

/// Vertices of the walls that wear, as they are, in the order of the walls and of their meshes: column(type, name, path, unit, csv, uses,
/// what it is)
#define SCREE_FRAME_WEAR(column) \
  column(std::int64_t, wall, "wear/wall", "", "", kFileOnly, "id") \
  column(Vec3, vertex, "wear/vertex", "m", "", kFileOnly, "axes and scale of the wall's mesh")

/// The periodic cell of a scene with [cell], one row: column(type, name, path, unit, csv, uses, what it is)
#define SCREE_FRAME_CELL(column) \
  column(Vec3, lower, "cell/lower", "m", "", kFileOnly, "its corner") \
  column(Vec3, upper, "cell/upper", "m", "", kFileOnly, "the opposite corner") \
  column(Vec3, rate, "cell/rate", "1/s", "", kFileOnly, "(dh/dt) / h of each length") \
  column(Vec3, shear, "cell/shear", "m", "", kAddedLater, "h_yz, h_xz, h_xy since the cell was a box") \
  column(Vec3, shear_rate, "cell/shear_rate", "1/s", "", kAddedLater, "L_yz, L_xz, L_xy") \
  column(Vec3, normal_stress, "cell/normal_stress", "Pa", "", kFileOnly, "xx, yy, zz, positive in compression") \
  column(Vec3, shear_stress, "cell/shear_stress", "Pa", "", kFileOnly, "yz, xz, xy")

/// Where impacts are recorded, of pairs of materials by bin of energy, those that have some; sums since the start of the run:
/// column(type, name, path, unit, csv, uses, what it is)
#define SCREE_FRAME_IMPACTS(column) \
  column(std::int32_t, material_a, "impacts/material_a", "", "", kFileOnly, "index in the scene") \
  column(std::int32_t, material_b, "impacts/material_b", "", "", kFileOnly, "index in the scene") \
  column(double, energy_from, "impacts/energy_from", "J", "", kFileOnly, "lower end of the bin") \
  column(double, energy_to, "impacts/energy_to", "J", "", kFileOnly, "upper end of the bin") \
  column(std::int64_t, normal_count, "impacts/normal_count", "", "", kFileOnly, "contacts that began with such an energy along the normal") \
  column(double, normal_energy, "impacts/normal_energy", "J", "", kFileOnly, "of these") \
  column(std::int64_t, shear_count, "impacts/shear_count", "", "", kFileOnly, "contacts that began with such an energy along the surfaces") \
  column(double, shear_energy, "impacts/shear_energy", "J", "", kFileOnly, "of these")

/// The same of what contacts have dissipated, a row for each pair of materials: column(type, name, path, unit, csv, uses, what it is)
#define SCREE_FRAME_LOSSES(column) \
  column(std::int32_t, material_a, "losses/material_a", "", "", kFileOnly, "index in the scene") \
  column(std::int32_t, material_b, "losses/material_b", "", "", kFileOnly, "index in the scene") \
  column(double, damping, "losses/damping", "J", "", kFileOnly, "along the normal, what contacts yield included") \
  column(double, friction, "losses/friction", "J", "", kFileOnly, "of sliding, its damping included") \
  column(double, rolling, "losses/rolling", "J", "", kFileOnly, "of rolling and torsional resistance")

/// Attributes of the group `frame`: column(type, name, unit, what it is)
#define SCREE_FRAME_SCALARS(column) \
  column(std::int64_t, number, "", "of the frame") \
  column(std::int64_t, step, "", "of the run") \
  column(double, time, "s", "at the end of the step") \
  column(double, kinetic, "J", "of the whole scene") \
  column(double, potential, "J", "of the whole scene") \
  column(double, elastic, "J", "of the whole scene, normal and tangential") \
  column(double, dissipated, "J", "of the whole scene, since the start")
// clang-format on
