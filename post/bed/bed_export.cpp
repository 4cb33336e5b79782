#include "post/bed/bed_export.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <span>

#include "core/base/error.hpp"
#include "core/base/utf8.hpp"
#include "core/geometry/mass_properties.hpp"
#include "core/storage/h5.hpp"
#include "post/bed/closed_cut.hpp"
#include "post/bed/part_bodies.hpp"
#include "post/bed/solid_grid.hpp"
#include "post/run/drawn_meshes.hpp"
#include "post/run/output_file.hpp"
#include "post/run/within.hpp"
#include "post/statistics/bed.hpp"
#include "post/statistics/contact_kinds.hpp"
#include "post/statistics/space_measures.hpp"

namespace scree {

namespace {

constexpr double kCell = 0.1, kRing = 0.05;  // of the mean diameter
constexpr double kMostCells = 1e8;           // 2.4 GB in memory and on disk
constexpr double kUsualCells = 4e6;          // of a grid whose cells nobody chose: 48 MB
constexpr double kLoss = 0.05;               // of a body's volume: caps are thin, so more is worth a note
constexpr double kSinglePrecision = 6e-8;    // of a coordinate
constexpr double kShare = 1e-3;              // of a gap: by so much single precision may move a vertex
constexpr double kWallDeviation = 0.25;      // of a gap: so near a round wall's facets lie to it

double volume_of(std::span<const TriangleMesh> meshes) {
  double sum = 0;
  for (const TriangleMesh& mesh : meshes) sum += mass_properties(mesh).volume;
  return sum;
}

/// A shape at scale 1 as triangles that hold its volume.
TriangleMesh closed_shape(const Shape& shape, int ball_level) {
  if (shape.kind != ShapeKind::sphere) return shape.mesh;
  TriangleMesh ball = icosphere(ball_level);
  const double factor = std::cbrt(shape.mass.volume / mass_properties(ball).volume);
  for (Vec3& p : ball.vertices) p *= factor;
  return ball;
}

void write_stl(const std::string& path, std::span<const TriangleMesh> meshes, const std::string& title) {
  OutputFile file(path);
  std::string bytes = title;
  bytes.resize(80, ' ');
  std::size_t triangles = 0;
  for (const TriangleMesh& mesh : meshes) triangles += mesh.triangles.size();
  const auto append = [&bytes](const auto& value) { bytes.append(reinterpret_cast<const char*>(&value), sizeof value); };
  if (triangles > std::numeric_limits<std::uint32_t>::max())
    throw UsageError("{}: {} triangles, an STL file holds at most {}; choose fewer for each ball, or a part with --within", path, triangles,
                     std::numeric_limits<std::uint32_t>::max());
  append(static_cast<std::uint32_t>(triangles));
  for (const TriangleMesh& mesh : meshes) {
    for (std::int32_t t = 0; t < mesh.triangle_count(); ++t) {
      const Vec3 n = cross(mesh.corner(t, 1) - mesh.corner(t, 0), mesh.corner(t, 2) - mesh.corner(t, 0));
      const double l = length(n);
      for (const Vec3& v : {l > 0 ? (1 / l) * n : n, mesh.corner(t, 0), mesh.corner(t, 1), mesh.corner(t, 2)}) {
        for (int k = 0; k < 3; ++k) append(static_cast<float>(v[k]));
      }
      append(std::uint16_t{0});
    }
    file.add(bytes);
    bytes.clear();
  }
  file.add(bytes);
  file.commit();
}

class BedExport {
 public:
  BedExport(const Run& run, const BedOptions& options)
      : run_(run),
        options_(options),
        frame_(Within::named(run, options.within).part_of(run, load_frame(run, find_frame(run, options.frame)))),
        facts_(run, options.container, frame_),
        view_(facts_, frame_) {
    if (view_.particles == 0)
      throw UsageError("--frame {}: no particle in frame {} (of {} s); choose another frame, or other bodies with --within", options.frame,
                       frame_.number, frame_.time);
  }

