// Attraction of two materials: force and range of one contact, as a case gives them. Decomposer and solver take them from here.
//
// A pair has one of three:
// - potential: F_c over a range s beyond touch; it grows linearly from the end of the range to touch and stays the same from there on
//   (solver/laws/attraction.hpp). Parting a contact takes F_c s / 2 from touch, and more from rest, where F_c presses it together.
// - neck: balls stick as in the theory of JKR (jkr.hpp), from touch until the neck tears.
// - bridge: of liquid, from touch until it ruptures. Willett, Adams, Johnson, Seville, Langmuir 16 (2000) 9396, equation 13:
//     F = F_c / (1 + 2.1 x + 10 x^2), F_c = 2 pi R gamma cos(theta), x = (gap / 2) / sqrt(V / R), R = 2 R*
//   (R is twice R*: that of either of two equal balls; codes differ by this factor of two). It ruptures at
//   (1 + theta / 2) (V^(1/3) + 0.1 V^(2/3) / R), or without the last term (Lian, Thornton, Adams, J. Colloid Interface Sci. 161 (1993)
//   138).
// With gather = "area" a potential is a traction over the range, whose work for each area is w (solver/contact/area_model.hpp).
// A neck and a bridge remember: whether two bodies have one depends on whether they have touched.
#pragma once

#include <functional>

#include "core/storage/scene_file.hpp"

namespace scree {

enum class PullKind { none, potential, neck, bridge };
inline PullKind pull_kind(const MaterialPair& pair) {
  if (pair.surface_tension > 0) return PullKind::bridge;
  if (pair.adhesion > 0 && pair.adhesion_hysteresis) return PullKind::neck;
  return pair.pull_off > 0 || pair.adhesion > 0 ? PullKind::potential : PullKind::none;
}
inline bool attracts(const MaterialPair& pair) { return pull_kind(pair) != PullKind::none; }
/// Whether two bodies attract each other only once they have touched.
inline bool remembers(const MaterialPair& pair) {
  const PullKind kind = pull_kind(pair);
  return kind == PullKind::neck || kind == PullKind::bridge;
}

/// F_c = 3/2 pi w R* (Johnson, Kendall, Roberts 1971) or 2 pi w R* (Derjaguin, Muller, Toporov 1975): this times w R*.
double pull_off_factor(AdhesionModel model);

/// F_c [N] of a contact of radius R* [m].
double pull_off_force(const MaterialPair& pair, double radius);

/// A contact at rest under its own attraction alone.
struct RestingContact {
  double overlap = 0;  ///< at which its push is F_c [m]
  double energy = 0;   ///< that lies between it and touch [J]: F_c overlap less what the push has stored
};
RestingContact resting_contact(ContactLaw law, const MaterialPair& pair, const Material& a, const Material& b, double radius);

/// Gap at which it ends [m]. Of a potential its range: as given, or from the work to part a contact at rest, F_c s / 2 and the energy
/// between rest and touch; 0 where separation_energy is less than that alone. Of a neck where it tears, of a bridge where it ruptures: no
/// less than that of any contact of at most this radius (0: of any).
double attraction_range(ContactLaw law, const MaterialPair& pair, const Material& a, const Material& b, double radius);

/// Work that parts a contact from touch on [J].
double parting_energy(ContactLaw law, const MaterialPair& pair, const Material& a, const Material& b, double radius);

/// Slope of the pull beyond touch where it is steepest [N/m], with gather = "area" for each area, 2 w / s^2 [N/m^3]: a spring of as much
/// would be as quick. 0 of a neck, which only softens.
double steepest_pull(const Settings& settings, const MaterialPair& pair, const Material& a, const Material& b, double radius);

/// Stiffness of the push of a neck [N/m], at the deepest point of an impact or at rest under its own attraction: the least it must be taken
/// for.
double neck_stiffness(const MaterialPair& pair, const Material& a, const Material& b, double radius, double mass, double speed);

/// A liquid bridge of one pair of bodies.
struct LiquidBridge {
  double force;    ///< F_c [N]
  double scale;    ///< gap at which x = 1 [m]
  double rupture;  ///< [m]
  LiquidBridge(const MaterialPair& pair, double radius);
  double force_at(double gap) const;
  /// Work from a gap on until it ruptures [J].
  double energy_at(double gap) const;
  double steepest() const;  ///< largest slope of the force [N/m]
};

/// The widest range of the attractions of a scene [m]; 0: none. With those of bodies whose R* is not given as they are told by the pair.
double widest_range(const Scene& scene);

/// What a pair gives that does not go together: the key and what is wrong with it. A key of "" says that all is well. Follows from the pair
/// and the settings alone.
struct AttractionFault {
  const char* key = "";
  std::string text;
};
AttractionFault attraction_fault(const Settings& settings, const MaterialPair& pair, const Material& a, const Material& b);

/// Greatest overlap [m] of an elastic impact whose bodies attract each other: what the push stores is the energy of motion and the work of
/// the attraction.
double impact_overlap(ContactLaw law, const MaterialPair& pair, const Material& a, const Material& b, double radius, double mass,
                      double speed);

/// Throws UsageError where a contact would be pressed through its margins by its attraction alone.
/// in   radius   R* of the largest bodies [m]     in  margin  sum of both [m]
void check_pressing(const Settings& settings, const MaterialPair& pair, const Material& a, const Material& b, double radius, double margin);

/// Throws UsageError for a body that sticks by necks and is no ball.   in   body    how a message names it, asked only for a message
void check_is_ball_where_necks_are(const Scene& scene, const Shape& shape, std::int32_t material, const std::function<std::string()>& body);

/// Throws UsageError where margins and attraction reach further than a body is thick: what lies behind it would act through it. The
/// thickness is twice volume over area, that of a plate, and no more than the largest ball inside a body that is convex; a ball's diameter.
/// in   body    how a message names it, asked only for a message     in  reach  margins of both bodies and the range [m]
void check_thickness(const Shape& shape, double scale, const std::function<std::string()>& body, double reach);

}  // namespace scree
