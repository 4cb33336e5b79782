#include "mesher/fracture/fracture.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>

#include "core/base/error.hpp"
#include "core/base/index.hpp"
#include "core/placing/random_numbers.hpp"
#include "mesher/check/mesh_check.hpp"
#include "mesher/fracture/cut_faces.hpp"
#include "mesher/fracture/cut_mesh.hpp"
#include "mesher/repair/mesh_repair.hpp"
#include "mesher/repair/winding_field.hpp"

namespace scree {

namespace {

/// Cuts that are tried with generators moved by a few parts of Generators::kGrid, before the body is refused. One is enough for points
/// at random; two for points that a user has laid in a pattern, whose planes meet in more than they should.
constexpr std::uint64_t kMaxAttempts = 8;
/// By how much generators are moved then, as part of the body's extent: far above the grid, far below the size of a cell.
constexpr double kNudge = 1e-5;
/// Rounds in which generators of slivers are drawn again.
constexpr std::uint64_t kMaxRounds = 30;
/// Rounds in which generators move to the centres of their cells (S. Lloyd, Least squares quantization in PCM, IEEE Trans. Inf. Theory 28
/// (1982) 129): after eight, volumes of cells differ by a tenth, and more hardly helps.
constexpr int kEvenRounds = 8;
/// Draws in the bounding box for a point in the body: enough for bodies that fill a thousandth of their box.
constexpr std::uint64_t kMaxDraws = 20'000;

/// Smallest power of two above all coordinates of the mesh.
double unit_of(const TriangleMesh& mesh) {
  double largest = 0;
  for (const Vec3& p : mesh.vertices) largest = std::max({largest, std::abs(p.x), std::abs(p.y), std::abs(p.z)});
  return std::ldexp(1.0, std::ilogb(largest) + 1);
}

class PointsInside {
 public:
  PointsInside(const Shape& body, const FractureForm& form) : body_(body), form_(form), field_(body.mesh), box_(bounding_box(body.mesh)) {}

  /// Draws the point of generator `index`; `round` counts how often before.
  Vec3 draw(std::int32_t index, std::uint64_t round) const {
    const RandomNumbers random(form_.seed, index, round);
    const Vec3 e = box_.extent();
    for (std::uint64_t draw = 0; draw < kMaxDraws; ++draw) {
      const Vec3 p =
          box_.lower + Vec3{e.x * random.uniform(3 * draw), e.y * random.uniform(3 * draw + 1), e.z * random.uniform(3 * draw + 2)};
      if (is_inside(p)) return p;
    }
    throw InputError("'{}': of {} points in the box around it none lies inside: it is too thin to be cut at random places", body_.name,
                     kMaxDraws);
  }

  bool is_inside(const Vec3& p) const { return field_.at(p) > 0.5; }

