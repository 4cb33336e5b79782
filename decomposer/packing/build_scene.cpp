#include "decomposer/packing/build_scene.hpp"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>
#include <numeric>
#include <optional>

#include "core/base/counted.hpp"
#include "core/base/error.hpp"
#include "core/base/numbers.hpp"
#include "core/base/units.hpp"
#include "core/geometry/closed_mesh.hpp"
#include "core/geometry/mass_properties.hpp"
#include "core/placing/random_numbers.hpp"
#include "core/storage/wall_state.hpp"
#include "core/surface/inset.hpp"
#include "core/surface/touch_surface.hpp"
#include "decomposer/packing/case_warnings.hpp"
#include "decomposer/packing/compact.hpp"
#include "decomposer/packing/cut_bodies.hpp"
#include "decomposer/packing/feasibility.hpp"
#include "decomposer/packing/going_on.hpp"
#include "decomposer/packing/inlets.hpp"
#include "decomposer/packing/margin_rule.hpp"
#include "decomposer/packing/packer.hpp"
#include "decomposer/packing/relax.hpp"
#include "decomposer/packing/settle.hpp"
#include "decomposer/packing/shape_files.hpp"
#include "decomposer/packing/start_checks.hpp"

namespace scree {

namespace {

class Builder {
 public:
  Builder(const Case& c, const ChildSolver& solver) : case_(c), solver_(solver) {}

  PackedScene build() {
    out_.inputs.push_back({case_.path, case_.sha256, nullptr});
    if (case_.start) take_bodies_of_run();
    scene().settings = case_.settings;
    scene().materials = case_.materials;
    for (const CasePair& p : case_.pairs) scene().pairs.push_back(p.pair);
    load_shapes();
    load_walls();
    if (parts_.carried && case_.start->leave_out) {  // its region may be what a wall holds
      leave_out(case_, load_region(*case_.start->leave_out, case_.start->where + ".leave_out"), parts_.carried->from);
      load_carried_shapes();
    }
    if (parts_.carried) parts_.carried->wall_partner = partners_of_walls(parts_.carried->from, parts_.walls, scene().shapes);
    load_regions();
    draw_particles();
    choose_margin(case_, parts_, scene(), report());
    move_surfaces_in();
    check_start(case_, parts_, scene(), report().notices);
    check_inlets(case_, parts_, scene(), report().notices);
    Case placed = case_;
    if (placed.relax != Relax::none) relax(placed);
    Packer packer(placed, parts_, scene(), report());
    packer.place_carried_bodies();
    packer.place_given_bodies();
    Placements placements(parts_);
    check_feasible(placed, parts_, scene());
    packer.place_particles(placements);
    settle_populations(placed, parts_, scene(), solver_, placements, report());
    for (std::size_t k = 0; k < placed.populations.size(); ++k) {
      if (placed.populations[k].method == PackingMethod::compact)
        compact_population(placed, parts_, scene(), k, solver_, placements, report());
    }
    for (std::size_t k = 0; k < placed.populations.size(); ++k) {
      report().solid_fraction[k] = placements.volume_placed(parts_, k) / parts_.regions[k].volume;
    }
    check_none_is_empty(placements);
    add_placed(placed, parts_, placements, scene());
    add_forces();
    for (std::size_t s = 0; s < case_.shapes.size(); ++s) cut_here(s);
    note_diameters();
    cut_bodies(case_, parts_, pieces_, scene(), report());
    check_outlets();
    check_cell();
    if (parts_.carried) out_.start = start_of(parts_.carried->from, scene(), parts_.carried->wall_partner);
    out_.inputs.insert(out_.inputs.end(), files_.inputs().begin(), files_.inputs().end());
    fill_report();
    report().facets = facets_of_walls(parts_, scene());
    report().case_warnings = warnings_of_case(case_, parts_, scene(), report());
    return std::move(out_);
  }

