// The present state of a simulation as a frame.
#pragma once

#include "core/storage/frame_file.hpp"
#include "solver/run/measures.hpp"

namespace scree {

/// Appends a body to those of a frame, in the world.
/// in   rank     its owner
/// in   origin   of the scene as it is computed [m], see origin.hpp
void add_frame_body(const SolverScene& scene, const ParticleRecord& body, int rank, const Vec3& origin, FrameBodies& bodies);

/// This rank's part of a frame, in the world; walls and scalars are the same on every rank. Collective.
/// in   energies        of the whole scene, now
/// in   with_contacts   whether contacts are computed for it
/// The number and the provenance are left to the caller.
Frame make_frame(Simulation& simulation, const Energies& energies, int rank, bool with_contacts, const Vec3& origin);

}  // namespace scree