  BedResult run() {
    make_folder(options_.folder);
    result_.numbers = {{"format", "scree-bed"},
                       {"format_version", 1},
                       {"run", run_.name},
                       {"frame", frame_.number},
                       {"time", frame_.time},
                       {"particles", view_.particles},
                       {"mean_diameter", view_.mean_diameter}};
    place_bodies();
    place_walls();
    write_grid();
    write_radial();
    write_surfaces();
    write_contacts();
    h5::write_text_file(path_of("bed.json"), json_text(result_.numbers, 1) + "\n");
    return std::move(result_);
  }

 private:
  std::string path_of(const char* name) {
    result_.files.push_back(name);
    return options_.folder + "/" + name;
  }
  void say(const std::string& line) { result_.summary += line + "\n"; }

  TriangleMesh placed(std::size_t row) const {
    const FrameBodies& b = frame_.bodies;
    TriangleMesh mesh = shapes_[static_cast<std::size_t>(b.shape[row])];
    Vec3 position = b.position[row], image;
    if (view_.facts.period.any()) view_.facts.period.wrap(position, image);
    const Mat3 turn = matrix_of(b.orientation[row]);
    for (Vec3& p : mesh.vertices) p = position + turn * (b.scale[row] * p);
    return mesh;
  }

  void place_bodies() {
    for (const Shape& shape : run_.scene.shapes) shapes_.push_back(closed_shape(shape, options_.ball_level));
    const FrameBodies& b = frame_.bodies;
    for (std::size_t row = 0; row < b.size(); ++row) {
      const auto shape = static_cast<std::size_t>(b.shape[row]);
      place_.push_back(view_.is_particle[row] != 0 ? static_cast<std::int32_t>(bodies_.size())
                                                   : -1 - static_cast<std::int32_t>(walls_.size()));
      if (view_.is_particle[row] == 0) {
        walls_.push_back(placed(row));
        continue;
      }
      bodies_.push_back(placed(row));
      rows_.push_back(row);
      diameters_.push_back(b.scale[row] * view_.facts.diameter[shape]);
      for (const Vec3& p : bodies_.back().vertices) extent_.add(p);
    }
    volume_ = volume_of(bodies_);
  }

  void place_walls() {
    const double deviation = kWallDeviation * options_.gap * *std::min_element(diameters_.begin(), diameters_.end());
    const std::vector<WallPlace> places = wall_places(frame_, run_.scene);
    for (std::size_t w = 0; w < run_.scene.walls.size(); ++w) {
      TriangleMesh mesh = wall_surface_in(frame_, run_.scene.walls[w], run_.scene, places[w], extent_, deviation);
      wall_index_[run_.scene.walls[w].id] = -1 - static_cast<std::int32_t>(walls_.size());
      walls_.push_back(std::move(mesh));
    }
  }

  /// The box of the grid: along gravity that of the bodies, else the container where it ends near them.
  GridCells grid_cells() const {
    const Container& container = view_.facts.container;
    const Box3 room = container.room.bounds();
    const double margin = view_.mean_diameter;
    Box3 box = extent_;
    for (int k = 0; k < 3; ++k) {
      if (view_.facts.period.is_periodic(k)) {
        box.lower[k] = view_.facts.cell_lower[k];
        box.upper[k] = view_.facts.cell_lower[k] + view_.facts.period.period()[k];
      } else if (k != container.vertical) {
        // corners may reach through the wall by as much as they overlap it
        box.lower[k] = std::min(extent_.lower[k], std::max(room.lower[k], extent_.lower[k] - margin));
        box.upper[k] = std::max(extent_.upper[k], std::min(room.upper[k], extent_.upper[k] + margin));
      }
    }
    const Vec3 extent = box.extent();
    const double volume = extent.x * extent.y * extent.z;
    const double edge = options_.cell > 0 ? options_.cell : std::max(kCell * view_.mean_diameter, std::cbrt(volume / kUsualCells));
    GridCells cells;
    cells.lower = box.lower;
    double count = 1;
    for (int k = 0; k < 3; ++k) {
      const double along = std::max(1.0, std::round(extent[k] / edge));
      count *= along;
      if (!(count <= kMostCells))
        throw UsageError(
            "--cell {} m: a grid of {:.2g} cells in the box of {:.4g} x {:.4g} x {:.4g} m, at most {:g} expected; choose at least {:.2g} m",
            edge, extent.x * extent.y * extent.z / (edge * edge * edge), extent.x, extent.y, extent.z, kMostCells,
            1.01 * std::cbrt(volume / kMostCells));
      cells.count[static_cast<std::size_t>(k)] = static_cast<std::int64_t>(along);
      cells.spacing[k] = extent[k] / along;
    }
    return cells;
  }

