#include <fmt/format.h>

#include <algorithm>
#include <cstring>
#include <limits>
#include <string_view>

#include "core/base/error.hpp"
#include "mesher/io/byte_reader.hpp"
#include "mesher/io/mesh_file.hpp"
#include "mesher/io/text_reader.hpp"

namespace scree {

namespace {

constexpr std::size_t kHeaderBytes = 84, kTriangleBytes = 50;  // of a binary STL: 80 of text and a count; 12 float32 and 2 bytes
/// So many bytes at the start of a file tell text from binary.
constexpr std::size_t kProbe = 512;

std::string lower_case(std::string_view word) {
  std::string text(word);
  for (char& c : text) {
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  }
  return text;
}

bool is_text(std::string_view bytes) {
  return std::all_of(bytes.begin(), bytes.end(),
                     [](char c) { return c < 0 || (c >= 32 && c < 127) || (c >= 9 && c <= 13); });  // < 0: UTF-8
}

std::uint64_t promised_triangles(std::string_view bytes) {
  std::uint32_t count = 0;
  std::memcpy(&count, bytes.data() + kHeaderBytes - sizeof count, sizeof count);
  return count;
}

void add_corner(TriangleMesh& mesh, const Vec3& p) {
  if (mesh.vertices.size() % 3 == 0) {
    const std::int32_t v = mesh.vertex_count();
    mesh.triangles.push_back({v, v + 1, v + 2});
  }
  mesh.vertices.push_back(p);
}

MeshFile read_binary(std::string_view bytes, const std::string& path) {
  static_assert(std::endian::native == std::endian::little, "the count above is read as it stands");
  const std::uint64_t count = promised_triangles(bytes);
  if (count > std::numeric_limits<std::int32_t>::max() / 3)
    throw InputError("{}: {} triangles; at most {} can be read", path, count, std::numeric_limits<std::int32_t>::max() / 3);
  MeshFile file;
  file.reader = "STL, binary";
  file.mesh.vertices.reserve(3 * count);
  file.mesh.triangles.reserve(count);
  ByteReader reader(bytes, path, std::endian::little, kHeaderBytes);
  for (std::uint64_t t = 0; t < count; ++t) {
    reader.skip(3 * sizeof(float));  // the normal follows from the corners
    for (int k = 0; k < 3; ++k) {
      const float x = reader.take<float>(), y = reader.take<float>(), z = reader.take<float>();
      add_corner(file.mesh, {x, y, z});
    }
    reader.skip(2);
  }
  return file;
}

MeshFile read_text(std::string_view bytes, const std::string& path) {
  TextReader text(bytes, path, '\0');
  MeshFile file;
  file.reader = "STL, text";
  const auto expect = [&](const char* word) {
    if (const std::string_view found = text.word(word); lower_case(found) != word)
      throw InputError("{}: found '{}'; expected '{}'", text.place(), shown_word(found), word);
  };
  int solids = 0;
  bool is_open = false;  // within solid ... endsolid
  while (!text.at_end()) {
    const std::string word = lower_case(text.word("facet"));
    if (word == "solid" || word == "endsolid") {
      const bool opens = word == "solid";
      if (opens == is_open) throw InputError("{}: '{}' where {} expected", text.place(), word, is_open ? "'endsolid' is" : "'solid' is");
      is_open = opens;
      solids += opens ? 1 : 0;
      if (!text.at_line_start()) text.rest_of_line();  // its name
      continue;
    }
    if (word != "facet" || !is_open) throw InputError("{}: found '{}'; expected 'facet' in a 'solid'", text.place(), shown_word(word));
    expect("normal");
    for (int k = 0; k < 3; ++k) text.word("a component of the normal");
    expect("outer");
    expect("loop");
    for (int k = 0; k < 3; ++k) {
      expect("vertex");
      const double x = text.number("x"), y = text.number("y"), z = text.number("z");
      add_corner(file.mesh, {x, y, z});
    }
    expect("endloop");
    expect("endfacet");
    if (file.mesh.vertices.size() > static_cast<std::size_t>(std::numeric_limits<std::int32_t>::max() - 3))
      throw InputError("{}: more than {} triangles", text.place(), file.mesh.triangle_count());
  }
  if (file.mesh.triangles.empty()) throw InputError("{}: it cannot be read as .stl: it begins with 'solid', but no facet follows", path);
  if (is_open) file.notes.push_back("there is no 'endsolid' at the end of the file, so it may be truncated");
  if (solids > 1) file.notes.push_back(fmt::format("{} parts of the file were joined into one mesh", solids));
  return file;
}

}  // namespace

MeshFile parse_stl(std::vector<char> data, const std::string& path) {
  const std::string_view bytes(data.data(), data.size());
  // many binary files begin with "solid", too: the length decides first
  const std::uint64_t promised = bytes.size() < kHeaderBytes ? 0 : promised_triangles(bytes);
  const std::uint64_t needed = kHeaderBytes + kTriangleBytes * promised;
  if (bytes.size() >= kHeaderBytes && needed == bytes.size()) return read_binary(bytes, path);
  // some programs write more after the triangles; as much as whole triangles is a count that lies
  if (promised > 0 && bytes.size() > needed && (bytes.size() - needed) % kTriangleBytes != 0 && !is_text(bytes.substr(0, kProbe))) {
    MeshFile file = read_binary(bytes.substr(0, needed), path);
    file.notes.push_back(fmt::format("{} bytes after its {} triangles are left out", bytes.size() - needed, promised));
    return file;
  }
  const std::string_view probe = bytes.substr(0, kProbe);
  if (is_text(probe)) {
    const std::size_t start = probe.starts_with("\xef\xbb\xbf") ? 3 : std::min(probe.find_first_not_of(" \t\r\n"), probe.size());
    if (lower_case(bytes.substr(start, 5)) == "solid") return read_text(bytes.substr(start), path);
  } else if (bytes.size() >= kHeaderBytes) {
    throw InputError(
        "{}: it cannot be read as .stl: as a binary STL its header promises {} triangles, which need {} bytes, but the "
        "file has {}; it is truncated or damaged: export the model again",
        path, promised, needed, bytes.size());
  }
  throw InputError(
      "{}: it cannot be read as .stl: it is no STL; a binary one has 84 bytes of header, a text one begins with 'solid' "
      "and has facets",
      path);
}

}  // namespace scree
