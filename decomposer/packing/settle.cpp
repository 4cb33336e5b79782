#include "decomposer/packing/settle.hpp"

#include <algorithm>
#include <cmath>

#include "core/base/error.hpp"
#include "core/base/long_work.hpp"
#include "core/base/units.hpp"
#include "core/surface/touch_surface.hpp"
#include "decomposer/packing/packer.hpp"
#include "decomposer/packing/softness.hpp"

namespace scree {

namespace {

// Draws that a body of a pour gets before the next one is tried, and how many in a row may fail: late in a stage the next stage
// gives more for less.
constexpr std::uint64_t kPourAttempts = 200;
constexpr int kFailuresInARow = 40;
constexpr double kLongestRest = 60;  // falls through the region that the bed gets to come to rest
// Of these, so many by itself: a ball that rolls on a flat floor without rolling friction is at rest after no time. 30 balls and 30 cubes
// on a floor of 20 x 20 cm took all 60 falls, seven times as long as with a rolling friction of 0.01; beds that hold their balls need about
// five.
constexpr double kOwnRest = 10;
// From a softer bed to the stiffness of the case by this factor at a time: what was pressed by the softer law expands, and all at once
// would throw the bed up. The softest stage takes so many falls through the largest body, a stiffer one less by the root of its stiffness,
// as its waves are faster: about as many steps.
constexpr double kStiffer = 2, kExpanding = 0.5;
// A softer bed is at rest enough once it moves by no more than what expands sets it going: of the energy of a fall of each body through its
// own diameter. What moves in it falls by e in the time of such a fall, whatever the contacts: the rest of stop_at_rest would take twice
// as long, for nothing.
constexpr double kSoftRest = 0.01;
constexpr double kLonger = 1.5;  // each look at it comes so much later than the one before: a part begins without springs

std::string text_of(const Vec3& p) {
  const auto length_text = [](double x) { return format_quantity(x, Dimension::length); };
  return fmt::format("({}, {}, {})", length_text(p.x), length_text(p.y), length_text(p.z));
}

class Settler {
 public:
  Settler(const Case& c, const SceneParts& parts, const Scene& scene, const ChildSolver& solver, Placements& placements,
          PackingReport& report)
      : case_(c),
        parts_(parts),
        scene_(scene),
        solver_(solver),
        placements_(placements),
        report_(report),
        moves_(parts.draws.size(), 0),
        velocity_(parts.draws.size()),
        spin_(parts.draws.size()) {
    const double g = length(c.settings.gravity);
    double height = 0;
    for (std::size_t i = 0; i < parts.draws.size(); ++i) {
      const CasePopulation& p = case_.populations[parts.draws[i].population];
      if (p.method != PackingMethod::settle) continue;
      if (!(g > 0)) throw UsageError("{}: method = \"settle\" needs gravity; nothing would fall", p.where);
      if (!has_support(case_) && !case_.settings.domain.bounded)
        throw UsageError("{}: method = \"settle\" needs a wall or a fixed body below; nothing would end the fall", p.where);
      waiting_.push_back(i);
      const Vec3 e = parts.regions[parts.draws[i].population].box.extent(), d = (1 / g) * case_.settings.gravity;
      height = std::max(height, std::abs(d.x) * e.x + std::abs(d.y) * e.y + std::abs(d.z) * e.z);
      const double diameter = parts.draws[i].scale * parts.shape(parts.draws[i].shape).shape.equivalent_diameter();
      largest_ = std::max(largest_, diameter);
    }
    wanted_ = waiting_.size();
    softness_ = softness_of_pouring(c, parts, scene, report);
    if (g > 0) {
      fall_ = std::sqrt(2 * height / g);
      own_fall_ = std::sqrt(2 * largest_ / g);
    }
  }

  void run() {
    if (waiting_.empty()) return;
    bool rests = false;
    {
      LongWork work("settle", static_cast<double>(wanted_));
      while (!waiting_.empty()) {
        const std::size_t before = wanted_ - waiting_.size(), added = pour();
        if (added == 0) break;
        rests = waiting_.empty();
        if (rests) break;  // the last ones come to rest with all
        move(fall_, false, [&](double share) {
          work.update(static_cast<double>(before) + share * static_cast<double>(added),
                      fmt::format("{} of {} bodies poured", before + added, wanted_));
        });
      }
    }
    if (!rests) refuse_what_was_not_poured();
    if (softness_ < 1) {
      slow_down();
      grow_stiff();
    }
    come_to_rest();
    trim();
  }