  void write_grid() {
    const GridCells cells = grid_cells();
    SolidGrid grid(cells);
    const Periodicity period = view_.facts.period.any() ? view_.facts.period.with_least_shear() : Periodicity{};
    const auto reach = [&](int k) { return period.is_periodic(k) ? 1 : 0; };
    std::vector<Vec3> shifts;
    for (int x = -reach(0); x <= reach(0); ++x) {
      for (int y = -reach(1); y <= reach(1); ++y) {
        for (int z = -reach(2); z <= reach(2); ++z)
          shifts.push_back(period.any() ? period.shift({static_cast<double>(x), static_cast<double>(y), static_cast<double>(z)}) : Vec3{});
      }
    }
    for (const TriangleMesh& body : bodies_) {
      const Box3 box = bounding_box(body);
      for (const Vec3& shift : shifts) {
        bool meets = true;
        for (int k = 0; k < 3; ++k) meets = meets && box.lower[k] + shift[k] < cells.upper()[k] && box.upper[k] + shift[k] > cells.lower[k];
        if (meets) grid.add(body, shift);
      }
    }
    std::vector<double> solid = grid.fractions();
    double sum = 0, largest = 0;
    for (double& share : solid) {
      // cells that no body reaches hold the rounding of what lies above them
      constexpr double kRounding = 1e-9;
      if (std::abs(share) < kRounding) share = 0;
      sum += share;
      largest = std::max(largest, share);
    }
    std::vector<std::uint8_t> inside;
    for (std::int64_t z = 0; z < cells.count[2]; ++z) {
      for (std::int64_t y = 0; y < cells.count[1]; ++y) {
        for (std::int64_t x = 0; x < cells.count[0]; ++x) {
          const Vec3 centre =
              cells.lower + Vec3{(static_cast<double>(x) + 0.5) * cells.spacing.x, (static_cast<double>(y) + 0.5) * cells.spacing.y,
                                 (static_cast<double>(z) + 0.5) * cells.spacing.z};
          inside.push_back(view_.facts.container.holds(centre) ? 1 : 0);
        }
      }
    }
    write_grid_vti(path_of("void_fraction.vti"), cells, solid, inside);
    const BedSolid bed = bed_solid(view_);
    result_.numbers["solid_volume"] = volume_;
    result_.numbers["solid_volume_in_grid"] = sum * cells.cell_volume();
    result_.numbers["cells"] = {cells.count[0], cells.count[1], cells.count[2]};
    result_.numbers["cell"] = {cells.spacing.x, cells.spacing.y, cells.spacing.z};
    result_.numbers["void_fraction"] = 1 - bed.fraction;
    result_.numbers["void_fraction_of_container"] = 1 - bed.of_container;
    say(fmt::format(
        "bed        {} particles, frame {} of {:.6g} s, void fraction {:.4f} (inner 80 % of the bed), {:.4f} (container up to the top)",
        view_.particles, frame_.number, frame_.time, 1 - bed.fraction, 1 - bed.of_container));
    say(fmt::format("grid       {} x {} x {} cells of {:.3g} m, {:.6g} m^3 of solid in it, {:.6g} m^3 in all bodies", cells.count[0],
                    cells.count[1], cells.count[2], cells.spacing.x, sum * cells.cell_volume(), volume_));
    const double in_grid = sum * cells.cell_volume();
    constexpr double kNoted = 1e-6;
    if (std::abs(in_grid - volume_) > kNoted * volume_)
      result_.notes.push_back(
          fmt::format("{:.3g} % of the solid is not in the grid: bodies reach out of it", 100 * (1 - in_grid / volume_)));
    if (is_turned_box(view_.facts, frame_))
      result_.notes.push_back(
          "the box around the bed is turned in this frame, and the void fractions take its room without the turn: they mean nothing; give "
          "the room of the bed with --container");
    if (!std::isfinite(bed.fraction) || !(bed.of_container > 0))
      result_.notes.push_back(
          "the container holds none of the bodies: its void fractions mean nothing; give the right one with --container");
    if (options_.cell <= 0 && cells.spacing.x > 1.5 * kCell * view_.mean_diameter)
      result_.notes.push_back(
          fmt::format("cells are {:.2g} mean diameters wide, so that the grid has at most {:g}; --cell sets another edge",
                      cells.spacing.x / view_.mean_diameter, kUsualCells));
    if (largest > 1 + 1e-6)
      result_.notes.push_back(
          fmt::format("the largest solid fraction of a cell is {:.4f}: what two bodies hold, as at contacts, counts twice", largest));
  }