 private:
  const Shape& body_;
  const FractureForm& form_;
  WindingField field_;
  Box3 box_;
};

/// The closed surface of a cell, and for each triangle the face that it belongs to (-1: the body's surface).
struct CellSurface {
  std::vector<Triangle> triangles;
  std::vector<std::int32_t> face;
};

std::vector<CellSurface> surfaces_of(const CutMesh& cut) {
  std::vector<CellSurface> cells(cut.skin.size());
  for (std::size_t i = 0; i < cells.size(); ++i) {
    cells[i].triangles = cut.skin[i];
    cells[i].face.assign(cut.skin[i].size(), -1);
  }
  for (std::size_t f = 0; f < cut.faces.size(); ++f) {
    for (const Triangle& t : cut.faces[f].triangles) {
      CellSurface &a = cells[at(cut.faces[f].cell_a)], &b = cells[at(cut.faces[f].cell_b)];
      a.triangles.push_back(t);
      b.triangles.push_back({t[0], t[2], t[1]});
      a.face.push_back(static_cast<std::int32_t>(f));
      b.face.push_back(static_cast<std::int32_t>(f));
    }
  }
  return cells;
}

/// A mesh of its own from triangles of many vertices.
TriangleMesh extracted(const std::vector<Vec3>& vertices, const std::vector<Triangle>& triangles) {
  TriangleMesh mesh;
  std::map<std::int32_t, std::int32_t> index;
  for (const Triangle& t : triangles) {
    Triangle own{};
    for (std::size_t k = 0; k < 3; ++k) {
      const auto [it, is_new] = index.try_emplace(t[k], mesh.vertex_count());
      if (is_new) mesh.vertices.push_back(vertices[at(t[k])]);
      own[k] = it->second;
    }
    mesh.triangles.push_back(own);
  }
  return mesh;
}

/// Joins the components of a cell's surface into pieces: a component that faces inwards is a cavity of the smallest one around it.
/// Gives the piece of each component, numbered from 0, or -1 for a cavity whose piece is not known (a mesh that is no solid).
std::vector<std::int32_t> pieces_of(const TriangleMesh& mesh, const std::vector<std::int32_t>& component, std::int32_t count,
                                    std::int32_t& piece_count) {
  std::vector<std::vector<std::int32_t>> triangles(at(count));
  for (std::size_t t = 0; t < component.size(); ++t) triangles[at(component[t])].push_back(static_cast<std::int32_t>(t));
  std::vector<double> volume;
  for (const std::vector<std::int32_t>& part : triangles) {
    TriangleMesh own;
    own.vertices = mesh.vertices;
    for (std::int32_t t : part) own.triangles.push_back(mesh.triangles[at(t)]);
    volume.push_back(mass_properties(own).volume);
  }
  std::vector<std::int32_t> piece(at(count), -1);
  piece_count = 0;
  for (std::size_t c = 0; c < piece.size(); ++c) {
    if (volume[c] > 0) piece[c] = piece_count++;
  }
  for (std::size_t c = 0; c < piece.size(); ++c) {
    if (volume[c] > 0) continue;
    const Vec3& inside = mesh.corner(triangles[c][0], 0);
    double smallest = std::numeric_limits<double>::infinity();
    for (std::size_t o = 0; o < piece.size(); ++o) {
      if (volume[o] > 0 && volume[o] < smallest && winding_number(mesh, triangles[o], inside) > 0.5)
        smallest = volume[o], piece[c] = piece[o];
    }
  }
  return piece;
}

/// Pieces and faces of a cut; throws DegenerateCut when rounding has left a piece that is no solid.
Fracture assembled(const Shape& body, const CutMesh& cut, const Generators& generators, double unit) {
  Fracture result;
  std::vector<std::array<std::int32_t, 2>> piece_of_face(cut.faces.size(), {-1, -1});
  const std::vector<CellSurface> cells = surfaces_of(cut);
  double smallest = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < cells.size(); ++i) {
    std::int32_t count = 0, piece_count = 0;
    const TriangleMesh surface = extracted(cut.vertices, cells[i].triangles);
    const std::vector<std::int32_t> component = find_components(surface, count);
    const std::vector<std::int32_t> piece = pieces_of(surface, component, count, piece_count);
    const auto first = static_cast<std::int32_t>(result.pieces.size());
    double cell_volume = 0;
    for (std::int32_t p = 0; p < piece_count; ++p) {
      std::vector<Triangle> own;
      for (std::size_t t = 0; t < component.size(); ++t) {
        if (piece[at(component[t])] == p) own.push_back(surface.triangles[t]);
      }
      TriangleMesh mesh = extracted(surface.vertices, own);
      clean_mesh(mesh, false);
      const MeshCheck check = check_mesh(mesh);
      if (!check.is_solid()) throw DegenerateCut();
      result.pieces.push_back(make_solid(fmt::format("{}_{}", body.name, result.pieces.size() + 1), std::move(mesh)));
      result.pieces.back().verdict = json_of(check);
      result.cell_of.push_back(static_cast<std::int32_t>(i));
      cell_volume += result.pieces.back().mass.volume;
    }
    smallest = std::min(smallest, cell_volume);
    for (std::size_t t = 0; t < component.size(); ++t) {
      const std::int32_t f = cells[i].face[t], p = piece[at(component[t])];
      if (p < 0) throw DegenerateCut();
      if (f >= 0) piece_of_face[at(f)][cut.faces[at(f)].cell_a == static_cast<std::int32_t>(i) ? 0 : 1] = first + p;
    }
  }
  result.smallest_cell = smallest;
  result.table.body = body.name;
  result.table.volume = body.mass.volume;
  TriangleMesh& drawn = result.table.face_mesh;
  std::vector<Triangle> all;
  for (std::size_t f = 0; f < cut.faces.size(); ++f) {
    const CutFace& face = cut.faces[f];
    const Vec3 between = generators.points()[at(face.cell_b)] - generators.points()[at(face.cell_a)];
    SharedFace shared = face_measures(face.loops, cut.vertices, normalised(between));
    shared.piece_a = piece_of_face[f][0];
    shared.piece_b = piece_of_face[f][1];
    shared.height = unit * length(between);
    result.table.faces.push_back(shared);
    for (const Triangle& t : face.triangles) {
      all.push_back(t);
      result.table.face_of.push_back(static_cast<std::int32_t>(f));
    }
  }
  drawn = extracted(cut.vertices, all);
  for (const Vec3& g : generators.points()) result.generators.push_back(unit * g);
  return result;
}

/// Moves each point to the centre of mass of its cell, where that lies in the body.
void move_to_centres(const Fracture& cut, const PointsInside& inside, std::vector<Vec3>& points) {
  std::vector<Vec3> moment(points.size());
  std::vector<double> volume(points.size(), 0);
  for (std::size_t p = 0; p < cut.pieces.size(); ++p) {
    const std::size_t cell = at(cut.cell_of[p]);
    moment[cell] += cut.pieces[p].mass.volume * cut.pieces[p].origin_shift;
    volume[cell] += cut.pieces[p].mass.volume;
  }
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (!(volume[i] > 0)) continue;
    const Vec3 centre = (1 / volume[i]) * moment[i];
    if (inside.is_inside(centre)) points[i] = centre;
  }
}

