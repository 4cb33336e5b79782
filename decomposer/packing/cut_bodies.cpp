#include "decomposer/packing/cut_bodies.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>

#include "core/base/error.hpp"
#include "core/base/units.hpp"
#include "core/placing/random_numbers.hpp"
#include "decomposer/packing/child_tool.hpp"
#include "decomposer/packing/faces_between.hpp"

namespace scree {

namespace {

/// Volumes of a body and of the body that its pieces were cut from are the same within this part: files hold the same doubles.
constexpr double kSameVolume = 1e-9;
/// By as much may an inset fall short of the margin: rounding of both.
constexpr double kInsetRounding = 1e-9;
/// Of a body's radius: faces that are so near touch, since places and meshes are written down rounded.
constexpr double kTouchingFaces = 1e-6;
/// A face of less than this part of the largest face of both of its pieces holds nothing and carries no bond: cells that meet in a corner
/// by chance have such faces.
constexpr double kMinFace = 1e-6;

std::int32_t index_in_case(const SceneParts& parts, std::int32_t scene_shape) {
  for (std::size_t i = 0; i < parts.scene_shape.size(); ++i) {
    if (parts.scene_shape[i] == scene_shape) return static_cast<std::int32_t>(i);
  }
  return -1;
}

/// Axes of a face's bond to those of the body: x normal, y its axis.
Quat frame_of(const SharedFace& face) {
  const Vec3 z = cross(face.normal, face.axis);
  // columns are the axes
  return normalised(quaternion_of(transpose(Mat3{{face.normal, face.axis, z}})));
}

class Cutter {
 public:
  Cutter(const Case& c, const SceneParts& parts, const PieceFiles& pieces, Scene& scene, PackingReport& report)
      : case_(c), parts_(parts), pieces_(pieces), scene_(scene), report_(report) {
    for (const std::int64_t id : scene.bodies.id) next_id_ = std::max(next_id_, id + 1);
    for (const Wall& wall : scene.walls) next_id_ = std::max(next_id_, wall.id + 1);
    first_piece_ = next_id_;
  }

  void run() {
    const BodyTable whole = std::exchange(scene_.bodies, {});
    std::vector<BodyRow> cut_rows;
    for (std::size_t b = 0; b < whole.size(); ++b) {
      const BodyRow row = whole.row(b);
      const std::int32_t shape = index_in_case(parts_, row.shape);
      if (shape < 0 || !pieces_.contains(static_cast<std::size_t>(shape))) {
        scene_.bodies.add(row);
        continue;
      }
      cut_rows.push_back(row);
    }
    for (const BodyRow& row : cut_rows) add_pieces(row, static_cast<std::size_t>(index_in_case(parts_, row.shape)));
    for (const CaseBond& between : case_.bonds) {
      if (between.between_a >= 0) bond_faces(between);
    }
    for (const CaseBond& within : case_.bonds) {
      if (within.material < 0 || held_.contains(within.material)) continue;
      const std::string& name = case_.materials[static_cast<std::size_t>(within.material)].name;
      report_.notices.push_back(fmt::format(
          "{}.within = \"{}\": no body of that material starts as pieces, so that these bonds hold nothing; give the shape pieces, for "
          "instance pieces = {{ cells = 20 }}, or bond bodies that lie face to face with between = [\"{}\", \"{}\"]",
          within.where, name, name, name));
    }
    // several faces may join two pieces: they stay in the order of the file
    std::stable_sort(scene_.bonds.begin(), scene_.bonds.end(),
                     [](const Bond& l, const Bond& r) { return std::pair(l.a, l.b) < std::pair(r.a, r.b); });
    draw_strengths();
    tell(cut_rows.size());
  }