 private:
  /// Places what finds room; gives how many did.
  std::size_t pour() {
    Scene unused;
    unused.settings = scene_.settings;
    unused.walls = scene_.walls;
    Packer packer(case_, parts_, unused, report_);
    for (std::size_t i = 0; i < placements_.body.size(); ++i) {
      if (placements_.is_placed[i] != 0) packer.keep(placements_.body[i]);
    }
    packer.keep_standing();
    int failures = 0;
    std::vector<std::size_t> left;
    std::size_t added = 0;
    for (std::size_t n = 0; n < waiting_.size(); ++n) {
      const std::size_t i = waiting_[n];
      const Draw& d = parts_.draws[i];
      // every stage draws other places for a body that found none before
      if (failures < kFailuresInARow && packer.try_place(d, placements_.body[i], kPourAttempts, stage_ * kPourAttempts)) {
        packer.keep(placements_.body[i]);
        placements_.is_placed[i] = moves_[i] = 1;
        velocity_[i] = case_.populations[d.population].velocity;
        spin_[i] = case_.populations[d.population].angular_velocity;
        ++added;
        failures = 0;
      } else {
        left.push_back(i);
        ++failures;
      }
    }
    waiting_ = std::move(left);
    ++stage_;
    return added;
  }

  /// What is poured softer, until little of it moves.
  void slow_down() {
    LongWork work("settle", 0);
    work.update(0);
    const double longest = kLongestRest * fall_;
    double part = std::max(own_fall_, fall_ / 10);
    for (double time = 0; time < longest && softness_ < 1; time += part, part *= kLonger) {
      if (time >= kOwnRest * fall_ && rolls_on()) stop_rolling();
      const double kinetic = move(part, false, [&](double share) {
        work.update(0, fmt::format("{} bodies slow down, {} of at most {}", wanted_ - waiting_.size(),
                                   format_quantity(time + share * part, Dimension::time), format_quantity(longest, Dimension::time)));
      });
      if (nearly_rests(kinetic)) return;
    }
  }

  /// As a whole, and each body so far that it lands no faster than from its own diameter.
  bool nearly_rests(double kinetic) const {
    const double g = length(case_.settings.gravity);
    double falls = 0;
    for (std::size_t i = 0; i < moves_.size(); ++i) {
      if (moves_[i] == 0) continue;
      const Draw& d = parts_.draws[i];
      const double diameter = d.scale * parts_.shape(d.shape).shape.equivalent_diameter();
      if (squared_length(velocity_[i]) + 0.25 * diameter * diameter * squared_length(spin_[i]) > 2 * g * diameter) return false;
      falls += scene_.materials[static_cast<std::size_t>(case_.populations[d.population].material)].density * d.volume * g * diameter;
    }
    return kinetic <= kSoftRest * falls;
  }

  /// Balls roll, and nothing that there is ends it.
  bool rolls_on() const { return !stops_rolls_ && may_roll(scene_); }

  void stop_rolling() {
    stops_rolls_ = true;
    report_.notices.push_back(fmt::format(
        "settle: bodies still rolled after {}; they came to rest with a rolling friction of {}, since a pair of this case has none",
        format_quantity(kOwnRest * fall_, Dimension::time), kRollingAtRest));
  }

  /// Its duration is not known beforehand: no share of it is reported, since the limit is long.
  void come_to_rest() {
    const double longest = kLongestRest * fall_, own = kOwnRest * fall_;
    LongWork work("settle", 0);
    work.update(0);
    const auto rest = [&](double from, double to) {
      move(to - from, true, [&](double share) {
        work.update(0,
                    fmt::format("{} bodies come to rest, {} of at most {}", wanted_ - waiting_.size(),
                                format_quantity(from + share * (to - from), Dimension::time), format_quantity(longest, Dimension::time)));
      });
    };
    rest(0, rolls_on() ? own : longest);
    if (!at_rest_ && rolls_on()) {
      stop_rolling();
      rest(own, longest);
    }
    if (!at_rest_)
      report_.notices.push_back(
          fmt::format("settle: not at rest after {}; kinetic energy {:.3g} J", format_quantity(longest, Dimension::time), kinetic_));
  }

