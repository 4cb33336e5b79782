#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <map>
#include <optional>
#include <string_view>

#include "core/base/error.hpp"
#include "core/geometry/polygons.hpp"
#include "mesher/io/byte_reader.hpp"
#include "mesher/io/mesh_file.hpp"
#include "mesher/io/text_reader.hpp"

namespace scree {

namespace {

enum class Type { int8, uint8, int16, uint16, int32, uint32, float32, float64 };

const std::map<std::string_view, Type> kTypes{
    {"char", Type::int8},     {"int8", Type::int8},       {"uchar", Type::uint8},    {"uint8", Type::uint8},
    {"short", Type::int16},   {"int16", Type::int16},     {"ushort", Type::uint16},  {"uint16", Type::uint16},
    {"int", Type::int32},     {"int32", Type::int32},     {"uint", Type::uint32},    {"uint32", Type::uint32},
    {"float", Type::float32}, {"float32", Type::float32}, {"double", Type::float64}, {"float64", Type::float64}};

std::size_t bytes_of(Type type) {
  constexpr std::size_t kBytes[] = {1, 1, 2, 2, 4, 4, 4, 8};
  return kBytes[static_cast<std::size_t>(type)];
}
bool is_float(Type type) { return type == Type::float32 || type == Type::float64; }

struct Property {
  std::string name;
  Type type = Type::float32;
  std::optional<Type> count_type;  // of a list
};

struct Element {
  std::string name;
  std::int64_t count = 0;
  std::vector<Property> properties;
  const Property* find(std::string_view property) const {
    const auto it = std::find_if(properties.begin(), properties.end(), [&](const Property& p) { return p.name == property; });
    return it == properties.end() ? nullptr : &*it;
  }
};

enum class Encoding { text, little, big };

struct Header {
  Encoding encoding = Encoding::text;
  std::vector<Element> elements;
  std::size_t bytes = 0;  ///< where the data begin
  std::int64_t lines = 0;
  std::vector<std::string> notes;
};

Type type_named(std::string_view name, const std::string& place) {
  const auto it = kTypes.find(name);
  if (it == kTypes.end()) throw InputError("{}: '{}' is no type of PLY; expected char, int, float, double ...", place, shown_word(name));
  return it->second;
}

Header read_header(std::string_view bytes, const std::string& path) {
  if (!bytes.starts_with("ply")) throw InputError("{}: it cannot be read as .ply: it does not begin with 'ply'", path);
  // the first line tells how lines end: data may begin with a byte that looks like the second half of CR LF
  const std::string_view line_end = bytes.substr(3).starts_with("\r\n") ? "\r\n" : bytes.substr(3).starts_with("\r") ? "\r" : "\n";
  Header header;
  bool has_format = false;
  for (;;) {
    const std::size_t end = bytes.find(line_end, header.bytes);
    ++header.lines;
    if (end == std::string_view::npos) throw InputError("{}: the header has no 'end_header'; the file is truncated or no PLY", path);
    const std::string_view whole = bytes.substr(header.bytes, end - header.bytes);
    header.bytes = end + line_end.size();
    const std::string place = fmt::format("{}, line {}", path, header.lines);
    TextReader text(whole, path, '\0', '\0', header.lines);
    const std::vector<std::string_view> words = text.rest_of_line();
    if (words.empty() || words[0] == "ply" || words[0] == "comment" || words[0] == "obj_info") continue;
    if (words[0] == "end_header") break;
    if (words[0] == "format" && words.size() >= 2) {
      has_format = true;
      if (words[1] == "ascii")
        header.encoding = Encoding::text;
      else if (words[1] == "binary_little_endian")
        header.encoding = Encoding::little;
      else if (words[1] == "binary_big_endian")
        header.encoding = Encoding::big;
      else
        throw InputError("{}: format '{}'; expected ascii, binary_little_endian or binary_big_endian", place, shown_word(words[1]));
    } else if (words[0] == "element" && words.size() == 3) {
      const std::int64_t count = text.integer_of(words[2], "the number of its entries");
      if (count < 0 || count > std::numeric_limits<std::int32_t>::max())
        throw InputError("{}: element {} has {} entries; expected 0 to {}", place, shown_word(words[1]), count,
                         std::numeric_limits<std::int32_t>::max());
      header.elements.push_back({std::string(words[1]), count, {}});
    } else if (words[0] == "property" && !header.elements.empty() && words.size() == 3) {
      header.elements.back().properties.push_back({std::string(words[2]), type_named(words[1], place), {}});
    } else if (words[0] == "property" && !header.elements.empty() && words.size() == 5 && words[1] == "list") {
      const Type count_type = type_named(words[2], place);
      if (is_float(count_type)) throw InputError("{}: a list counts its items in {}; expected a whole type", place, words[2]);
      header.elements.back().properties.push_back({std::string(words[4]), type_named(words[3], place), count_type});
    } else if (words[0] == "format" || words[0] == "element" || words[0] == "property") {
      throw InputError("{}: '{}' is not understood; expected 'format ascii 1.0', 'element vertex 8', 'property float x' or the like", place,
                       shown_word(whole, 40));
    } else {  // some programs write remarks without the word 'comment'
      header.notes.push_back(fmt::format("line {} of the header was skipped: '{}'", header.lines, shown_word(whole, 40)));
    }
  }
  if (!has_format) throw InputError("{}: the header has no line 'format'", path);
  return header;
}

/// The values behind the header, as text or as bytes.
class Values {
 public:
  Values(std::string_view bytes, const Header& header, std::string path)
      : path_(path),
        is_text_(header.encoding == Encoding::text),
        text_(is_text_ ? bytes.substr(header.bytes) : std::string_view{}, path, '\0', '\0', header.lines + 1),
        bytes_(bytes, path, header.encoding == Encoding::big ? std::endian::big : std::endian::little, header.bytes) {}