 private:
  /// From here on bodies are what contacts are computed with.
  void move_surfaces_in() {
    if (!(scene().settings.margin_ratio > 0)) return;
    const auto make = [&](std::vector<PackShape>& shapes, const std::vector<std::int32_t>& scene_shape) {
      for (std::size_t i = 0; i < shapes.size(); ++i)
        if (scene_shape[i] >= 0) shapes[i] = make_pack_shape(scene().shapes[static_cast<std::size_t>(scene_shape[i])], scene().settings);
    };
    make(parts_.shapes, parts_.scene_shape);
    if (parts_.carried) make(parts_.carried->shapes, parts_.carried->scene_shape);
    report_roundings();
  }

  /// How far touch is from what was drawn: more than edges and corners are rounded by where parts are thinner than two margins.
  void report_roundings() {
    for (std::size_t i = 0; i < parts_.shapes.size(); ++i) {
      const PackShape& shape = parts_.shapes[i];
      if (!(shape.margin > 0)) continue;
      const Shape& drawn = scene().shapes[static_cast<std::size_t>(parts_.scene_shape[i])];
      const InsetDeviation off = deviation_of_inset(drawn.mesh, shape.shape.mesh, shape.margin);
      report().roundings.push_back({drawn.name, shape.margin, off.mean, off.largest, 0.5 * drawn.equivalent_diameter()});
    }
  }

  void relax(Case& placed) {
    double gap = 2 * common_margin(scene().settings);
    for (const CaseBody& b : placed.bodies) gap = std::max(gap, kTouch * b.scale * parts_.shape(b.shape).radius);
    const Relaxation done = relax_given_bodies(placed, parts_, scene(), gap);
    if (done.moved == 0) return;
    report().notices.push_back(
        fmt::format("contact.relax = {}: {} bodies separated in {} sweeps, by up to {}; their potential energy changed by {:.3g} J. The "
                    "strongest contact was: {}",
                    placed.relax == Relax::all ? "true" : "\"shallow\"", done.moved, done.sweeps,
                    format_quantity(done.furthest, Dimension::length), done.potential_change, done.hardest));
  }

  Scene& scene() { return out_.scene; }
  PackingReport& report() { return out_.report; }

  /// Before bodies are cut into pieces. A case that goes on where a run ended has no populations of its own, and the bodies of those of the
  /// run.
  void note_diameters() {
    const BodyTable& b = scene().bodies;
    std::vector<std::vector<double>>& diameters = report().diameters;
    for (std::size_t i = 0; i < b.size(); ++i) {
      if (b.population[i] < 0) continue;
      const auto k = static_cast<std::size_t>(b.population[i]);
      if (k >= diameters.size()) diameters.resize(k + 1);
      diameters[k].push_back(b.scale[i] * scene().shapes[static_cast<std::size_t>(b.shape[i])].equivalent_diameter());
    }
    for (std::vector<double>& of_population : diameters) std::sort(of_population.begin(), of_population.end());
  }

  // ---- bodies of a run ----

  void take_bodies_of_run() {
    CarriedBodies& carried = parts_.carried.emplace();
    carried.from = read_run(case_);
    if (!carried.from.scene.bonds.empty()) {
      throw InputError(
          "{}: the run has {} bonds, which this case would not take over, and which of them broke is not taken over either; begin with "
          "a run without [[bonds]]",
          case_.start->where, carried.from.scene.bonds.size());
    }
    if (case_.start->goes_on) go_on(case_, carried.from, report().notices);
    if (carried.from.in_transit > 0)
      report().notices.push_back(
          fmt::format("{}: {} of {} had left through an outlet and waited at an inlet to come in again: not in this scene",
                      case_.start->where, counted(carried.from.in_transit, "body", "bodies"), case_.start->run));
    for (BodyRow& row : carried.from.bodies) {  // populations of this case come first
      if (row.population >= 0) row.population += static_cast<std::int32_t>(case_.populations.size());
    }
    parts_.first_id = carried.from.first_free_id;
    out_.inputs.insert(out_.inputs.end(), carried.from.inputs.begin(), carried.from.inputs.end());
    // only now it is known which bodies can meet
    const std::vector<MaterialUse> uses = uses_of(carried.from, case_);
    check_pairs(case_, uses);
    drop_pairs_that_cannot_meet(case_, uses);
  }

