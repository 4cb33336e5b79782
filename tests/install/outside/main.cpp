// Prints the volume and the surface of the shapes in a file, and the exact distance of two triangles.
#include <cstdio>
#include <exception>

#include "core/distance/triangle_distance.hpp"
#include "core/storage/shape_file.hpp"

int main(int argc, char** argv) {
  if (argc != 2) return 2;
  try {
    for (const scree::Shape& shape : scree::read_shape_file(argv[1]).shapes) {
      std::printf("%s %.17g %.17g\n", shape.name.c_str(), shape.mass.volume, shape.area);
    }
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 3;
  }
  const scree::Vec3 a[3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  const scree::Vec3 b[3] = {{4, 0, 0}, {4, 4, 0}, {4, 0, 4}};  // the vertex (1, 0, 0) is 3 from it
  std::printf("distance %.17g\n", scree::triangle_distance(a, b).distance);
  return 0;
}
