#include "decomposer/build_scene.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <numeric>

#include "core/base/error.hpp"
#include "core/base/units.hpp"
#include "decomposer/placed_body.hpp"
#include "decomposer/random_numbers.hpp"

namespace scree {

namespace {

std::string metres(double value) { return format_quantity(value, Dimension::length); }

/// A particle that has been drawn but not placed.
struct Draw {
  std::int64_t id = 0;
  std::size_t population = 0;
  std::int32_t shape = 0;   ///< index into the case's shapes
  double scale = 1, volume = 0;
};

struct Region {
  Box3 box;
  double volume = 0;
  PackShape mesh;             ///< when the region is a mesh
  bool is_mesh = false;
};

class Builder {
 public:
  Builder(const Case& c, const std::function<void(double, double)>& progress) : case_(c), progress_(progress) {}

  PackedScene build() {
    scratch_ = make_mesh_distance_scratch();
    out_.inputs.push_back({case_.path, sha256_of_bytes(case_.text.data(), case_.text.size()), nullptr});
    scene().settings = case_.settings;
    scene().materials = case_.materials;
    for (const CasePair& p : case_.pairs) scene().pairs.push_back(p.pair);
    load_shapes();
    load_walls();
    load_regions();
    draw_particles();
    choose_margin();
    place_given_bodies();
    place_particles();
    fill_report();
    return std::move(out_);
  }

 private:
  Scene& scene() { return out_.scene; }
  PackingReport& report() { return out_.report; }
  double gap() const { return 2 * out_.scene.settings.margin; }   // contact starts at the sum of two margins

  // ---- files ----

  const ShapeFile& open_shapes(const std::string& file, const std::string& where) {
    const auto found = files_.find(file);
    if (found != files_.end()) return found->second;
    try {
      ShapeFile content = read_shape_file(file);
      out_.inputs.push_back({file, sha256_of_file(file), content.provenance});
      return files_.emplace(file, std::move(content)).first->second;
    } catch (const InputError& e) {
      throw InputError("{}: {}; make it with scree-mesher import", where, e.what());
    }
  }

  Shape load_shape(const CaseShape& s) {
    if (s.file.empty()) return make_sphere(s.name, s.sphere_radius);
    const ShapeFile& file = open_shapes(s.file, s.where);
    std::string names;
    for (const Shape& shape : file.shapes) {
      if (file.shapes.size() == 1 && s.name_in_file.empty()) {
        if (shape.kind == ShapeKind::surface) {
          throw InputError("{}: {} is a wall surface without mass; import it without --surface to use it as a body", s.where, s.file);
        }
      } else if (shape.name != s.name_in_file) {
        names += (names.empty() ? "" : ", ") + shape.name;
        continue;
      }
      Shape result = shape;
      result.name = s.name;
      return result;
    }
    throw UsageError("{}: {} holds {} shapes ({}); say which with name = \"...\"", s.where, s.file, file.shapes.size(), names);
  }

  void load_shapes() {
    std::vector<bool> used(case_.shapes.size(), false);
    for (const CaseBody& b : case_.bodies) used[static_cast<std::size_t>(b.shape)] = true;
    for (const CasePopulation& p : case_.populations) {
      for (const auto& share : p.shares) used[static_cast<std::size_t>(share.first)] = true;
    }
    pack_shapes_.resize(case_.shapes.size());
    scene_shape_.assign(case_.shapes.size(), -1);
    for (std::size_t i = 0; i < case_.shapes.size(); ++i) {
      if (!used[i]) {
        report().notices.push_back(fmt::format("{}: is not used", case_.shapes[i].where));
        continue;
      }
      pack_shapes_[i].shape = load_shape(case_.shapes[i]);
      pack_shapes_[i].bvh = build_bvh(pack_shapes_[i].shape.mesh);
      pack_shapes_[i].radius = pack_shapes_[i].shape.bounding_radius();
      scene_shape_[i] = static_cast<std::int32_t>(scene().shapes.size());
      scene().shapes.push_back(pack_shapes_[i].shape);
    }
  }

