#include "decomposer/relax.hpp"

#include <algorithm>
#include <cmath>

#include "core/base/error.hpp"
#include "core/geometry/periodic.hpp"

namespace scree {

namespace {

/// Length that leads out of an overlap along `direction`, or `most` when no shorter one does. is_free(length): out at that length.
template <class IsFree>
double way_out(double most, double stride, IsFree&& is_free) {
  double before = 0, way = stride;
  while (way < most && !is_free(way)) {
    before = way;
    way += stride;
  }
  if (way >= most) return most;
  constexpr int kHalvings = 50;  // to the last bits of a stride
  for (int i = 0; i < kHalvings; ++i) {
    const double middle = 0.5 * (before + way);
    (is_free(middle) ? way : before) = middle;
  }
  return way;
}

class Relaxer {
 public:
  Relaxer(Case& c, const SceneParts& parts, const Scene& scene, double gap)
      : case_(c), parts_(parts), scene_(scene), gap_(gap * kJustAbove), scratch_(make_mesh_distance_scratch()),
        periodicity_(c.settings.domain.lower, c.settings.domain.upper, c.settings.domain.periodic) {
    for (const CaseBody& b : case_.bodies) {
      bodies_.push_back({&parts.shape(b.shape), b.scale, b.position, b.orientation});
      const double s = b.scale;
      const Shape& shape = bodies_.back().shape->shape;
      mass_.push_back(c.materials[static_cast<std::size_t>(b.material)].density * shape.mass.volume * s * s * s);
    }
  }

  Relaxation run() {
    Relaxation result;
    std::string apart;
    while (!(apart = sweep()).empty()) {
      if (++result.sweeps == kMostSweeps) {
        throw InputError("{} after {} sweeps of contact.relax; give the bodies more room", apart, result.sweeps);
      }
    }
    for (std::size_t i = 0; i < bodies_.size(); ++i) {
      const Vec3 way = bodies_[i].position - case_.bodies[i].position;
      if (length(way) == 0) continue;
      ++result.moved;
      result.furthest = std::max(result.furthest, length(way));
      result.potential_change -= mass_[i] * dot(case_.settings.gravity, way);
      case_.bodies[i].position = bodies_[i].position;
    }
    return result;
  }

 private:
  /// Goes through all pairs once; names one that was still too close, or "".
  std::string sweep() {
    std::string found;
    for (std::size_t i = 0; i < bodies_.size(); ++i) {
      if (!case_.bodies[i].fixed) {
        for (std::size_t w = 0; w < scene_.walls.size(); ++w) {
          if (wall_holds(w, bodies_[i])) continue;
          push_from_wall(i, w);
          found = fmt::format("{}: still overlaps {} (wall '{}')", case_.bodies[i].where, case_.walls[w].where, scene_.walls[w].name);
        }
      }
      for (std::size_t j = 0; j < i; ++j) {
        if (case_.bodies[i].fixed && case_.bodies[j].fixed) continue;
        PlacedBody other = bodies_[j];
        if (periodicity_.any()) other.position = bodies_[i].position + periodicity_.nearest(other.position - bodies_[i].position);
        if (length(bodies_[i].position - other.position) > bodies_[i].radius() + other.radius() + gap_) continue;
        if (are_apart(bodies_[i], other)) continue;
        push_apart(i, j, other);
        found = fmt::format("{}: still overlaps {}", case_.bodies[i].where, case_.bodies[j].where);
      }
    }
    return found;
  }

  bool are_apart(const PlacedBody& a, const PlacedBody& b) { return gap_between(a, b, gap_ * kJustAbove, *scratch_) >= gap_; }

  bool wall_holds(std::size_t w, const PlacedBody& body) {
    return wall_allows(parts_.walls[w], &parts_.wall_bodies[w], parts_.wall_is_solid[w], body, body.world_vertices(), gap_, *scratch_);
  }

