#include "decomposer/packing/going_on.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "core/base/error.hpp"
#include "core/storage/json_keys.hpp"
#include "core/storage/wall_state.hpp"

namespace scree {

namespace {

constexpr double kSameTime = 1e-9;  // of the clock: it is a sum of durations

nlohmann::json values_of(WallMotion motion) {
  nlohmann::json values = nlohmann::json::object();
  JsonKeyWriter writer(values);
  std::visit([&](auto& kind) { kind.keys(writer); }, motion.kind);
  return values;
}

/// in   clock   by which the second motion is earlier [s]
bool are_the_same(const WallMotion& a, const WallMotion& b, double clock) {
  const auto same_time = [&](double x, double y) {
    return std::abs(x - clock - y) <= kSameTime * std::max({clock, std::abs(x), std::abs(y)});
  };
  if (a.kind.index() != b.kind.index() || values_of(a) != values_of(b)) return false;
  if (const auto* several = std::get_if<Several>(&a.kind)) {
    const std::vector<WallMotion>&mine = several->parts, &theirs = std::get<Several>(b.kind).parts;
    return std::equal(mine.begin(), mine.end(), theirs.begin(), theirs.end(),
                      [&](const WallMotion& part, const WallMotion& other) { return are_the_same(part, other, clock); });
  }
  return !a.is_prescribed() || (same_time(a.start, b.start) && same_time(a.stop, b.stop));
}

/// Of a wall that answers to force: its limits and its centre of mass, as of a wall that is placed where this one stood.
void place_at(WallMotion& motion, double way) {
  const std::optional<Drive> drive = motion.drive();
  std::visit(
      [&](auto& kind) {
        if constexpr (requires { kind.stroke; }) {
          for (double& end : kind.stroke) end -= way;
          for (double& end : kind.swing) end -= way;
        }
        if constexpr (requires { kind.mass_centre; })
          kind.mass_centre = drive->guide.state(way, 0, {kind.mass_centre, Quat{}}).pose.position;
      },
      motion.kind);
}

bool have_one_form(const Wall& a, const Wall& b) {
  if (a.kind != b.kind) return false;
  switch (a.kind) {
    case WallKind::plane:
      return true;
    case WallKind::box_inside:
      return length((a.upper - a.lower) - (b.upper - b.lower)) <= kUnitTolerance * length(a.upper - a.lower);
    case WallKind::cylinder_inside: {
      const double mine = length(a.axis_end - a.axis_start);
      return a.radius == b.radius && std::abs(mine - length(b.axis_end - b.axis_start)) <= kUnitTolerance * mine;
    }
    case WallKind::sphere_inside:
      return a.radius == b.radius;
    case WallKind::mesh:
      return a.scale == b.scale;  // its surface: check_surface_goes_on()
  }
  return false;
}

class GoingOn {
 public:
  GoingOn(Case& c, FromRun& from, std::vector<std::string>& notices)
      : case_(c), from_(from), notices_(notices), clock_(from.clock_of_run), where_(c.start->where + ".continue") {}

  void all() {
    case_.bodies.clear();
    case_.populations.clear();
    std::set<std::string> met;
    for (CaseWall& wall : case_.walls) {
      const std::size_t k = from_.wall_named(wall.wall.name);
      if (k < from_.scene.walls.size() && met.insert(wall.wall.name).second) {
        one(wall, k);
      } else {
        notices_.push_back(
            fmt::format("{}: {} has no wall '{}': it stands where this case puts it", where_, case_.start->run, wall.wall.name));
      }
    }
    for (const Wall& wall : from_.scene.walls) {
      if (std::none_of(case_.walls.begin(), case_.walls.end(), [&](const CaseWall& w) { return w.wall.name == wall.name; }))
        notices_.push_back(fmt::format("{}: this case has no wall '{}', which {} had", where_, wall.name, case_.start->run));
    }
    if (!case_.inlets.empty())
      notices_.push_back(fmt::format("{}: inlets begin again, at 0 s of this case, with all that they are to bring in", where_));
    from_.start.clock = clock_ + from_.start.time;
    if (case_.settings.heat) take_heat_sources();
    for_each_table([&](TimeTable& table) {
      for (double& time : table.time) time -= from_.start.clock;
    });
  }

 private:
  /// Over the time of the run.
  template <class Action>
  void for_each_table(Action&& action) {
    const auto one = [&](TimeTable& table) {
      if (!table.is_constant()) action(table);
    };
    for (CaseWall& wall : case_.walls) {
      one(wall.wall.heat.temperature);
      one(wall.wall.heat.flux);
    }
    if (case_.settings.heat) std::for_each(case_.settings.heat->source_tables.begin(), case_.settings.heat->source_tables.end(), one);
    if (case_.settings.cell) std::for_each(case_.settings.cell->strain_rate.begin(), case_.settings.cell->strain_rate.end(), one);
  }