  /// From a soft bed at rest to one that has the contacts of the case, near rest.
  void grow_stiff() {
    LongWork work("settle", 0);
    const double softest = softness_;
    while (softness_ < 1) {
      softness_ = std::min(1.0, kStiffer * softness_);
      work.update(0, fmt::format("contacts at {:.2g} of their stiffness", softness_));
      expands_ = true;
      move(kExpanding * own_fall_ * std::sqrt(softest / softness_), false, {});
    }
    expands_ = false;
  }

  /// Lets all poured bodies move for a time, or until they rest; gives their kinetic energy [J].
  double move(double time, bool until_rest, const std::function<void(double)>& progress) {
    std::vector<std::int64_t> draw_of_body;
    Scene stage = stage_scene(case_, parts_, scene_, placements_, moves_, velocity_, spin_, draw_of_body);
    stage.settings.duration = time;
    stage.settings.output_every = until_rest ? std::max(own_fall_, fall_ / 10) : time;
    stage.settings.stop_at_rest = until_rest;
    const Frame frame = run_stage(stage, progress);
    if (frame.bodies.size() != stage.bodies.size()) {
      throw InputError("{}: {} bodies left the domain while settling; close the container or widen the domain",
                       case_.populations[population()].where, stage.bodies.size() - frame.bodies.size());
    }
    // frames are sorted by id, and so are the bodies of a stage
    for (std::size_t b = 0; b < frame.bodies.size(); ++b) {
      SCREE_ASSERT(frame.bodies.id[b] == stage.bodies.id[b], "body {}", b);
      if (draw_of_body[b] < 0) continue;
      const auto i = static_cast<std::size_t>(draw_of_body[b]);
      placements_.body[i].position = frame.bodies.position[b];
      placements_.body[i].orientation = frame.bodies.orientation[b];
      velocity_[i] = frame.bodies.velocity[b];
      spin_[i] = frame.bodies.angular_velocity[b];
    }
    at_rest_ = until_rest && frame.time < time * (1 - 1e-6);
    kinetic_ = frame.kinetic;
    return frame.kinetic;
  }

  /// A bed that turns out to be too soft is made stiffer.
  Frame run_stage(const Scene& stage, const std::function<void(double)>& progress) {
    while (true) {
      Scene softer = stage;
      if (softness_ < 1) soften(softer, softness_);
      make_elastic(softer);
      if (expands_) damp(softer);
      stop_spins(softer);
      if (stops_rolls_) stop_rolls(softer);
      try {
        return run_solver(solver_, softer, progress);
      } catch (const RunInvalid& e) {
        if (softness_ == 1 || expands_) {
          throw InputError("{}: settling failed after {} of {} bodies were poured: {}", case_.populations[population()].where,
                           wanted_ - waiting_.size(), wanted_, e.what());
        }
      }
      softness_ = std::min(1.0, kStiffer * kStiffer * softness_);
    }
  }

  void refuse_what_was_not_poured() {
    for (const std::size_t i : waiting_) {
      const std::size_t k = parts_.draws[i].population;
      const CasePopulation& p = case_.populations[k];
      if (p.amount == CasePopulation::Amount::fill) continue;
      std::size_t wanted = 0;
      for (const Draw& d : parts_.draws) wanted += d.population == k ? 1 : 0;
      throw InputError(
          "{}: the region is full: {} of {} bodies were poured, a solid fraction of {:.3f} instead of the requested {:.3f}. Enlarge "
          "the region, request fewer, or give fill = true",
          p.where, placements_.count_placed(parts_, k), wanted, placements_.volume_placed(parts_, k) / parts_.regions[k].volume,
          report_.solid_fraction[k]);
    }
  }

