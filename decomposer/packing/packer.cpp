#include "decomposer/packing/packer.hpp"

#include <algorithm>

#include "core/base/error.hpp"
#include "core/base/long_work.hpp"
#include "core/base/units.hpp"
#include "core/placing/orientation.hpp"
#include "core/placing/random_numbers.hpp"
#include "core/storage/contact_limits.hpp"
#include "core/storage/domain_side.hpp"

namespace scree {

namespace {

// An easy packing needs fewer draws than this and never makes a vacancy map.
constexpr std::uint64_t kPlainDraws = 32;

// Which of a particle's random numbers is what.
constexpr std::uint64_t kOrientation = 0, kPlace = 3, kVoxel = 6;

}  // namespace

Packer::Packer(const Case& c, const SceneParts& parts, Scene& scene, PackingReport& report)
    : case_(c),
      parts_(parts),
      scene_(scene),
      report_(report),
      periodicity_(periodicity_of(c.settings.domain)),
      scratch_(make_mesh_distance_scratch()) {
  vacancies_.resize(case_.populations.size());
  smallest_ball_.assign(case_.populations.size(), 1e300);
  for (const Draw& d : parts_.draws) {
    double& ball = smallest_ball_[d.population];
    ball = std::min(ball, d.scale * parts_.shape(d.shape).inner_radius);
  }
}

void Packer::keep(const PlacedBody& body, std::int32_t given) {
  const Domain& d = case_.settings.domain;
  const auto turns = [&](int k) { return periodicity_.is_periodic(k) ? 1 : 0; };
  for (int i = -turns(0); i <= turns(0); ++i) {
    for (int j = -turns(1); j <= turns(1); ++j) {
      for (int k = -turns(2); k <= turns(2); ++k) {
        PlacedBody image = body;
        image.position = periodicity_.way_of(body.position, {static_cast<double>(i), static_cast<double>(j), static_cast<double>(k)});
        // the solver wants a period of two diameters, so nothing that reaches further in can be met
        bool in_reach = true;
        for (int axis = 0; axis < 3; ++axis) {
          const double reach = 0.5 * periodicity_.period()[axis];
          in_reach = in_reach && (!periodicity_.is_periodic(axis) ||
                                  (image.position[axis] >= d.lower[axis] - reach && image.position[axis] <= d.upper[axis] + reach));
        }
        if (in_reach) keep_one(image, given);
      }
    }
  }
}

void Packer::keep_one(const PlacedBody& body, std::int32_t given) {
  given_.push_back(given);
  grid_.insert(static_cast<std::int32_t>(placed_.size()), body.position, body.radius());
  placed_.push_back(body);
  for (std::size_t k = 0; k < vacancies_.size(); ++k) {
    if (vacancies_[k]) vacancies_[k]->close(body.position, inner_ball(body) + smallest_ball_[k] + gap());
  }
}

bool Packer::domain_holds(const Vec3& p) const {
  const Domain& d = case_.settings.domain;
  if (!d.bounded) return true;
  for (int k = 0; k < 3; ++k) {
    if (p[k] < d.lower[k] || p[k] > d.upper[k]) return false;
  }
  return true;
}

bool Packer::walls_allow(const PlacedBody& body, const std::vector<Vec3>& vertices, double distance, std::size_t* refusing) {
  for (std::size_t i = 0; i < parts_.walls.size(); ++i) {
    if (wall_allows(parts_.walls[i], &parts_.wall_bodies[i], parts_.wall_is_solid[i], body, vertices, distance, *scratch_)) continue;
    if (refusing != nullptr) *refusing = i;
    return false;
  }
  return true;
}

double Packer::deepest(const PlacedBody& a, const PlacedBody& b) const {
  // what touches deeper than this ends the run before its first step; a barrier gives way until surfaces meet
  const bool yields = scene_.settings.barrier > 0;
  if (scene_.settings.surface == TouchAt::drawn) {
    const double margins = a.margin() + b.margin();
    return margins > 0 ? -(yields ? 1 : kStopOverlapRatio) * margins : -kPressedIn * std::min(a.rounding(), b.rounding());
  }
  return yields ? 0 : (1 - kStopOverlapRatio) * gap();
}

double Packer::deepest(const PlacedBody& body, const Wall& wall) const {
  // an analytic wall carries the margin of the body
  if (scene_.settings.surface == TouchAt::outside) return std::max(kTouch * body.radius(), deepest(body, body));
  return wall.kind == WallKind::mesh && !body.is_sphere() ? 0.5 * deepest(body, body) : deepest(body, body);
}

bool Packer::walls_bear(const PlacedBody& body, const std::vector<Vec3>& vertices, std::size_t& refusing) {
  for (std::size_t i = 0; i < parts_.walls.size(); ++i) {
    const double least = deepest(body, parts_.walls[i]);
    if (wall_allows(parts_.walls[i], &parts_.wall_bodies[i], parts_.wall_is_solid[i], body, vertices, least, *scratch_)) continue;
    refusing = i;
    return false;
  }
  return true;
}

void Packer::place_given_bodies() {
  constexpr std::size_t kShown = 5;  // a bed that was settled elsewhere has thousands of contacts
  std::size_t contacts = 0;
  const auto starts_in_contact = [&](const CaseBody& body, const std::string& with) {
    if (++contacts <= kShown) report_.notices.push_back(fmt::format("{}: starts in contact with {}", body.where, with));
  };
  for (std::size_t i = 0; i < case_.bodies.size(); ++i) {
    const CaseBody& b = case_.bodies[i];
    const PlacedBody body{&parts_.shape(b.shape), b.scale, b.position, b.orientation};
    if (!domain_holds(b.position))
      throw InputError("{}: lies outside the domain: its centre is {}; move it, or widen the domain", b.where,
                       beyond_side(case_.settings.domain, b.position, true));
    // a fixed body may stand in a wall: nothing ever computes their contact
    std::size_t wall = 0;
    const std::vector<Vec3> vertices = body.world_vertices();
    if (!b.fixed && !walls_bear(body, vertices, wall)) {
      throw InputError(
          "{}: overlaps {} (wall '{}'), touches it to more than {} of the margins, or lies behind it; move it, or set contact.relax = true",
          b.where, case_.walls[wall].where, scene_.walls[wall].name, kStopOverlapRatio);
    }
    // drawn surfaces that meet to rounding are not pressed
    const double apart = gap() > 0 ? gap() : -kTouch * body.radius();
    if (!b.fixed && !walls_allow(body, vertices, apart, &wall)) {
      starts_in_contact(b, fmt::format("wall '{}'", scene_.walls[wall].name));
    }
    near_.clear();
    const double near = std::max(gap(), kTouch * body.radius());
    grid_.for_each_near(body.position, body.radius() + near, [&](std::int32_t j) {
      near_.push_back(j);
      return true;
    });
    std::sort(near_.begin(), near_.end());  // reported in the order of the case
    for (const std::int32_t n : near_) {
      const auto j = static_cast<std::size_t>(n);
      if (b.fixed && is_fixed(j)) continue;
      const double found = gap_between(placed_[j], body, near * kJustAbove, *scratch_);
      if (!(found > deepest(body, placed_[j]))) {
        throw InputError("{}: overlaps {}, or touches it to more than {} of the margins; {}", b.where, name_of(j), kStopOverlapRatio,
                         is_carried(j) ? "move it away" : "move one of them, or set contact.relax = true");
      }
      if (found < apart) starts_in_contact(b, name_of(j));
    }
    keep(body, static_cast<std::int32_t>(i));
    BodyRow row;
    row.id = parts_.first_id + static_cast<std::int64_t>(i);
    row.shape = parts_.scene_shape[static_cast<std::size_t>(b.shape)];
    row.material = b.material;
    row.scale = b.scale;
    row.position = b.position;
    row.orientation = b.orientation;
    row.velocity = b.velocity;
    row.angular_velocity = b.angular_velocity;
    row.fixed = b.fixed;
    row.lock_rotation = b.lock_rotation;
    row.temperature = b.temperature;
    row.heat_source = b.heat_source;
    row.heat_table = b.heat_table;
    scene_.bodies.add(row);
  }
  if (contacts > kShown)
    report_.notices.push_back(
        fmt::format("{} pairs of given bodies, or of a given body and a wall, start in contact; the first {} are named", contacts, kShown));
}

bool Packer::is_free(const PlacedBody& body, const Region& region) {
  if (!domain_holds(body.position)) return false;
  // solids whose inner balls come closer than the gap are closer than the gap themselves: nearly all refusals end here
  near_.clear();
  bool free = true;
  const double ball = inner_ball(body);
  grid_.for_each_near(body.position, body.radius() + gap(), [&](std::int32_t j) {
    const PlacedBody& other = placed_[static_cast<std::size_t>(j)];
    const double least = ball + inner_ball(other) + gap();
    free = ball <= 0 || inner_ball(other) <= 0 || squared_length(other.position - body.position) >= least * least;
    near_.push_back(j);
    return free;
  });
  if (!free) return false;
  body.world_vertices(vertices_);
  if (!region.is_box() && !region.holds(body, vertices_, 0, *scratch_)) return false;  // a box holds what was drawn
  if (!walls_allow(body, vertices_, gap())) return false;
  const double touch = std::max(gap(), 1e-12 * body.radius());
  return std::all_of(near_.begin(), near_.end(), [&](std::int32_t j) {
    return gap_between(placed_[static_cast<std::size_t>(j)], body, touch * kJustAbove, *scratch_) >= touch;
  });
}

Box3 Packer::box_of_centres(const Region& region, const Box3& extent) const {
  const Domain& domain = case_.settings.domain;
  Box3 box{region.box.lower - extent.lower, region.box.upper - extent.upper};
  for (int k = 0; k < 3; ++k) {
    // a region as long as a periodic axis has no sides there
    const bool around =
        domain.periodic[static_cast<std::size_t>(k)] && region.box.lower[k] <= domain.lower[k] && region.box.upper[k] >= domain.upper[k];
    if (!around || !region.is_box()) continue;
    box.lower[k] = domain.lower[k];
    box.upper[k] = domain.upper[k];
  }
  return box;
}

VacancyMap& Packer::vacancy(std::size_t population) {
  std::optional<VacancyMap>& map = vacancies_[population];
  if (!map) {
    double smallest_body = 1e300;
    for (const Draw& d : parts_.draws) {
      if (d.population == population) smallest_body = std::min(smallest_body, d.scale * parts_.shape(d.shape).radius);
    }
    const double ball = smallest_ball_[population];
    map.emplace(box_of_centres(parts_.regions[population], {{-ball, -ball, -ball}, {ball, ball, ball}}), ball, smallest_body);
    for (const PlacedBody& body : placed_) map->close(body.position, inner_ball(body) + ball + gap());
  }
  return *map;
}

bool Packer::try_place(const Draw& d, PlacedBody& body, std::uint64_t attempts, std::uint64_t first) {
  const Region& region = parts_.regions[d.population];
  const BodyOrientation& turned = case_.populations[d.population].orientation;
  fits_ = false;
  for (std::uint64_t attempt = first + 1; attempt <= first + attempts; ++attempt) {
    ++report_.attempts;
    const RandomNumbers random(case_.settings.seed, d.id, attempt);
    body.orientation = draw_orientation(turned, body.shape->shape, random, kOrientation);
    body.position = {};
    // the centre is drawn from where the turned body fits between the sides of the region
    const Box3 box = box_of_centres(region, body.world_box());
    const Vec3 &low = box.lower, &high = box.upper;
    if (low.x > high.x || low.y > high.y || low.z > high.z) continue;
    fits_ = true;
    const Vec3 place{random.uniform(kPlace), random.uniform(kPlace + 1), random.uniform(kPlace + 2)};
    if (attempt - first <= kPlainDraws) {
      for (int k = 0; k < 3; ++k) body.position[k] = low[k] + place[k] * (high[k] - low[k]);
    } else {
      VacancyMap& map = vacancy(d.population);
      if (map.is_full()) return false;
      body.position = map.draw(random, kVoxel, place);
      const Vec3& p = body.position;
      if (p.x < low.x || p.y < low.y || p.z < low.z || p.x > high.x || p.y > high.y || p.z > high.z) continue;
    }
    if (is_free(body, region)) return true;
  }
  return false;
}

void Packer::place_particles(Placements& placements) {
  // largest first: small ones find holes between large ones, not the reverse
  std::vector<std::size_t> order;
  for (std::size_t i = 0; i < parts_.draws.size(); ++i) {
    if (case_.populations[parts_.draws[i].population].method == PackingMethod::random) order.push_back(i);
  }
  const auto radius = [&](std::size_t i) { return parts_.draws[i].scale * parts_.shape(parts_.draws[i].shape).radius; };
  std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return radius(a) != radius(b) ? radius(a) > radius(b) : parts_.draws[a].id < parts_.draws[b].id;
  });
  for (std::size_t k = 0; k < case_.populations.size(); ++k) {
    if (case_.populations[k].method == PackingMethod::lattice) place_on_lattice(k, placements);
  }
  LongWork work("packing", static_cast<double>(order.size()));
  for (std::size_t n = 0; n < order.size(); ++n) {
    const Draw& d = parts_.draws[order[n]];
    const std::uint64_t before = report_.attempts;
    if (!try_place(d, placements.body[order[n]], kAttempts, 0)) fail(d, report_.attempts - before, placements);
    keep(placements.body[order[n]]);
    placements.is_placed[order[n]] = 1;
    work.update(static_cast<double>(n + 1), fmt::format("{} of {} bodies", n + 1, order.size()));
  }
}