  /// A shape that the case has too, to the last bit, is one shape.
  std::int32_t find_in_scene(const Shape& shape) const {
    const std::vector<Shape>& all = out_.scene.shapes;
    for (std::size_t i = 0; i < all.size(); ++i) {
      const Shape& other = all[i];
      if (other.name == shape.name && other.kind == shape.kind && other.sphere_radius == shape.sphere_radius &&
          other.cell_size == shape.cell_size && other.mesh.vertices == shape.mesh.vertices && other.mesh.triangles == shape.mesh.triangles)
        return static_cast<std::int32_t>(i);
    }
    return -1;
  }

  void load_pieces(std::size_t shape) {
    const CaseShape& of = case_.shapes[shape];
    if (!of.falls_apart()) return;
    for (const CaseInlet& i : case_.inlets) {
      for (const auto& share : i.shares) {
        if (static_cast<std::size_t>(share.first) == shape)
          throw InputError(
              "{}: the shape '{}' starts as pieces, and bodies that come in later are whole; give the inlet a shape without pieces",
              i.where, of.name);
      }
    }
    if (of.cells > 0) return;  // cut when margin and sizes are known
    const ShapeFile& file = files_.open(of.pieces, of.where);
    check_pieces(of, parts_.shapes[shape].shape, file);
    pieces_.emplace(shape, file);
  }

  /// Pieces that the case has cut here: inset by the margin, at the scale of the smallest body.
  void cut_here(std::size_t shape) {
    const CaseShape& of = case_.shapes[shape];
    if (of.cells == 0) return;
    double smallest = 0;
    const BodyTable& bodies = scene().bodies;
    for (std::size_t b = 0; b < bodies.size(); ++b) {
      if (bodies.shape[b] == parts_.scene_shape[shape]) smallest = smallest > 0 ? std::min(smallest, bodies.scale[b]) : bodies.scale[b];
    }
    if (!(smallest > 0)) return;
    ShapeFile file = cut_shape(of, scene().settings.surface == TouchAt::drawn ? 0 : scene().settings.margin / smallest);
    check_pieces(of, parts_.shapes[shape].shape, file);
    pieces_.emplace(shape, std::move(file));
  }

  /// Of [[bodies]], which are the first of what this case adds.
  void add_forces() {
    for (std::size_t b = 0; b < case_.bodies.size(); ++b) {
      if (length(case_.bodies[b].force) > 0)
        scene().forces.push_back({parts_.first_id + static_cast<std::int64_t>(b), case_.bodies[b].force});
    }
    if (!case_.start || !case_.start->goes_on) return;
    const FromRun& from = parts_.carried->from;
    for (const BodyForce& force : from.scene.forces) {
      if (std::any_of(from.bodies.begin(), from.bodies.end(), [&](const BodyRow& row) { return row.id == force.id; }))
        scene().forces.push_back(force);
    }
  }

  void load_carried_shapes() {
    CarriedBodies& carried = *parts_.carried;
    const std::vector<Shape>& shapes = carried.from.scene.shapes;
    carried.shapes.resize(shapes.size());
    carried.scene_shape.assign(shapes.size(), -1);
    for (const BodyRow& row : carried.from.bodies) {
      const auto k = static_cast<std::size_t>(row.shape);
      if (carried.scene_shape[k] < 0) {
        carried.shapes[k] = make_pack_shape(shapes[k]);
        carried.scene_shape[k] = find_in_scene(shapes[k]);
        if (carried.scene_shape[k] < 0) {
          carried.scene_shape[k] = static_cast<std::int32_t>(scene().shapes.size());
          scene().shapes.push_back(shapes[k]);
        }
      }
      carried.placed.push_back({&carried.shapes[k], row.scale, row.position, row.orientation});
    }
  }