  /// Takes out what does not lie wholly in its region: with `fill`, which is as many as fit. A population of a given number, mass or solid
  /// fraction would be smaller than requested, and is refused as one is that its region cannot hold.
  void trim() {
    const MeshDistanceScratchPtr scratch = make_mesh_distance_scratch();
    std::vector<std::size_t> trimmed(case_.populations.size(), 0);
    std::vector<Box3> reach(case_.populations.size());  // of what lies outside
    for (std::size_t i = 0; i < moves_.size(); ++i) {
      if (moves_[i] == 0) continue;
      const std::size_t k = parts_.draws[i].population;
      PlacedBody body = placements_.body[i];
      if (!(common_margin(scene_.settings) > 0)) body.scale *= 1 - kPressedIn;
      if (holds_around(parts_.regions[k], body, *scratch)) continue;
      placements_.is_placed[i] = 0;
      ++trimmed[k];
      reach[k].add(body.position);
      for (const Vec3& vertex : body.world_vertices()) reach[k].add(vertex);
      const double r = body.rounding();
      reach[k].add(body.position - Vec3{r, r, r});
      reach[k].add(body.position + Vec3{r, r, r});
    }
    for (std::size_t k = 0; k < trimmed.size(); ++k) {
      if (trimmed[k] == 0) continue;
      const CasePopulation& p = case_.populations[k];
      const std::size_t left = placements_.count_placed(parts_, k), all = left + trimmed[k];
      const Box3& region = parts_.regions[k].box;
      const std::string places = fmt::format("they reach from {} to {}, the region from {} to {}", text_of(reach[k].lower),
                                             text_of(reach[k].upper), text_of(region.lower), text_of(region.upper));
      if (p.amount == CasePopulation::Amount::fill) {
        report_.notices.push_back(fmt::format("{}: {} of {} bodies came to rest outside their region and were removed, {} are left; {}",
                                              p.where, trimmed[k], all, left, places));
        continue;
      }
      if (left == 0) continue;  // refused with the other populations of which nothing is left
      throw InputError(
          "{}: {} of {} bodies came to rest outside their region and would be missing: {}. Make the region contain the place where the "
          "walls hold them (it may reach beyond walls; region = {{ inside_wall = \"NAME\" }} is what a wall holds), or give fill = true in "
          "place of the amount, which keeps what lies in the region",
          p.where, trimmed[k], all, places);
    }
  }

  /// A box that is as long as a periodic axis has no sides there.
  bool holds_around(const Region& region, const PlacedBody& body, MeshDistanceScratch& scratch) const {
    if (!region.is_box()) return region.holds(body, body.world_vertices(), 0, scratch);
    Wall open = region.shape;
    const Domain& domain = case_.settings.domain;
    for (int k = 0; k < 3; ++k) {
      if (!domain.periodic[static_cast<std::size_t>(k)] || region.box.lower[k] > domain.lower[k] || region.box.upper[k] < domain.upper[k])
        continue;
      open.lower[k] = -1e300;
      open.upper[k] = 1e300;
    }
    return wall_allows(open, nullptr, false, body, body.world_vertices(), 0, scratch);
  }

  std::size_t population() const {
    for (std::size_t k = 0; k < case_.populations.size(); ++k) {
      if (case_.populations[k].method == PackingMethod::settle) return k;
    }
    return 0;
  }

  const Case& case_;
  const SceneParts& parts_;
  const Scene& scene_;
  const ChildSolver& solver_;
  Placements& placements_;
  PackingReport& report_;
  std::vector<std::uint8_t> moves_;
  std::vector<Vec3> velocity_, spin_;
  std::vector<std::size_t> waiting_;  // draws that are not in yet, in the order of their ids
  std::size_t wanted_ = 0;
  std::uint64_t stage_ = 0;
  double largest_ = 0, fall_ = 0, own_fall_ = 0;
  double softness_ = 1;   // of contacts now, see softness.hpp
  bool expands_ = false;  // while it becomes stiffer
  bool stops_rolls_ = false;
  bool at_rest_ = false;  // after the last part of the way
  double kinetic_ = 0;    // then [J]
};

}  // namespace

void settle_populations(const Case& c, const SceneParts& parts, const Scene& scene, const ChildSolver& solver, Placements& placements,
                        PackingReport& report) {
  Settler settler(c, parts, scene, solver, placements, report);
  settler.run();
}

}  // namespace scree
