#include "post/vtk_files.hpp"

#include <vtkCellArray.h>
#include <vtkCellData.h>
#include <vtkFloatArray.h>
#include <vtkIntArray.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkPoints.h>
#include <vtkPolyData.h>
#include <vtkTypeInt64Array.h>
#include <vtkXMLPolyDataWriter.h>

#include <cstdio>
#include <filesystem>

#include "core/base/error.hpp"
#include "core/storage/h5.hpp"
#include "post/vtk_mesh.hpp"

namespace scree {

namespace {

/// Points and triangles as they are gathered.
struct Gathered {
  vtkNew<vtkPoints> points;
  vtkNew<vtkCellArray> triangles;
  Gathered() { points->SetDataTypeToFloat(); }
  void add(const TriangleMesh& mesh, double scale, const Vec3& position, const Quat& orientation) {
    const vtkIdType first = points->GetNumberOfPoints();
    for (const Vec3& v : mesh.vertices) {
      const Vec3 p = position + rotate(orientation, scale * v);
      points->InsertNextPoint(p.x, p.y, p.z);
    }
    for (const Triangle& t : mesh.triangles) {
      const vtkIdType corners[3] = {first + t[0], first + t[1], first + t[2]};
      triangles->InsertNextCell(3, corners);
    }
  }
};

void write(const std::string& path, vtkPolyData* data) {
  const std::string temporary = h5::temporary_name(path);
  vtkNew<vtkXMLPolyDataWriter> writer;
  writer->SetFileName(temporary.c_str());
  writer->SetInputData(data);
  writer->SetDataModeToAppended();
  writer->EncodeAppendedDataOff();
  writer->SetCompressorTypeToZLib();
  writer->SetIdTypeToInt32();
  if (writer->Write() != 1 || writer->GetErrorCode() != 0) {
    std::remove(temporary.c_str());
    throw SystemError("cannot write {}; is the disk full, or the folder not writable?", path);
  }
  h5::publish_file(temporary, path);
}

}  // namespace

vtkSmartPointer<vtkPolyData> vtk_mesh(const DrawnMesh& drawn) {
  Gathered all;
  all.add(drawn.mesh, 1, {}, {});
  auto data = vtkSmartPointer<vtkPolyData>::New();
  data->SetPoints(all.points);
  data->SetPolys(all.triangles);
  if (!drawn.normals.empty()) {
    vtkNew<vtkFloatArray> normals;
    normals->SetName("Normals");
    normals->SetNumberOfComponents(3);
    for (const Vec3& n : drawn.normals) normals->InsertNextTuple3(n.x, n.y, n.z);
    data->GetPointData()->SetNormals(normals);
  }
  return data;
}

vtkSmartPointer<vtkPolyData> vtk_walls(const Scene& scene, const std::vector<TriangleMesh>& walls, const std::vector<WallPlace>& places) {
  Gathered all;
  vtkNew<vtkTypeInt64Array> id;
  id->SetName("wall");
  for (std::size_t w = 0; w < walls.size(); ++w) {
    all.add(walls[w], 1, places[w].position, places[w].orientation);
    for (std::size_t t = 0; t < walls[w].triangles.size(); ++t) id->InsertNextValue(scene.walls[w].id);
  }
  auto data = vtkSmartPointer<vtkPolyData>::New();
  data->SetPoints(all.points);
  data->SetPolys(all.triangles);
  data->GetCellData()->AddArray(id);
  return data;
}

void write_mesh_vtp(const std::string& path, const DrawnMesh& mesh) { write(path, vtk_mesh(mesh)); }

void write_walls_vtp(const std::string& path, const Scene& scene, const std::vector<TriangleMesh>& walls, const std::vector<WallPlace>& places) {
  write(path, vtk_walls(scene, walls, places));
}

void write_surfaces_vtp(const std::string& path, const FrameBodies& bodies, const std::vector<DrawnMesh>& shapes) {
  Gathered all;
  vtkNew<vtkTypeInt64Array> id;
  vtkNew<vtkIntArray> shape, material;
  vtkNew<vtkFloatArray> speed, normals;
  id->SetName("id");
  shape->SetName("shape");
  material->SetName("material");
  speed->SetName("speed");
  normals->SetName("Normals");
  normals->SetNumberOfComponents(3);
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    const DrawnMesh& drawn = shapes[static_cast<std::size_t>(bodies.shape[i])];
    all.add(drawn.mesh, bodies.scale[i], bodies.position[i], bodies.orientation[i]);
    const double v = length(bodies.velocity[i]);
    for (std::size_t t = 0; t < drawn.mesh.triangles.size(); ++t) {
      id->InsertNextValue(bodies.id[i]);
      shape->InsertNextValue(bodies.shape[i]);
      material->InsertNextValue(bodies.material[i]);
      speed->InsertNextValue(static_cast<float>(v));
    }
    for (const Vec3& n : drawn.normals) {
      const Vec3 turned = rotate(bodies.orientation[i], n);
      normals->InsertNextTuple3(turned.x, turned.y, turned.z);
    }
  }
  vtkNew<vtkPolyData> data;
  data->SetPoints(all.points);
  data->SetPolys(all.triangles);
  data->GetCellData()->AddArray(id);
  data->GetCellData()->AddArray(shape);
  data->GetCellData()->AddArray(material);
  data->GetCellData()->AddArray(speed);
  // point normals belong to curved surfaces only, so a scene of balls has them and one with rocks has none
  if (normals->GetNumberOfTuples() == all.points->GetNumberOfPoints()) data->GetPointData()->SetNormals(normals);
  write(path, data);
}

}  // namespace scree