  void load_walls() {
    auto id = static_cast<std::int64_t>(case_.bodies.size());
    wall_shapes_.resize(case_.walls.size());
    wall_bodies_.resize(case_.walls.size());
    wall_is_solid_.assign(case_.walls.size(), false);
    for (std::size_t i = 0; i < case_.walls.size(); ++i) {
      Wall wall = case_.walls[i].wall;
      wall.id = id++;
      if (wall.kind == WallKind::mesh) {
        const ShapeFile& file = open_shapes(case_.walls[i].file, case_.walls[i].where);
        if (file.shapes.size() != 1) {
          throw InputError("{}: {} holds {} shapes; a wall is made of one", case_.walls[i].where, case_.walls[i].file, file.shapes.size());
        }
        const Shape& source = file.shapes.front();
        if (source.kind == ShapeKind::sphere) {
          throw InputError("{}: {} is an analytic sphere; use a fixed body", case_.walls[i].where, case_.walls[i].file);
        }
        // a wall keeps the coordinates of its file, also when it was imported as a solid
        TriangleMesh mesh = source.mesh;
        if (source.kind == ShapeKind::solid) {
          for (Vec3& p : mesh.vertices) p += source.origin_shift;
          wall_is_solid_[i] = true;
        }
        wall.shape = static_cast<std::int32_t>(scene().shapes.size());
        Shape surface = make_surface(source.name, std::move(mesh));
        surface.verdict = source.verdict;
        wall_shapes_[i] = {surface, build_bvh(surface.mesh), bounding_radius(surface.mesh)};
        wall_bodies_[i] = {&wall_shapes_[i], wall.scale, wall.position, wall.orientation};
        scene().shapes.push_back(std::move(surface));
      }
      scene().walls.push_back(std::move(wall));
    }
  }

  void load_regions() {
    for (const CasePopulation& p : case_.populations) {
      Region region;
      region.box = p.region;
      if (!p.region_file.empty()) {
        const ShapeFile& file = open_shapes(p.region_file, p.where);
        const Shape& source = file.shapes.front();
        region.is_mesh = true;
        region.mesh.shape = source;
        for (Vec3& v : region.mesh.shape.mesh.vertices) v += source.kind == ShapeKind::solid ? source.origin_shift : Vec3{};
        region.volume = mass_properties(region.mesh.shape.mesh).volume;
        if (file.shapes.size() != 1 || source.kind == ShapeKind::sphere || !(region.volume > 0)) {
          throw InputError("{}: {} cannot be a region; expected one closed mesh with outward triangles", p.where, p.region_file);
        }
        region.mesh.shape.kind = ShapeKind::surface;
        region.mesh.bvh = build_bvh(region.mesh.shape.mesh);
        region.mesh.radius = bounding_radius(region.mesh.shape.mesh);
        region.box = bounding_box(region.mesh.shape.mesh);
      } else {
        const Vec3 e = region.box.extent();
        region.volume = e.x * e.y * e.z;
      }
      regions_.push_back(std::move(region));
    }
  }

  // ---- what is to be placed ----

  void draw_particles() {
    auto id = static_cast<std::int64_t>(case_.bodies.size() + case_.walls.size());
    for (std::size_t k = 0; k < case_.populations.size(); ++k) {
      const CasePopulation& p = case_.populations[k];
      const double density = scene().materials[static_cast<std::size_t>(p.material)].density;
      const double wanted_volume = p.amount == CasePopulation::Amount::mass ? p.value / density : p.value * regions_[k].volume;
      std::vector<double> given(p.shares.size(), 0.0);
      double volume = 0;
      for (std::size_t n = 0;; ++n) {
        if (p.amount == CasePopulation::Amount::count && static_cast<double>(n) >= p.value) break;
        // the shape furthest behind its share: any prefix of the population has the shares to within one body
        std::size_t next = 0;
        for (std::size_t s = 1; s < p.shares.size(); ++s) {
          const double owed = p.shares[s].second * static_cast<double>(n + 1) - given[s];
          if (owed > p.shares[next].second * static_cast<double>(n + 1) - given[next]) next = s;
        }
        const Shape& shape = pack_shapes_[static_cast<std::size_t>(p.shares[next].first)].shape;
        Draw draw{id, k, p.shares[next].first, 1, 0};
        if (p.size) draw.scale = p.size->quantile(RandomNumbers(case_.settings.seed, id, 0).uniform(0)) / shape.equivalent_diameter();
        draw.volume = shape.mass.volume * draw.scale * draw.scale * draw.scale;
        if (p.amount != CasePopulation::Amount::count && volume + 0.5 * draw.volume > wanted_volume) break;
        given[next] += 1;
        volume += draw.volume;
        draws_.push_back(draw);
        ++id;
      }
      report().solid_fraction.push_back(volume / regions_[k].volume);
    }
  }

