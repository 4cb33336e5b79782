#include "post/vtk/vtk_files.hpp"

#include <vtkCellArray.h>
#include <vtkCellData.h>
#include <vtkDoubleArray.h>
#include <vtkFieldData.h>
#include <vtkFloatArray.h>
#include <vtkIntArray.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkPoints.h>
#include <vtkPolyData.h>
#include <vtkStringArray.h>
#include <vtkTypeInt32Array.h>
#include <vtkTypeInt64Array.h>
#include <vtkTypeInt8Array.h>
#include <vtkXMLPolyDataWriter.h>

#include <cstdio>
#include <limits>
#include <numeric>
#include <type_traits>

#include "core/base/error.hpp"
#include "core/base/temporary_file.hpp"
#include "post/run/bonds_in_frame.hpp"
#include "post/run/contact_network.hpp"
#include "post/vtk/vtk_mesh.hpp"

namespace scree {

namespace {

/// Points and triangles, with room for all of them taken at once.
class Gathered {
 public:
  Gathered(std::size_t points, std::size_t triangles) {
    points_->SetDataTypeToFloat();
    points_->SetNumberOfPoints(static_cast<vtkIdType>(points));
    point_ = static_cast<float*>(points_->GetVoidPointer(0));
    offsets_->SetNumberOfValues(static_cast<vtkIdType>(triangles) + 1);
    corners_->SetNumberOfValues(3 * static_cast<vtkIdType>(triangles));
    for (std::size_t t = 0; t <= triangles; ++t) offsets_->SetValue(static_cast<vtkIdType>(t), static_cast<int>(3 * t));
    corner_ = corners_->GetPointer(0);
  }
  void add(const TriangleMesh& mesh, double scale, const Vec3& position, const Quat& orientation) {
    const Mat3 turn = matrix_of(orientation);
    for (const Vec3& v : mesh.vertices) {
      const Vec3 p = position + turn * (scale * v);
      for (int k = 0; k < 3; ++k) *point_++ = static_cast<float>(p[k]);
    }
    for (const Triangle& t : mesh.triangles) {
      for (const std::int32_t v : t) *corner_++ = first_ + v;
    }
    first_ += mesh.vertex_count();
  }
  vtkSmartPointer<vtkPolyData> poly_data() const {
    vtkNew<vtkCellArray> triangles;
    triangles->SetData(offsets_, corners_);
    auto data = vtkSmartPointer<vtkPolyData>::New();
    data->SetPoints(points_);
    data->SetPolys(triangles);
    return data;
  }

