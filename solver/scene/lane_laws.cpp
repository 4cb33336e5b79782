#include "solver/scene/lane_laws.hpp"

#include <algorithm>
#include <cmath>
#include <type_traits>

#include "solver/built_with.hpp"
#include "solver/scene/solver_scene.hpp"

namespace scree {

namespace {

/// A law that is not named here goes the general way.
template <class Entry>
constexpr LaneLawKind kind_of() {
  constexpr bool linear = std::is_same_v<typename Entry::Normal, LinearLaw>, hertz = std::is_same_v<typename Entry::Normal, HertzLaw>;
  constexpr bool viscous = std::is_same_v<typename Entry::Damp, ViscousDamping>;
  if (linear && viscous) return LaneLawKind::linear_viscous;
  if (linear && std::is_same_v<typename Entry::Damp, HuntCrossleyDamping>) return LaneLawKind::linear_hunt_crossley;
  return hertz && viscous ? LaneLawKind::hertz_viscous : LaneLawKind::none;
}

template <class Entry>
LaneLaw ball_law(const PairLaw& law) {
  constexpr LaneLawKind kind = kind_of<Entry>();
  LaneLaw row;
  // products in the order of HertzLaw and ViscousDamping: the bits are theirs
  row.stiffness = kind == LaneLawKind::hertz_viscous ? 4.0 / 3 * law.stiffness : law.stiffness;
  row.size_stiffness = law.size_stiffness;
  row.damping = kind == LaneLawKind::linear_hunt_crossley ? law.damping_slope : 2 * law.damping_ratio;
  row.friction = law.friction;
  row.friction_sliding = law.friction_sliding;
  row.tangential_ratio = law.tangential_ratio;
  row.tangential_damping = law.tangential_damping * std::sqrt(law.tangential_ratio / Entry::Normal::kExponent);
  row.radius = law.radius;
  return row;
}

void add_zones(const SolverScene& scene, LaneLaws& table) {
  for (std::size_t n = 0; n < scene.zones().size(); ++n) {
    const WallZone& zone = scene.zones()[n];
    const Wall& wall = scene.source().walls[static_cast<std::size_t>(zone.wall)];
    const bool is_plane = zone.kind == WallZone::Kind::plane, is_round = zone.kind == WallZone::Kind::cylinder;
    // one that is moved from outside answers to nothing
    const Drive* drive = scene.has_answering_walls() ? scene.drive(static_cast<std::size_t>(zone.wall)) : nullptr;
    const bool answers = drive != nullptr && !drive->is_outer;
    const bool goes = (is_plane || (is_round && zone.radius > 0)) && !wall.surface.moves() && !answers;
    table.row_of_zone.push_back(goes ? static_cast<std::int32_t>(table.zones.size()) : -1);
    if (goes) table.zones.push_back({static_cast<std::int32_t>(n), wall.material});
    table.has_cylinders = table.has_cylinders || (goes && is_round);
  }
}

}  // namespace

LaneLaws make_lane_laws(const SolverScene& scene) {
  LaneLaws table;
  const LawChoice& choice = scene.law_choice();
  if (choice.gathering != Gathering::potential || choice.attraction || choice.yields || scene.reach() > 0 ||
      scene.source().settings.barrier > 0 || !scene.source().bonds.empty() || scene.laws_by_max_overlap())
    return table;
  table.friction = built_with::kFriction && choice.friction;
  table.needs_radius = choice.needs_radius;
  table.max_overlap_by_size = scene.margins_by_size();
  table.margin = table.max_overlap_by_size ? 0 : 2 * scene.margin();
  table.materials = scene.source().materials.size();
  for_law(choice.law, [&]<class Entry>() {
    if constexpr (kind_of<Entry>() != LaneLawKind::none) {
      table.kind = kind_of<Entry>();
      for (std::size_t row = 0; row < table.materials * table.materials; ++row) {
        const PairLaw& law = scene.law(static_cast<std::int32_t>(row / table.materials), static_cast<std::int32_t>(row % table.materials));
        // pairs keep as many springs as others of the scene: one of friction, two where materials roll (with a spring), or none
        const bool rolls = law.rolling_friction > 0 || law.torsional_friction > 0;
        const bool like_others =
            !built_with::kFriction || (rolls == choice.rolling && (!rolls || (law.rolling_spring && law.friction > 0)));
        const bool rubs = table.friction ? law.friction > 0 : Entry::Damp::acts(law);
        table.laws.push_back(ball_law<Entry>(law));
        table.holds.push_back(like_others && rubs ? 1 : 0);
        if (built_with::kFriction && choice.rolling) table.rolling.push_back({law.rolling_friction, law.torsional_friction});
      }
    }
  });
  return table;
}

LaneLaws make_ball_laws(const SolverScene& scene) {
  const std::vector<SolverShape>& shapes = scene.shapes();
  if (std::none_of(shapes.begin(), shapes.end(), [](const SolverShape& s) { return s.kind == ShapeKind::sphere; })) return {};
  LaneLaws table = scene.lane_laws();
  if (table.kind != LaneLawKind::none) add_zones(scene, table);
  return table;
}

}  // namespace scree
