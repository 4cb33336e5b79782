// The pieces that a body is cut into, and the faces that they share: what a shape file from `scree-mesher fracture` holds beside shapes.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/geometry/triangle_mesh.hpp"
#include "core/storage/h5.hpp"

namespace scree {

/// A plane face between two pieces. Coordinates are those of the body that was cut: origin at its centre of mass.
struct SharedFace {
  std::int32_t piece_a = 0, piece_b = 0;  ///< indices of shapes in the file
  double area = 0;                        ///< [m^2]
  Vec3 centroid;                          ///< [m]
  Vec3 normal;                            ///< unit, from a to b
  Vec3 axis;                              ///< unit, in the face: the principal axis of the smaller second moment
  double moment_1 = 0;                    ///< [m^4] of rotation about `axis`: integral of the squared distance from it
  double moment_2 = 0;                    ///< [m^4] of rotation about normal x axis; >= moment_1
  double height = 0;                      ///< [m] distance of the generators of both cells, which the face bisects
  double rim_radius = 0;                  ///< [m] from the centroid to the farthest point of the rim
};

struct PieceTable {
  std::string body;                   ///< name of the shape that was cut
  double volume = 0;                  ///< [m^3] of it
  double inset = 0;                   ///< [m] by which shared faces of the meshes of the pieces lie behind those of this table
  std::vector<SharedFace> faces;      ///< by piece_a, piece_b
  TriangleMesh face_mesh;             ///< the faces as triangles, for pictures; counter-clockwise seen from b
  std::vector<std::int32_t> face_of;  ///< T of face_mesh: index in faces
};

/// Group /pieces of a shape file.
void write_piece_table(const h5::Group& group, const PieceTable& table);
/// in   piece_count   shapes of the file: indices of faces are checked against it
/// Fails: InputError for what is missing, of another size, no finite number, or no face.
PieceTable read_piece_table(const h5::Group& group, std::int64_t piece_count);

}  // namespace scree
