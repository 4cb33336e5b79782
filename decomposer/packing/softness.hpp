// How much softer than the case a bed may be poured. Steps grow with the root of the softness, and nothing of the way into the bed stays:
// contacts are made as stiff as the case has them before the bed comes to its last rest (settle.cpp).
#pragma once

#include "decomposer/packing/packing_report.hpp"
#include "decomposer/packing/scene_parts.hpp"

namespace scree {

/// Share of the stiffness of the case, <= 1, with which what is poured neither overlaps too far by an impact nor by the weight of the bed.
/// 1 where little would be won, and where contacts are more than springs (a barrier, an elastic layer, a law that is not known here).
double softness_of_pouring(const Case& c, const SceneParts& parts, const Scene& scene, const PackingReport& report);

/// Contacts of a share of their stiffness, and a step that follows from them.
void soften(Scene& scene, double share);

/// Contacts without dents, which a scene does not keep: they lose by damping what they would lose by yielding.
void make_elastic(Scene& scene);

/// Contacts that lose most of what they store.
void damp(Scene& scene);

/// Balls lose their spin about a contact's normal, which no friction ends in a case without torsional friction: it moves no surface, and a
/// bed would never be at rest for it.
void stop_spins(Scene& scene);

/// Of R* times the normal force: a ball that rolls at 0.1 m/s stops within 1.5 s, and lies still on slopes of half a degree only.
inline constexpr double kRollingAtRest = 0.01;

/// Whether balls may roll on a flat floor without end: there are some, and a pair without rolling friction.
bool may_roll(const Scene& scene);

/// Balls that may roll so come to rest.
void stop_rolls(Scene& scene);

}  // namespace scree
