#include "post/statistics/contact_kinds.hpp"

#include <algorithm>
#include <limits>

#include "post/run/contact_network.hpp"

namespace scree {

namespace {

constexpr double kOneDirection = 0.9063;  // cosine of 25 degrees

/// Length and width of a set of points.   Cost: the square of their number, which is small.
void measure(const std::vector<Vec3>& points, SurfaceContact& contact) {
  std::size_t first = 0, second = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    for (std::size_t j = i + 1; j < points.size(); ++j) {
      const double d = length(points[j] - points[i]);
      if (d > contact.length) contact.length = d, first = i, second = j;
    }
  }
  if (!(contact.length > 0)) return;
  const Vec3 line = (1 / contact.length) * (points[second] - points[first]);
  for (const Vec3& p : points) {
    const Vec3 r = p - points[first];
    contact.width = std::max(contact.width, length(r - dot(r, line) * line));
  }
}

double smaller_diameter(const FrameView& view, const SurfaceContact& c) {
  double smaller = std::numeric_limits<double>::infinity();
  for (const std::int32_t row : {c.row_a, c.row_b}) {
    if (row < 0) continue;
    const auto r = static_cast<std::size_t>(row);
    const double d = view.frame.bodies.scale[r] * view.facts.diameter[static_cast<std::size_t>(view.frame.bodies.shape[r])];
    if (d > 0) smaller = std::min(smaller, d);
  }
  return smaller;
}

/// The contacts of one pair, whose points are those from `begin` to `end`.
void add_contacts_of_pair(const FrameView& view, std::size_t begin, std::size_t end, std::vector<SurfaceContact>& found) {
  const FrameContacts& c = view.frame.contacts;
  std::vector<std::size_t> left;
  for (std::size_t i = begin; i < end; ++i) {
    if (carries(c.normal_force[i])) left.push_back(i);
  }
  while (!left.empty()) {
    const std::size_t strongest = *std::max_element(
        left.begin(), left.end(), [&](std::size_t i, std::size_t j) { return std::abs(c.normal_force[i]) < std::abs(c.normal_force[j]); });
    SurfaceContact contact;
    contact.body_a = c.body_a[begin];
    contact.body_b = c.body_b[begin];
    contact.row_a = view.row_a[begin];
    contact.row_b = view.row_b[begin];
    std::vector<std::size_t> others;
    std::vector<Vec3> points;
    for (const std::size_t i : left) {
      if (i != strongest && dot(c.normal[i], c.normal[strongest]) < kOneDirection) {
        others.push_back(i);
        continue;
      }
      points.push_back(c.point[strongest] + view.facts.period.nearest(c.point[i] - c.point[strongest]));
      contact.normal_force += c.normal_force[i];
      contact.normal += c.normal[i];
      contact.point += points.back();
    }
    contact.points = static_cast<std::int32_t>(points.size());
    contact.point *= 1 / static_cast<double>(points.size());
    contact.normal = normalised(contact.normal);
    measure(points, contact);
    const double patch = kPatch * smaller_diameter(view, contact);
    contact.kind = contact.width > patch ? ContactKind::face : contact.length > patch ? ContactKind::edge : ContactKind::point;
    found.push_back(contact);
    left = std::move(others);
  }
}

}  // namespace

const char* name_of(ContactKind kind) { return kind == ContactKind::face ? "face" : kind == ContactKind::edge ? "edge" : "point"; }

std::vector<SurfaceContact> surface_contacts(const FrameView& view) {
  const FrameContacts& c = view.frame.contacts;
  std::vector<SurfaceContact> found;
  for (std::size_t begin = 0; begin < c.size();) {
    std::size_t end = begin + 1;
    while (end < c.size() && c.body_a[end] == c.body_a[begin] && c.body_b[end] == c.body_b[begin]) ++end;
    add_contacts_of_pair(view, begin, end, found);
    begin = end;
  }
  return found;
}

double constraints_of(ContactKind kind, bool has_friction) {
  switch (kind) {
    case ContactKind::face:
      return has_friction ? 6 : 3;
    case ContactKind::edge:
      return has_friction ? 5 : 2;
    case ContactKind::point:
      break;
  }
  return has_friction ? 3 : 1;
}

std::vector<BodyConstraints> body_constraints(const FrameView& view, const std::vector<SurfaceContact>& contacts) {
  std::vector<BodyConstraints> bodies(view.frame.bodies.size());
  for (const SurfaceContact& c : contacts) {
    const bool both = view.particle(c.row_a) && view.particle(c.row_b);
    for (const std::int32_t row : {c.row_a, c.row_b}) {
      if (!view.particle(row)) continue;
      BodyConstraints& b = bodies[static_cast<std::size_t>(row)];
      (c.kind == ContactKind::face ? b.face : c.kind == ContactKind::edge ? b.edge : b.point) += 1;
      b.with_friction += (both ? 0.5 : 1.0) * constraints_of(c.kind, true);
      b.without_friction += constraints_of(c.kind, false);
    }
  }
  return bodies;
}

ConstraintMeasures constraint_measures(const FrameView& view, const Group& group, const std::vector<BodyConstraints>& bodies) {
  ConstraintMeasures m;
  double members = 0;
  for (std::size_t row = 0; row < bodies.size(); ++row) {
    if (!group.holds(view, row)) continue;
    const BodyConstraints& b = bodies[row];
    members += 1;
    m.point += b.point;
    m.edge += b.edge;
    m.face += b.face;
    m.with_friction += b.with_friction;
    m.without_friction += b.without_friction;
  }
  for (double* sum : {&m.point, &m.edge, &m.face, &m.with_friction, &m.without_friction}) *sum /= members;  // NaN of none
  return m;
}

}  // namespace scree