  void write_radial() {
    const Container& container = view_.facts.container;
    if (container.room.kind != Region::Kind::cylinder) {
      result_.notes.push_back(
          "no radial void fraction: the container is no cylinder; give one with --container cylinder:x0,y0,z0,x1,y1,z1,r");
      return;
    }
    const double radius = container.room.radius, d = view_.mean_diameter;
    const double most = 10000;
    ProfileBins bins;
    bins.axis = 'r';
    bins.high = radius;
    bins.count = options_.rings > 0 ? static_cast<std::size_t>(options_.rings)
                                    : static_cast<std::size_t>(std::clamp(std::round(radius / (kRing * d)), 1.0, most));
    const Profile rings = profile(view_, bins);
    std::string text = "distance_from_wall,distance_from_wall_over_diameter,distance_from_axis,void_fraction,solid_fraction\nm,-,m,-,-\n";
    for (std::size_t k = bins.count; k-- > 0;) {
      const double r = bins.low + (static_cast<double>(k) + 0.5) * bins.width();
      text += fmt::format("{},{},{},{},{}\n", radius - r, (radius - r) / d, r, 1 - rings.solid_fraction[k], rings.solid_fraction[k]);
    }
    h5::write_text_file(path_of("radial_void_fraction.csv"), text);
  }

  std::vector<BedContact> bed_contacts() const {
    std::vector<BedContact> contacts;
    for (const SurfaceContact& c : contacts_) {
      const auto index = [&](std::int32_t row, std::int64_t id) {
        if (row >= 0) return place_[static_cast<std::size_t>(row)];
        const auto wall = wall_index_.find(id);
        return wall == wall_index_.end() ? std::numeric_limits<std::int32_t>::min() : wall->second;
      };
      BedContact contact{index(c.row_a, c.body_a), index(c.row_b, c.body_b), c.point, c.normal};
      if (contact.a < 0 || (contact.b >= 0 && contact.b < contact.a)) {
        std::swap(contact.a, contact.b);
        contact.normal = -contact.normal;
      }
      if (contact.a >= 0 && contact.b != std::numeric_limits<std::int32_t>::min()) contacts.push_back(contact);
    }
    return contacts;
  }