 private:
  void bond_faces(const CaseBond& between) {
    const double distance = between.distance > 0 ? between.distance : touch_distance();
    const std::size_t count = bond_faces_between(between, distance, whole_, scene_);
    if (count == 0) {
      throw InputError(
          "{}: no two faces of bodies of '{}' and '{}' lie within {} of each other: nothing is bonded; give a larger distance, or place "
          "the "
          "bodies face to face",
          between.where, case_.materials[static_cast<std::size_t>(between.between_a)].name,
          case_.materials[static_cast<std::size_t>(between.between_b)].name, format_quantity(distance, Dimension::length));
    }
    report_.notices.push_back(fmt::format("{}: {} faces that lie within {} of each other are bonded", between.where, count,
                                          format_quantity(distance, Dimension::length)));
  }

  /// How far apart faces may lie that touch [m]: where touch begins as drawn, by what rounding makes of a body's size.
  double touch_distance() const {
    if (scene_.settings.surface == TouchAt::outside) return 2 * scene_.settings.margin * (1 + kInsetRounding);
    double largest = 0;
    for (std::size_t b = 0; b < scene_.bodies.size(); ++b)
      largest =
          std::max(largest, scene_.bodies.scale[b] * scene_.shapes[static_cast<std::size_t>(scene_.bodies.shape[b])].bounding_radius());
    return kTouchingFaces * largest;
  }

  void add_pieces(const BodyRow& row, std::size_t shape) {
    const ShapeFile& file = pieces_.at(shape);
    check(row, case_.shapes[shape], file);
    const std::int32_t first_shape = first_shape_of(shape, file);
    const std::int64_t first_id = next_id_;
    for (std::size_t p = 0; p < file.shapes.size(); ++p) {
      BodyRow piece = row;
      const Vec3 arm = rotate(row.orientation, row.scale * file.shapes[p].origin_shift);
      piece.id = next_id_++;
      whole_[piece.id] = row.id;
      piece.shape = first_shape + static_cast<std::int32_t>(p);
      piece.position = row.position + arm;
      piece.velocity = row.velocity + cross(row.angular_velocity, arm);
      scene_.bodies.add(piece);
    }
    if (!row.fixed) add_bonds(row, file, first_id);
    // a force on the whole is one on its pieces by their mass, which does not turn it
    for (const BodyForce& force : std::vector<BodyForce>(scene_.forces)) {
      if (force.id != row.id) continue;
      std::erase_if(scene_.forces, [&](const BodyForce& f) { return f.id == row.id; });
      for (std::size_t p = 0; p < file.shapes.size(); ++p) {
        const double share = file.shapes[p].mass.volume / file.pieces->volume;
        scene_.forces.push_back({first_id + static_cast<std::int64_t>(p), share * force.force});
      }
    }
  }

  void check(const BodyRow& row, const CaseShape& shape, const ShapeFile& file) const {
    if (row.lock_rotation)
      throw InputError("{}: body {} has lock_rotation and the shape '{}', which starts as pieces; pieces of it would turn", shape.where,
                       row.id, shape.name);
    if (scene_.settings.surface == TouchAt::drawn) return;  // their faces are just in touch as they are cut
    const double inset = row.scale * file.pieces->inset, margin = scene_.settings.margin;
    if (inset >= (1 - kInsetRounding) * margin) return;
    throw InputError(
        "{}: the pieces of '{}' are moved inwards by {} at the scale {:.4g} of body {}, and the margin is {}: pieces that no bond "
        "holds would press each other; cut it with scree-mesher fracture --inset \"{:.9g} m\", or give a contact.margin of at most "
        "{:.6g} m",
        shape.where, shape.name, format_quantity(inset, Dimension::length), row.scale, row.id, format_quantity(margin, Dimension::length),
        margin / row.scale, inset);
  }

  /// The pieces' shapes follow all others, once for all bodies of a shape.
  std::int32_t first_shape_of(std::size_t shape, const ShapeFile& file) {
    const auto [it, is_new] = first_shape_.try_emplace(shape, static_cast<std::int32_t>(scene_.shapes.size()));
    if (!is_new) return it->second;
    for (std::size_t p = 0; p < file.shapes.size(); ++p) {
      scene_.shapes.push_back(file.shapes[p]);
      scene_.shapes.back().name = fmt::format("{}_{}", case_.shapes[shape].name, p + 1);
    }
    return it->second;
  }