  void take_heat_sources() {
    const std::size_t tables = from_.scene.settings.heat ? from_.scene.settings.heat->source_tables.size() : 0;
    if (tables != case_.settings.heat->source_tables.size())
      throw UsageError("{}: {} has {} tables of heat_source, this case has {}; give it the same", where_, case_.start->run, tables,
                       case_.settings.heat->source_tables.size());
    std::map<std::int64_t, std::size_t> row_of;
    const BodyTable& bodies = from_.scene.bodies;
    for (std::size_t i = 0; i < bodies.size(); ++i) row_of[bodies.id[i]] = i;
    for (BodyRow& row : from_.bodies) {
      const auto found = row_of.find(row.id);
      if (found == row_of.end()) continue;  // it came in through an inlet
      const BodyRow was = bodies.row(found->second);
      row.heat_source = was.heat_source;
      row.heat_table = was.heat_table;
    }
  }

  void one(CaseWall& wall, std::size_t k) {
    const Wall& was = from_.scene.walls[k];
    Wall& now = wall.wall;
    if (!have_one_form(now, was))
      throw UsageError("{}: wall '{}' has another form or size than in {}; give it another name", where_, now.name, case_.start->run);
    if (now.wear > 0) notices_.push_back(fmt::format("{}: wall '{}' begins as it was drawn, not as it was worn", where_, now.name));
    const bool goes_on = is_as_in_run(now.motion, was.motion) && !was.motion.drive();
    if (goes_on) {
      take_place(now, was);
      now.motion = was.motion;
      now.motion.advance_clock(from_.start.time);
    } else {
      const auto driven = from_.driven.find(k);
      const bool has_turned =
          was.motion.drive() ? driven == from_.driven.end() : !(wall_state(was, from_.start.time).orientation == was.orientation);
      if (has_turned && (now.kind != WallKind::mesh || now.surface.is_given()))
        throw UsageError(
            "{}: wall '{}' had turned in {}, and its motion is another here; only a wall made of triangles, without a surface that moves, "
            "can go on from there",
            where_, now.name, case_.start->run);
      Wall stood = was;
      stood.motion.advance_clock(from_.start.time);
      take_place(now, driven != from_.driven.end() ? driven->second.standing : wall_at_start(stood));
      if (was.motion.drive() && is_as_in_run(now.motion, was.motion)) {
        if (!now.motion.drive()->is_servo()) notices_.push_back(fmt::format("{}: wall '{}' begins at rest", where_, now.name));
        now.motion = was.motion;
        now.motion.advance_clock(from_.start.time);
        place_at(now.motion, driven->second.way);
      }
    }
    if (now.surface.is_given() && is_as_in_run(now.surface.motion, was.surface.motion)) {
      now.surface.motion = was.surface.motion;
      now.surface.motion.advance_clock(from_.start.time);
    }
  }

  /// By the clock of this case, or by that of the first run that it goes on from.
  bool is_as_in_run(const WallMotion& here, const WallMotion& there) const {
    return are_the_same(here, there, 0) || (clock_ > 0 && are_the_same(here, there, clock_));
  }

  static void take_place(Wall& wall, const Wall& there) {
    wall.point = there.point;
    wall.normal = there.normal;
    wall.lower = there.lower;
    wall.upper = there.upper;
    wall.axis_start = there.axis_start;
    wall.axis_end = there.axis_end;
    wall.position = there.position;
    wall.orientation = there.orientation;
  }

  Case& case_;
  FromRun& from_;
  std::vector<std::string>& notices_;
  double clock_;  // of the run, at its 0 s [s]
  std::string where_;
};

}  // namespace

void go_on(Case& c, FromRun& from, std::vector<std::string>& notices) { GoingOn(c, from, notices).all(); }

void check_surface_goes_on(const Case& c, const FromRun& from, const Wall& wall, const TriangleMesh& surface) {
  const std::size_t k = from.wall_named(wall.name);
  if (!c.start->goes_on || k >= from.scene.walls.size()) return;
  const TriangleMesh& was = from.scene.shapes[static_cast<std::size_t>(from.scene.walls[k].shape)].mesh;
  if (was.vertices != surface.vertices || was.triangles != surface.triangles)
    throw UsageError("{}.continue: wall '{}' has another surface than in {}; give it another name", c.start->where, wall.name,
                     c.start->run);
}

void leave_out(const Case& c, const Region& region, FromRun& from) {
  std::vector<std::size_t> kept;
  std::set<std::int64_t> left;
  for (std::size_t i = 0; i < from.bodies.size(); ++i) {
    if (region.contains(from.bodies[i].position))
      left.insert(from.bodies[i].id);
    else
      kept.push_back(i);
  }
  if (kept.empty())
    throw UsageError("{}.leave_out: all {} bodies of {} lie in this region; no body would be left", c.start->where, left.size(),
                     c.start->run);
  from.start.left_out = static_cast<std::int64_t>(left.size());
  if (left.empty()) return;
  const auto take = [&](auto& column) {
    if (column.empty()) return;  // of a frame
    for (std::size_t n = 0; n < kept.size(); ++n) column[n] = column[kept[n]];
    column.resize(kept.size());
  };
  take(from.bodies);
  take(from.start.x_remainder);
  take(from.start.q_principal);
  take(from.start.q_remainder);
  from.start.bodies = static_cast<std::int64_t>(kept.size());
  for (PairTable& table : from.start.pairs) {
    std::vector<std::size_t> rows;
    for (std::size_t n = 0; n < table.size(); ++n) {
      if (!left.contains(table.a[n]) && (table.zone[n] >= 0 || !left.contains(table.b[n]))) rows.push_back(n);
    }
    table.take(rows);
  }
}

}  // namespace scree
