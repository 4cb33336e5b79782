#include "core/storage/piece_table.hpp"

#include <cmath>

namespace scree {

void write_piece_table(const h5::Group& group, const PieceTable& table) {
  group.write_attribute("body", table.body);
  group.write_attribute("volume", table.volume);
  group.write_attribute("inset", table.inset);
  std::vector<std::int32_t> pieces, corners;
  std::vector<Vec3> centroid, normal, axis;
  std::vector<double> area, moments, height, rim;
  for (const SharedFace& f : table.faces) {
    pieces.insert(pieces.end(), {f.piece_a, f.piece_b});
    area.push_back(f.area);
    centroid.push_back(f.centroid);
    normal.push_back(f.normal);
    axis.push_back(f.axis);
    moments.insert(moments.end(), {f.moment_1, f.moment_2});
    height.push_back(f.height);
    rim.push_back(f.rim_radius);
  }
  for (const Triangle& t : table.face_mesh.triangles) corners.insert(corners.end(), t.begin(), t.end());
  group.write_array("pieces", pieces, 2, "");
  group.write_array("area", area, 1, "m^2");
  group.write_array("centroid", centroid, "m");
  group.write_array("normal", normal, "");
  group.write_array("axis", axis, "");
  group.write_array("second_moments", moments, 2, "m^4");
  group.write_array("height", height, 1, "m");
  group.write_array("rim_radius", rim, 1, "m");
  group.write_array("vertices", table.face_mesh.vertices, "m");
  group.write_array("triangles", corners, 3, "");
  group.write_array("face_of_triangle", table.face_of, 1, "");
}

PieceTable read_piece_table(const h5::Group& group, std::int64_t piece_count) {
  PieceTable table;
  table.body = group.read_text_attribute("body");
  table.volume = group.read_double_attribute("volume");
  table.inset = group.read_double_attribute("inset");
  const auto pieces = group.read_array<std::int32_t>("pieces", 2);
  const std::size_t n = pieces.size() / 2;
  const auto expect = [&](const char* name, std::size_t found, std::size_t expected) {
    if (found != expected) throw InputError("{}/{}: {} rows found, {} expected", group.path(), name, found, expected);
  };
  const auto numbers = [&](const char* name, std::int64_t columns) {
    std::vector<double> values = group.read_array<double>(name, columns);
    expect(name, values.size() / static_cast<std::size_t>(columns), n);
    return values;
  };
  const auto vectors = [&](const char* name) {
    std::vector<Vec3> values = group.read_vectors(name);
    expect(name, values.size(), n);
    return values;
  };
  const std::vector<double> area = numbers("area", 1), moments = numbers("second_moments", 2), height = numbers("height", 1),
                            rim = numbers("rim_radius", 1);
  const std::vector<Vec3> centroid = vectors("centroid"), normal = vectors("normal"), axis = vectors("axis");
  for (std::size_t i = 0; i < n; ++i) {
    const SharedFace f{pieces[2 * i],  pieces[2 * i + 1],  area[i],   centroid[i], normal[i], axis[i],
                       moments[2 * i], moments[2 * i + 1], height[i], rim[i]};
    if (f.piece_a < 0 || f.piece_a >= piece_count || f.piece_b < 0 || f.piece_b >= piece_count || f.piece_a == f.piece_b) {
      throw InputError("{}/pieces: face {} joins pieces {} and {}, but there are {} pieces, counted from 0", group.path(), i, f.piece_a,
                       f.piece_b, piece_count);
    }
    const bool is_face = f.area > 0 && f.height > 0 && f.moment_1 > 0 && f.moment_2 > 0 && f.rim_radius > 0 && is_finite(f.centroid) &&
                         std::abs(dot(f.normal, f.normal) - 1) < 1e-6 && std::abs(dot(f.axis, f.axis) - 1) < 1e-6 &&
                         std::abs(dot(f.axis, f.normal)) < 1e-6 &&
                         std::isfinite(f.area + f.height + f.moment_1 + f.moment_2 + f.rim_radius);
    if (!is_face) {
      throw InputError(
          "{}: face {} of area {:g}, height {:g} and second moments {:g}, {:g} is none; cut the body again with scree-mesher "
          "fracture",
          group.path(), i, f.area, f.height, f.moment_1, f.moment_2);
    }
    table.faces.push_back(f);
  }
  table.face_mesh.vertices = group.read_vectors("vertices");
  const auto corners = group.read_array<std::int32_t>("triangles", 3);
  table.face_of = group.read_array<std::int32_t>("face_of_triangle", 1);
  expect("face_of_triangle", table.face_of.size(), corners.size() / 3);
  for (std::size_t t = 0; t + 2 < corners.size(); t += 3) {
    for (std::size_t k = 0; k < 3; ++k) {
      if (corners[t + k] < 0 || corners[t + k] >= table.face_mesh.vertex_count())
        throw InputError("{}/triangles: triangle {} names vertex {}, but there are {}", group.path(), t / 3, corners[t + k],
                         table.face_mesh.vertex_count());
    }
    table.face_mesh.triangles.push_back({corners[t], corners[t + 1], corners[t + 2]});
  }
  for (std::int32_t f : table.face_of) {
    if (f < 0 || f >= static_cast<std::int32_t>(n)) throw InputError("{}/face_of_triangle: {} names none of {} faces", group.path(), f, n);
  }
  return table;
}

}  // namespace scree