  double number(Type type) {
    if (is_text_) return text_.number("a number");
    switch (type) {
      case Type::int8:
        return bytes_.take<std::int8_t>();
      case Type::uint8:
        return bytes_.take<std::uint8_t>();
      case Type::int16:
        return bytes_.take<std::int16_t>();
      case Type::uint16:
        return bytes_.take<std::uint16_t>();
      case Type::int32:
        return bytes_.take<std::int32_t>();
      case Type::uint32:
        return bytes_.take<std::uint32_t>();
      case Type::float32:
        return static_cast<double>(bytes_.take<float>());
      case Type::float64:
        return bytes_.take<double>();
    }
    return 0;
  }
  std::int64_t integer(Type type) { return is_text_ ? text_.integer("a whole number") : static_cast<std::int64_t>(number(type)); }

  void skip(const Property& property) {
    const std::int64_t count = property.count_type ? integer(*property.count_type) : 1;
    if (count < 0) throw InputError("{}: a list of {} items", place(), count);
    if (is_text_) {
      for (std::int64_t i = 0; i < count; ++i) text_.word("a value");
    } else {
      bytes_.skip(static_cast<std::size_t>(count) * bytes_of(property.type));
    }
  }

  void begin(const Element& element, std::int64_t entry) {
    if (!is_text_) return;
    if (text_.at_end()) {
      throw InputError(
          "{}: the header promises {} entries of element {}, but the file ends after {}; it is truncated or damaged: "
          "export the model again",
          path_, element.count, element.name, entry);
    }
    if (text_.at_line_start()) return;
    throw InputError("{}: entry {} of element {} does not begin its line: the line has more numbers than the header says", place(), entry,
                     element.name);
  }

  /// An entry takes at least two characters for each number, or its bytes.
  void expect_room(const Element& element) const {
    std::size_t least = 0;
    for (const Property& p : element.properties) least += is_text_ ? 2 : bytes_of(p.count_type ? *p.count_type : p.type);
    const std::size_t left = is_text_ ? text_.left() + 1 : bytes_.left();
    if (static_cast<std::size_t>(element.count) * least <= left) return;
    throw InputError(
        "{}: the header promises {} entries of element {}, which need at least {} bytes, but {} are left; the file is "
        "truncated or damaged: export the model again",
        path_, element.count, element.name, static_cast<std::size_t>(element.count) * least, left);
  }

  void expect_end() {
    if (is_text_ ? text_.at_end() : bytes_.is_blank_to_end()) return;
    throw InputError("{}: {} follow what the header promises; its counts are wrong or the file is damaged: export the model again", place(),
                     is_text_ ? "more numbers" : fmt::format("{} bytes", bytes_.left()));
  }

  std::string place() const { return is_text_ ? text_.place() : fmt::format("{}, byte {}", path_, bytes_.at()); }