  void add_bonds(const BodyRow& row, const ShapeFile& file, std::int64_t first_id) {
    const auto given = std::find_if(case_.bonds.begin(), case_.bonds.end(), [&](const CaseBond& b) { return b.material == row.material; });
    if (given == case_.bonds.end()) {
      loose_.insert(row.material);
      return;
    }
    held_.insert(row.material);
    std::vector<double> largest(file.shapes.size(), 0);
    for (const SharedFace& f : file.pieces->faces) {
      for (const std::int32_t p : {f.piece_a, f.piece_b})
        largest[static_cast<std::size_t>(p)] = std::max(largest[static_cast<std::size_t>(p)], f.area);
    }
    const double s = row.scale, height = 2 * s * std::cbrt(0.75 * file.pieces->volume / std::numbers::pi);
    const double density = scene_.materials[static_cast<std::size_t>(row.material)].density;
    for (std::size_t p = 0; p < file.shapes.size(); ++p)
      own_weight_[first_id + static_cast<std::int64_t>(p)] = density * length(scene_.settings.gravity) * height;
    for (const SharedFace& f : file.pieces->faces) {
      const auto a = static_cast<std::size_t>(f.piece_a), b = static_cast<std::size_t>(f.piece_b);
      if (f.area < kMinFace * std::max(largest[a], largest[b])) continue;
      SharedFace face = f;
      Bond bond;
      bond.a = first_id + f.piece_a;
      bond.b = first_id + f.piece_b;
      bond.point_a = s * (f.centroid - file.shapes[a].origin_shift);
      bond.point_b = s * (f.centroid - file.shapes[b].origin_shift);
      if (bond.a > bond.b) {
        std::swap(bond.a, bond.b);
        std::swap(bond.point_a, bond.point_b);
        face.normal = -face.normal;
      }
      bond.frame_a = bond.frame_b = frame_of(face);
      bond.area = s * s * f.area;
      bond.moment_1 = s * s * s * s * f.moment_1;
      bond.moment_2 = s * s * s * s * f.moment_2;
      bond.height = s * f.height;
      bond.rim_radius = s * f.rim_radius;
      fill_bond(*given, bond);
      scene_.bonds.push_back(bond);
    }
  }

  /// Strengths by Weibull, each a function of seed and number of its bond. The mean is the strength that is given.
  void draw_strengths() {
    std::map<std::int64_t, std::int32_t> material_of;
    for (std::size_t b = 0; b < scene_.bodies.size(); ++b) material_of[scene_.bodies.id[b]] = scene_.bodies.material[b];
    const auto modulus_of = [&](const Bond& bond) {
      const auto [low, high] = std::minmax(material_of.at(bond.a), material_of.at(bond.b));
      for (const CaseBond& b : case_.bonds) {
        if (are_of_one_body(whole_, bond.a, bond.b) ? b.material == low : b.between_a == low && b.between_b == high)
          return b.weibull_modulus;
      }
      return 0.0;
    };
    for (std::size_t k = 0; k < scene_.bonds.size(); ++k) {
      const double modulus = modulus_of(scene_.bonds[k]);
      if (!(modulus > 0)) continue;
      const RandomNumbers random(case_.settings.seed, static_cast<std::int64_t>(k), 0x626F6E64);  // "bond": no other draw has this attempt
      const double factor = std::pow(-std::log1p(-random.uniform(0)), 1 / modulus) / std::tgamma(1 + 1 / modulus);
      Bond& bond = scene_.bonds[k];
      const auto scale = [&](double& strength, double by) {
        if (strength < kNeverBreaks) strength *= by;
      };
      scale(bond.tension, factor);
      scale(bond.cohesion, factor);
      scale(bond.fracture_energy, factor * factor);
    }
  }

