#include "decomposer/packing/compact.hpp"

#include <algorithm>
#include <cmath>

#include "core/base/error.hpp"
#include "core/base/long_work.hpp"
#include "core/base/units.hpp"
#include "decomposer/packing/packer.hpp"

namespace scree {

namespace {

constexpr double kStartFraction = 0.22;  // easy for random addition of any shape
constexpr double kGrowthOfRest = 0.15;   // share of what is left that one stage grows
constexpr double kFastestGrowth = 0.05;  // of the scale, in one stage
constexpr double kRecovery = 1.5;        // of the growth, after each stage that held, when one before it was too fast
constexpr double kSlowestGrowth = 1e-4;  // of the scale: below, the packing is jammed
// A packing that jams is drawn back by this share of the scale, with margins that fill a little more than the gap: pressed thus it comes to
// rest in a denser order, and grows again. Two such rounds took 260 balls from 0.627 to above 0.630; more add little.
constexpr int kMaxRounds = 2;
constexpr double kDrawnBack = 0.05, kMarginOfGap = 1.2;
constexpr double kPressedByStage = 0.5;    // of the margins, that one stage presses two bodies into each other
constexpr double kTooDeep = 0.9;           // of the margins, at the end of a stage: the next one would not begin
constexpr double kContactsPerStage = 60;   // duration of a stage, in durations of one contact
constexpr double kStageRestitution = 0.2;  // of a stage: much damping, and no creeping as with none left

class Compactor {
 public:
  Compactor(const Case& c, const SceneParts& parts, const Scene& scene, std::size_t population, const ChildSolver& solver,
            Placements& placements, PackingReport& report)
      : case_(c),
        parts_(parts),
        scene_(scene),
        population_(population),
        solver_(solver),
        placements_(placements),
        report_(report),
        moves_(parts.draws.size(), 0),
        still_(parts.draws.size()) {
    for (std::size_t i = 0; i < parts.draws.size(); ++i) {
      if (parts.draws[i].population != population) continue;
      moves_[i] = 1;
      volume_ += parts.draws[i].volume;
      largest_ = std::max(largest_, parts.draws[i].scale * parts.shape(parts.draws[i].shape).radius);
      const double v = parts.draws[i].volume;
      lightest_ = std::min(lightest_, v);
    }
  }

  void run() {
    const Region& region = parts_.regions[population_];
    if (!(volume_ > 0)) return;
    // As far apart as a stage of the fastest growth leaves bodies. Placed at the gap of the case and grown at once, they would begin
    // deeper than any margin, and growth had to be as slow as a narrow margin allows: 400 stages in place of 30.
    const double placed = std::min(1.0, std::cbrt(kStartFraction * region.volume / volume_));
    place_small(placed);
    double scale = placed < 1 ? placed / (1 + kFastestGrowth / kPressedByStage) : 1;  // what finds room in its size need not grow
    double most = kFastestGrowth;
    int rounds = 0;
    LongWork work("compact", 1);
    while (scale < 1) {
      const double wanted = growth(scale, most), next = grown(scale, wanted);
      const int left = stages_left(scale, most);
      progress_ = [&, left](double share) {
        work.update((stages_ + share) / (stages_ + left),
                    fmt::format("{:.3f} of the size, stage {} of about {}", scale, stages_ + 1, stages_ + left));
      };
      progress_(0);
      const Placements before = placements_;
      if (grow(next, std::max(case_margin(), wanted * next * largest_ / kPressedByStage))) {
        scale = next;
        most = std::min(kRecovery * most, kFastestGrowth);
        continue;
      }
      placements_ = before;
      most = 0.5 * std::min(most, std::max(wanted, kSlowestGrowth));
      if (most >= kSlowestGrowth) continue;
      jammed_at_ = std::max(jammed_at_, scale);
      if (rounds++ < kMaxRounds && grow((1 - kDrawnBack) * scale, std::max(case_margin(), kMarginOfGap * kDrawnBack * scale * largest_))) {
        scale *= 1 - kDrawnBack;
        most = kFastestGrowth;
        continue;
      }
      throw InputError(
          "{}: jammed at a solid fraction of {:.4f} instead of the requested {:.4f} ({}). "
          "Request less, or give the bodies a wider range of sizes{}",
          case_.populations[population_].where, jammed_at_ * jammed_at_ * jammed_at_ * volume_ / region.volume, volume_ / region.volume,
          why_.substr(0, why_.find(';')),
          case_.margin_given ? fmt::format(", or reduce the margin ({}, which bodies keep from each other and from the sides)",
                                           format_quantity(case_margin(), Dimension::length))
                             : "");
    }
    if (worst_ > 0) {
      report_.notices.push_back(fmt::format("compact: the bodies of {} start in contact, with overlaps of at most {:.2f} of the margins",
                                            case_.populations[population_].where, worst_));
    }
  }