 private:
  vtkNew<vtkPoints> points_;
  vtkNew<vtkTypeInt32Array> offsets_, corners_;
  float* point_ = nullptr;
  int* corner_ = nullptr;
  std::int32_t first_ = 0;
};

/// An array of `size` rows, filled by value(row, component).
template <class Array, class Value>
vtkSmartPointer<Array> array_of(const char* name, std::size_t size, int components, const Value& value) {
  auto array = vtkSmartPointer<Array>::New();
  array->SetName(name);
  array->SetNumberOfComponents(components);
  array->SetNumberOfTuples(static_cast<vtkIdType>(size));
  auto* at = array->GetPointer(0);
  using Element = std::remove_reference_t<decltype(*at)>;
  for (std::size_t i = 0; i < size; ++i) {
    for (int c = 0; c < components; ++c) *at++ = static_cast<Element>(value(i, c));
  }
  return array;
}

template <class T>
using ArrayOf = std::conditional_t<std::is_same_v<T, std::int64_t>, vtkTypeInt64Array,
                                   std::conditional_t<std::is_same_v<T, std::int32_t>, vtkIntArray, vtkFloatArray>>;

/// The columns of bodies or contacts that are for this use (see FrameUse), as arrays with one row per index.
template <class Table>
void add_columns(vtkDataSetAttributes* to, const Table& table, unsigned use, const std::vector<std::int32_t>& indices) {
  Table::visit([&](const auto& c) {
    using Value = typename std::decay_t<decltype(c)>::Value;
    if ((c.uses & use) == 0) return;
    if (!has_column(table, c)) return;
    const auto& values = table.*c.column;
    to->AddArray(
        array_of<ArrayOf<Value>>(std::string(c.dataset()).c_str(), indices.size(), component_count<Value>,
                                 [&](std::size_t i, int k) { return component(values[static_cast<std::size_t>(indices[i])], k); }));
  });
}

/// What bodies have, and their speeds.
void add_body_arrays(vtkDataSetAttributes* to, const FrameBodies& b, unsigned use, const std::vector<std::int32_t>& body) {
  add_columns(to, b, use, body);
  to->AddArray(array_of<vtkFloatArray>("speed", body.size(), 1,
                                       [&](std::size_t i, int) { return length(b.velocity[static_cast<std::size_t>(body[i])]); }));
}

std::vector<std::int32_t> all_rows(std::size_t size) {
  std::vector<std::int32_t> all(size);
  std::iota(all.begin(), all.end(), 0);
  return all;
}

/// Points with one vertex cell each.
vtkSmartPointer<vtkPolyData> points_of(const std::vector<Vec3>& positions) {
  vtkNew<vtkPoints> points;
  points->SetData(array_of<vtkFloatArray>("Points", positions.size(), 3, [&](std::size_t i, int c) { return positions[i][c]; }));
  vtkNew<vtkCellArray> vertices;
  vertices->SetData(array_of<vtkTypeInt32Array>("offsets", positions.size() + 1, 1, [](std::size_t i, int) { return i; }),
                    array_of<vtkTypeInt32Array>("connectivity", positions.size(), 1, [](std::size_t i, int) { return i; }));
  auto data = vtkSmartPointer<vtkPolyData>::New();
  data->SetPoints(points);
  data->SetVerts(vertices);
  return data;
}

/// What stands behind the numbers of an array, as field data: item k is that of number k.
template <class Item>
void add_names(vtkPolyData* data, const char* name, const std::vector<Item>& items) {
  vtkNew<vtkStringArray> names;
  names->SetName(name);
  for (const Item& item : items) names->InsertNextValue(item.name);
  data->GetFieldData()->AddArray(names);
}

void write(const std::string& path, vtkPolyData* data) {
  TemporaryFile temporary(path);
  vtkNew<vtkXMLPolyDataWriter> writer;
  writer->SetFileName(temporary.name().c_str());
  writer->SetInputData(data);
  writer->SetDataModeToAppended();
  writer->EncodeAppendedDataOff();
  writer->SetCompressorTypeToZLib();
  writer->SetCompressionLevel(1);
  writer->SetIdTypeToInt32();
  if (writer->Write() != 1 || writer->GetErrorCode() != 0)
    throw SystemError("cannot write {}; is the disk full, or the folder not writable?", path);
  temporary.publish();
}

}  // namespace

vtkSmartPointer<vtkPolyData> vtk_mesh(const DrawnMesh& drawn) {
  Gathered all(drawn.mesh.vertices.size(), drawn.mesh.triangles.size());
  all.add(drawn.mesh, 1, {}, {});
  auto data = all.poly_data();
  if (!drawn.normals.empty()) {
    data->GetPointData()->SetNormals(
        array_of<vtkFloatArray>("Normals", drawn.normals.size(), 3, [&](std::size_t i, int c) { return drawn.normals[i][c]; }));
  }
  return data;
}

vtkSmartPointer<vtkPolyData> vtk_walls(const Scene& scene, const std::vector<TriangleMesh>& walls, const std::vector<WallPlace>& places,
                                       const std::vector<WallLoads>& loads) {
  std::size_t points = 0, triangles = 0;
  for (const TriangleMesh& wall : walls) {
    points += wall.vertices.size();
    triangles += wall.triangles.size();
  }
  Gathered all(points, triangles);
  std::vector<std::int64_t> id;
  for (std::size_t w = 0; w < walls.size(); ++w) {
    all.add(walls[w], 1, places[w].position, places[w].orientation);
    id.insert(id.end(), walls[w].triangles.size(), scene.walls[w].id);
  }
  auto data = all.poly_data();
  data->GetCellData()->AddArray(array_of<vtkTypeInt64Array>("wall", id.size(), 1, [&](std::size_t i, int) { return id[i]; }));
  if (!loads.empty()) {
    std::vector<std::int8_t> mapped;
    for (std::size_t w = 0; w < walls.size(); ++w) mapped.insert(mapped.end(), walls[w].triangles.size(), scene.walls[w].load_map ? 1 : 0);
    data->GetCellData()->AddArray(
        array_of<vtkTypeInt8Array>("has_load_map", mapped.size(), 1, [&](std::size_t i, int) { return mapped[i]; }));
  }
  std::vector<std::size_t> count;
  for (const TriangleMesh& wall : walls) count.push_back(wall.triangles.size());
  for (std::size_t q = 0; q < kLoadQuantities.size() && !loads.empty(); ++q) {
    const std::vector<double> values = on_drawn_walls(loads, q, count);
    data->GetCellData()->AddArray(
        array_of<vtkFloatArray>(kLoadQuantities[q].name, values.size(), 1, [&](std::size_t i, int) { return values[i]; }));
  }
  return data;
}

void write_mesh_vtp(const std::string& path, const DrawnMesh& mesh) { write(path, vtk_mesh(mesh)); }

void write_walls_vtp(const std::string& path, const Scene& scene, const std::vector<TriangleMesh>& walls,
                     const std::vector<WallPlace>& places, const std::vector<WallLoads>& loads) {
  const auto data = vtk_walls(scene, walls, places, loads);
  data->GetFieldData()->AddArray(
      array_of<vtkTypeInt64Array>("wall_ids", scene.walls.size(), 1, [&](std::size_t w, int) { return scene.walls[w].id; }));
  add_names(data, "wall_names", scene.walls);
  write(path, data);
}

void write_surfaces_vtp(const std::string& path, const Frame& frame, const Scene& scene, const std::vector<DrawnMesh>& shapes) {
  const FrameBodies& bodies = frame.bodies;
  const auto shape_of = [&](std::size_t i) -> const DrawnMesh& { return shapes[static_cast<std::size_t>(bodies.shape[i])]; };
  std::size_t points = 0, triangles = 0;
  bool curved = true;  // point normals belong to curved surfaces only, so a scene of balls has them and one with rocks has none
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    points += shape_of(i).mesh.vertices.size();
    triangles += shape_of(i).mesh.triangles.size();
    curved = curved && !shape_of(i).normals.empty();
  }
  // offsets into the file are int32
  if (3 * triangles > static_cast<std::size_t>(std::numeric_limits<std::int32_t>::max())) {
    throw UsageError(
        "{}: {} triangles in one frame are too many for one file; choose fewer bodies (--region, --ids) or write bodies instead of "
        "surfaces",
        path, triangles);
  }
  Gathered all(points, triangles);
  std::vector<std::int32_t> body;
  std::vector<Vec3> normals;
  body.reserve(triangles);
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    const DrawnMesh& drawn = shape_of(i);
    all.add(drawn.mesh, bodies.scale[i], bodies.position[i], bodies.orientation[i]);
    body.insert(body.end(), drawn.mesh.triangles.size(), static_cast<std::int32_t>(i));
    if (!curved) continue;
    for (const Vec3& n : drawn.normals) normals.push_back(rotate(bodies.orientation[i], n));
  }
  const auto data = all.poly_data();
  add_body_arrays(data->GetCellData(), bodies, kOnSurfaces, body);
  add_names(data, "shape_names", scene.shapes);
  add_names(data, "material_names", scene.materials);
  if (!scene.bonds.empty()) {
    const std::vector<std::int64_t> fragment = fragment_ids(scene, bodies, frame.bonds.bond);
    data->GetCellData()->AddArray(array_of<vtkTypeInt64Array>(
        "fragment", body.size(), 1, [&](std::size_t i, int) { return fragment[static_cast<std::size_t>(body[i])]; }));
    const std::vector<Vec3> ways = ways_apart(scene, frame);
    std::vector<std::size_t> body_of_point;
    for (std::size_t i = 0; i < bodies.size(); ++i) body_of_point.insert(body_of_point.end(), shape_of(i).mesh.vertices.size(), i);
    data->GetPointData()->AddArray(
        array_of<vtkFloatArray>("apart", points, 3, [&](std::size_t i, int c) { return ways[body_of_point[i]][c]; }));
  }
  if (curved)
    data->GetPointData()->SetNormals(
        array_of<vtkFloatArray>("Normals", normals.size(), 3, [&](std::size_t i, int c) { return normals[i][c]; }));
  write(path, data);
}