  // ---- files ----

  void load_shapes() {
    const std::vector<bool> used = used_shapes(case_);
    parts_.shapes.resize(case_.shapes.size());
    parts_.scene_shape.assign(case_.shapes.size(), -1);
    for (std::size_t i = 0; i < case_.shapes.size(); ++i) {
      if (!used[i]) {
        if (case_.start && case_.start->goes_on) continue;  // the run has bodies of it
        report().notices.push_back(fmt::format("{}: is not used", case_.shapes[i].where));
        continue;
      }
      parts_.shapes[i] = make_pack_shape(files_.body_shape(case_.shapes[i]));
      parts_.scene_shape[i] = static_cast<std::int32_t>(scene().shapes.size());
      scene().shapes.push_back(parts_.shapes[i].shape);
      scene().shapes.back().cell_size = case_.shapes[i].cell_size;
      load_pieces(i);
    }
    if (parts_.carried && !case_.start->leave_out) load_carried_shapes();
  }

  /// A wall or region keeps the coordinates of its file, also when it was imported as a solid.
  static TriangleMesh mesh_of_file(const Shape& source) {
    TriangleMesh mesh = source.mesh;
    if (source.kind == ShapeKind::solid) {
      for (Vec3& p : mesh.vertices) p += source.origin_shift;
    }
    return mesh;
  }

  Shape load_wall_surface(const CaseWall& wall, std::size_t index) {
    if (wall.form) return make_surface(wall.wall.name, wall.form->surface);
    const Shape& source = files_.wall_shape(wall);
    parts_.wall_is_solid[index] = source.kind == ShapeKind::solid;
    Shape surface = make_surface(source.name, mesh_of_file(source));
    surface.verdict = source.verdict;
    return surface;
  }

  void load_walls() {
    auto id = parts_.first_id + static_cast<std::int64_t>(case_.bodies.size());
    parts_.wall_shapes.resize(case_.walls.size());
    parts_.wall_bodies.resize(case_.walls.size());
    parts_.wall_is_solid.assign(case_.walls.size(), false);
    for (std::size_t i = 0; i < case_.walls.size(); ++i) {
      Wall wall = case_.walls[i].wall;
      wall.id = id++;
      if (wall.kind == WallKind::mesh) {
        wall.shape = static_cast<std::int32_t>(scene().shapes.size());
        Shape surface = load_wall_surface(case_.walls[i], i);
        if (parts_.carried) check_surface_goes_on(case_, parts_.carried->from, wall, surface.mesh);
        parts_.wall_shapes[i] = make_pack_shape(surface);
        scene().shapes.push_back(std::move(surface));
      }
      parts_.walls.push_back(wall_at_start(wall));
      const Wall& placed = parts_.walls.back();
      if (wall.kind == WallKind::mesh) parts_.wall_bodies[i] = {&parts_.wall_shapes[i], placed.scale, placed.position, placed.orientation};
      scene().walls.push_back(std::move(wall));
    }
  }

  void load_regions() {
    for (const CasePopulation& p : case_.populations) parts_.regions.push_back(load_region(p.region, p.where));
    for (const CaseInlet& i : case_.inlets) {
      parts_.inlets.push_back(load_region(i.region, i.where));
      scene().inlets.push_back(make_inlet(i, parts_, keep_region(parts_.inlets.back(), i.name)));
    }
    for (const CaseOutlet& o : case_.outlets) {
      parts_.outlets.push_back(load_region(o.region, o.where));
      scene().outlets.push_back({o.name, keep_region(parts_.outlets.back(), o.name), o.to});
    }
  }

