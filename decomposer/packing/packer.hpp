// Places bodies: the given ones with a check, the drawn ones by random sequential addition, largest first, with
// exact distances between the meshes.
//
// The first kPlainDraws places of a particle are uniform in its region; later ones are uniform over what a vacancy map
// leaves open. A test of inner balls comes before the exact one. Neither changes which places are accepted.
#pragma once

#include <array>
#include <functional>
#include <optional>
#include <string>

#include "core/geometry/periodic.hpp"
#include "core/surface/touch_surface.hpp"
#include "decomposer/packing/packing_report.hpp"
#include "decomposer/packing/placements.hpp"
#include "decomposer/packing/vacancy_map.hpp"

namespace scree {

class Packer {
 public:
  /// Borrows all; scene.settings.margin is known by now.
  Packer(const Case& c, const SceneParts& parts, Scene& scene, PackingReport& report);

  /// Adds the bodies that come from a run, as they are. Throws InputError when a wall that was not in that run, or a wider margin, presses
  /// one too far, or when one lies outside the domain.
  void place_carried_bodies();

  /// Adds the bodies given one by one. Throws InputError when one overlaps another, a wall, or lies outside.
  void place_given_bodies();

  /// Places all draws of the populations with method = "random" and "lattice". Throws InputError when a particle finds no place.
  void place_particles(Placements& placements);

  /// One particle at random. The random numbers are those of attempts first + 1 ... first + attempts.
  bool try_place(const Draw& d, PlacedBody& body, std::uint64_t attempts, std::uint64_t first);

  /// Notes a placed body and its images through periodic axes. `given`: its number among [[bodies]], or -1.
  void keep(const PlacedBody& body, std::int32_t given = -1);
  /// Notes what does not move while others are packed: bodies of a run, and those given one by one.
  void keep_standing();

 private:
  double gap() const { return 2 * common_margin(scene_.settings); }  // contact starts at the sum of two margins
  /// Least gap of two bodies, and of a body and a wall, with which a run can begin [m]; below 0 where surfaces may be pressed into each
  /// other.
  double deepest(const PlacedBody& a, const PlacedBody& b) const;
  double deepest(const PlacedBody& body, const Wall& wall) const;
  double inner_ball(const PlacedBody& body) const { return body.scale * body.shape->inner_radius; }
  static constexpr std::int32_t kDrawn = -1, kFirstCarried = -2;  // carried body n: kFirstCarried - n
  std::size_t carried_number(std::size_t placed) const { return static_cast<std::size_t>(kFirstCarried - given_[placed]); }
  bool is_carried(std::size_t placed) const { return given_[placed] <= kFirstCarried; }
  bool is_fixed(std::size_t placed) const;
  std::string name_of(std::size_t placed) const;
  std::string advice_on_margin() const;
  void check_carried_at_walls(std::size_t body, bool is_wider, std::vector<std::size_t>& touching);
  void check_carried_pairs(std::size_t body);
  void keep_one(const PlacedBody& body, std::int32_t given);
  bool domain_holds(const Vec3& p) const;
  bool walls_allow(const PlacedBody& body, const std::vector<Vec3>& vertices, double distance, std::size_t* refusing = nullptr);
  bool walls_bear(const PlacedBody& body, const std::vector<Vec3>& vertices, std::size_t& refusing);
  bool is_free(const PlacedBody& body, const Region& region);  // fills near_ and vertices_
  /// Where the centre of a body that reaches `extent` about it may lie between the sides of a region.
  Box3 box_of_centres(const Region& region, const Box3& extent) const;
  VacancyMap& vacancy(std::size_t population);
  [[noreturn]] void fail(const Draw& d, std::uint64_t attempts, const Placements& placements);
  void place_on_lattice(std::size_t population, Placements& placements);  // lattice.cpp
  bool fill_lattice(std::size_t population, const std::vector<std::size_t>& members, const Box3& box,
                    const std::array<std::int64_t, 3>& cells, bool takes_all, Placements& placements);

  const Case& case_;
  const SceneParts& parts_;
  Scene& scene_;
  PackingReport& report_;
  Periodicity periodicity_;
  std::vector<PlacedBody> placed_;   // and images
  std::vector<std::int32_t> given_;  // of each placed one, see keep; below -1: of a run
  PlacedGrid grid_;
  std::vector<double> smallest_ball_;                 // inner ball of the smallest body of each population [m]
  std::vector<std::optional<VacancyMap>> vacancies_;  // one per population, made when it is needed
  bool fits_ = false;                                 // whether the last body tried fits between the sides of its region
  std::vector<std::int32_t> near_;
  std::vector<Vec3> vertices_;
  MeshDistanceScratchPtr scratch_;
};

}  // namespace scree