  /// The shortest way out among directions; the first among equals.
  template <class IsFreeAt>
  Vec3 shortest(const std::vector<Vec3>& directions, double most, double stride, IsFreeAt&& is_free_at) {
    Vec3 best;
    double least = most;
    for (const Vec3& d : directions) {
      // what is longer than the best by less than rounding does not take its place
      constexpr double kShorter = 1 - 1e-9;
      const double way = way_out(least, stride, [&](double t) { return is_free_at(t * d); });
      if (way < kShorter * least) {
        least = way;
        best = d;
      }
    }
    return least * best;
  }

  static void add_axes(const Quat& q, std::vector<Vec3>& directions) {
    for (int k = 0; k < 3; ++k) {
      Vec3 axis;
      axis[k] = 1;
      for (const Vec3& d : {rotate(q, axis), -rotate(q, axis)}) {
        constexpr double kSame = 1 - 1e-12;
        if (std::none_of(directions.begin(), directions.end(), [&](const Vec3& known) { return dot(known, d) > kSame; })) directions.push_back(d);
      }
    }
  }

  void push_apart(std::size_t i, std::size_t j, const PlacedBody& other) {
    std::vector<Vec3> directions;
    const Vec3 between = bodies_[i].position - other.position;
    if (length(between) > 0) directions.push_back(normalised(between));
    add_axes(bodies_[i].orientation, directions);
    add_axes(other.orientation, directions);
    add_axes({}, directions);
    const double smaller = std::min(bodies_[i].radius(), other.radius()), reach = bodies_[i].radius() + other.radius();
    // beyond both diameters nothing can be in the way
    Vec3 way = shortest(directions, 2 * reach + gap_, stride_of(smaller, reach), [&](const Vec3& t) {
      PlacedBody moved = bodies_[i];
      moved.position += t;
      return are_apart(moved, other);
    });
    way = capped(way, kRelaxShare * smaller);
    const double inverse_i = case_.bodies[i].fixed ? 0 : 1 / mass_[i], inverse_j = case_.bodies[j].fixed ? 0 : 1 / mass_[j];
    bodies_[i].position += (inverse_i / (inverse_i + inverse_j)) * way;
    bodies_[j].position -= (inverse_j / (inverse_i + inverse_j)) * way;
  }

  void push_from_wall(std::size_t i, std::size_t w) {
    const Wall& wall = parts_.walls[w];
    const Vec3& x = bodies_[i].position;
    std::vector<Vec3> directions;
    const auto towards = [&](const Vec3& d) {
      if (length(d) > 0) directions.push_back(normalised(d));
    };
    if (wall.kind == WallKind::plane) towards(wall.normal);
    if (wall.kind == WallKind::sphere_inside) towards(wall.point - x);
    if (wall.kind == WallKind::cylinder_inside) {
      const Vec3 axis = normalised(wall.axis_end - wall.axis_start), from = x - wall.axis_start;
      towards(dot(from, axis) * axis - from);
      towards(axis);
      towards(-axis);
    }
    add_axes({}, directions);
    const double size = bodies_[i].radius();
    // a body behind a plane may be as far from it as it likes: the way is bounded by how far the first stride leaves it
    const double most = 4 * size + gap_ + (wall.kind == WallKind::plane ? std::abs(dot(wall.normal, x - wall.point)) : 0.0);
    const Vec3 way = shortest(directions, most, stride_of(size, most), [&](const Vec3& t) {
      PlacedBody moved = bodies_[i];
      moved.position += t;
      return wall_holds(w, moved);
    });
    bodies_[i].position += capped(way, kRelaxShare * size);
  }

  static double stride_of(double size, double most) { return std::max(0.05 * size, most / 64); }
  static Vec3 capped(const Vec3& way, double most) { return length(way) > most ? (most / length(way)) * way : way; }

  Case& case_;
  const SceneParts& parts_;
  const Scene& scene_;
  double gap_;
  MeshDistanceScratchPtr scratch_;
  Periodicity periodicity_;
  std::vector<PlacedBody> bodies_;
  std::vector<double> mass_;     // [kg]
};

}  // namespace

Relaxation relax_given_bodies(Case& c, const SceneParts& parts, const Scene& scene, double gap) { return Relaxer(c, parts, scene, gap).run(); }

}  // namespace scree
