#include "post/run/region.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "core/base/error.hpp"
#include "core/base/units.hpp"

namespace scree {

namespace {

/// Narrows [first, last] to where f(s) = c + b s <= 0. False when nothing is left.
bool narrow_by_plane(double c, double b, double& first, double& last) {
  if (b == 0) return c <= 0;
  const double s = -c / b;
  if (b > 0)
    last = std::min(last, s);
  else
    first = std::max(first, s);
  return first < last;
}

/// Narrows [first, last] to where q s^2 + 2 p s + c <= 0, with q >= 0.
bool narrow_by_quadric(double q, double p, double c, double& first, double& last) {
  if (q <= 0) return c <= 0;
  const double discriminant = p * p - q * c;
  if (discriminant <= 0) return false;
  const double root = std::sqrt(discriminant);
  first = std::max(first, (-p - root) / q);
  last = std::min(last, (-p + root) / q);
  return first < last;
}

}  // namespace

bool Region::contains(const Vec3& point) const {
  switch (kind) {
    case Kind::box:
      for (int k = 0; k < 3; ++k) {
        if (point[k] < lower[k] || point[k] >= upper[k]) return false;  // half open: boxes side by side count nothing twice
      }
      return true;
    case Kind::cylinder: {
      const Vec3 axis = upper - lower, d = point - lower;
      const double along = dot(d, axis) / squared_length(axis);
      return along >= 0 && along < 1 && squared_length(d - along * axis) < radius * radius;
    }
    case Kind::sphere:
      return squared_length(point - lower) < radius * radius;
  }
  return false;
}

double Region::volume() const {
  switch (kind) {
    case Kind::box:
      return (upper.x - lower.x) * (upper.y - lower.y) * (upper.z - lower.z);
    case Kind::cylinder:
      return std::numbers::pi * radius * radius * length(upper - lower);
    case Kind::sphere:
      return 4.0 / 3.0 * std::numbers::pi * radius * radius * radius;
  }
  return 0;
}

Box3 Region::bounds() const {
  Box3 box;
  box.add(lower);
  if (kind != Kind::sphere) box.add(upper);
  if (kind == Kind::box) return box;
  for (int k = 0; k < 3; ++k) {
    double reach = radius;
    if (kind == Kind::cylinder) {
      const Vec3 axis = normalised(upper - lower);
      reach *= std::sqrt(std::max(0.0, 1 - axis[k] * axis[k]));
    }
    box.lower[k] -= reach;
    box.upper[k] += reach;
  }
  return box;
}

double Region::volume_in(const Box3& box, int lines) const {
  const Box3 whole = bounds();
  const Box3 part{component_max(box.lower, whole.lower), component_min(box.upper, whole.upper)};
  const Vec3 extent = part.extent();
  if (!(extent.x > 0 && extent.y > 0 && extent.z > 0)) return 0;
  if (kind == Kind::box) return extent.x * extent.y * extent.z;
  // lines across the axis of a cylinder: their lengths change steadily from one to the next, those along it from nothing to all
  int along = 0;
  if (kind == Kind::cylinder) {
    const Vec3 axis = upper - lower;
    for (int k = 1; k < 3; ++k) {
      if (std::abs(axis[k]) < std::abs(axis[along])) along = k;
    }
  }
  const int u = (along + 1) % 3, v = (along + 2) % 3;
  const auto place = [lines](double k) { return 0.5 - 0.5 * std::cos(std::numbers::pi * k / lines); };
  double volume = 0;
  for (int i = 0; i < lines; ++i) {
    for (int j = 0; j < lines; ++j) {
      Vec3 a = part.lower;
      a[u] += extent[u] * place(i + 0.5);
      a[v] += extent[v] * place(j + 0.5);
      Vec3 b = a;
      b[along] = part.upper[along];
      if (const auto inside = part_inside(a, b)) {
        volume += (inside->second - inside->first) * (place(i + 1) - place(i)) * (place(j + 1) - place(j));
      }
    }
  }
  return volume * extent.x * extent.y * extent.z;
}

std::optional<std::pair<double, double>> Region::part_inside(const Vec3& a, const Vec3& b) const {
  double first = 0, last = 1;
  const Vec3 d = b - a;
  bool left = true;
  switch (kind) {
    case Kind::box:
      for (int k = 0; k < 3 && left; ++k) {
        left = narrow_by_plane(lower[k] - a[k], -d[k], first, last) && narrow_by_plane(a[k] - upper[k], d[k], first, last);
      }
      break;
    case Kind::cylinder: {
      const double extent = length(upper - lower);
      const Vec3 axis = (1 / extent) * (upper - lower), from = a - lower;
      const double start = dot(from, axis), change = dot(d, axis);
      const Vec3 across = from - start * axis, turn = d - change * axis;
      left = narrow_by_plane(-start, -change, first, last) && narrow_by_plane(start - extent, change, first, last) &&
             narrow_by_quadric(squared_length(turn), dot(across, turn), squared_length(across) - radius * radius, first, last);
      break;
    }
    case Kind::sphere: {
      const Vec3 from = a - lower;
      left = narrow_by_quadric(squared_length(d), dot(from, d), squared_length(from) - radius * radius, first, last);
      break;
    }
  }
  if (!left) return std::nullopt;
  return std::pair{first, last};
}

Region parse_region(const std::string& text) {
  const std::string where = "region '" + text + "'";
  Region region;
  std::string rest = text;
  const std::size_t colon = rest.find(':');
  const std::size_t equals = rest.substr(0, colon).find('=');
  if (equals != std::string::npos) {
    region.name = rest.substr(0, equals);
    rest = rest.substr(equals + 1);
  } else {
    region.name = text;
    // a name stands in a column of a table
    std::replace(region.name.begin(), region.name.end(), ',', ' ');
  }
  const std::size_t kind_end = rest.find(':');
  const std::string kind = rest.substr(0, kind_end);
  std::vector<double> numbers;
  for (std::size_t begin = kind_end; begin != std::string::npos;) {
    const std::size_t end = rest.find(',', begin + 1);
    numbers.push_back(parse_quantity(rest.substr(begin + 1, end == std::string::npos ? end : end - begin - 1), Dimension::length, where));
    begin = end;
  }
  std::size_t expected = 0;
  if (kind == "box") {
    region.kind = Region::Kind::box;
    expected = 6;
  } else if (kind == "cylinder") {
    region.kind = Region::Kind::cylinder;
    expected = 7;
  } else if (kind == "sphere") {
    region.kind = Region::Kind::sphere;
    expected = 4;
  } else {
    throw UsageError("{}: '{}' is no kind of region; expected box:x0,y0,z0,x1,y1,z1, cylinder:x0,y0,z0,x1,y1,z1,r or sphere:x,y,z,r", where,
                     kind);
  }
  if (numbers.size() != expected) throw UsageError("{}: {} numbers found, {} expected", where, numbers.size(), expected);
  region.lower = {numbers[0], numbers[1], numbers[2]};
  if (region.kind != Region::Kind::sphere) region.upper = {numbers[3], numbers[4], numbers[5]};
  if (region.kind != Region::Kind::box) region.radius = numbers.back();
  if (region.kind == Region::Kind::box) {
    const Vec3 a = region.lower, b = region.upper;
    region.lower = component_min(a, b);
    region.upper = component_max(a, b);
  }
  if (region.kind != Region::Kind::box && !(region.radius > 0))
    throw UsageError("{}: radius {:g} m found, a radius above 0 expected", where, region.radius);
  if (!(region.volume() > 0)) throw UsageError("{}: it has no volume", where);
  return region;
}

}  // namespace scree
