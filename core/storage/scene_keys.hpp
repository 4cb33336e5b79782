// The keys of a case that its scene file keeps: settings, materials, pairs of materials. A new one is an entry in scene_keys.cpp and the
// member that it fills (scene.hpp): the case and the scene file are then read and written with it, and it is in the schema and
// CASE.md.
#pragma once

#include "core/storage/keys.hpp"
#include "core/storage/scene.hpp"

namespace scree {

/// title, seed, gravity
void run_keys(KeyVisitor& k, Settings& s);
void time_keys(KeyVisitor& k, Settings& s);
/// min and max only when the domain is bounded
void domain_keys(KeyVisitor& k, Domain& d);
void fluid_keys(KeyVisitor& k, Fluid& f);
void heat_keys(KeyVisitor& k, Heat& h);
/// Of [cell]: what ends the run.
void cell_stop_keys(KeyVisitor& k, CellControl& c);
void contact_keys(KeyVisitor& k, Settings& s);
void motion_keys(KeyVisitor& k, Settings& s);
void output_keys(KeyVisitor& k, Settings& s);
void material_keys(KeyVisitor& k, Material& m);
/// in   s   whose law and gathering decide what a pair must give
void pair_keys(KeyVisitor& k, MaterialPair& p, const Settings& s);
// of scenes with heat
void material_heat_keys(KeyVisitor& k, Material& m);
void pair_heat_keys(KeyVisitor& k, MaterialPair& p);

}  // namespace scree