/// What of a piece lies `inset` behind the planes of its shared faces: its part in the cell of its own centre among the mirror images of
/// that centre in these planes.
TriangleMesh moved_inwards(const Fracture& cut, std::int32_t piece, double inset) {
  const Shape& shape = cut.pieces[at(piece)];
  const double unit = unit_of(shape.mesh);
  std::map<std::int32_t, Vec3> mirrored;  // by cell: several faces towards one cell lie in one plane
  for (const SharedFace& face : cut.table.faces) {
    if (face.piece_a != piece && face.piece_b != piece) continue;
    const Vec3 outward = face.piece_a == piece ? face.normal : -face.normal;
    const double distance = dot(outward, face.centroid - shape.origin_shift);
    if (!(distance > inset)) {
      throw InputError(
          "'{}': its centre is {:.3g} m from a shared face, and faces should be moved inwards by {:.3g} m: ask for fewer cells, "
          "--evenly, or a smaller --inset",
          shape.name, distance, inset);
    }
    mirrored[cut.cell_of[at(face.piece_a == piece ? face.piece_b : face.piece_a)]] = (2 / unit) * (distance - inset) * outward;
  }
  if (mirrored.empty()) return shape.mesh;
  for (std::uint64_t attempt = 0; attempt < kMaxAttempts; ++attempt) {
    std::vector<Vec3> points{Vec3{}};
    for (const auto& [cell, point] : mirrored) {
      // Rounding to the grid and the nudge move and tilt the plane: within the piece, whose extent is 1, by as much as this. Faces end up
      // that further inside than requested.
      const double size = length(point), nudge = attempt == 0 ? 0 : kNudge, slack = (Generators::kGrid + nudge * size) * (1 + 2 / size);
      points.push_back((1 - slack / size) * point);
      const RandomNumbers random(attempt, cell, 1);
      for (int k = 0; attempt > 0 && k < 3; ++k) points.back()[k] += nudge * size * (random.uniform(static_cast<std::uint64_t>(k)) - 0.5);
    }
    try {
      const CutMesh part = cut_mesh(shape.mesh, unit, Generators(std::move(points)));
      std::vector<Triangle> own = part.skin[0];
      for (const CutFace& face : part.faces) {
        if (face.cell_a == 0) own.insert(own.end(), face.triangles.begin(), face.triangles.end());
      }
      TriangleMesh mesh = extracted(part.vertices, own);
      clean_mesh(mesh, false);
      if (check_mesh(mesh).is_solid()) return mesh;
    } catch (const DegenerateCut&) {
    }
  }
  throw InputError("'{}': nothing solid is left of it behind faces moved inwards by {:.3g} m; ask for a smaller --inset or fewer cells",
                   shape.name, inset);
}

