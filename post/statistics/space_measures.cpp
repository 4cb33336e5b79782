#include "post/statistics/space_measures.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <numeric>

#include "core/base/numbers.hpp"

namespace scree {

namespace {

constexpr double kDegrees = 180 / std::numbers::pi;

int axis_index(char axis) { return axis - 'x'; }

double distance_from_line(const Vec3& p, const Vec3& through, int vertical) {
  Vec3 d = p - through;
  d[vertical] = 0;
  return length(d);
}

}  // namespace

MotionMeasures motion_measures(const FrameView& view, const Group& group) {
  MotionMeasures m;
  const FrameBodies& b = view.frame.bodies;
  std::size_t count = 0;
  double squares = 0;
  for (std::size_t i = 0; i < b.size(); ++i) {
    if (!group.holds(view, i)) continue;
    ++count;
    m.mass += view.mass[i];
    m.centre += view.mass[i] * b.position[i];
    m.velocity += view.mass[i] * b.velocity[i];
    m.speed += view.mass[i] * length(b.velocity[i]);
    m.spin += length(b.angular_velocity[i]);
  }
  m.particles = static_cast<double>(count);
  if (count == 0) {
    m.centre = m.velocity = {kNaN, kNaN, kNaN};
    m.speed = m.spin = m.granular_temperature = m.temperature = m.temperature_spread = kNaN;
    return m;
  }
  m.centre *= 1 / m.mass;
  m.velocity *= 1 / m.mass;
  m.speed /= m.mass;
  m.spin /= static_cast<double>(count);
  for (std::size_t i = 0; i < b.size(); ++i) {
    if (group.holds(view, i)) squares += view.mass[i] * squared_length(b.velocity[i] - m.velocity);
  }
  m.granular_temperature = squares / m.mass / 3;
  m.temperature = m.temperature_spread = kNaN;
  if (!b.has_temperature) return m;
  double mean = 0, deviations = 0;
  for (std::size_t i = 0; i < b.size(); ++i) mean += group.holds(view, i) ? view.mass[i] * b.temperature[i] : 0;
  mean /= m.mass;
  for (std::size_t i = 0; i < b.size(); ++i)
    deviations += group.holds(view, i) ? view.mass[i] * (b.temperature[i] - mean) * (b.temperature[i] - mean) : 0;
  m.temperature = mean;
  m.temperature_spread = std::sqrt(deviations / m.mass);
  return m;
}

BodyEnergies energies_of_bodies(const FrameView& view) {
  const Scene& scene = view.facts.run->scene;
  const FrameBodies& b = view.frame.bodies;
  const double fluid = scene.settings.fluid ? scene.settings.fluid->density : 0;
  BodyEnergies energies;
  for (std::size_t i = 0; i < b.size(); ++i) {
    if (view.is_particle[i] == 0) continue;
    const Shape& shape = scene.shapes[static_cast<std::size_t>(b.shape[i])];
    const double density = scene.materials[static_cast<std::size_t>(b.material[i])].density;
    const Mat3 turn = matrix_of(b.orientation[i]);
    const Vec3 spin = transpose(turn) * b.angular_velocity[i];
    const double moment = density * std::pow(b.scale[i], 5) * dot(spin, shape.mass.inertia * spin);
    energies.kinetic += 0.5 * (view.mass[i] * squared_length(b.velocity[i]) + moment);
    energies.potential -= view.mass[i] * (1 - fluid / density) * dot(scene.settings.gravity, b.position[i]);
    const auto given = std::lower_bound(scene.forces.begin(), scene.forces.end(), b.id[i],
                                        [](const BodyForce& force, std::int64_t id) { return force.id < id; });
    if (given != scene.forces.end() && given->id == b.id[i]) energies.potential -= dot(given->force, b.position[i]);
  }
  return energies;
}

double region_solid_fraction(const FrameView& view, const Region& region) {
  double solid = 0;
  view.for_each_sample([&](const Vec3& p, double v, std::size_t) { solid += view.facts.images_in(region, p) * v; });
  return solid / region.volume();
}

Profile profile(const FrameView& view, const ProfileBins& bins) {
  const Container& container = view.facts.container;
  const FrameBodies& b = view.frame.bodies;
  const std::size_t n = bins.count;
  const bool rings = bins.axis == 'r';
  const int axis = rings ? 0 : axis_index(bins.axis);
  const double width = bins.width(), bed_low = view.solid_low, bed_high = view.solid_high;
  const bool in_bed_only = rings || axis != container.vertical;
  const auto bin_of = [&](const Vec3& p) {
    if (in_bed_only && (p[container.vertical] < bed_low || p[container.vertical] >= bed_high)) return n;
    const double place = ((rings ? container.distance_from_axis(p) : p[axis]) - bins.low) / width;
    return place >= 0 && place < static_cast<double>(n) ? static_cast<std::size_t>(place) : n;
  };
  Profile p{std::vector<double>(n), std::vector<double>(n), std::vector<double>(n), std::vector<Vec3>(n)};
  view.for_each_sample([&](const Vec3& x, double v, std::size_t) {
    if (!container.holds(x)) return;  // what has left it is none of its solid
    if (const std::size_t k = bin_of(x); k < n) p.solid_fraction[k] += v;
  });
  std::vector<double> mass(n);
  for (const int pass : {0, 1}) {
    for (std::size_t i = 0; i < b.size(); ++i) {
      if (view.is_particle[i] == 0) continue;
      const std::size_t k = bin_of(b.position[i]);
      if (k == n) continue;
      if (pass == 0) {
        p.particles[k] += 1;
        mass[k] += view.mass[i];
        p.velocity[k] += view.mass[i] * b.velocity[i];
      } else {
        p.granular_temperature[k] += view.mass[i] * squared_length(b.velocity[i] - p.velocity[k]) / (3 * mass[k]);
      }
    }
    for (std::size_t k = 0; pass == 0 && k < n; ++k) p.velocity[k] *= 1 / mass[k];  // NaN where nothing is
  }
  for (std::size_t k = 0; k < n; ++k) {
    const double low = bins.low + static_cast<double>(k) * width, high = low + width;
    Box3 part = container.room.bounds();
    if (in_bed_only) {
      part.lower[container.vertical] = bed_low;
      part.upper[container.vertical] = bed_high;
    }
    if (!rings) {
      part.lower[axis] = low;
      part.upper[axis] = high;
    }
    const double room = rings ? container.ring_volume_in(part, low, high) : container.volume_in(part);
    p.solid_fraction[k] = room > 0 ? p.solid_fraction[k] / room : kNaN;
    if (p.particles[k] == 0) p.granular_temperature[k] = kNaN;
  }
  return p;
}

std::vector<double> pair_correlation(const FrameView& view, std::size_t shells, double reach) {
  std::vector<double> g(shells, kNaN);
  const FrameBodies& b = view.frame.bodies;
  Box3 box;
  // of each pair one image is seen, the nearest: farther than this, further ones would count
  double half_period = std::numeric_limits<double>::infinity();
  for (int k = 0; k < 3; ++k) {
    if (view.facts.period.is_periodic(k)) {
      box.lower[k] = view.facts.cell_lower[k];
      box.upper[k] = box.lower[k] + view.facts.period.period()[k];
      half_period = std::min(half_period, 0.5 * view.facts.period.period()[k]);
      continue;
    }
    std::vector<double> places;
    for (std::size_t i = 0; i < b.size(); ++i) {
      if (view.is_particle[i] != 0) places.push_back(b.position[i][k]);
    }
    if (places.size() < 2) return g;
    const std::size_t margin = places.size() / 20;
    for (const std::size_t at : {margin, places.size() - 1 - margin}) {
      std::nth_element(places.begin(), places.begin() + static_cast<std::ptrdiff_t>(at), places.end());
      (at == margin ? box.lower : box.upper)[k] = places[at];
    }
  }
  const Vec3 extent = box.extent();
  std::vector<Vec3> points;
  for (std::size_t i = 0; i < b.size(); ++i) {
    if (view.is_particle[i] == 0) continue;
    bool inside = true;
    for (int k = 0; k < 3; ++k)
      inside = inside && (view.facts.period.is_periodic(k) || (b.position[i][k] >= box.lower[k] && b.position[i][k] < box.upper[k]));
    if (inside) points.push_back(b.position[i]);
  }
  const std::size_t n = points.size();
  if (n < 2 || !(extent.x > 0 && extent.y > 0 && extent.z > 0) || !(reach > 0)) return g;

  // cells no smaller than the reach, points sorted by cell
  int cells[3];
  for (int k = 0; k < 3; ++k) cells[k] = std::clamp(static_cast<int>(extent[k] / reach), 1, 512);
  // images across y and z of a cell that is sheared lie elsewhere along x, and across z along y
  if (view.facts.period.is_sheared()) cells[0] = 1;
  if (view.facts.period.shear().x != 0) cells[1] = 1;
  const auto cell_of = [&](const Vec3& p, int k) {
    return std::clamp(static_cast<int>((p[k] - box.lower[k]) / extent[k] * cells[k]), 0, cells[k] - 1);
  };
  const auto flat = [&](int x, int y, int z) { return static_cast<std::size_t>((x * cells[1] + y) * cells[2] + z); };
  std::vector<std::size_t> start(static_cast<std::size_t>(cells[0] * cells[1] * cells[2]) + 1);
  for (const Vec3& p : points) ++start[flat(cell_of(p, 0), cell_of(p, 1), cell_of(p, 2)) + 1];
  for (std::size_t i = 1; i < start.size(); ++i) start[i] += start[i - 1];
  std::vector<std::size_t> next(start.begin(), start.end() - 1);
  std::vector<Vec3> sorted(n);
  for (const Vec3& p : points) sorted[next[flat(cell_of(p, 0), cell_of(p, 1), cell_of(p, 2))]++] = p;

  std::vector<double> seen(shells);
  const double volume = extent.x * extent.y * extent.z, width = reach / static_cast<double>(shells);
  for (std::size_t i = 0; i < n; ++i) {
    const Vec3& p = sorted[i];
    std::array<std::array<int, 3>, 3> near;
    std::array<int, 3> count{};
    for (int k = 0; k < 3; ++k) {
      for (int step = -1; step <= 1; ++step) {
        int at = cell_of(p, k) + step;
        if (view.facts.period.is_periodic(k)) at = (at + cells[k]) % cells[k];
        const auto axis = static_cast<std::size_t>(k);
        const auto begin = near[axis].begin(), end = begin + count[axis];
        if (at >= 0 && at < cells[k] && std::find(begin, end, at) == end) near[axis][static_cast<std::size_t>(count[axis]++)] = at;
      }
    }
    for (int x = 0; x < count[0]; ++x) {
      for (int y = 0; y < count[1]; ++y) {
        for (int z = 0; z < count[2]; ++z) {
          const std::size_t cell =
              flat(near[0][static_cast<std::size_t>(x)], near[1][static_cast<std::size_t>(y)], near[2][static_cast<std::size_t>(z)]);
          for (std::size_t j = std::max(i + 1, start[cell]); j < start[cell + 1]; ++j) {
            const Vec3 d = view.facts.period.nearest(sorted[j] - p);
            const double square = squared_length(d);
            if (square >= reach * reach) continue;
            double common = volume;
            for (int k = 0; k < 3; ++k) {
              if (!view.facts.period.is_periodic(k)) common *= 1 - std::abs(d[k]) / extent[k];
            }
            seen[std::min(shells - 1, static_cast<std::size_t>(std::sqrt(square) / width))] += 2 / common;
          }
        }
      }
    }
  }
  for (std::size_t s = 0; s < shells; ++s) {
    const double low = static_cast<double>(s) * width, high = low + width;
    if (high > half_period) break;
    const double shell = 4.0 / 3.0 * std::numbers::pi * (high * high * high - low * low * low);
    g[s] = seen[s] * volume * volume / (static_cast<double>(n) * static_cast<double>(n - 1) * shell);
  }
  return g;
}

namespace {

/// Particles of two kinds in cubes that hold about 12 of them. Made once for all kinds that the same particles may have.
class MixingCells {
 public:
  /// in   kind   by row of bodies: particles of kind 0 and 1 are counted
  MixingCells(const FrameView& view, const std::vector<std::uint8_t>& kind) {
    constexpr double kPerCell = 12;
    const FrameBodies& b = view.frame.bodies;
    Box3 box;
    for (std::size_t i = 0; i < b.size(); ++i) {
      if (view.is_particle[i] == 0 || kind[i] > 1) continue;
      rows_.push_back(i);
      box.add(b.position[i]);
    }
    if (is_noise()) return;
    // an extent of 0 (a single layer) must not make the cell vanish
    const Vec3 extent = box.extent();
    const double largest = std::max({extent.x, extent.y, extent.z});
    const double room = std::max(extent.x, 1e-6 * largest) * std::max(extent.y, 1e-6 * largest) * std::max(extent.z, 1e-6 * largest);
    const double side = std::cbrt(room * kPerCell / static_cast<double>(rows_.size()));
    std::map<std::array<std::int64_t, 3>, std::size_t> number;  // of each cell
    cells_.reserve(rows_.size());
    for (const std::size_t i : rows_) {
      const Vec3 d = (1 / side) * (b.position[i] - box.lower);
      const auto [found, is_new] = number.try_emplace(
          {static_cast<std::int64_t>(d.x), static_cast<std::int64_t>(d.y), static_cast<std::int64_t>(d.z)}, number.size());
      cells_.push_back(found->second);
    }
    counts_.resize(number.size());
    for (const std::size_t cell : cells_) counts_[cell] += 1;
    for (const auto& [place, cell] : number) by_place_.push_back(cell);
  }