 private:
  /// Meshes that touch where they are drawn; balls by themselves grow with margins of one width.
  bool goes_with_size() const { return scene_.settings.surface == TouchAt::drawn && scene_.settings.margin_ratio > 0; }
  /// Balls that touch without a margin grow with a small one.
  double case_margin() const {
    constexpr double kForBalls = 1e-3;  // of the radius
    if (goes_with_size()) return scene_.settings.margin_ratio * largest_;
    return scene_.settings.margin > 0 ? scene_.settings.margin : kForBalls * largest_;
  }

  void place_small(double scale) {
    Scene unused;
    unused.settings = scene_.settings;
    unused.walls = scene_.walls;
    SceneParts small = parts_;
    for (Draw& d : small.draws) {
      if (d.population == population_) d.scale *= scale;
    }
    for (std::size_t i = 0; i < small.wall_bodies.size(); ++i) {
      if (small.wall_bodies[i].shape != nullptr) small.wall_bodies[i].shape = &small.wall_shapes[i];
    }
    Packer packer(case_, small, unused, report_);
    for (std::size_t i = 0; i < placements_.body.size(); ++i) {
      if (placements_.is_placed[i] != 0) packer.keep(placements_.body[i]);
    }
    packer.keep_standing();
    for (std::size_t i = 0; i < small.draws.size(); ++i) {
      if (moves_[i] == 0) continue;
      PlacedBody& body = placements_.body[i];
      body.scale = small.draws[i].scale;
      if (!packer.try_place(small.draws[i], body, kAttempts, 0)) {
        throw InputError(
            "{}: found no place for the bodies even at {:.2f} of their size; the region is too narrow or too full of other bodies",
            case_.populations[population_].where, scale);
      }
      packer.keep(body);
      placements_.is_placed[i] = 1;
    }
  }

  /// By which share of a scale the next stage grows, and to which.
  double growth(double scale, double most) const {
    const double rest = 1 / scale - 1;
    return std::min({most, std::max(kGrowthOfRest * rest, 0.25 * case_margin() / largest_), rest});
  }
  static double grown(double scale, double wanted) { return 1 / scale - 1 <= wanted * (1 + 1e-12) ? 1 : scale * (1 + wanted); }
  /// Stages from a scale to the end when none of them fails.
  int stages_left(double scale, double most) const {
    constexpr int kMaxStages = 10000;
    int stages = 0;
    for (; scale < 1 && stages < kMaxStages; ++stages) {
      scale = grown(scale, growth(scale, most));
      most = std::min(kRecovery * most, kFastestGrowth);
    }
    return stages;
  }