void write_bodies_vtp(const std::string& path, const FrameBodies& b) {
  const auto data = points_of(b.position);
  add_body_arrays(data->GetPointData(), b, kInParaView, all_rows(b.size()));
  write(path, data);
}

void write_contacts_vtp(const std::string& path, const FrameContacts& c) {
  const std::size_t n = c.size();
  const auto data = points_of(c.point);
  vtkPointData* arrays = data->GetPointData();
  add_columns(arrays, c, kInParaView, all_rows(n));
  arrays->AddArray(array_of<vtkFloatArray>(
      "force", n, 3, [&](std::size_t i, int k) { return c.normal_force[i] * c.normal[i][k] + c.tangential_force[i][k]; }));
  write(path, data);
}

vtkSmartPointer<vtkPolyData> vtk_bonds(const std::vector<BondFace>& faces) {
  const std::size_t n = faces.size();
  vtkNew<vtkPoints> points;
  points->SetData(array_of<vtkFloatArray>("Points", 4 * n, 3, [&](std::size_t i, int c) { return faces[i / 4].corners[i % 4][c]; }));
  vtkNew<vtkCellArray> cells;
  cells->SetData(array_of<vtkTypeInt32Array>("offsets", n + 1, 1, [](std::size_t i, int) { return 4 * i; }),
                 array_of<vtkTypeInt32Array>("connectivity", 4 * n, 1, [](std::size_t i, int) { return i; }));
  auto data = vtkSmartPointer<vtkPolyData>::New();
  data->SetPoints(points);
  data->SetPolys(cells);
  vtkCellData* arrays = data->GetCellData();
  arrays->AddArray(array_of<vtkTypeInt64Array>("body_a", n, 1, [&](std::size_t i, int) { return faces[i].body_a; }));
  arrays->AddArray(array_of<vtkTypeInt64Array>("body_b", n, 1, [&](std::size_t i, int) { return faces[i].body_b; }));
  for (const BondQuantity& q : kBondQuantities)
    arrays->AddArray(array_of<vtkFloatArray>(q.name, n, 1, [&](std::size_t i, int) { return faces[i].*q.value; }));
  arrays->AddArray(array_of<vtkFloatArray>("energy", n, 1, [&](std::size_t i, int) { return faces[i].energy; }));
  return data;
}