  /// Fastest impact to expect: initial speeds, the highest fall, the fastest wall.
  double fastest_impact() {
    double speed = 0;
    std::size_t movers = draws_.size();
    for (const CaseBody& b : case_.bodies) {
      const double lever = b.scale * pack_shapes_[static_cast<std::size_t>(b.shape)].radius;
      speed = std::max(speed, length(b.velocity) + lever * length(b.angular_velocity));
      movers += b.fixed ? 0 : 1;
    }
    for (const Draw& d : draws_) {
      const CasePopulation& p = case_.populations[d.population];
      const double lever = d.scale * pack_shapes_[static_cast<std::size_t>(d.shape)].radius;
      speed = std::max(speed, length(p.velocity) + lever * length(p.angular_velocity));
    }
    double wall_speed = 0;
    for (std::size_t i = 0; i < scene().walls.size(); ++i) {
      const Wall& w = scene().walls[i];
      const WallMotion& m = w.motion;
      double fastest = 0;
      if (m.kind == WallMotion::Kind::translate) fastest = std::abs(m.rate);
      if (m.kind == WallMotion::Kind::oscillate) fastest = 2 * std::numbers::pi * std::abs(m.frequency * m.amplitude);
      if (m.kind == WallMotion::Kind::rotate) {
        double lever = 0;
        for (const Vec3& p : wall_points(i)) lever = std::max(lever, length(cross(m.axis, p - m.centre)));
        fastest = std::abs(m.rate) * lever;
      }
      for (std::size_t r = 1; r < m.table_time.size(); ++r) {
        fastest = std::max(fastest, length(m.table_position[r] - m.table_position[r - 1]) / (m.table_time[r] - m.table_time[r - 1]));
      }
      wall_speed = std::max(wall_speed, fastest);
    }
    const double g = length(case_.settings.gravity);
    double fall = 0;
    if (g > 0) {
      const Vec3 up = (-1.0 / g) * case_.settings.gravity;
      double top = -1e300, bottom = 1e300;
      const auto add = [&](const Vec3& p, bool starts) {
        if (starts) top = std::max(top, dot(up, p));
        bottom = std::min(bottom, dot(up, p));
      };
      for (const CaseBody& b : case_.bodies) add(b.position, true);
      for (const Region& r : regions_) {
        for (int corner = 0; corner < 8; ++corner) {
          add({(corner & 1 ? r.box.upper : r.box.lower).x, (corner & 2 ? r.box.upper : r.box.lower).y,
               (corner & 4 ? r.box.upper : r.box.lower).z}, true);
        }
      }
      bool has_walls = !scene().walls.empty();
      for (std::size_t i = 0; i < scene().walls.size(); ++i) {
        for (const Vec3& p : wall_points(i)) add(p, false);
      }
      fall = g * case_.settings.duration;
      if (has_walls && top > bottom) fall = std::min(fall, std::sqrt(2 * g * (top - bottom)));
    }
    return fall + (movers >= 2 ? 2 : 1) * speed + wall_speed;
  }

  /// Points that span a wall: where things can fall to, and what its rotation moves.
  std::vector<Vec3> wall_points(std::size_t i) {
    const Wall& w = scene().walls[i];
    switch (w.kind) {
      case WallKind::plane: return {w.point};
      case WallKind::box_inside:
        return {w.lower, w.upper, {w.upper.x, w.lower.y, w.lower.z}, {w.lower.x, w.upper.y, w.lower.z}, {w.lower.x, w.lower.y, w.upper.z},
                {w.lower.x, w.upper.y, w.upper.z}, {w.upper.x, w.lower.y, w.upper.z}, {w.upper.x, w.upper.y, w.lower.z}};
      case WallKind::cylinder_inside: {
        std::vector<Vec3> points;
        for (const Vec3& end : {w.axis_start, w.axis_end}) {
          for (int k = 0; k < 3; ++k) {
            Vec3 arm;
            arm[k] = w.radius;
            points.push_back(end + arm);
            points.push_back(end - arm);
          }
        }
        return points;
      }
      case WallKind::sphere_inside: {
        std::vector<Vec3> points;
        for (int k = 0; k < 3; ++k) {
          Vec3 arm;
          arm[k] = w.radius;
          points.push_back(w.point + arm);
          points.push_back(w.point - arm);
        }
        return points;
      }
      case WallKind::mesh: return wall_bodies_[i].world_vertices();
    }
    return {};
  }