  /// Gives all bodies a new size and lets them move apart. False when they cannot.
  bool grow(double scale, double margin) {
    for (std::size_t i = 0; i < moves_.size(); ++i) {
      if (moves_[i] != 0) placements_.body[i].scale = scale == 1 ? parts_.draws[i].scale : parts_.draws[i].scale * scale;
    }
    std::vector<std::int64_t> draw_of_body;
    Scene stage = stage_scene(case_, parts_, scene_, placements_, moves_, still_, still_, draw_of_body);
    add_region_walls(stage);
    // one material, no friction; the stiffness only sets the scale of time
    const double density = 1000, mass = density * lightest_ * scale * scale * scale;
    for (Material& m : stage.materials) m.density = density;
    stage.pairs.clear();
    for (std::int32_t a = 0; a < static_cast<std::int32_t>(stage.materials.size()); ++a) {
      for (std::int32_t b = a; b < static_cast<std::int32_t>(stage.materials.size()); ++b) {
        MaterialPair pair;
        pair.a = a;
        pair.b = b;
        pair.stiffness = mass;  // a contact of the lightest body lasts about 2 s
        pair.restitution = kStageRestitution;
        stage.pairs.push_back(pair);
      }
    }
    Settings& s = stage.settings;
    s.law = ContactLaw::linear;
    s.gather = Gathering::potential;
    s.gravity = {};
    s.cell.reset();
    s.margin = margin;
    s.surface = goes_with_size() ? TouchAt::drawn : TouchAt::outside;
    s.margin_ratio = goes_with_size() ? margin / (scale * largest_) : 0;
    s.step = 0;
    s.step_control = StepControl::fixed;
    s.steps_per_contact = 20;
    s.impact_speed = 0;
    constexpr double kContactTime = 2.2;  // [s] pi sqrt(m / 2k), two of the lightest
    s.duration = kContactsPerStage * kContactTime;
    s.output_every = s.duration;
    s.output_contacts = true;
    Frame frame;
    try {
      frame = run_solver(solver_, stage, progress_);
      ++stages_;
    } catch (const RunInvalid& e) {
      ++stages_;
      why_ = e.what();
      return false;
    }
    if (frame.bodies.size() != stage.bodies.size()) {
      why_ = "bodies left the domain";
      return false;
    }
    worst_ = 0;
    for (std::size_t i = 0; i < frame.contacts.size(); ++i)
      worst_ = std::max(worst_, frame.contacts.overlap[i] / std::min(frame.contacts.margin[i], 2 * margin));
    if (worst_ > kTooDeep) {
      why_ = fmt::format("overlaps of {:.2f} of the margins remain", worst_);
      return false;
    }
    for (std::size_t b = 0; b < frame.bodies.size(); ++b) {
      if (draw_of_body[b] < 0) continue;
      PlacedBody& body = placements_.body[static_cast<std::size_t>(draw_of_body[b])];
      body.position = frame.bodies.position[b];
      body.orientation = frame.bodies.orientation[b];
    }
    return true;
  }

  void add_region_walls(Scene& stage) const {
    const Region& region = parts_.regions[population_];
    Wall wall = region.shape;
    wall.name = "region";
    wall.id = parts_.first_id + static_cast<std::int64_t>(case_.bodies.size() + case_.walls.size() + parts_.draws.size());
    wall.motion = {};
    wall.surface = {};
    wall.material = case_.populations[population_].material;
    if (region.is_mesh()) {
      wall.shape = static_cast<std::int32_t>(stage.shapes.size());
      stage.shapes.push_back(region.mesh.shape);
    }
    stage.walls.push_back(wall);
  }

  const Case& case_;
  const SceneParts& parts_;
  const Scene& scene_;
  std::size_t population_;
  const ChildSolver& solver_;
  Placements& placements_;
  PackingReport& report_;
  std::vector<std::uint8_t> moves_;
  std::vector<Vec3> still_;
  double volume_ = 0, largest_ = 0, lightest_ = 1e300;  // [m^3], [m], [m^3]
  int stages_ = 0;                                      // that were run
  std::function<void(double)> progress_;                // told the share of a stage that is done
  double worst_ = 0;                                    // depth over margins at the end of the last stage
  double jammed_at_ = 0;                                // largest scale that was reached before
  std::string why_ = "no stage was run";
};

}  // namespace

void compact_population(const Case& c, const SceneParts& parts, const Scene& scene, std::size_t population, const ChildSolver& solver,
                        Placements& placements, PackingReport& report) {
  Compactor(c, parts, scene, population, solver, placements, report).run();
}

}  // namespace scree