  Region load_region(const CaseRegion& asked, const std::string& where) {
    if (asked.shape) return region_of(*asked.shape);
    if (asked.wall >= 0) return inside_of(static_cast<std::size_t>(asked.wall), where);
    const ShapeFile& file = files_.open(asked.file, where);
    const Shape& source = file.shapes.front();
    if (file.shapes.size() != 1 || source.kind == ShapeKind::sphere) {
      throw InputError("{}: {} cannot be a region; expected one closed mesh", where, asked.file);
    }
    try {
      return region_of(mesh_of_file(source));
    } catch (const InputError& e) {
      throw InputError("{}: {} {}", where, asked.file, e.what());
    }
  }

  /// A region as the scene keeps it; a mesh becomes one of its shapes.
  RegionShape keep_region(const Region& region, const std::string& name) {
    RegionShape kept = region.shape;
    kept.motion = {};
    kept.surface = {};
    if (!region.is_mesh()) return kept;
    kept.shape = static_cast<std::int32_t>(scene().shapes.size());
    scene().shapes.push_back(make_surface(name, region.mesh.shape.mesh));
    return kept;
  }

  Region inside_of(std::size_t index, const std::string& where) const {
    const CaseWall& wall = case_.walls[index];
    const Wall& placed = parts_.walls[index];
    if (placed.kind != WallKind::mesh) return region_of(placed);
    if (parts_.wall_is_solid[index]) {
      throw InputError(
          "{}: inside_wall = \"{}\": {} is a solid, and no body lies in a solid; make it a surface (scree-mesher import MESH --surface), "
          "or "
          "give region = {{ box = [[x, y, z], [x, y, z]] }}",
          where, wall.wall.name, wall.file);
    }
    TriangleMesh mesh = wall.form ? wall.form->inside : parts_.wall_shapes[index].shape.mesh;
    if (!wall.form && !is_closed(mesh)) {
      throw InputError(
          "{}: inside_wall = \"{}\": {} is not closed, or its triangles do not all face one side, so that it has no inside; give "
          "region = {{ inside = \"FILE\" }} with a closed mesh, or region = {{ box = [[x, y, z], [x, y, z]] }}",
          where, wall.wall.name, wall.file);
    }
    if (!wall.form && mass_properties(mesh).volume < 0)  // walls may face either side
      turn_inside_out(mesh);
    for (Vec3& p : mesh.vertices) p = placed.position + placed.scale * rotate(placed.orientation, p);
    return region_of(std::move(mesh));
  }

  // ---- what is to be placed ----

  void draw_particles() {
    auto id = parts_.first_id + static_cast<std::int64_t>(case_.bodies.size() + case_.walls.size());
    for (std::size_t k = 0; k < case_.populations.size(); ++k) {
      const CasePopulation& p = case_.populations[k];
      const double density = scene().materials[static_cast<std::size_t>(p.material)].density;
      const double wanted_volume = p.amount == CasePopulation::Amount::mass ? p.value / density : p.value * parts_.regions[k].volume;
      check_amount(p, parts_.regions[k], p.amount == CasePopulation::Amount::count ? p.value * least_volume(p) : wanted_volume);
      std::vector<double> given(p.shares.size(), 0.0);  // number or volume of each shape so far
      std::vector<std::uint64_t> drawn(p.shares.size(), 0);
      const std::optional<SizeSampler> sampler = p.size ? std::optional<SizeSampler>(*p.size) : std::nullopt;
      double volume = 0;
      for (std::size_t n = 0;; ++n) {
        if (p.amount == CasePopulation::Amount::count && static_cast<double>(n) >= p.value) break;
        // the shape furthest behind its share: any prefix of the population has the shares to within one body
        const double total = p.shares_by_mass ? volume : static_cast<double>(n + 1);
        std::size_t next = 0;
        double most_owed = -1e300;
        for (std::size_t s = 0; s < p.shares.size(); ++s) {
          const double owed = p.shares[s].second * total - given[s];
          if (owed > most_owed || (owed == most_owed && p.shares[s].second > p.shares[next].second)) {
            most_owed = owed;
            next = s;
          }
        }
        const Shape& shape = parts_.shapes[static_cast<std::size_t>(p.shares[next].first)].shape;
        Draw draw{id, k, p.shares[next].first, 1, 0};
        if (sampler) draw.scale = sampler->diameter(spread_number(k, next, drawn[next])) / shape.equivalent_diameter();
        draw.volume = shape.mass.volume * draw.scale * draw.scale * draw.scale;
        if (p.amount != CasePopulation::Amount::count && volume + 0.5 * draw.volume > wanted_volume) {
          if (n == 0) refuse_less_than_a_body(p, parts_.regions[k], wanted_volume, density, shape, draw);
          break;
        }
        given[next] += p.shares_by_mass ? draw.volume : 1;
        ++drawn[next];
        volume += draw.volume;
        parts_.draws.push_back(draw);
        ++id;
      }
      check_shares(p, drawn);
      report().solid_fraction.push_back(volume / parts_.regions[k].volume);
    }
  }

