// The laws of a scene as pairs of balls read them side by side: numbers alone, a row for each two materials.
//
// Pairs of balls (analytic spheres) have one contact each and a path of their own through a step (pairs/ball_evaluation.hpp), with the bits
// of the general one. What it does not have (rolling resistance of constant moment, attraction, a barrier, bonds, other ways of gathering)
// goes the general way: the scene as a whole, or the pairs of two materials.
#pragma once

#include <cstdint>
#include <vector>

namespace scree {

class SolverScene;

/// Which formulas the lanes have.
enum class LaneLawKind : std::uint8_t { none, linear_viscous, linear_hunt_crossley, hertz_viscous };

/// Of two materials: what of PairLaw a pair of balls reads. Eight numbers, so that rows are found by their index alone.
struct LaneLaw {
  double stiffness = 0;           ///< linear: k [N/m]; Hertz: 4/3 E* [Pa]
  double size_stiffness = 0;      ///< linear: what k has for each metre of R* [N/m^2]
  double damping = 0;             ///< viscous: 2 zeta; Hunt-Crossley: chi [s/m]
  double friction = 0;            ///< mu, static
  double friction_sliding = 0;    ///< mu, sliding
  double tangential_ratio = 0;    ///< rho
  double tangential_damping = 0;  ///< damping of sliding over chi times push
  double radius = 0;              ///< R* [m] as given; 0: that of the bodies
};

/// What two materials have against rolling, a row beside that of LaneLaw.
struct BallRolling {
  double friction = 0, torsional = 0;  ///< mu_r, mu_t
};

/// A zone of a wall, a plane or a cylinder, that balls meet this way.
struct BallZone {
  std::int32_t zone = 0;
  std::int32_t material = 0;
};

struct LaneLaws {
  LaneLawKind kind = LaneLawKind::none;  ///< none: no pair of the scene goes this way
  bool friction = false;
  bool needs_radius = false;
  bool max_overlap_by_size = false;  ///< overlap may go to the smaller radius; else to `margin`
  double margin = 0;                 ///< gap at which touch begins [m]
  std::vector<LaneLaw> laws;         ///< [material of A][material of B]
  std::vector<std::uint8_t> holds;   ///< whether pairs of these materials go this way
  std::vector<BallRolling> rolling;  ///< empty: no two materials have any
  std::size_t materials = 0;
  std::vector<BallZone> zones;
  std::vector<std::int32_t> row_of_zone;  ///< in `zones`, of each zone of the scene; -1 where balls meet it by the general path
  bool has_cylinders = false;
  std::size_t row(std::int32_t a, std::int32_t b) const { return static_cast<std::size_t>(a) * materials + static_cast<std::size_t>(b); }
};

/// Of all pairs that go in lanes, whatever the bodies are: without zones. Kind none where no pair of the scene may.
LaneLaws make_lane_laws(const SolverScene& scene);
/// The same with zones, where the scene has balls.
LaneLaws make_ball_laws(const SolverScene& scene);

}  // namespace scree