  void write_surfaces() {
    if (run_.scene.settings.output_contacts) contacts_ = surface_contacts(view_);
    move_origin();
    std::vector<double> whole;
    for (const TriangleMesh& body : bodies_) whole.push_back(mass_properties(body).volume);
    if (options_.parted) {
      std::vector<BedContact> contacts = bed_contacts();
      for (BedContact& c : contacts) c.point -= origin_;
      const Parting parting = part_bodies(bodies_, diameters_, walls_, view_.facts.period, contacts, {options_.gap});
      result_.numbers["gap"] = options_.gap;
      result_.numbers["pairs_parted"] = parting.parted;
      result_.numbers["pairs_left"] = parting.left.size();
      result_.numbers["self_crossings"] = parting.self_crossings;
      result_.numbers["smallest_gap"] = std::isfinite(parting.smallest_gap) ? nlohmann::json(parting.smallest_gap) : nlohmann::json();
      if (std::isfinite(parting.smallest_gap))
        say(fmt::format("parting    {} pairs parted, smallest distance {:.3g} m, {:.3g} of the mean diameter", parting.parted,
                        parting.smallest_gap, parting.smallest_gap / view_.mean_diameter));
      else
        say("parting    no two surfaces are near each other");
      if (parting.self_crossings > 0)
        result_.notes.push_back(fmt::format("{} pairs of triangles of one body pass through or touch each other where several caps meet",
                                            parting.self_crossings));
      if (!parting.left.empty()) result_.notes.push_back(words_of_left_pairs(parting));
    }
    std::size_t triangles = 0, open = 0;
    for (const TriangleMesh& body : bodies_) {
      volumes_.push_back(mass_properties(body).volume);
      triangles += body.triangles.size();
      open += open_edges(body);
    }
    const double in_file = volume_of(bodies_);
    result_.numbers["triangles"] = triangles;
    result_.numbers["open_edges"] = open;
    result_.numbers["volume_in_file"] = in_file;
    write_stl(path_of("bed.stl"), bodies_, "packed bed, written by scree-post");
    if (!walls_.empty()) write_stl(path_of("walls.stl"), walls_, "walls, written by scree-post");
    say(fmt::format("surface    {} triangles, {} open edges, {:.6g} m^3, {:.3g} % less than the bodies", triangles, open, in_file,
                    100 * (1 - in_file / volume_)));
    whole_ = std::move(whole);
    note_losses();
    const auto beyond = std::count_if(bodies_.begin(), bodies_.end(), [&](const TriangleMesh& body) {
      const Box3 box = bounding_box(body);
      for (int k = 0; k < 3; ++k) {
        if (!view_.facts.period.is_periodic(k)) continue;
        const double low = view_.facts.cell_lower[k] - origin_[k], high = low + view_.facts.period.period()[k];
        if (box.lower[k] < low || box.upper[k] > high) return true;
      }
      return false;
    });
    if (beyond > 0)
      result_.notes.push_back(fmt::format("{} bodies reach through a periodic side: bed.stl has each of them once and whole", beyond));
  }

  /// STL files have coordinates in single precision: far from the origin they are given from a point near the bed.
  void move_origin() {
    double farthest = 0, smallest = std::numeric_limits<double>::infinity();
    for (int k = 0; k < 3; ++k) farthest = std::max({farthest, std::abs(extent_.lower[k]), std::abs(extent_.upper[k])});
    for (const double d : diameters_) smallest = std::min(smallest, d);
    if (farthest * kSinglePrecision > kShare * options_.gap * smallest) origin_ = extent_.lower;
    result_.numbers["origin"] = {origin_.x, origin_.y, origin_.z};
    if (origin_ == Vec3{}) return;
    for (std::vector<TriangleMesh>* meshes : {&bodies_, &walls_}) {
      for (TriangleMesh& mesh : *meshes) {
        for (Vec3& p : mesh.vertices) p -= origin_;
      }
    }
    result_.notes.push_back(
        fmt::format("coordinates in bed.stl and walls.stl are from ({}, {}, {}) m: single precision is too coarse so far from 0", origin_.x,
                    origin_.y, origin_.z));
    const Vec3 extent = extent_.extent();
    if (std::max({extent.x, extent.y, extent.z}) * kSinglePrecision > kShare * options_.gap * smallest)
      result_.notes.push_back(
          fmt::format("the bed is {:.2g} times as large as its smallest body: single precision of STL moves vertices by more than {} gaps",
                      std::max({extent.x, extent.y, extent.z}) / smallest, kShare));
  }

  /// Caps that are more than thin: of a plate thinner than the gap, a body between hollow surfaces, a soft contact.
  void note_losses() {
    std::size_t count = 0, most = 0;
    double largest = 0;
    for (std::size_t i = 0; i < whole_.size(); ++i) {
      const double lost = 1 - volumes_[i] / whole_[i];
      count += lost > kLoss ? 1U : 0U;
      if (lost > largest) largest = lost, most = i;
    }
    result_.numbers["largest_loss"] = largest;
    if (count > 0)
      result_.notes.push_back(
          fmt::format("{} bodies lose more than {:g} % of their volume by caps, body {} most: {:.3g} %; bodies.csv has all", count,
                      100 * kLoss, frame_.bodies.id[rows_[most]], 100 * largest));
  }

