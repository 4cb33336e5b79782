#include "solver/step/inlets.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/base/units.hpp"
#include "solver/features/pair_features.hpp"
#include "solver/step/domain.hpp"

namespace scree {

namespace {

// Bodies that are tried at once, and places for each: what a reduction over the ranks is worth. A body that finds none of so many places
// free is tried again at the next step that is due.
constexpr std::size_t kBatch = 32, kTrials = 16;
// Draws of a place that the region and the domain hold, for one trial.
constexpr std::uint64_t kDraws = 16;

/// Numbers of an inlet have a seed of their own, so that those of its n-th body are no other body's.
std::uint64_t seed_of(const SolverScene& scene, std::size_t inlet) {
  return scene.source().settings.seed + 0x9E3779B97F4A7C15ull * (static_cast<std::uint64_t>(inlet) + 1);
}

/// Number n of an even sequence in [0, 1), shifted at random: the fractional part of n times an irrational number, in whole numbers, so
/// that it is as even for a large n. Two of them fill the square evenly: 1/p and 1/p^2 with p^3 = p + 1.
double even_number(const RandomNumbers& shift, std::uint64_t which, std::uint64_t n) {
  constexpr std::uint64_t kStep[2] = {0xC13FA9A902A6328Full, 0x91E10DA5C79E7B1Dull};
  const auto start = static_cast<std::uint64_t>(shift.uniform(which) * 0x1p53) << 11;
  return static_cast<double>((start + n * kStep[which]) >> 11) * 0x1p-53;
}

}  // namespace

/// A body that is to come in.
struct Inlets::Wanted {
  bool returns = false;  ///< from the queue
  std::int64_t number = 0;
  std::int32_t shape = 0, material = 0;
  double scale = 1, mass = 0;
  std::uint8_t lock_rotation = 0;
};

/// A place for it.
struct Inlets::Candidate {
  std::size_t wanted = 0;
  PlacedBody body;
};

/// The work of one step.
class Inlets::Feeder {
 public:
  Feeder(Inlets& inlets, RunState& s)
      : inlets_(inlets), s_(s), scene_(s.scene), least_gap_(2 * scene_.contact_range()), next_id_(s.largest_id + 1) {}

  void feed(std::size_t inlet);
  std::vector<ParticleRecord>& records() { return records_; }
  std::int64_t largest_id() const { return next_id_ - 1; }

 private:
  const Inlet& inlet() const { return scene_.source().inlets[inlet_]; }
  InletState& state() { return s_.totals.inlets[inlet_]; }

  Wanted new_body(std::int64_t number) const;
  std::vector<Wanted> due();
  std::vector<Candidate> candidates(const std::vector<Wanted>& wanted);
  bool find_place(const Wanted& w, std::uint64_t attempt, PlacedBody& body);
  std::vector<std::uint8_t> blocked(const std::vector<Candidate>& all);
  std::vector<PlacedBody> bodies_about(const Box3& box) const;
  bool walls_allow(const PlacedBody& body);
  bool are_apart(const PlacedBody& body, const PlacedBody& other);
  double gap(const PlacedBody& body) const { return std::max(least_gap_, kTouch * body.radius()); }
  void let_in(const Wanted& w, const PlacedBody& body);
  void find_no_room(const Wanted& w);