void write_bonds_vtp(const std::string& path, const Frame& frame, const Scene& scene) {
  const std::vector<BondFace> faces = bond_faces(scene, frame);
  const auto data = vtk_bonds(faces);
  const std::vector<Vec3> ways = ways_apart(scene, frame);
  const BodyRows row_of(frame.bodies);
  // both bodies of a bond that holds are of one fragment
  data->GetPointData()->AddArray(array_of<vtkFloatArray>(
      "apart", 4 * faces.size(), 3, [&](std::size_t i, int c) { return ways[static_cast<std::size_t>(row_of(faces[i / 4].body_a))][c]; }));
  write(path, data);
}

void write_network_vtp(const std::string& path, const Frame& frame, const Periodicity& period) {
  const std::vector<NetworkLine> lines = network_of(frame, period);
  std::vector<Vec3> ends;
  for (const NetworkLine& line : lines) {
    ends.push_back(line.from);
    ends.push_back(line.to);
  }
  vtkNew<vtkPoints> points;
  points->SetData(array_of<vtkFloatArray>("Points", ends.size(), 3, [&](std::size_t i, int c) { return ends[i][c]; }));
  vtkNew<vtkCellArray> cells;
  cells->SetData(array_of<vtkTypeInt32Array>("offsets", lines.size() + 1, 1, [](std::size_t i, int) { return 2 * i; }),
                 array_of<vtkTypeInt32Array>("connectivity", ends.size(), 1, [](std::size_t i, int) { return i; }));
  vtkNew<vtkPolyData> data;
  data->SetPoints(points);
  data->SetLines(cells);
  vtkPointData* arrays = data->GetPointData();
  const std::size_t n = ends.size();
  arrays->AddArray(array_of<vtkFloatArray>("normal_force", n, 1, [&](std::size_t i, int) { return lines[i / 2].normal_force; }));
  arrays->AddArray(array_of<vtkFloatArray>("tangential_force", n, 1, [&](std::size_t i, int) { return lines[i / 2].tangential_force; }));
  arrays->AddArray(array_of<vtkFloatArray>("force", n, 3, [&](std::size_t i, int c) { return lines[i / 2].force[c]; }));
  arrays->AddArray(array_of<vtkIntArray>("contact_points", n, 1, [&](std::size_t i, int) { return lines[i / 2].points; }));
  arrays->AddArray(array_of<vtkTypeInt64Array>("body_a", n, 1, [&](std::size_t i, int) { return lines[i / 2].body_a; }));
  arrays->AddArray(array_of<vtkTypeInt64Array>("body_b", n, 1, [&](std::size_t i, int) { return lines[i / 2].body_b; }));
  write(path, data);
}