  const std::vector<std::size_t>& rows() const { return rows_; }

  /// Lacey's index; NaN where there are too few, or one kind alone.   in   is_one   by particle, in the order of rows(): 0 or 1
  double index(const std::vector<std::uint8_t>& is_one) const {
    if (is_noise()) return kNaN;
    double ones = 0;
    std::vector<double> in_cell(counts_.size());
    for (std::size_t k = 0; k < rows_.size(); ++k) {
      ones += is_one[k];
      in_cell[cells_[k]] += is_one[k];
    }
    const double all = static_cast<double>(rows_.size()), p = ones / all;
    if (!(p > 0 && p < 1)) return kNaN;
    double variance = 0;
    for (const std::size_t cell : by_place_) variance += counts_[cell] * std::pow(in_cell[cell] / counts_[cell] - p, 2) / all;
    const double apart = p * (1 - p), random = apart * static_cast<double>(counts_.size()) / all;
    return apart > random ? (apart - variance) / (apart - random) : kNaN;
  }

 private:
  bool is_noise() const { return rows_.size() < 60; }  // with fewer than five cells the index is noise

  std::vector<std::size_t> rows_, cells_;  // of each particle its row and its cell
  std::vector<double> counts_;             // particles of each cell
  std::vector<std::size_t> by_place_;      // the cells, in an order that no order of bodies changes
};

std::vector<std::uint8_t> kinds_of_rows(const MixingCells& cells, const std::vector<std::uint8_t>& kind) {
  std::vector<std::uint8_t> is_one;
  for (const std::size_t i : cells.rows()) is_one.push_back(kind[i]);
  return is_one;
}

}  // namespace

double mixing_index(const FrameView& view, const std::vector<std::uint8_t>& kind) {
  const MixingCells cells(view, kind);
  return cells.index(kinds_of_rows(cells, kind));
}

double mixing_index_apart(const FrameView& view, const std::vector<std::uint8_t>& kind) {
  const MixingCells cells(view, kind);
  const std::vector<std::uint8_t> kinds = kinds_of_rows(cells, kind);
  const auto ones = static_cast<std::size_t>(std::count(kinds.begin(), kinds.end(), 1));
  const std::vector<std::size_t>& rows = cells.rows();
  std::vector<std::size_t> order(rows.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  double least = kNaN;
  for (int axis = 0; axis < 3; ++axis) {
    const auto place = [&](std::size_t k) { return view.frame.bodies.position[rows[k]][axis]; };
    std::sort(order.begin(), order.end(),
              [&](std::size_t i, std::size_t j) { return place(i) < place(j) || (place(i) == place(j) && i < j); });
    for (const bool from_below : {true, false}) {
      std::vector<std::uint8_t> is_one(rows.size());
      for (std::size_t k = 0; k < ones; ++k) is_one[order[from_below ? k : rows.size() - 1 - k]] = 1;
      least = std::fmin(least, cells.index(is_one));
    }
  }
  return least;
}

std::array<double, 3> size_segregation(const FrameView& view) {
  const FrameBodies& b = view.frame.bodies;
  constexpr double kSameSize = 1e-9;  // of a diameter: rounding of scales
  std::vector<double> diameter(b.size(), 0.0), sorted;
  for (std::size_t i = 0; i < b.size(); ++i) {
    diameter[i] = b.scale[i] * view.facts.run->scene.shapes[static_cast<std::size_t>(b.shape[i])].equivalent_diameter();
    if (view.is_particle[i] != 0) sorted.push_back(diameter[i]);
  }
  std::array<double, 3> segregation{kNaN, kNaN, kNaN};
  if (sorted.empty()) return segregation;
  std::sort(sorted.begin(), sorted.end());
  const double fine = sorted[(sorted.size() - 1) / 3], coarse = sorted[(2 * sorted.size()) / 3];
  const bool one_size_rules = coarse <= fine * (1 + kSameSize);  // what is smaller is fine, and what is larger is coarse
  const auto class_of = [&](double d) -> std::size_t {
    if (one_size_rules) return d < fine * (1 - kSameSize) ? 0 : d > coarse * (1 + kSameSize) ? 2 : 1;
    return d <= fine * (1 + kSameSize) ? 0 : d >= coarse * (1 - kSameSize) ? 2 : 1;
  };
  const MixingCells cells(view, std::vector<std::uint8_t>(b.size(), 0));
  for (std::size_t size_class = 0; size_class < 3; ++size_class) {
    std::vector<std::uint8_t> is_one;
    for (const std::size_t i : cells.rows()) is_one.push_back(size_class == class_of(diameter[i]) ? 1 : 0);
    segregation[size_class] = 1 - cells.index(is_one);
  }
  return segregation;
}

namespace {

/// Highest sample point of each column of the plan, columns one mean diameter wide.
std::vector<Vec3> surface_of(const FrameView& view) {
  const int up_axis = view.facts.container.vertical, u = (up_axis + 1) % 3, v = (up_axis + 2) % 3;
  const double up = view.facts.container.up, side = view.mean_diameter;
  std::map<std::pair<std::int64_t, std::int64_t>, Vec3> highest;
  view.for_each_sample([&](const Vec3& p, double, std::size_t) {
    const auto [it, is_new] = highest.try_emplace({std::llround(p[u] / side), std::llround(p[v] / side)}, p);
    if (!is_new && up * p[up_axis] > up * it->second[up_axis]) it->second = p;
  });
  std::vector<Vec3> points;
  for (const auto& [place, p] : highest) points.push_back(p);
  return points;
}

constexpr std::size_t kMinColumns = 8;

double no_surface(std::size_t columns, std::string* reason) {
  if (reason != nullptr) {
    *reason = fmt::format("the surface has {} {} one mean diameter wide, and {} are needed: too few bodies", columns,
                          columns == 1 ? "column" : "columns", kMinColumns);
  }
  return kNaN;
}

}  // namespace

double angle_of_repose_cone(const FrameView& view, std::string* reason) {
  const std::vector<Vec3> surface = surface_of(view);
  if (surface.size() < kMinColumns) return no_surface(surface.size(), reason);
  const Container& c = view.facts.container;
  const Vec3 centre = motion_measures(view, {}).centre;
  const double base = c.up > 0 ? view.lowest : -view.highest, height = view.highest - view.lowest;
  // rings one column wide, so that the outer, with more columns, do not weigh more
  std::map<std::int64_t, std::pair<double, double>> rings;
  for (const Vec3& p : surface) {
    auto& [sum, count] = rings[static_cast<std::int64_t>(distance_from_line(p, centre, c.vertical) / view.mean_diameter)];
    sum += c.up * p[c.vertical] - base;
    count += 1;
  }
  double n = 0, sr = 0, sh = 0, srr = 0, srh = 0;
  for (const auto& [ring, heights] : rings) {
    const double h = heights.first / heights.second;
    if (h < 0.1 * height || h > 0.9 * height) continue;
    const double r = (static_cast<double>(ring) + 0.5) * view.mean_diameter;
    n += 1;
    sr += r;
    sh += h;
    srr += r * r;
    srh += r * h;
  }
  const double spread = n * srr - sr * sr;
  if (n >= 3 && spread > 0) return kDegrees * std::atan(-(n * srh - sr * sh) / spread);
  if (reason != nullptr) {
    *reason = fmt::format(
        "no cone fits: {:.0f} of {} rings around the middle, one mean diameter wide, have a height between 10 % and 90 % of the heap's "
        "{:.3g} m, "
        "where at least 3 are needed: the sides are too steep (a column), the bed is flat, or it has too few bodies",
        n, rings.size(), height);
  }
  return kNaN;
}

double angle_of_repose_slope(const FrameView& view, std::string* reason) {
  const std::vector<Vec3> surface = surface_of(view);
  const Container& c = view.facts.container;
  const int u = (c.vertical + 1) % 3, v = (c.vertical + 2) % 3;
  Box3 plan;
  for (const Vec3& p : surface) plan.add(p);
  Eigen::Matrix3d left = Eigen::Matrix3d::Zero();
  Eigen::Vector3d right = Eigen::Vector3d::Zero();
  std::size_t count = 0;
  const Vec3 centre = plan.centre(), extent = plan.extent();
  for (const Vec3& p : surface) {
    if (std::abs(p[u] - centre[u]) > 0.4 * extent[u] || std::abs(p[v] - centre[v]) > 0.4 * extent[v]) continue;
    const Eigen::Vector3d row(p[u] - centre[u], p[v] - centre[v], 1);
    left += row * row.transpose();
    right += row * (p[c.vertical] - centre[c.vertical]);
    ++count;
  }
  if (count < kMinColumns) return no_surface(count, reason);
  const Eigen::Vector3d slope = left.ldlt().solve(right);
  return kDegrees * std::atan(std::hypot(slope[0], slope[1]));
}

}  // namespace scree