/// Moves the shared faces of all meshes inwards.
Fracture with_inset(Fracture cut, double inset) {
  if (!(inset > 0)) return cut;
  std::vector<TriangleMesh> meshes;
  for (std::size_t p = 0; p < cut.pieces.size(); ++p) meshes.push_back(moved_inwards(cut, static_cast<std::int32_t>(p), inset));
  for (std::size_t p = 0; p < meshes.size(); ++p) {
    Shape& shape = cut.pieces[p];
    shape.mesh = std::move(meshes[p]);
    shape.area = surface_area(shape.mesh);
    shape.verdict = json_of(check_mesh(shape.mesh));
  }
  cut.table.inset = inset;
  return cut;
}

/// Volume of each cell.
std::vector<double> cell_volumes(const Fracture& cut, std::size_t cells) {
  std::vector<double> volume(cells, 0);
  for (std::size_t p = 0; p < cut.pieces.size(); ++p) volume[at(cut.cell_of[p])] += cut.pieces[p].mass.volume;
  return volume;
}

/// Cuts with these points, moved a little where a plane passes through a vertex.
Fracture cut_at(const Shape& body, const FractureForm& form, const std::vector<Vec3>& points, double unit) {
  for (std::uint64_t attempt = 0; attempt < kMaxAttempts; ++attempt) {
    std::vector<Vec3> moved;
    for (std::size_t i = 0; i < points.size(); ++i) {
      Vec3 p = (1 / unit) * points[i];
      const RandomNumbers random(form.seed, static_cast<std::int64_t>(i), attempt);
      for (int k = 0; attempt > 0 && k < 3; ++k) p[k] += kNudge * (random.uniform(static_cast<std::uint64_t>(k)) - 0.5);
      moved.push_back(p);
    }
    try {
      const Generators generators(std::move(moved));
      Fracture result = assembled(body, cut_mesh(body.mesh, unit, generators), generators, unit);
      result.attempts = static_cast<std::int32_t>(attempt) + 1;
      return result;
    } catch (const DegenerateCut&) {
    }
  }
  throw InputError(
      "'{}': {} cuts into {} cells have each passed through a vertex or left a piece that is no solid; try another --seed, or simplify the "
      "mesh "
      "({} triangles)",
      body.name, kMaxAttempts, points.size(), body.mesh.triangle_count());
}

}  // namespace

Fracture fracture(const Shape& body, const FractureForm& form) {
  const double unit = unit_of(body.mesh);
  if (!form.generators.empty()) return with_inset(cut_at(body, form, form.generators, unit), form.inset);
  const PointsInside inside(body, form);
  std::vector<Vec3> points;
  for (std::int32_t i = 0; i < form.cells; ++i) points.push_back(inside.draw(i, 0));
  for (int round = 0; form.evenly && round < kEvenRounds; ++round) move_to_centres(cut_at(body, form, points, unit), inside, points);
  std::int32_t redrawn = 0;
  for (std::uint64_t round = 1; round <= kMaxRounds; ++round) {
    Fracture result = cut_at(body, form, points, unit);
    result.redrawn = redrawn;
    const std::vector<double> volume = cell_volumes(result, points.size());
    const double least = kSliverCell * body.mass.volume / form.cells;
    bool has_sliver = false;
    for (std::size_t i = 0; i < points.size(); ++i) {
      if (volume[i] >= least) continue;
      points[i] = inside.draw(static_cast<std::int32_t>(i), round);
      has_sliver = true;
      ++redrawn;
    }
    if (!has_sliver) return with_inset(std::move(result), form.inset);
  }
  throw InputError(
      "'{}': after {} rounds some of {} cells still have less than {:g} of the mean volume; the body does not hold that many: ask for "
      "fewer "
      "cells, or --evenly",
      body.name, kMaxRounds, form.cells, kSliverCell);
}

}  // namespace scree