 private:
  std::string path_;
  bool is_text_;
  TextReader text_;
  ByteReader bytes_;
};

/// The list of a facet's corners.
const Property& corners_of(const Element& element, const std::string& path) {
  for (const char* name : {"vertex_indices", "vertex_index"}) {
    if (const Property* p = element.find(name); p != nullptr && p->count_type && !is_float(p->type)) return *p;
  }
  throw InputError("{}: element {} has no 'property list uchar int vertex_indices'", path, element.name);
}

void read_vertices(Values& values, const Element& element, const std::string& path, PolygonMesh& mesh) {
  for (const char* axis : {"x", "y", "z"}) {
    if (const Property* p = element.find(axis); p == nullptr || p->count_type)
      throw InputError("{}: element vertex has no number {}; expected 'property float {}'", path, axis, axis);
  }
  for (std::int64_t v = 0; v < element.count; ++v) {
    values.begin(element, v);
    Vec3 p;
    for (const Property& property : element.properties) {
      if (property.name.size() == 1 && property.name[0] >= 'x' && property.name[0] <= 'z' && !property.count_type) {
        p[property.name[0] - 'x'] = values.number(property.type);
      } else {
        values.skip(property);
      }
    }
    mesh.vertices.push_back(p);
  }
}

/// One facet for each entry, or strips of triangles, in which -1 begins a new one.
void read_facets(Values& values, const Element& element, const std::string& path, std::int64_t vertex_count, PolygonMesh& mesh) {
  const bool are_strips = element.name == "tristrips";
  const Property& corners = corners_of(element, path);
  std::vector<std::int32_t> list;
  for (std::int64_t f = 0; f < element.count; ++f) {
    values.begin(element, f);
    for (const Property& property : element.properties) {
      if (&property != &corners) {
        values.skip(property);
        continue;
      }
      const std::int64_t count = values.integer(*property.count_type);
      if (count < 0) throw InputError("{}: facet {} has {} corners", values.place(), f, count);
      list.clear();
      for (std::int64_t k = 0; k < count; ++k) {
        const std::int64_t index = values.integer(property.type);
        if ((index < 0 && !(are_strips && index == -1)) || index >= vertex_count) {
          throw InputError("{}: {} {} names vertex {}, but there are {} vertices, counted from 0", values.place(),
                           are_strips ? "strip" : "facet", f, index, vertex_count);
        }
        list.push_back(static_cast<std::int32_t>(index));
      }
      if (!are_strips) {
        mesh.corners.insert(mesh.corners.end(), list.begin(), list.end());
        mesh.close_facet();
        continue;
      }
      for (std::size_t k = 0, place = 0; k < list.size(); ++k) {
        place = list[k] < 0 ? 0 : place + 1;
        if (place < 3 || list[k - 2] == list[k - 1] || list[k - 1] == list[k] || list[k] == list[k - 2]) continue;
        const bool is_odd = place % 2 == 1;  // every second triangle runs the other way
        for (std::size_t i : {is_odd ? k - 2 : k - 1, is_odd ? k - 1 : k - 2, k}) mesh.corners.push_back(list[i]);
        mesh.close_facet();
      }
    }
  }
}

}  // namespace

MeshFile parse_ply(std::vector<char> data, const std::string& path) {
  const std::string_view bytes(data.data(), data.size());
  const Header header = read_header(bytes, path);
  const auto vertices = std::find_if(header.elements.begin(), header.elements.end(), [](const Element& e) { return e.name == "vertex"; });
  if (vertices == header.elements.end()) throw InputError("{}: the header has no 'element vertex'", path);
  Values values(bytes, header, path);
  PolygonMesh mesh;
  std::vector<std::string> notes = header.notes;
  for (const Element& element : header.elements) {
    if (element.properties.empty()) continue;
    values.expect_room(element);
    if (&element == &*vertices) {
      read_vertices(values, element, path, mesh);
    } else if (element.name == "face" || element.name == "tristrips") {
      read_facets(values, element, path, vertices->count, mesh);
    } else {
      for (std::int64_t i = 0; i < element.count; ++i) {
        values.begin(element, i);
        for (const Property& property : element.properties) values.skip(property);
      }
      if (element.count > 0) notes.push_back(fmt::format("the {} entries of element '{}' were left out", element.count, element.name));
    }
  }
  values.expect_end();
  if (vertices->properties.empty() && vertices->count > 0) throw InputError("{}: element vertex has no properties", path);
  const char* reader = header.encoding == Encoding::text ? "PLY, text" : "PLY, binary";
  MeshFile file = mesh_file_from(std::move(mesh), reader, path);
  file.notes.insert(file.notes.end(), notes.begin(), notes.end());
  return file;
}

}  // namespace scree
