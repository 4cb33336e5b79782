// Coverage-guided fuzzing (libFuzzer) of our own readers and of check and repair; see run.sh.
//
// The first byte chooses: a BMF, OFF, PLY, STL or OBJ file, which is read and checked; a mesh spelt out in bytes, whose few lattice points
// make coincident, flat, crossing and non-manifold triangles likely, which is checked, or checked, healed and checked again. Everything
// happens in this process and without files: about 1000 runs a second with AddressSanitizer.
#include <array>
#include <cstddef>
#include <cstdint>

#include "core/base/error.hpp"
#include "mesher/io/mesh_file.hpp"
#include "tests/fuzz/certificate.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size < 2) return 0;
  const std::uint8_t kind = data[0];
  ++data, --size;
  if (kind % 2 == 0) {
    constexpr std::array kParsers{scree::parse_bmf, scree::parse_off, scree::parse_ply, scree::parse_stl, scree::parse_obj};
    try {
      const auto parse = kParsers[kind / 2 % kParsers.size()];
      scree::test::examine(parse({data, data + size}, "fuzz.mesh").mesh, false);
    } catch (const scree::Error&) {  // refused with words: as it should be
    }
    return 0;
  }
  scree::TriangleMesh mesh;
  const std::size_t vertex_count = 4 + data[0] % 28;
  std::size_t at = 1;
  for (std::size_t v = 0; v < vertex_count && at < size; ++v, ++at) {
    const int code = data[at];
    mesh.vertices.push_back({double(code % 5), double(code / 5 % 5), double(code / 25 % 5) + (code >= 125 ? 0.37 : 0.0)});
  }
  const auto count = static_cast<std::int32_t>(mesh.vertices.size());
  for (; at + 2 < size && count > 0; at += 3) {
    mesh.triangles.push_back({data[at] % count, data[at + 1] % count, data[at + 2] % count});
  }
  scree::test::examine(std::move(mesh), kind % 4 == 3);
  return 0;
}