  Inlets& inlets_;
  RunState& s_;
  const SolverScene& scene_;
  double least_gap_;
  std::int64_t next_id_;
  std::size_t inlet_ = 0;
  std::vector<PlacedBody> accepted_;  // in this step
  std::vector<ParticleRecord> records_;
  std::vector<Vec3> vertices_;
};

Inlets::Wanted Inlets::Feeder::new_body(std::int64_t number) const {
  const Source& source = inlets_.sources_[inlet_];
  const RandomNumbers shift(seed_of(scene_, inlet_), -1, 0);
  const auto n = static_cast<std::uint64_t>(number);
  const double which = even_number(shift, 0, n);
  const auto found = std::upper_bound(source.up_to.begin(), source.up_to.end(), which);
  const auto k = std::min(static_cast<std::size_t>(found - source.up_to.begin()), source.up_to.size() - 1);
  Wanted w;
  w.number = number;
  w.shape = inlet().shares[k].shape;
  w.material = inlet().material;
  const Shape& shape = scene_.source().shapes[static_cast<std::size_t>(w.shape)];
  w.scale = scale_of(inlet().size, shape, source.sizes ? source.sizes->diameter(even_number(shift, 1, n)) : 0);
  w.mass = body_mass(scene_, w.shape, w.material, w.scale);
  return w;
}

/// Who is to come in now: those that come again, then new ones.
std::vector<Inlets::Wanted> Inlets::Feeder::due() {
  std::vector<Wanted> wanted;
  for (const TransitBody& b : state().queue) {
    if (wanted.size() == kBatch) return wanted;
    wanted.push_back({true, b.id, b.shape, b.material, b.scale, body_mass(scene_, b.shape, b.material, b.scale), b.lock_rotation});
  }
  const double owed = inlet().owed(s_.clock.time());
  double mass = state().mass;
  for (std::int64_t n = state().count; wanted.size() < kBatch; ++n) {
    if (inlet().count >= 0 && n >= inlet().count) break;
    Wanted w = new_body(n);
    const double after = inlet().rate.by_number ? static_cast<double>(n) + 0.5 : mass + 0.5 * w.mass;
    if (!(owed >= after) || mass + 0.5 * w.mass > inlet().limit) break;
    mass += w.mass;
    wanted.push_back(w);
  }
  return wanted;
}

/// A place that the region and the domain hold; whether there is one among the draws of an attempt.
bool Inlets::Feeder::find_place(const Wanted& w, std::uint64_t attempt, PlacedBody& body) {
  const Region& region = inlets_.sources_[inlet_].region;
  body = {&inlets_.shapes_[static_cast<std::size_t>(w.shape)], w.scale, {}, {}};
  // bodies that come again have numbers of their own
  const std::int64_t key = w.returns ? -2 - w.number : w.number;
  for (std::uint64_t draw = 0; draw < kDraws; ++draw) {
    const RandomNumbers random(seed_of(scene_, inlet_), key, attempt * kDraws + draw);
    if (!draw_place(region, inlet().orientation, random, body) || is_outside(scene_, body.position)) continue;
    body.world_vertices(vertices_);
    if (!region.is_box() && !region.holds(body, vertices_, 0, *inlets_.scratch_)) continue;
    Vec3 image;
    scene_.periodicity().wrap(body.position, image);
    return true;
  }
  return false;
}

std::vector<Inlets::Candidate> Inlets::Feeder::candidates(const std::vector<Wanted>& wanted) {
  const auto look = static_cast<std::uint64_t>(s_.clock.step / kExchangeSteps);
  std::vector<Candidate> all;
  for (std::size_t n = 0; n < wanted.size(); ++n) {
    for (std::size_t t = 0; t < kTrials; ++t) {
      Candidate c{n, {}};
      if (find_place(wanted[n], look * kTrials + t, c.body)) all.push_back(c);
    }
  }
  return all;
}

/// Own bodies that reach into a box that is wider by the gap.
std::vector<PlacedBody> Inlets::Feeder::bodies_about(const Box3& box) const {
  const ParticleSet& p = s_.particles;
  std::vector<PlacedBody> near;
  const Vec3 centre = box.centre(), half = 0.5 * box.extent();
  for (std::size_t i = 0; i < p.owned; ++i) {
    const double reach = p.radius[i] + std::max(least_gap_, kTouch * length(half));
    const Vec3 way = scene_.periodicity().nearest(p.x[i] - centre);
    // along a periodic axis a long region reaches around: all that lie there count
    bool far = false;
    for (int k = 0; k < 3; ++k) far = far || std::abs(way[k]) > half[k] + reach;
    if (far) continue;
    near.push_back(
        {&inlets_.shapes_[static_cast<std::size_t>(p.shape[i])], p.scale[i], p.x[i], mesh_orientation(scene_, p.shape[i], p.q[i])});
  }
  return near;
}

bool Inlets::Feeder::are_apart(const PlacedBody& body, const PlacedBody& other) {
  const double least = gap(body), reach = body.radius() + other.radius() + least;
  const Vec3 way = scene_.periodicity().nearest(other.position - body.position);
  if (squared_length(way) >= reach * reach) return true;
  PlacedBody image = other;
  image.position = body.position + way;
  return gap_between(image, body, least * kJustAbove, *inlets_.scratch_) >= least;
}

bool Inlets::Feeder::walls_allow(const PlacedBody& body) {
  const double least = gap(body), reach = least + body.rounding();
  body.world_vertices(vertices_);
  for (const WallZone& zone : scene_.zones()) {
    const auto w = static_cast<std::size_t>(zone.wall);
    const Wall& wall = scene_.source().walls[w];
    const WallState& state = s_.walls[w];
    if (zone.kind == WallZone::Kind::mesh) {
      const PlacedBody mesh{&inlets_.shapes_[static_cast<std::size_t>(wall.shape)], wall.scale, state.position, state.orientation};
      if (gap_between(mesh, body, least * kJustAbove, *inlets_.scratch_) < least) return false;
      continue;
    }
    for (const Vec3& p : vertices_) {
      Vec3 normal;
      if (zone_gap(zone, rotate_inverse(state.orientation, p - state.position), normal) < reach) return false;
    }
  }
  return true;
}

/// Which places are taken, by the bodies of any rank or by a wall. Walls are the same everywhere: each rank looks at a share of the places.
std::vector<std::uint8_t> Inlets::Feeder::blocked(const std::vector<Candidate>& all) {
  std::vector<std::uint8_t> taken(all.size(), 0);
  if (all.empty()) return taken;
  Box3 box;
  for (const Candidate& c : all) {
    const double r = c.body.radius();
    box.add(c.body.position - Vec3{r, r, r});
    box.add(c.body.position + Vec3{r, r, r});
  }
  const std::vector<PlacedBody> near = bodies_about(box);
  const auto ranks = static_cast<std::size_t>(s_.comm.size()), me = static_cast<std::size_t>(s_.comm.rank());
  for (std::size_t n = 0; n < all.size(); ++n) {
    const PlacedBody& body = all[n].body;
    const bool free = std::all_of(near.begin(), near.end(), [&](const PlacedBody& other) { return are_apart(body, other); }) &&
                      (n % ranks != me || walls_allow(body));
    taken[n] = free ? 0 : 1;
  }
  MPI_Allreduce(MPI_IN_PLACE, taken.data(), static_cast<int>(taken.size()), MPI_UINT8_T, MPI_MAX, s_.comm.get());
  return taken;
}

void Inlets::Feeder::let_in(const Wanted& w, const PlacedBody& body) {
  const std::int64_t id = w.returns ? w.number : next_id_++;
  records_.push_back(make_record(scene_, {id, w.shape, w.material, false, w.lock_rotation != 0, w.scale, body.position, body.orientation,
                                          inlet().velocity, inlet().angular_velocity, inlet().temperature}));
  accepted_.push_back(body);
  if (w.returns) {
    state().queue.erase(state().queue.begin());
    ++state().returned;
  } else {
    ++state().count;
    state().mass += w.mass;
  }
  inlets_.inserted_.push_back({id, s_.clock.step, s_.clock.time(), w.mass, w.scale * body.shape->shape.equivalent_diameter(), body.position,
                               static_cast<std::int32_t>(inlet_), w.shape, w.material});
}

void Inlets::Feeder::find_no_room(const Wanted& w) {
  InletState& now = state();
  now.is_blocked = 1;
  ++now.blocked_looks;
  const Shape& shape = scene_.source().shapes[static_cast<std::size_t>(w.shape)];
  const std::string text =
      fmt::format("inlet '{}': no room for its next body ('{}', diameter {}) at {}, after {} bodies: {} places in its region were tried",
                  inlet().name, shape.name, format_quantity(w.scale * shape.equivalent_diameter(), Dimension::length),
                  format_quantity(s_.clock.time(), Dimension::time), now.count + now.returned, kTrials);
  if (inlet().when_full == WhenFull::stop) {
    mpi::on_root(s_.comm, [&] {
      throw RunInvalid("step {}: {}. when_full = \"stop\" ends the run; enlarge the region, lower the rate, or let bodies leave it faster",
                       s_.clock.step, text);
    });
  }
  if (now.first_blocked >= 0) return;
  now.first_blocked = s_.clock.time();
  if (s_.comm.rank() == 0) {
    warn_once("scree-solver",
              text + ". It waits for room, and what is missing comes as soon as there is; run.json has the shortfall at the end");
  }
}

void Inlets::Feeder::feed(std::size_t inlet) {
  inlet_ = inlet;
  while (true) {
    const std::vector<Wanted> wanted = due();
    if (wanted.empty()) {
      state().is_blocked = 0;
      return;
    }
    const std::vector<Candidate> all = candidates(wanted);
    const std::vector<std::uint8_t> taken = blocked(all);
    auto next = all.begin();
    for (std::size_t n = 0; n < wanted.size(); ++n) {
      const PlacedBody* place = nullptr;
      for (; next != all.end() && next->wanted == n; ++next) {
        const PlacedBody& body = next->body;
        if (place != nullptr || taken[static_cast<std::size_t>(next - all.begin())] != 0) continue;
        if (std::all_of(accepted_.begin(), accepted_.end(), [&](const PlacedBody& other) { return are_apart(body, other); })) place = &body;
      }
      if (place == nullptr) return find_no_room(wanted[n]);
      let_in(wanted[n], *place);
    }
  }
}

Inlets::Inlets(const SolverScene& scene) : scene_(scene) {
  const Scene& source = scene.source();
  if (source.inlets.empty()) return;
  scratch_ = make_mesh_distance_scratch();
  for (const Shape& shape : source.shapes) shapes_.push_back(make_pack_shape(shape, source.settings));
  for (const Inlet& inlet : source.inlets) {
    Source& s = sources_.emplace_back();
    s.region = region_of(inlet.region, source.shapes, fmt::format("inlet '{}'", inlet.name));
    double sum = 0;
    for (const Inlet::Share& share : inlet.shares) s.up_to.push_back(sum += share.share);
    for (double& share : s.up_to) share /= sum;
    if (inlet.size) s.sizes = std::make_unique<SizeSampler>(*inlet.size);
  }
}

Inlets::~Inlets() = default;

void Inlets::feed(RunState& s, Arrivals& arrivals) {
  if (sources_.empty() || s.clock.substep != 0 || s.clock.step % kExchangeSteps != 0) return;
  Feeder feeder(*this, s);
  for (std::size_t k = 0; k < sources_.size(); ++k) feeder.feed(k);
  if (feeder.records().empty()) return;
  // all ranks have the same: the first gives them
  if (s.comm.rank() != 0) feeder.records().clear();
  arrivals.add_known(s, feeder.records(), feeder.largest_id());
}

std::vector<InsertedBody> Inlets::take_inserted() { return std::exchange(inserted_, {}); }

}  // namespace scree