  /// Margin from size, speed and stiffness: the depth v sqrt(m/k) of the worst impact may use up kDepthShare of
  /// the margin sum. Source: design rule of VALIDATION.md section 2, k >= m (v / (f e))^2.
  void choose_margin() {
    double heaviest = 0, smallest = 1e300;
    bool has_meshes = false;
    const auto add = [&](std::int32_t shape, std::int32_t material, double scale, bool moves) {
      const Shape& s = pack_shapes_[static_cast<std::size_t>(shape)].shape;
      has_meshes = has_meshes || s.kind != ShapeKind::sphere;
      if (!moves) return;
      heaviest = std::max(heaviest, scene().materials[static_cast<std::size_t>(material)].density * s.mass.volume * scale * scale * scale);
      smallest = std::min(smallest, scale * s.equivalent_diameter());
    };
    for (const CaseBody& b : case_.bodies) add(b.shape, b.material, b.scale, !b.fixed);
    for (const Draw& d : draws_) add(d.shape, case_.populations[d.population].material, d.scale, true);
    double softest = 1e300;
    for (const CasePair& p : case_.pairs) softest = std::min(softest, p.pair.stiffness);
    report().fastest_impact = fastest_impact();
    const double depth = heaviest > 0 && softest < 1e300 ? report().fastest_impact * std::sqrt(heaviest / softest) : 0;

    double& margin = scene().settings.margin;
    if (!case_.margin_given && heaviest > 0) {
      constexpr double kSmallestShare = 0.01, kNoticeShare = 0.05, kLargestShare = 0.2;  // of the smallest body's diameter
      margin = std::max(0.5 * depth / kDepthShare, kSmallestShare * smallest);
      const double needed = heaviest * std::pow(report().fastest_impact / (kDepthShare * 2 * kNoticeShare * smallest), 2);
      const std::string advice = fmt::format(
          "the margin derived from the heaviest body ({}), the fastest impact expected ({}) and the softest pair ({}) is {}, {:.0f} % of "
          "the smallest body; a stiffness of {} would bring it to 5 %", format_quantity(heaviest, Dimension::mass),
          format_quantity(report().fastest_impact, Dimension::velocity), format_quantity(softest, Dimension::stiffness), metres(margin),
          100 * margin / smallest, format_quantity(needed, Dimension::stiffness));
      if (margin > kLargestShare * smallest) throw UsageError("{}: contact.margin: {}; raise it, or give contact.margin", case_.path, advice);
      if (margin > kNoticeShare * smallest) report().notices.push_back(advice);
    }
    if (has_meshes && !(margin > 0)) {
      throw UsageError("{}: contact.margin = 0: meshes need a margin > 0 (typically 1 to 3 % of the body's size); leave it out to have it derived",
                       case_.path);
    }
    if (margin > 0) report().depth_share = depth / (2 * margin);
    constexpr double kWarnShare = 0.8;
    if (report().depth_share > kWarnShare) {
      report().notices.push_back(fmt::format(
          "the fastest impact expected ({}) of the heaviest body ({}) would use up {:.2f} of the margins and end the run; "
          "raise stiffness to {} or margin to {}", format_quantity(report().fastest_impact, Dimension::velocity),
          format_quantity(heaviest, Dimension::mass), report().depth_share,
          format_quantity(softest * std::pow(report().depth_share / kDepthShare, 2), Dimension::stiffness),
          metres(margin * report().depth_share / kDepthShare)));
    }
  }

  // ---- placing ----

  void add_body(std::int64_t id, std::int32_t shape, std::int32_t material, const PlacedBody& placed, const Vec3& velocity,
                const Vec3& angular_velocity, bool fixed, bool lock_rotation, std::int32_t population) {
    BodyTable& b = scene().bodies;
    b.id.push_back(id);
    b.shape.push_back(scene_shape_[static_cast<std::size_t>(shape)]);
    b.material.push_back(material);
    b.scale.push_back(placed.scale);
    b.position.push_back(placed.position);
    b.orientation.push_back(placed.orientation);
    b.velocity.push_back(velocity);
    b.angular_velocity.push_back(angular_velocity);
    b.fixed.push_back(fixed ? 1 : 0);
    b.lock_rotation.push_back(lock_rotation ? 1 : 0);
    b.population.push_back(population);
  }

  bool domain_holds(const Vec3& p) const {
    const Domain& d = case_.settings.domain;
    if (!d.bounded) return true;
    for (int k = 0; k < 3; ++k) {
      if (p[k] < d.lower[k] || p[k] > d.upper[k]) return false;
    }
    return true;
  }

