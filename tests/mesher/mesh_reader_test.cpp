// The readers of OFF, PLY, STL and OBJ: every valid way to write a mesh is read, counts that lie are refused, no digit is lost.
#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>

#include "core/base/error.hpp"
#include "mesher/check/mesh_check.hpp"
#include "mesher/io/mesh_file.hpp"
#include "mesher/repair/mesh_repair.hpp"
#include "tests/mesher/tool_run.hpp"

namespace scree {
namespace {

MeshFile read(const std::string& name, const std::string& text) {
  const test::Folder folder;
  folder.write(name, text);
  return read_mesh_file(folder / name);
}

/// A right tetrahedron of legs 1, however it is written.
void expect_tetrahedron(const std::string& name, const std::string& text) {
  SCOPED_TRACE(name + ":\n" + text);
  MeshFile file;
  ASSERT_NO_THROW(file = read(name, text));
  EXPECT_EQ(file.mesh.triangle_count(), 4);
  clean_mesh(file.mesh, false);
  const MeshCheck check = check_mesh(file.mesh);
  EXPECT_TRUE(check.is_solid());
  EXPECT_NEAR(check.mass.volume, 1.0 / 6, 1e-15);
}

/// The file is refused and the message holds the words.
void expect_refused(const std::string& name, const std::string& text, const std::string& words) {
  SCOPED_TRACE(name + ":\n" + text);
  try {
    read(name, text);
    ADD_FAILURE() << "it was read";
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find(words), std::string::npos) << "looked for '" << words << "' in\n" << error.what();
    EXPECT_NE(std::string(error.what()).find(name), std::string::npos) << error.what();
  }
}

std::string replaced(std::string text, const std::string& what, const std::string& with) {
  for (std::size_t at = 0; (at = text.find(what, at)) != std::string::npos; at += with.size()) text.replace(at, what.size(), with);
  return text;
}

template <class T>
void append(std::string& bytes, T value, std::endian order = std::endian::little) {
  char raw[sizeof(T)];
  std::memcpy(raw, &value, sizeof value);
  if (order != std::endian::native) std::reverse(raw, raw + sizeof(T));
  bytes.append(raw, sizeof raw);
}

const std::string kVertices = "0 0 0\n1 0 0\n0 1 0\n0 0 1\n", kFacets = "3 0 2 1\n3 0 1 3\n3 1 2 3\n3 0 3 2\n";
const std::string kOff = "OFF\n4 4 6\n" + kVertices + kFacets;
constexpr double kCorners[4][3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
constexpr int kSides[4][3] = {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {0, 3, 2}};

TEST(OffReader, a_comment_between_vertices_and_facets_loses_no_facet) {
  expect_tetrahedron("t.off", "OFF\n4 4 6\n# vertices\n" + kVertices + "\n# facets\n" + kFacets + "# end\n");
}

TEST(OffReader, every_valid_variant_gives_the_same_tetrahedron) {
  expect_tetrahedron("t.off", kOff);
  expect_tetrahedron("t.off", "# made by hand\n\nOFF # three dimensions\n\n4 4 6 # counts\n" + replaced(kVertices, "\n", "\t# v\n\n") +
                                  replaced(kFacets, "\n", " # f\n"));
  expect_tetrahedron("t.off", replaced(kOff, "\n", "\r\n"));
  expect_tetrahedron("t.off", replaced(kOff, "\n", "\r"));
  expect_tetrahedron("t.off", kOff.substr(4));                                                    // no keyword
  expect_tetrahedron("t.off", "OFF 4 4 6\n" + kVertices + kFacets);                               // on one line
  expect_tetrahedron("t.off", "OFF4 4 6\n" + kVertices + kFacets);                                // without a space
  expect_tetrahedron("t.off", "OFF\n4 4\n" + kVertices + kFacets);                                // no count of edges
  expect_tetrahedron("t.off", "OFF\n4 4 0\n" + replaced(kVertices, "\n", " ") + "\n" + kFacets);  // vertices in one line
  expect_tetrahedron("t.off", "COFF\n4 4 6\n" + replaced(kVertices, "\n", " 255 0 0 255\n") + replaced(kFacets, "\n", " 3\n"));
  expect_tetrahedron("t.off", "NOFF\n4 4 6\n" + replaced(kVertices, "\n", " 0 0 1\n") + kFacets);
  expect_tetrahedron("t.off", "STCNOFF\n4 4 6\n" + replaced(kVertices, "\n", " 0 0 1 .5 .5 .5 1 0 1\n") + kFacets);
  expect_tetrahedron("t.off", "OFF\n4 4 6\n" + replaced(kVertices, "\n", " 10 20 30\n") + replaced(kFacets, "\n", " .8 .1 .1\n"));
  expect_tetrahedron("t.off", replaced(replaced(kOff, "1 0 0", "+1. .0 -0"), "0 0 1\n", "0 0 1E0\n"));
  std::string binary = "OFF BINARY\n";
  for (std::int32_t count : {4, 4, 6}) append(binary, count, std::endian::big);
  for (const auto& p : kCorners) {
    for (double x : p) append(binary, static_cast<float>(x), std::endian::big);
  }
  for (const auto& side : kSides) {
    append(binary, std::int32_t{3}, std::endian::big);
    for (std::int32_t v : side) append(binary, v, std::endian::big);
    append(binary, std::int32_t{1}, std::endian::big);
    append(binary, 0.5F, std::endian::big);
  }
  expect_tetrahedron("t.off", binary);
  expect_refused("t.off", binary + "abcd", "4 bytes follow the last of 4 facets");
  expect_refused("t.off", binary.substr(0, binary.size() - 4), "in the middle of its data");
}

TEST(OffReader, counts_that_lie_are_refused_with_the_line) {
  expect_refused("t.off", replaced(kOff, "4 4 6", "4 5 6"), "the header promises 4 vertices and 5 facets, and 8 lines follow");
  expect_refused("t.off", replaced(kOff, "4 4 6", "4 3 6"), "line 9: data follow the last facet");
  expect_refused("t.off", replaced(kOff, "4 4 6", "5 4 6"), "the header promises 5 vertices");
  expect_refused("t.off", replaced(kOff, "4 4 6", "5 3 6"), "line 7: 4 numbers for vertex 4; expected 3");
  expect_refused("t.off", replaced(kOff, "4 4 6", "3 5 6"), "line 6: facet 0 has 0 corners");
  expect_refused("t.off", replaced(kOff, "4 4 6", "4 2000000000 6"), "more than the");
  expect_refused("t.off", replaced(kOff, "4 4 6", "-4 4 6"), "counts of at least 0");
  expect_refused("t.off", kOff.substr(0, kOff.size() - 9), "truncated");
}

TEST(OffReader, what_is_no_mesh_in_space_is_refused_with_the_line) {
  expect_refused("t.off", replaced(kOff, "3 0 2 1", "3 0 2 4"), "line 7: facet 0 names vertex 4, but there are 4 vertices");
  expect_refused("t.off", replaced(kOff, "3 0 2 1", "4 0 2 1"), "line 7: facet 0 should have 4 corners, but 3 numbers follow");
  expect_refused("t.off", replaced(kOff, "0 1 0\n0", "0 1,5 0\n0"), "line 5: '1,5' is no number; expected y");
  expect_refused("t.off", "4OFF\n1 0 0\n0 0 0 1\n", "four or more dimensions");
  expect_refused("t.off", "appearance {\n}\n" + kOff, "it begins with 'appearance'");
}

std::string ply_header(const std::string& format, const std::string& real = "float") {
  return "ply\nformat " + format + " 1.0\ncomment by hand\nelement vertex 4\nproperty uchar red\nproperty " + real + " x\nproperty " +
         real + " y\nproperty " + real +
         " z\nproperty list uchar short rings\nelement face 4\nproperty float quality\nproperty list uint8 int32 vertex_index\n"
         "element edge 1\nproperty int vertex1\nproperty int vertex2\nend_header\n";
}

template <class Real>
std::string binary_ply(std::endian order) {
  std::string bytes =
      ply_header(order == std::endian::big ? "binary_big_endian" : "binary_little_endian", sizeof(Real) == 8 ? "double" : "float");
  for (const auto& p : kCorners) {
    append(bytes, std::uint8_t{255}, order);
    for (double x : p) append(bytes, static_cast<Real>(x), order);
    append(bytes, std::uint8_t{2}, order);
    for (std::int16_t ring : {7, 8}) append(bytes, ring, order);
  }
  for (const auto& side : kSides) {
    append(bytes, 0.5F, order);
    append(bytes, std::uint8_t{3}, order);
    for (std::int32_t v : side) append(bytes, v, order);
  }
  for (std::int32_t v : {0, 1}) append(bytes, v, order);
  return bytes;
}

const std::string kPly = ply_header("ascii") + "255 0 0 0 2 7 8\n0 1 0 0 0\n0 0 1 0 1 7\n0 0 0 1 0\n" +
                         replaced("\n" + kFacets, "\n3 ", "\n0.5 3 ").substr(1) + "0 1\n";

TEST(PlyReader, every_valid_variant_gives_the_same_tetrahedron) {
  expect_tetrahedron("t.ply", kPly);
  expect_tetrahedron("t.ply", replaced(kPly, "\n", "\r\n"));
  expect_tetrahedron("t.ply", replaced(kPly, "comment by hand", "Created by a program without the word"));
  for (std::endian order : {std::endian::little, std::endian::big}) {
    expect_tetrahedron("t.ply", binary_ply<float>(order));
    expect_tetrahedron("t.ply", binary_ply<double>(order));
    expect_tetrahedron("t.ply", binary_ply<double>(order) + "\n");
  }
  // facets first, and strips, of which every second triangle runs the other way
  const std::string head = "ply\nformat ascii 1.0\n", vertices = "element vertex 4\nproperty float x\nproperty float y\nproperty float z\n";
  expect_tetrahedron("t.ply",
                     head + "element face 4\nproperty list uchar int vertex_indices\n" + vertices + "end_header\n" + kFacets + kVertices);
  expect_tetrahedron("t.ply", head + vertices + "element tristrips 1\nproperty list int int vertex_indices\nend_header\n" + kVertices +
                                  "12 0 2 1 3 -1 0 1 3 -1 0 3 2\n");
}

TEST(PlyReader, counts_that_lie_are_refused_with_line_or_byte) {
  expect_refused("t.ply", replaced(kPly, "element face 4", "element face 5"), "the file ends at line 26");
  expect_refused("t.ply", replaced(kPly, "element face 4", "element face 3"), "line 24: more numbers follow what the header promises");
  expect_refused("t.ply", replaced(kPly, "element vertex 4", "element vertex 3"),
                 "line 20: entry 1 of element face does not begin its line");
  expect_refused("t.ply", replaced(kPly, "element edge 1", "element edge 0"), "line 24: more numbers follow what the header promises");
  expect_refused("t.ply", replaced(kPly, "element vertex 4", "element vertex 2000000000"), "which need at least");
  expect_refused("t.ply", kPly.substr(0, kPly.size() - 4), "1 entries of element edge, which need at least 4 bytes");
  const std::string binary = binary_ply<double>(std::endian::little);
  expect_refused("t.ply", replaced(binary, "element face 4", "element face 3"), " bytes follow what the header promises");
  expect_refused("t.ply", replaced(binary, "element face 4", "element face 5"), "t.ply");
  expect_refused("t.ply", replaced(binary, "element vertex 4", "element vertex 5"), "t.ply");
  expect_refused("t.ply", binary.substr(0, binary.size() - 9), "truncated");
  expect_refused("t.ply", replaced(kPly, "0.5 3 0 3 2", "0.5 3 0 4 2"), "line 24: facet 3 names vertex 4");
}

std::string text_stl(const char* name = "") {
  std::string text = "solid " + std::string(name) + "\n";
  for (const auto& side : kSides) {
    text += "  facet normal 0 0 0\n    outer loop\n";
    for (int v : side) text += fmt::format("      vertex {} {} {}\n", kCorners[v][0], kCorners[v][1], kCorners[v][2]);
    text += "    endloop\n  endfacet\n";
  }
  return text + "endsolid " + name + "\n";
}

std::string binary_stl(std::uint32_t count) {
  std::string bytes = "solid of a program that writes binary files like this one";  // many do
  bytes.resize(80, ' ');
  append(bytes, count);
  for (const auto& side : kSides) {
    for (int k = 0; k < 3; ++k) append(bytes, 0.0F);
    for (int v : side) {
      for (double x : kCorners[v]) append(bytes, static_cast<float>(x));
    }
    append(bytes, std::uint16_t{0});
  }
  return bytes;
}

TEST(StlReader, text_and_binary_give_the_same_tetrahedron) {
  expect_tetrahedron("t.stl", text_stl());
  expect_tetrahedron("t.stl", text_stl("vertex of a facet"));  // a name may hold any word
  expect_tetrahedron("t.stl", replaced(replaced(text_stl("x"), "facet", "FACET"), "\n", "\r\n"));
  expect_tetrahedron("t.stl", binary_stl(4));
}

TEST(StlReader, counts_that_lie_and_broken_text_are_refused) {
  expect_refused("t.stl", binary_stl(5), "promises 5 triangles, which need 334 bytes, but the file has 284");
  expect_refused("t.stl", binary_stl(3), "promises 3 triangles, which need 234 bytes, but the file has 284");
  const MeshFile longer = read("t.stl", binary_stl(4) + std::string(7, '\0'));
  EXPECT_EQ(longer.mesh.triangle_count(), 4);
  EXPECT_EQ(longer.notes.at(0), "7 bytes after its 4 triangles are left out");
  expect_refused("t.stl", replaced(text_stl(), "      vertex 1 0 0\n    endloop", "    endloop"), "expected 'vertex'");
  expect_refused("t.stl", text_stl().substr(0, 300), "the file ends at line");
  const MeshFile cut = read("t.stl", replaced(text_stl(), "endsolid", ""));
  ASSERT_EQ(cut.notes.size(), 1U);
  EXPECT_NE(cut.notes[0].find("may be truncated"), std::string::npos);
  const MeshFile two = read("t.stl", text_stl("a") + text_stl("b"));
  EXPECT_EQ(two.mesh.triangle_count(), 8);
  EXPECT_EQ(two.notes.at(0), "2 parts of the file were joined into one mesh");
}

TEST(ObjReader, every_valid_variant_gives_the_same_tetrahedron) {
  const std::string vertices = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\n";
  const std::string facets = "f 1 3 2\nf 1 2 4\nf 2 3 4\nf 1 4 3\n";
  expect_tetrahedron("t.obj", vertices + facets);
  expect_tetrahedron("t.obj", facets + vertices);  // indices may come first
  expect_tetrahedron("t.obj", vertices + "f -4 -2 -3\nf -4 -3 -1\nf -3 -2 -1\nf -4 -1 -2\n");
  expect_tetrahedron("t.obj", vertices + "vn 0 0 1\nvt 0 0\nf 1/1/1 3/1/1 2/1/1\nf 1//1 2//1 4//1\nf 2/1 3/1 4/1\nf 1 \\\n 4 3 # end\n");
  expect_tetrahedron("t.obj", "mtllib a.mtl\ng one\n" + replaced(vertices, "\n", " 1.0 0.5 0.5 0.5\n") + "usemtl red\ns off\n" + facets);
  std::string wide = "\xfe\xff";  // UTF-16, high byte first
  for (char c : vertices + facets) wide += std::string{'\0', c};
  expect_tetrahedron("t.obj", wide);
}

TEST(ObjReader, indices_beyond_the_vertices_are_refused_and_what_is_skipped_is_reported) {
  const std::string vertices = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
  expect_refused("t.obj", vertices + "f 1 2 4\n", "line 4: a facet names vertex 4, but there are 3 vertices");
  expect_refused("t.obj", vertices + "f 1 2 -4\n", "line 4: a facet names vertex -4");
  expect_refused("t.obj", vertices + "f 1 2 -9223372036854775808\n", "line 4: a facet names vertex -9223372036854775808");
  expect_refused("t.obj", vertices + "f 1 2 9223372036854775807\n", "line 4: a facet names vertex 9223372036854775807");
  expect_refused("t.obj", vertices + "f 1 2 0\n", "line 4: a facet names vertex 0");
  expect_refused("t.obj", vertices + "v 1 2\n", "line 4: 2 numbers for a vertex");
  const MeshFile file = read("t.obj", vertices + "f 1 2 3\nl 1 2\nsurf 0 1 0 1 1 2 3 4\n");
  ASSERT_EQ(file.notes.size(), 2U);
  EXPECT_EQ(file.notes[0], "1 points and lines were left out");
  EXPECT_NE(file.notes[1].find("first 'surf' in line 6"), std::string::npos) << file.notes[1];
}

TEST(MeshReaders, keep_every_digit_of_a_double) {
  const double x = 1e6 + 0.123456789;  // in single precision a sixteenth is lost
  const std::string number = fmt::format("{}", x);
  std::string ply = ply_header("binary_little_endian", "double");
  ply = replaced(ply, "element edge 1", "element edge 0");
  std::string data;
  for (const auto& p : kCorners) {
    append(data, std::uint8_t{0});
    for (double c : p) append(data, c == 1 ? x : c);
    append(data, std::uint8_t{0});
  }
  for (const auto& side : kSides) {
    append(data, 0.0F);
    append(data, std::uint8_t{3});
    for (std::int32_t v : side) append(data, v);
  }
  for (const auto& [name, text] :
       {std::pair<std::string, std::string>("t.off", "OFF\n4 4 0\n" + replaced(kVertices, "1", number) + kFacets),
        {"t.ply", replaced(replaced(replaced(kPly, " 1 0 0 0\n", " " + number + " 0 0 0\n"), "0 0 1 0 1 7", "0 0 " + number + " 0 1 7"),
                           "0 0 0 1 0\n", "0 0 0 " + number + " 0\n")},
        {"t.ply", ply + data},
        {"t.stl", replaced(replaced(text_stl(), " 1", " " + number), "normal 0 0 0", "normal 0 0 -1")},
        {"t.obj", "v 0 0 0\nv " + number + " 0 0\nv 0 " + number + " 0\nv 0 0 " + number + "\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 1 4 3\n"}}) {
    SCOPED_TRACE(name);
    EXPECT_EQ(bounding_box(read(name, text).mesh).upper, (Vec3{x, x, x}));
  }
}

}  // namespace
}  // namespace scree
