#include <fmt/format.h>

#include <limits>
#include <string_view>

#include "core/base/error.hpp"
#include "core/geometry/polygons.hpp"
#include "mesher/io/byte_reader.hpp"
#include "mesher/io/mesh_file.hpp"
#include "mesher/io/text_reader.hpp"

namespace scree {

namespace {

constexpr std::int64_t kMaxIndices = std::numeric_limits<std::int32_t>::max();

/// What stands before the first vertex: [ST][C][N][4][n]OFF [BINARY], then three counts, of which that of the edges has no meaning.
struct OffHeader {
  bool has_texture = false, has_colour = false, has_normal = false, is_binary = false;
  std::int64_t vertex_count = 0, facet_count = 0;

  /// Numbers of a vertex where they are not told apart by lines.
  int numbers_of_a_vertex() const { return 3 + (has_normal ? 3 : 0) + (has_colour ? 4 : 0) + (has_texture ? 2 : 0); }
};

/// Reads the keyword; what follows it in the same word ("OFF490", as one collection of models has it) is left in `word`.
OffHeader read_keyword(std::string_view& word, const std::string& place) {
  OffHeader header;
  const std::string_view keyword = word;
  const auto takes = [&](std::string_view prefix) {
    if (!word.starts_with(prefix)) return false;
    word.remove_prefix(prefix.size());
    return true;
  };
  while (!takes("OFF")) {
    if (takes("ST")) {
      header.has_texture = true;
    } else if (takes("C")) {
      header.has_colour = true;
    } else if (takes("N")) {
      header.has_normal = true;
    } else if (word.starts_with("4") || word.starts_with("n")) {
      throw InputError("{}: '{}' has vertices in four or more dimensions; expected OFF, of three", place, keyword);
    } else {
      throw InputError("{}: it cannot be read as .off: it begins with '{}'; expected OFF, or COFF, NOFF, STOFF", place,
                       shown_word(keyword));
    }
  }
  return header;
}

void expect_counts(const OffHeader& header, std::size_t bytes_left, std::size_t least_vertex, std::size_t least_facet,
                   const std::string& place) {
  const std::int64_t v = header.vertex_count, f = header.facet_count;
  if (v < 0 || f < 0) throw InputError("{}: {} vertices and {} facets; expected counts of at least 0", place, v, f);
  const bool fits = v <= kMaxIndices && f <= kMaxIndices &&
                    static_cast<std::size_t>(v) * least_vertex + static_cast<std::size_t>(f) * least_facet <= bytes_left + 1;
  if (fits) return;
  throw InputError(
      "{}: the header promises {} vertices and {} facets, more than the {} bytes after it can hold; the file is "
      "truncated or damaged: export the model again",
      place, v, f, bytes_left);
}

std::int32_t expect_index(std::int64_t index, std::int64_t vertex_count, std::int64_t facet, const std::string& place) {
  if (index >= 0 && index < vertex_count) return static_cast<std::int32_t>(index);
  throw InputError("{}: facet {} names vertex {}, but there are {} vertices, counted from 0", place, facet, index, vertex_count);
}

/// One vertex and one facet a line; what follows the coordinates and the corners is colours and the like.
PolygonMesh read_lines(TextReader text, const OffHeader& header) {
  PolygonMesh mesh;
  std::size_t fields_of_first = 0;
  for (std::int64_t v = 0; v < header.vertex_count; ++v) {
    const auto& fields = text.rest_of_line();
    if (v == 0) fields_of_first = fields.size();
    // colours may have three or four components, and no line but theirs
    if (fields.size() < 3 || (fields.size() != fields_of_first && !header.has_colour)) {
      throw InputError("{}: {} numbers for vertex {}; expected {}", text.place(), fields.size(), v,
                       std::max<std::size_t>(fields_of_first, 3));
    }
    mesh.vertices.push_back({text.number_of(fields[0], "x"), text.number_of(fields[1], "y"), text.number_of(fields[2], "z")});
  }
  for (std::int64_t f = 0; f < header.facet_count; ++f) {
    const auto& fields = text.rest_of_line();
    const std::int64_t corners = text.integer_of(fields.at(0), "the number of vertices of a facet");
    if (corners < 1) throw InputError("{}: facet {} has {} corners", text.place(), f, corners);
    if (corners >= static_cast<std::int64_t>(fields.size())) {
      throw InputError("{}: facet {} should have {} corners, but {} numbers follow in its line", text.place(), f, corners,
                       fields.size() - 1);
    }
    for (std::size_t k = 1; k <= static_cast<std::size_t>(corners); ++k) {
      mesh.corners.push_back(expect_index(text.integer_of(fields[k], "a vertex index"), header.vertex_count, f, text.place()));
    }
    mesh.close_facet();
  }
  return mesh;
}

/// Vertices anywhere, as the format allows; a facet begins a line, and its colour lasts to the end of the line.
PolygonMesh read_words(TextReader text, const OffHeader& header) {
  PolygonMesh mesh;
  for (std::int64_t v = 0; v < header.vertex_count; ++v) {
    const double x = text.number("x"), y = text.number("y"), z = text.number("z");
    mesh.vertices.push_back({x, y, z});
    for (int k = 3; k < header.numbers_of_a_vertex(); ++k) text.number("a normal, colour or texture coordinate");
  }
  for (std::int64_t f = 0; f < header.facet_count; ++f) {
    if (!text.at_line_start()) throw InputError("{}: facet {} does not begin its line", text.place(), f);
    const std::int64_t corners = text.integer("the number of vertices of a facet");
    if (corners < 1) throw InputError("{}: facet {} has {} corners", text.place(), f, corners);
    for (std::int64_t k = 0; k < corners; ++k) {
      mesh.corners.push_back(expect_index(text.integer("a vertex index"), header.vertex_count, f, text.place()));
    }
    mesh.close_facet();
    if (!text.at_line_start()) text.rest_of_line();
  }
  if (!text.at_end()) throw InputError("{}: data follow the last facet", text.place());
  return mesh;
}

PolygonMesh read_text(TextReader text, const OffHeader& header) {
  TextReader ahead = text;
  std::int64_t lines = 0;
  for (; !ahead.at_end(); ++lines) ahead.rest_of_line();
  if (lines == header.vertex_count + header.facet_count) return read_lines(text, header);
  try {
    return read_words(text, header);
  } catch (const InputError& error) {
    throw InputError(
        "{}; the header promises {} vertices and {} facets, and {} lines follow it: the file is truncated or damaged, "
        "export the model again",
        error.what(), header.vertex_count, header.facet_count, lines);
  }
}

/// Big-endian: three int32 counts; float32 for the vertices; for each facet int32 corners, indices and number of colour components,
/// then float32 components.
PolygonMesh read_binary(std::string_view bytes, OffHeader header, std::size_t start, const std::string& path) {
  ByteReader reader(bytes, path, std::endian::big, start);
  header.vertex_count = reader.take<std::int32_t>();
  header.facet_count = reader.take<std::int32_t>();
  reader.skip(sizeof(std::int32_t));
  const auto place = [&] { return fmt::format("{}, byte {}", path, reader.at()); };
  const auto vertex_bytes = sizeof(float) * static_cast<std::size_t>(header.numbers_of_a_vertex());
  expect_counts(header, reader.left(), vertex_bytes, 2 * sizeof(std::int32_t), place());
  PolygonMesh mesh;
  for (std::int64_t v = 0; v < header.vertex_count; ++v) {
    const float x = reader.take<float>(), y = reader.take<float>(), z = reader.take<float>();
    mesh.vertices.push_back({x, y, z});
    reader.skip(vertex_bytes - 3 * sizeof(float));
  }
  for (std::int64_t f = 0; f < header.facet_count; ++f) {
    const auto corners = reader.take<std::int32_t>();
    if (corners < 1) throw InputError("{}: facet {} has {} corners", place(), f, corners);
    for (std::int32_t k = 0; k < corners; ++k)
      mesh.corners.push_back(expect_index(reader.take<std::int32_t>(), header.vertex_count, f, place()));
    const auto colours = reader.take<std::int32_t>();
    if (colours < 0) throw InputError("{}: facet {} has {} colour components", place(), f, colours);
    reader.skip(sizeof(float) * static_cast<std::size_t>(colours));
    mesh.close_facet();
  }
  if (!reader.is_blank_to_end()) {
    throw InputError(
        "{}: {} bytes follow the last of {} facets that the header promises; the file is damaged: export the model "
        "again",
        place(), reader.left(), header.facet_count);
  }
  return mesh;
}

}  // namespace

MeshFile parse_off(std::vector<char> data, const std::string& path) {
  const std::string_view raw(data.data(), data.size());
  // a binary file is text up to the end of its first line
  const std::size_t first_end = raw.find('\n');
  if (const std::string_view first = raw.substr(0, first_end); first_end != std::string_view::npos && first.ends_with("OFF BINARY")) {
    std::string_view keyword = first.substr(0, first.size() - std::string_view(" BINARY").size());
    const OffHeader header = read_keyword(keyword, path);
    return mesh_file_from(read_binary(raw, header, first_end + 1, path), "OFF", path);
  }
  const std::string bytes = plain_text(std::move(data));
  TextReader text(bytes, path, '#');
  std::string_view word = text.word("OFF");
  const bool has_keyword = word.find_first_not_of("0123456789") != std::string_view::npos;  // the format lets it be left out
  OffHeader header = has_keyword ? read_keyword(word, text.place()) : OffHeader{};
  if (has_keyword && word.empty()) word = text.word("the number of vertices");
  header.vertex_count = text.integer_of(word, "the number of vertices");
  header.facet_count = text.integer("the number of facets");
  if (!text.at_line_start()) {  // that of the edges, which is often 0
    if (const auto& rest = text.rest_of_line(); rest.size() > 1)
      throw InputError("{}: {} numbers follow the number of facets; expected that of the edges only", text.place(), rest.size());
  } else if (TextReader ahead = text; ahead.rest_of_line().size() == 1) {
    text.rest_of_line();
  }
  // the shortest vertex is "0 0 0" and the shortest facet "1 0", each with the end of its line
  expect_counts(header, text.left(), 6, 4, text.place());
  return mesh_file_from(read_text(text, header), "OFF", path);
}

}  // namespace scree
