#include "decomposer/packing/inlets.hpp"

#include <algorithm>

#include "core/base/units.hpp"
#include "core/placing/random_numbers.hpp"
#include "core/storage/attraction.hpp"
#include "core/surface/touch_surface.hpp"

namespace scree {

namespace {

// Places that are tried for a body: of a region of which a thousandth is free of walls, one is found nearly always.
constexpr std::uint64_t kTries = 4000;

/// The largest body of one shape of an inlet, at places in its region.
class Trial {
 public:
  Trial(const Case& c, const SceneParts& parts, const Scene& scene, std::size_t inlet)
      : case_(c),
        parts_(parts),
        asked_(c.inlets[inlet]),
        region_(parts.inlets[inlet]),
        gap_(2 * common_margin(scene.settings) + widest_range(scene)),
        scratch_(make_mesh_distance_scratch()) {}

  void run(std::int32_t of) {
    const PackShape& shape = parts_.shape(of);
    PlacedBody body{&shape, scales_of(asked_.size, shape.shape).largest, {}, {}};
    bool fits = false, is_free = false;
    std::size_t wall = 0;
    for (std::uint64_t attempt = 0; attempt < kTries && !is_free; ++attempt) {
      const RandomNumbers random(case_.settings.seed, of, attempt);
      if (!place(random, body)) continue;
      fits = true;
      is_free = walls_allow(body, wall);
      if (is_free) find_outlet(body);
    }
    const std::string what = fmt::format("'{}' of diameter {}", case_.shapes[static_cast<std::size_t>(of)].name,
                                         metres(body.scale * shape.shape.equivalent_diameter()));
    const Vec3 e = region_.box.extent();
    if (!fits) {
      throw InputError(
          "{}.region: holds no {} in any of {} orientations and places; it is {} x {} x {}; enlarge it, or make the bodies smaller",
          asked_.where, what, kTries, metres(e.x), metres(e.y), metres(e.z));
    }
    if (!is_free) {
      throw InputError(
          "{}.region: lies in the wall '{}' or within its reach: none of {} places for {} is clear of the walls{}; move or enlarge "
          "it",
          asked_.where, case_.walls[wall].wall.name, kTries, what,
          gap_ > 0 ? fmt::format(" by the {} at which contact begins", metres(gap_)) : "");
    }
  }

 private:
  bool place(const RandomNumbers& random, PlacedBody& body) {
    if (!draw_place(region_, asked_.orientation, random, body)) return false;
    body.world_vertices(vertices_);
    return region_.is_box() || region_.holds(body, vertices_, 0, *scratch_);
  }

  bool walls_allow(const PlacedBody& body, std::size_t& refusing) {
    for (std::size_t w = 0; w < parts_.walls.size(); ++w) {
      if (wall_allows(parts_.walls[w], &parts_.wall_bodies[w], parts_.wall_is_solid[w], body, vertices_, gap_, *scratch_)) continue;
      refusing = w;
      return false;
    }
    return true;
  }

  void find_outlet(const PlacedBody& body) const {
    for (std::size_t k = 0; k < case_.outlets.size(); ++k) {
      const CaseOutlet& outlet = case_.outlets[k];
      if (outlet.to >= 0 || !parts_.outlets[k].contains(body.position)) continue;
      throw UsageError(
          "{}: the outlet '{}' holds places of the inlet '{}' ({}): it would take bodies out as they come in. Move one of them, or let "
          "them "
          "come in again with to = \"{}\"",
          outlet.where, outlet.name, asked_.name, asked_.where, asked_.name);
    }
  }

  const Case& case_;
  const SceneParts& parts_;
  const CaseInlet& asked_;
  const Region& region_;
  double gap_;
  MeshDistanceScratchPtr scratch_;
  std::vector<Vec3> vertices_;
};

}  // namespace

Inlet make_inlet(const CaseInlet& asked, const SceneParts& parts, const RegionShape& region) {
  Inlet inlet = asked.inlet;
  inlet.name = asked.name;
  inlet.region = region;
  inlet.material = asked.material;
  inlet.size = asked.size;
  inlet.orientation = asked.orientation;
  inlet.velocity = asked.velocity;
  inlet.angular_velocity = asked.angular_velocity;
  inlet.temperature = asked.temperature;
  double sum = 0;
  for (const auto& [shape, share] : asked.shares) {
    // with a distribution of sizes all shapes have the same mean volume
    const double volume = asked.shares_by_mass && !asked.size ? parts.shape(shape).shape.mass.volume : 1;
    inlet.shares.push_back({parts.scene_shape[static_cast<std::size_t>(shape)], share / volume});
    sum += share / volume;
  }
  for (Inlet::Share& share : inlet.shares) share.share /= sum;
  return inlet;
}

void check_inlets(const Case& c, const SceneParts& parts, const Scene& scene, std::vector<std::string>& notices) {
  for (std::size_t k = 0; k < c.inlets.size(); ++k) {
    const CaseInlet& asked = c.inlets[k];
    Trial trial(c, parts, scene, k);
    for (const auto& share : asked.shares) trial.run(share.first);
    const Inlet& inlet = asked.inlet;
    const bool ends = inlet.stop < c.settings.duration || inlet.limit < 1e300 || inlet.count >= 0;
    if (ends || !c.outlets.empty() || c.settings.domain.outside == Outside::remove) continue;
    notices.push_back(fmt::format(
        "{}: the inlet '{}' has no limit, count or stop, and nothing takes bodies out again: once its region is full, {}", asked.where,
        asked.name, inlet.when_full == WhenFull::stop ? "the run ends (exit 5)" : "it waits, and the run goes on until its end"));
  }
}

}  // namespace scree