  void tell(std::size_t bodies) {
    if (bodies > 0) {
      report_.notices.push_back(fmt::format("{} cut into {} pieces, held by {} bonds",
                                            bodies == 1 ? "1 body" : fmt::format("{} bodies", bodies), next_id_ - first_piece_,
                                            scene_.bonds.size()));
    }
    std::size_t weak = 0, bonds = 0;
    double heaviest = 0;
    for (const Bond& bond : scene_.bonds) {
      const auto found = own_weight_.find(bond.a);
      if (found == own_weight_.end()) continue;
      ++bonds;
      weak += bond.tension < found->second ? 1 : 0;
      heaviest = std::max(heaviest, found->second);
    }
    if (weak > 0) {
      report_.notices.push_back(fmt::format(
          "{} of {} bonds hold less tension than the stress of their body's own weight over its height, {} at most: they may break as "
          "soon as it lies on something; raise tension",
          weak, bonds, format_quantity(heaviest, Dimension::pressure)));
    }
    for (const std::int32_t material : loose_) {
      report_.notices.push_back(fmt::format("bodies of '{}' start as loose pieces: no [[bonds]] has within = \"{}\"",
                                            case_.materials[static_cast<std::size_t>(material)].name,
                                            case_.materials[static_cast<std::size_t>(material)].name));
    }
  }

  const Case& case_;
  const SceneParts& parts_;
  const PieceFiles& pieces_;
  Scene& scene_;
  PackingReport& report_;
  std::int64_t next_id_ = 0, first_piece_ = 0;
  std::map<std::size_t, std::int32_t> first_shape_;
  std::set<std::int32_t> loose_;
  std::set<std::int32_t> held_;  ///< materials whose pieces bonds hold
  WholeBodies whole_;
  std::map<std::int64_t, double> own_weight_;  // of each piece: density times gravity times height of its body [Pa]
};

}  // namespace

void check_pieces(const CaseShape& shape, const Shape& whole, const ShapeFile& pieces) {
  if (!pieces.pieces) {
    throw InputError("{}: pieces = \"{}\": has no table of shared faces; make it with scree-mesher fracture {} --cells N -o NAME.shape.h5",
                     shape.where, shape.pieces, shape.file);
  }
  if (std::abs(pieces.pieces->volume - whole.mass.volume) > kSameVolume * whole.mass.volume) {
    throw InputError("{}: pieces = \"{}\": are those of a body '{}' of {:.9g} m^3, and '{}' has {:.9g} m^3; cut {} again", shape.where,
                     shape.pieces, pieces.pieces->body, pieces.pieces->volume, shape.name, whole.mass.volume, shape.file);
  }
}

ShapeFile cut_shape(const CaseShape& shape, double inset) {
  const TemporaryFolder folder;
  const std::string path = folder / "pieces.shape.h5";
  std::vector<std::string> words{
      tool_beside("scree-mesher"),       "fracture", shape.file, "--cells", fmt::format("{}", shape.cells), "--seed",
      fmt::format("{}", shape.cut_seed), "-o",       path};
  if (shape.cut_evenly) words.emplace_back("--evenly");
  if (!shape.name_in_file.empty()) words.insert(words.end(), {"--shape", shape.name_in_file});
  if (inset > 0) words.insert(words.end(), {"--inset", fmt::format("{:.17g} m", inset)});
  std::string said;
  const int code = run_tool(words, "pieces = { cells = ... }", "install it beside scree-decomposer, or give a file of pieces",
                            [&](const char* bytes, std::size_t size) { said.append(bytes, size); });
  if (code != 0) throw InputError("{}: pieces = {{ cells = {} }}: {}", shape.where, shape.cells, error_said(said));
  return read_shape_file(path);
}

void cut_bodies(const Case& c, const SceneParts& parts, const PieceFiles& pieces, Scene& scene, PackingReport& report) {
  if (pieces.empty() && c.bonds.empty()) return;
  Cutter cutter(c, parts, pieces, scene, report);
  cutter.run();
  std::sort(scene.forces.begin(), scene.forces.end(), [](const BodyForce& l, const BodyForce& r) { return l.id < r.id; });
}

}  // namespace scree