vtkSmartPointer<vtkPolyData> vtk_cell(const FrameCell& cell, const Periodicity& period) {
  // one that is not periodic along z ends there at planes
  const Periodicity least = Periodicity::at_corner(cell.lower[0], cell.upper[0] - cell.lower[0], period.least_shear());
  std::vector<Vec3> corners;  // bit k of its number: beyond the side along axis k; an edge joins two corners that differ in one bit
  std::vector<std::size_t> ends;
  for (std::size_t c = 0; c < 8; ++c) {
    corners.push_back(least.lower() + least.shift({c & 1 ? 1.0 : 0.0, c & 2 ? 1.0 : 0.0, c & 4 ? 1.0 : 0.0}));
    for (const std::size_t bit : {1U, 2U, 4U}) {
      if ((c & bit) == 0) ends.insert(ends.end(), {c, c | bit});
    }
  }
  vtkNew<vtkPoints> points;
  points->SetData(array_of<vtkFloatArray>("Points", corners.size(), 3, [&](std::size_t i, int c) { return corners[i][c]; }));
  vtkNew<vtkCellArray> cells;
  cells->SetData(array_of<vtkTypeInt32Array>("offsets", ends.size() / 2 + 1, 1, [](std::size_t i, int) { return 2 * i; }),
                 array_of<vtkTypeInt32Array>("connectivity", ends.size(), 1, [&](std::size_t i, int) { return ends[i]; }));
  auto data = vtkSmartPointer<vtkPolyData>::New();
  data->SetPoints(points);
  data->SetLines(cells);
  return data;
}

void write_cell_vtp(const std::string& path, const FrameCell& cell, const Periodicity& period) {
  const auto data = vtk_cell(cell, period);
  data->GetFieldData()->AddArray(
      array_of<vtkDoubleArray>("normal_stress", 1, 3, [&](std::size_t, int c) { return cell.normal_stress[0][c]; }));
  data->GetFieldData()->AddArray(
      array_of<vtkDoubleArray>("shear_stress", 1, 3, [&](std::size_t, int c) { return cell.shear_stress[0][c]; }));
  write(path, data);
}

}  // namespace scree
