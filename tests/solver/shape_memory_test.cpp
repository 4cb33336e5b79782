// What a shape costs in memory, as the heap counts it.
#include <gtest/gtest.h>
#include <malloc.h>

#include "solver/scene/solver_scene.hpp"
#include "tests/support/shapes.hpp"

namespace scree {
namespace {

/// Bytes of the heap in use, the allocator's own included.
std::size_t heap_in_use() {
  const struct mallinfo2 info = mallinfo2();
  return info.uordblks + info.hblkhd;
}

// Small shapes have a row for each edge, 160 bytes, and three edges for two triangles.
TEST(ShapeMemory, a_shape_in_the_solver_takes_at_most_160_bytes_a_triangle_of_the_heap_and_240_for_the_rows_of_its_edges) {
  for (const int level : {2, 3, 4, 5}) {
    const Shape source = make_solid("rock", test::rock(11, level));
    const auto triangles = static_cast<double>(source.mesh.triangles.size());
    { const SolverShape first = make_solver_shape(source); }  // what libraries keep for good
    const std::size_t before = heap_in_use();
    const SolverShape shape = make_solver_shape(source);
    const auto used = static_cast<double>(heap_in_use() - before);
    EXPECT_EQ(shape.edge_rows.empty(), shape.mesh.triangles.size() > SolverShape::kMaxWithRows);
    EXPECT_LE(used, (shape.edge_rows.empty() ? 160 : 400) * triangles);
    // the figure in the plan of a run is this one, but for the allocator's rounding
    // and what it has cached of the shape before, which counts as in use
    EXPECT_LE(static_cast<double>(shape.memory()), 1.005 * used);
    EXPECT_GE(static_cast<double>(shape.memory()), 0.97 * used);
    std::printf("  %.0f triangles: %.1f bytes a triangle of the heap, mesh %.1f, tree %.1f, features %.1f\n", triangles, used / triangles,
                static_cast<double>(shape.mesh.vertices.size() * sizeof(Vec3) + shape.mesh.triangles.size() * sizeof(Triangle)) / triangles,
                static_cast<double>(shape.bvh.memory()) / triangles, static_cast<double>(shape.features.memory()) / triangles);
  }
}

}  // namespace
}  // namespace scree