  /// Number n of a sequence in [0, 1) that fills it evenly at any length, so that also a few bodies follow their distribution:
  /// the distribution functions differ by about (1 + log n) / n, where independent numbers would differ by 0.9 / sqrt(n).
  /// Source: Kronecker sequence with the golden ratio (Niederreiter 1992), shifted by a random number.
  double spread_number(std::size_t population, std::size_t which, std::uint64_t n) const {
    const RandomNumbers random(case_.settings.seed, -1 - static_cast<std::int64_t>(population), 0);
    const double x = random.uniform(which) + static_cast<double>(n) * (std::numbers::phi - 1);
    return x - std::floor(x);
  }

  double least_volume(const CasePopulation& p) const {
    double least = 1e300;
    for (const auto& [index, share] : p.shares) {
      const Shape& shape = parts_.shape(index).shape;
      const double scale = scales_of(p.size, shape).smallest;
      least = std::min(least, shape.mass.volume * scale * scale * scale);
    }
    return least;
  }

  [[noreturn]] static void refuse_less_than_a_body(const CasePopulation& p, const Region& region, double wanted, double density,
                                                   const Shape& shape, const Draw& first) {
    const std::string body =
        fmt::format("one '{}' of diameter {}", shape.name, format_quantity(first.scale * shape.equivalent_diameter(), Dimension::length));
    if (p.amount == CasePopulation::Amount::mass) {
      throw InputError("{}: mass = {} is less than half of {}, {}: no body would be placed; request more, or smaller bodies", p.where,
                       format_quantity(p.value, Dimension::mass), body, format_quantity(density * first.volume, Dimension::mass));
    }
    throw InputError(
        "{}: solid_fraction = {:g} of the region ({:.4g} m^3) is {:.3g} m^3, less than half of {}, {:.3g} m^3: no body would be "
        "placed; request more, or smaller bodies",
        p.where, p.value, region.volume, wanted, body, first.volume);
  }

  /// A shape with a share that is too small for a single body would be missing without a word.
  void check_shares(const CasePopulation& p, const std::vector<std::uint64_t>& drawn) const {
    for (std::size_t s = 0; s < p.shares.size(); ++s) {
      if (drawn[s] > 0) continue;
      const std::uint64_t all = std::accumulate(drawn.begin(), drawn.end(), std::uint64_t{0});
      throw InputError(
          "{}: the share {:g} of '{}' gives not one of {} bodies; request more bodies, give it a larger share, or leave it out", p.where,
          p.shares[s].second, case_.shapes[static_cast<std::size_t>(p.shares[s].first)].name, all);
    }
  }

