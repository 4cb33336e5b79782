// *.shape.h5: one or more shapes. The page of the format is SHAPE_FORMAT.md beside this file.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "core/base/json_record.hpp"
#include "core/geometry/mass_properties.hpp"
#include "core/geometry/triangle_mesh.hpp"
#include "core/storage/h5.hpp"
#include "core/storage/piece_table.hpp"

namespace scree {

inline constexpr const char* kShapeFormat = "scree-shape";
inline constexpr std::int64_t kShapeFormatVersion = 1;

enum class ShapeKind : std::int32_t {
  solid = 0,    ///< closed mesh with mass
  surface = 1,  ///< wall surface: may be open, no mass, file coordinates kept
  sphere = 2    ///< analytic: one vertex at the centre, no triangles
};

/// A rigid shape of scale 1, shared by any number of bodies.
struct Shape {
  std::string name;
  ShapeKind kind = ShapeKind::solid;
  TriangleMesh mesh;         ///< solid: origin at the centre of mass, axes as in the file it came from
  double cell_size = 0;      ///< [m], in a scene: contacts further apart than this do not share stiffness; 0: they do
  double sphere_radius = 0;  ///< [m], sphere only: rounding radius about the vertex
  Vec3 origin_shift;         ///< centre of mass in the coordinates of the file [m]
  MassProperties mass;       ///< density 1, about the origin of the mesh; zero for a surface
  double area = 0;           ///< [m^2]
  JsonRecord verdict;        ///< what the mesh check found (see mesher/README.md); null for analytic shapes

  /// Radius of the smallest sphere about the origin that holds the shape, rounding included [m].
  double bounding_radius() const;
  /// Diameter of the ball of equal volume [m]; 0 for a surface.
  double equivalent_diameter() const;
};

/// Fills mass (density 1) and area, moves the mesh's centre of mass to the origin and records the shift.
/// Throws InputError when the signed volume is not > 0.
Shape make_solid(const std::string& name, TriangleMesh mesh);
/// A wall surface: coordinates kept, no mass.
Shape make_surface(const std::string& name, TriangleMesh mesh);
/// An analytic ball.
Shape make_sphere(const std::string& name, double radius);

/// Writes whole or not at all. provenance as made by provenance_record(); pieces where the shapes are those of a cut body.
void write_shape_file(const std::string& path, const std::vector<Shape>& shapes, const nlohmann::json& provenance,
                      const PieceTable* pieces = nullptr);

struct ShapeFile {
  std::vector<Shape> shapes;
  JsonRecord provenance;
  std::optional<PieceTable> pieces;  ///< of a body that was cut: all shapes are its pieces
};
/// Throws InputError when the file is missing, damaged, of another kind or of a newer version, or when its
/// contents cannot be a shape (index out of range, NaN).
ShapeFile read_shape_file(const std::string& path);

/// Shapes inside another file (a scene holds copies): one child group per shape, "shape_0000" and so on.
void write_shapes(const h5::Group& group, const std::vector<Shape>& shapes);
std::vector<Shape> read_shapes(const h5::Group& group);

/// Checks attributes "format" and "format_version" of a file's root and says what to do when they do not fit.
void check_format(const h5::Group& root, const std::string& format, std::int64_t newest_version);

}  // namespace scree
