// Attraction of two materials: force and range of one contact, as a case gives them. Who packs a scene and who runs it take them from here.
//
// A contact has the attraction F_c over a range s beyond touch: it grows linearly from the end of the range to touch and stays the same
// from there on (solver/laws/attraction.hpp). Parting a contact takes F_c s / 2 from touch, and more from rest, where F_c presses it
// together.
#pragma once

#include <functional>

#include "core/storage/scene_file.hpp"

namespace scree {

inline bool attracts(const MaterialPair& pair) { return pair.pull_off > 0 || pair.adhesion > 0; }

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

/// Range s [m]: as given, or from the work to part a contact at rest, F_c s / 2 and the energy between rest and touch.
/// 0 where separation_energy is less than that alone.
double attraction_range(ContactLaw law, const MaterialPair& pair, const Material& a, const Material& b, double radius);

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

/// Throws UsageError where margins and attraction reach further than a body is thick: what lies behind it would act through it. The
/// thickness is twice volume over area, that of a plate, and no more than the largest ball inside a body that is convex; a ball's diameter.
/// in   body    how a message names it, asked only for a message     in  reach  margins of both bodies and the range [m]
void check_thickness(const Shape& shape, double scale, const std::function<std::string()>& body, double reach);

}  // namespace scree
