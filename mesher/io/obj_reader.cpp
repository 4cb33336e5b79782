#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <limits>
#include <string_view>

#include "core/base/error.hpp"
#include "core/geometry/polygons.hpp"
#include "mesher/io/mesh_file.hpp"
#include "mesher/io/text_reader.hpp"

namespace scree {

namespace {

/// Statements that say nothing about where facets are.
constexpr std::array kWithoutShape{"vt",  "vn",    "s",        "usemtl",   "mtllib", "usemap", "maplib",     "mg",
                                   "lod", "bevel", "c_interp", "d_interp", "vp",     "o",      "shadow_obj", "trace_obj"};

/// Vertex index of a corner "v", "v/t", "v//n" or "v/t/n": from 1, or from -1 backwards through the vertices so far.
std::int64_t corner_index(const TextReader& text, std::string_view corner, std::size_t vertices_so_far) {
  const std::int64_t index = text.integer_of(corner.substr(0, corner.find('/')), "a vertex index");
  if (index > 0) return index - 1;
  const auto so_far = static_cast<std::int64_t>(vertices_so_far);
  if (index < 0 && index >= -so_far) return so_far + index;  // not -index <= so_far: the lowest number has no opposite
  throw InputError("{}: a facet names vertex {}, but {} vertices come before it; they are counted from 1, or backwards from -1",
                   text.place(), index, vertices_so_far);
}

}  // namespace

MeshFile parse_obj(std::vector<char> data, const std::string& path) {
  const std::string bytes = plain_text(std::move(data));
  TextReader text(bytes, path, '#', '\\');
  PolygonMesh mesh;
  std::int64_t lines_and_points = 0, unknown = 0, largest = -1, groups = 0;
  std::string first_unknown, place_of_largest;
  bool in_new_group = true;
  while (!text.at_end()) {
    const auto& words = text.rest_of_line();
    const std::string_view what = words[0];
    if (what == "v") {
      if (words.size() < 4) throw InputError("{}: {} numbers for a vertex; expected at least 3", text.place(), words.size() - 1);
      if (mesh.vertices.size() >= std::numeric_limits<std::int32_t>::max()) throw InputError("{}: too many vertices", text.place());
      mesh.vertices.push_back({text.number_of(words[1], "x"), text.number_of(words[2], "y"), text.number_of(words[3], "z")});
    } else if (what == "f" || what == "fo") {
      if (words.size() < 4) ++lines_and_points;
      for (std::size_t k = 1; k < words.size() && words.size() >= 4; ++k) {
        const std::int64_t index = corner_index(text, words[k], mesh.vertices.size());
        if (index > largest) largest = index, place_of_largest = text.place();
        mesh.corners.push_back(static_cast<std::int32_t>(std::min<std::int64_t>(index, std::numeric_limits<std::int32_t>::max())));
      }
      if (words.size() >= 4) mesh.close_facet();
      if (in_new_group) ++groups;
      in_new_group = false;
    } else if (what == "g" || what == "o") {
      in_new_group = true;
    } else if (what == "l" || what == "p") {
      ++lines_and_points;
    } else if (std::find(kWithoutShape.begin(), kWithoutShape.end(), what) == kWithoutShape.end()) {
      if (unknown++ == 0) first_unknown = fmt::format("'{}' in line {}", shown_word(what), text.line());
    }
  }
  if (largest >= static_cast<std::int64_t>(mesh.vertices.size())) {
    throw InputError(
        "{}: a facet names vertex {}, but there are {} vertices; the file is truncated or damaged: export the model "
        "again",
        place_of_largest, largest + 1, mesh.vertices.size());
  }
  MeshFile file = mesh_file_from(std::move(mesh), "OBJ", path);
  if (lines_and_points > 0) file.notes.push_back(fmt::format("{} points and lines were left out", lines_and_points));
  if (groups > 1) file.notes.push_back(fmt::format("{} parts of the file were joined into one mesh", groups));
  if (unknown > 0) {
    file.notes.push_back(fmt::format("{} of statements that are not read (curves, free surfaces) were left out, first {}",
                                     unknown == 1 ? "1 line" : fmt::format("{} lines", unknown), first_unknown));
  }
  return file;
}

}  // namespace scree