  std::string words_of_left_pairs(const Parting& parting) const {
    std::string names;
    constexpr std::size_t kNamed = 5;
    for (std::size_t i = 0; i < parting.left.size() && i < kNamed; ++i) {
      const auto& [a, b] = parting.left[i];
      const auto id = [&](std::int32_t index) { return frame_.bodies.id[rows_[static_cast<std::size_t>(index)]]; };
      names += fmt::format("{}{}-{}", i > 0 ? ", " : "", id(a), b >= 0 ? std::to_string(id(b)) : std::string("wall"));
    }
    return fmt::format(
        "{} pairs are nearer than half a gap or cross ({}{}): both surfaces are hollow there, they overlap deeply, or a body is thinner "
        "than the gap; a mesh generator may fail there",
        parting.left.size(), names, parting.left.size() > kNamed ? ", ..." : "");
  }

  void write_contacts() {
    const FrameBodies& b = frame_.bodies;
    const bool has_contacts = run_.scene.settings.output_contacts;
    if (!has_contacts) result_.notes.push_back("the run kept no contacts: no kinds of contacts, no constraints");
    const std::vector<BodyConstraints> constraints = body_constraints(view_, contacts_);
    if (has_contacts) {
      std::string text = "body_a,body_b,kind,points,length,width,normal_force,x,y,z,nx,ny,nz\n,,,,m,m,N,m,m,m,,,\n";
      for (const SurfaceContact& c : contacts_) {
        text += fmt::format("{},{},{},{},{},{},{},{},{},{},{},{},{}\n", c.body_a, c.body_b, name_of(c.kind), c.points, c.length, c.width,
                            c.normal_force, c.point.x, c.point.y, c.point.z, c.normal.x, c.normal.y, c.normal.z);
      }
      h5::write_text_file(path_of("contacts.csv"), text);
    }
    std::string text =
        has_contacts
            ? "id,volume,volume_in_file,point_contacts,edge_contacts,face_contacts,constraints,constraints_frictionless\n,m^3,m^3,,,,,\n"
            : "id,volume,volume_in_file\n,m^3,m^3\n";
    double with = 0, without = 0, counts[3] = {0, 0, 0};
    for (std::size_t i = 0; i < rows_.size(); ++i) {
      const BodyConstraints& c = constraints[rows_[i]];
      text += fmt::format("{},{},{}", b.id[rows_[i]], whole_[i], volumes_[i]);
      if (has_contacts) text += fmt::format(",{},{},{},{},{}", c.point, c.edge, c.face, c.with_friction, c.without_friction);
      text += "\n";
      with += c.with_friction;
      without += c.without_friction;
      counts[0] += c.point;
      counts[1] += c.edge;
      counts[2] += c.face;
    }
    h5::write_text_file(path_of("bodies.csv"), text);
    if (!has_contacts) return;
    const auto n = static_cast<double>(rows_.size());
    result_.numbers["contacts_per_particle"] = {{"point", counts[0] / n}, {"edge", counts[1] / n}, {"face", counts[2] / n}};
    result_.numbers["constraints"] = with / n;
    result_.numbers["constraints_frictionless"] = without / n;
    say(fmt::format(
        "contacts   per particle {:.3f} in points, {:.3f} along edges, {:.3f} with faces; constraints per particle {:.3f} (frictionless "
        "count {:.3f})",
        counts[0] / n, counts[1] / n, counts[2] / n, with / n, without / n));
  }

  const Run& run_;
  const BedOptions& options_;
  Frame frame_;
  SceneFacts facts_;
  FrameView view_;
  BedResult result_;
  std::vector<TriangleMesh> shapes_;                 ///< at scale 1
  std::vector<TriangleMesh> bodies_;                 ///< particles, in the world
  std::vector<TriangleMesh> walls_;                  ///< fixed bodies, then walls, in the world
  std::vector<std::size_t> rows_;                    ///< of each particle in the frame
  std::vector<std::int32_t> place_;                  ///< of each row: its particle, or -1 - its wall
  std::map<std::int64_t, std::int32_t> wall_index_;  ///< -1 - wall, by id
  std::vector<double> diameters_, whole_, volumes_;  ///< of each particle [m], [m^3] whole and in the file
  std::vector<SurfaceContact> contacts_;
  Box3 extent_;
  Vec3 origin_;  ///< of what is in STL files [m]
  double volume_ = 0;
};

}  // namespace

BedResult export_bed(const Run& run, const BedOptions& options) { return BedExport(run, options).run(); }

}  // namespace scree