  bool walls_allow(const PlacedBody& body, const std::vector<Vec3>& vertices, double distance, std::size_t* refusing = nullptr) {
    for (std::size_t i = 0; i < scene().walls.size(); ++i) {
      if (wall_allows(scene().walls[i], &wall_bodies_[i], wall_is_solid_[i], body, vertices, distance, *scratch_)) continue;
      if (refusing != nullptr) *refusing = i;
      return false;
    }
    return true;
  }

  void place_given_bodies() {
    for (std::size_t i = 0; i < case_.bodies.size(); ++i) {
      const CaseBody& b = case_.bodies[i];
      const PlacedBody body{&pack_shapes_[static_cast<std::size_t>(b.shape)], b.scale, b.position, b.orientation};
      if (!domain_holds(b.position)) throw InputError("{}: lies outside the domain", b.where);
      // a fixed body may stand in a wall: nothing ever computes their contact
      std::size_t wall = 0;
      const std::vector<Vec3> vertices = body.world_vertices();
      const double touch = 1e-9 * body.radius();
      if (!b.fixed && !walls_allow(body, vertices, touch, &wall)) {
        throw InputError("{}: overlaps {} (wall '{}') or lies behind it; move it", b.where, case_.walls[wall].where, scene().walls[wall].name);
      }
      if (!b.fixed && !walls_allow(body, vertices, gap(), &wall)) {
        report().notices.push_back(fmt::format("{}: starts in contact with wall '{}'", b.where, scene().walls[wall].name));
      }
      for (std::size_t j = 0; j < i; ++j) {
        if (b.fixed && case_.bodies[j].fixed) continue;
        if (length(placed_[j].position - body.position) > placed_[j].radius() + body.radius() + gap()) continue;
        const double found = gap_between(placed_[j], body, std::max(gap(), touch) * kJustAbove, *scratch_);
        if (!(found > 0)) throw InputError("{}: overlaps {}; move one of them", b.where, case_.bodies[j].where);
        if (found < gap()) report().notices.push_back(fmt::format("{}: starts in contact with {}", b.where, case_.bodies[j].where));
      }
      placed_.push_back(body);
      grid_.insert(static_cast<std::int32_t>(i), body.position, body.radius());
      add_body(static_cast<std::int64_t>(i), b.shape, b.material, body, b.velocity, b.angular_velocity, b.fixed, b.lock_rotation, -1);
    }
  }

  /// Whether a drawn place is free: in the region and the domain, clear of walls and of all bodies so far.
  bool is_free(const PlacedBody& body, const Region& region) {
    if (!domain_holds(body.position)) return false;
    const std::vector<Vec3> vertices = body.world_vertices();
    if (region.is_mesh) {
      const PlacedBody hull{&region.mesh, 1, {}, {}};
      if (!is_inside(region.mesh.shape.mesh, vertices.front())) return false;
      if (!(gap_between(hull, body, 1e-6 * body.radius(), *scratch_) > 0)) return false;
    }
    if (!walls_allow(body, vertices, gap())) return false;
    bool free = true;
    grid_.for_each_near(body.position, body.radius() + gap(), [&](std::int32_t j) {
      const double touch = std::max(gap(), 1e-12 * body.radius());
      free = gap_between(placed_[static_cast<std::size_t>(j)], body, touch * kJustAbove, *scratch_) >= touch;
      return free;
    });
    return free;
  }

  bool try_place(const Draw& d, const Region& region, PlacedBody& body) {
    for (std::uint64_t attempt = 1; attempt <= kAttempts; ++attempt) {
      ++report().attempts;
      const RandomNumbers random(case_.settings.seed, d.id, attempt);
      body.orientation = random.orientation(0);
      body.position = {};
      // the centre is drawn from where the turned body fits between the sides of the region
      const Box3 extent = body.world_box();
      const Vec3 low = region.box.lower - extent.lower, high = region.box.upper - extent.upper;
      if (low.x > high.x || low.y > high.y || low.z > high.z) continue;
      for (int k = 0; k < 3; ++k) body.position[k] = low[k] + random.uniform(static_cast<std::uint64_t>(3 + k)) * (high[k] - low[k]);
      if (is_free(body, region)) return true;
    }
    return false;
  }

