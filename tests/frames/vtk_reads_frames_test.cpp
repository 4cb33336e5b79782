// Every frame that frame_file_test left is read by VTK's own vtkHDFReader: the same reader that ParaView has.
// A separate program, because VTK brings the serial HDF5 library.
//
//   vtk_reads_frames_test FOLDER    FOLDER/NAME_RANKS/frame_000012.hdf of frame_file_test
#include <vtkCell.h>
#include <vtkDataArray.h>
#include <vtkHDFReader.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkUnstructuredGrid.h>

#include <cstdio>
#include <filesystem>
#include <map>
#include <set>
#include <string>

#include "tests/frames/frame_values.hpp"

namespace {

namespace fs = std::filesystem;
int failures = 0;

void expect(bool condition, const fs::path& file, const char* what, long long id = -1) {
  if (condition) return;
  if (++failures <= 20) std::fprintf(stderr, "%s: %s (body %lld)\n", file.c_str(), what, id);
}

bool equal(vtkDataArray* array, vtkIdType row, const scree::Vec3& v) {
  return array->GetComponent(row, 0) == v.x && array->GetComponent(row, 1) == v.y && array->GetComponent(row, 2) == v.z;
}

void check_frame(const fs::path& file, long long count, int owners) {
  vtkNew<vtkHDFReader> reader;
  expect(reader->CanReadFile(file.c_str()) != 0, file, "vtkHDFReader does not know the file");
  reader->SetFileName(file.c_str());
  reader->Update();
  auto* grid = vtkUnstructuredGrid::SafeDownCast(reader->GetOutputAsDataSet());
  expect(grid != nullptr, file, "no unstructured grid");
  if (grid == nullptr) return;
  expect(grid->GetNumberOfPoints() == count, file, "wrong number of points");
  expect(grid->GetNumberOfCells() == count, file, "wrong number of cells");
  if (count == 0 || grid->GetNumberOfPoints() != count) return;
  std::map<std::string, vtkDataArray*> arrays;
  const std::map<std::string, int> components{{"id", 1},   {"quat", 4},  {"shape", 1},    {"material", 1},
                                              {"rank", 1}, {"scale", 1}, {"velocity", 3}, {"angular_velocity", 3}};
  for (const auto& [name, width] : components) {
    arrays[name] = grid->GetPointData()->GetArray(name.c_str());
    expect(arrays[name] != nullptr && arrays[name]->GetNumberOfComponents() == width, file, ("array " + name).c_str());
    if (arrays[name] == nullptr || arrays[name]->GetNumberOfComponents() != width) return;
  }
  std::set<long long> seen;
  for (vtkIdType row = 0; row < count; ++row) {
    const auto id = static_cast<long long>(arrays["id"]->GetComponent(row, 0));
    expect(id >= 0 && id < count && seen.insert(id).second, file, "id out of range or twice", id);
    const scree::Quat q = scree::test::orientation_of(id);
    double p[3];
    grid->GetPoint(row, p);
    const scree::Vec3 x = scree::test::position_of(id);
    expect(p[0] == x.x && p[1] == x.y && p[2] == x.z, file, "position", id);
    expect(arrays["quat"]->GetComponent(row, 0) == q.w && arrays["quat"]->GetComponent(row, 3) == q.z, file, "orientation", id);
    expect(arrays["shape"]->GetComponent(row, 0) == static_cast<double>(id % 3), file, "shape", id);
    expect(arrays["material"]->GetComponent(row, 0) == static_cast<double>(id % 2), file, "material", id);
    expect(arrays["rank"]->GetComponent(row, 0) == static_cast<double>(id % owners), file, "rank", id);
    expect(arrays["scale"]->GetComponent(row, 0) == 1 + 0.001 * static_cast<double>(id), file, "scale", id);
    expect(equal(arrays["velocity"], row, scree::test::velocity_of(id)), file, "velocity", id);
    expect(equal(arrays["angular_velocity"], row, scree::test::spin_of(id)), file, "angular velocity", id);
    vtkCell* cell = grid->GetCell(row);
    expect(cell->GetCellType() == 1 && cell->GetPointId(0) == row, file, "vertex cell", id);
  }
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) return 2;
  const std::map<std::string, long long> counts{
      {"few", 10}, {"thousands", 3000}, {"chunks", 40000}, {"idle_few", 10}, {"idle_thousands", 3000}, {"one", 1}, {"none", 0}};
  int files = 0;
  for (const auto& [name, count] : counts) {
    for (const int ranks : {1, 2, 4}) {
      const fs::path file = fs::path(argv[1]) / (name + "_" + std::to_string(ranks)) / "frame_000012.hdf";
      expect(fs::exists(file), file, "is missing: frame_file_test writes it");
      if (!fs::exists(file)) continue;
      check_frame(file, count, name.starts_with("idle") ? 1 : ranks);
      ++files;
    }
  }
  std::printf("%d frames read by vtkHDFReader, %d failures\n", files, failures);
  return failures == 0 && files == 21 ? 0 : 1;
}