  /// Bodies that would leave with the first steps.
  void check_outlets() {
    const BodyTable& bodies = scene().bodies;
    for (std::size_t k = 0; k < case_.outlets.size(); ++k) {
      std::size_t inside = 0;
      for (std::size_t i = 0; i < bodies.size(); ++i)
        inside += bodies.fixed[i] == 0 && parts_.outlets[k].contains(bodies.position[i]) ? 1 : 0;
      if (inside == 0) continue;
      report().notices.push_back(
          fmt::format("{}: {} of the bodies that the scene starts with lie in the outlet '{}' and are taken out at once",
                      case_.outlets[k].where, inside, case_.outlets[k].name));
    }
  }

  void check_cell() const {
    if (!case_.settings.cell) return;
    if (const CellBlocker blocker = cell_blocker(out_.scene); blocker.key != nullptr)
      throw UsageError("{}: {} does not go with [cell]: {}", case_.path, blocker.key, blocker.why);
  }

  void check_none_is_empty(const Placements& placements) const {
    for (std::size_t k = 0; k < case_.populations.size(); ++k) {
      if (placements.count_placed(parts_, k) > 0) continue;
      throw InputError(
          "{}: none of its bodies lies in its region after settling; close the container, or extend the region to where the "
          "walls hold them (region = {{ inside_wall = \"NAME\" }} is what a wall holds)",
          case_.populations[k].where);
    }
  }

  /// Refuses what no packing can hold, before anything is drawn.
  static void check_amount(const CasePopulation& p, const Region& region, double volume) {
    if (volume < region.volume) return;
    constexpr double kSurelyWrong = 1e3;  // a length in another unit is a factor of 10 at least
    throw InputError(
        "{}: the bodies alone take {:.4g} m^3 and more, the region has {:.4g} m^3; request fewer or smaller bodies, or enlarge the "
        "region{}",
        p.where, volume, region.volume,
        volume > kSurelyWrong * region.volume ? "; was a mesh in mm? scree-mesher import MESH --unit mm" : "");
  }

  void fill_report() {
    const BodyTable& b = scene().bodies;
    for (std::size_t i = 0; i < b.size(); ++i) {
      const double s = b.scale[i];
      report().particle_volume += scene().shapes[static_cast<std::size_t>(b.shape[i])].mass.volume * s * s * s;
    }
    report().container_volume = container_volume(scene());
  }

  Case case_;  // of whose pairs only those stay that can meet
  const ChildSolver& solver_;
  PackedScene out_;
  ShapeFiles files_;
  PieceFiles pieces_;
  SceneParts parts_;
};

}  // namespace

double container_volume(const Scene& scene) {
  for (const Wall& w : scene.walls) {
    const Vec3 e = w.upper - w.lower;
    if (w.kind == WallKind::box_inside) return e.x * e.y * e.z;
    if (w.kind == WallKind::cylinder_inside) return kPi * w.radius * w.radius * length(w.axis_end - w.axis_start);
    if (w.kind == WallKind::sphere_inside) return 4.0 / 3.0 * kPi * w.radius * w.radius * w.radius;
  }
  return 0;
}

PackedScene build_scene(const Case& c, const ChildSolver& solver) {
  if (!c.start || !c.settings.cell) return Builder(c, solver).build();
  // bodies of a cell that has deformed lie in that cell
  const std::optional<CellOfRun> cell = read_run(c).cell;
  if (!cell) return Builder(c, solver).build();
  Case in_cell = c;
  in_cell.settings.domain.lower = cell->box.lower;
  in_cell.settings.domain.upper = cell->box.upper;
  in_cell.settings.domain.shear = cell->shear;
  PackedScene packed = Builder(in_cell, solver).build();
  const Vec3 extent = cell->box.extent();
  std::string notice = fmt::format("domain.min and max are those of the periodic cell of {}, {:g} x {:g} x {:g} m", c.start->run, extent.x,
                                   extent.y, extent.z);
  if (!(cell->shear == Vec3{}))
    notice += fmt::format(", sheared by yz {:g}, xz {:g}, xy {:g} m", cell->shear.x, cell->shear.y, cell->shear.z);
  packed.report.notices.push_back(std::move(notice));
  return packed;
}

}  // namespace scree