  void place_particles() {
    // largest first: small ones find holes between large ones, not the reverse
    std::vector<std::size_t> order(draws_.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    const auto radius = [&](std::size_t i) { return draws_[i].scale * pack_shapes_[static_cast<std::size_t>(draws_[i].shape)].radius; };
    std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
      return radius(a) != radius(b) ? radius(a) > radius(b) : draws_[a].id < draws_[b].id;
    });
    std::vector<PlacedBody> places(draws_.size());
    std::vector<std::size_t> placed_count(case_.populations.size(), 0);
    std::vector<double> placed_volume(case_.populations.size(), 0.0);
    for (std::size_t n = 0; n < order.size(); ++n) {
      const Draw& d = draws_[order[n]];
      PlacedBody& body = places[order[n]];
      body = {&pack_shapes_[static_cast<std::size_t>(d.shape)], d.scale, {}, {}};
      if (!try_place(d, regions_[d.population], body)) fail(d, n, placed_count, placed_volume);
      grid_.insert(static_cast<std::int32_t>(placed_.size()), body.position, body.radius());
      placed_.push_back(body);
      ++placed_count[d.population];
      placed_volume[d.population] += d.volume;
      if (progress_) progress_(static_cast<double>(n + 1), static_cast<double>(order.size()));
    }
    for (std::size_t i = 0; i < draws_.size(); ++i) {
      const CasePopulation& p = case_.populations[draws_[i].population];
      add_body(draws_[i].id, draws_[i].shape, p.material, places[i], p.velocity, p.angular_velocity, false, false,
               static_cast<std::int32_t>(draws_[i].population));
    }
  }

  [[noreturn]] void fail(const Draw& d, std::size_t placed, const std::vector<std::size_t>& count, const std::vector<double>& volume) {
    const CasePopulation& p = case_.populations[d.population];
    std::size_t wanted = 0;
    for (const Draw& other : draws_) wanted += other.population == d.population ? 1 : 0;
    const double region = regions_[d.population].volume;
    const std::string all = case_.populations.size() > 1 ? fmt::format(" ({} of {} over all populations)", placed, draws_.size()) : "";
    throw InputError(
        "{}: placed {} of {} bodies{}; the next one ('{}', diameter {}, largest first) found no place in {} draws. The solid fraction reached is "
        "{:.3f} of the {:.3f} asked for. Enlarge the region (now {:.4g} m^3), ask for fewer or smaller bodies, or reduce the margin ({})",
        p.where, count[d.population], wanted, all, case_.shapes[static_cast<std::size_t>(d.shape)].name,
        metres(d.scale * pack_shapes_[static_cast<std::size_t>(d.shape)].shape.equivalent_diameter()), kAttempts,
        volume[d.population] / region, report().solid_fraction[d.population], region, metres(scene().settings.margin));
  }

  void fill_report() {
    const BodyTable& b = scene().bodies;
    for (std::size_t i = 0; i < b.size(); ++i) {
      const double s = b.scale[i];
      report().particle_volume += scene().shapes[static_cast<std::size_t>(b.shape[i])].mass.volume * s * s * s;
    }
    report().container_volume = container_volume(scene());
  }

  const Case& case_;
  const std::function<void(double, double)>& progress_;
  PackedScene out_;
  std::map<std::string, ShapeFile> files_;
  std::vector<PackShape> pack_shapes_, wall_shapes_;
  std::vector<std::int32_t> scene_shape_;      // of a case's shape, -1 when unused
  std::vector<PlacedBody> wall_bodies_;        // of mesh walls
  std::vector<bool> wall_is_solid_;
  std::vector<Region> regions_;
  std::vector<Draw> draws_;
  std::vector<PlacedBody> placed_;
  PlacedGrid grid_;
  MeshDistanceScratchPtr scratch_;
};

}  // namespace

double container_volume(const Scene& scene) {
  constexpr double kPi = std::numbers::pi;
  for (const Wall& w : scene.walls) {
    const Vec3 e = w.upper - w.lower;
    if (w.kind == WallKind::box_inside) return e.x * e.y * e.z;
    if (w.kind == WallKind::cylinder_inside) return kPi * w.radius * w.radius * length(w.axis_end - w.axis_start);
    if (w.kind == WallKind::sphere_inside) return 4.0 / 3.0 * kPi * w.radius * w.radius * w.radius;
  }
  return 0;
}

PackedScene build_scene(const Case& c, const std::function<void(double, double)>& progress) { return Builder(c, progress).build(); }

}  // namespace scree