void Packer::fail(const Draw& d, std::uint64_t attempts, const Placements& placements) {
  const CasePopulation& p = case_.populations[d.population];
  std::size_t wanted = 0;
  for (const Draw& other : parts_.draws) wanted += other.population == d.population ? 1 : 0;
  const Region& region = parts_.regions[d.population];
  const std::string name = case_.shapes[static_cast<std::size_t>(d.shape)].name;
  const std::string diameter = metres(d.scale * parts_.shape(d.shape).shape.equivalent_diameter());
  if (!fits_) {
    const Vec3 e = region.box.extent();
    throw InputError(
        "{}: '{}' of diameter {} is larger than the region ({} x {} x {}) in all of {} orientations; enlarge the region, or make the "
        "bodies smaller",
        p.where, name, diameter, metres(e.x), metres(e.y), metres(e.z), attempts);
  }
  throw InputError(
      "{}: placed {} of {} bodies; the next one ('{}', diameter {}, largest first) found no place in {} draws. The solid fraction reached "
      "is {:.3f} instead of the requested {:.3f}. Enlarge the region (now {:.4g} m^3), request fewer or smaller bodies, reduce the margin "
      "({}), or use "
      "method = \"settle\" or \"compact\"",
      p.where, placements.count_placed(parts_, d.population), wanted, name, diameter, attempts,
      placements.volume_placed(parts_, d.population) / region.volume, report_.solid_fraction[d.population], region.volume,
      metres(scene_.settings.margin));
}

}  // namespace scree
