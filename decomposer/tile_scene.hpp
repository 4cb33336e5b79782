// A settled box of bodies, repeated side by side: a large bed for the price of a small one.
#pragma once

#include <array>

#include "core/storage/frame_file.hpp"
#include "core/storage/scene_file.hpp"

namespace scree {

/// The bodies of a frame, `copies` times along each axis; the box walls grow to hold them all.
///
/// How: the period along an axis is the inner width of the scene's only box wall. Copies meet where each had its wall: at a gap
/// of two margins or more, as the wall held them one margin off. Friction springs are not in a frame: they start again.
/// in   frame    positions, orientations and velocities; empty bodies: those of the scene itself
/// in   copies   >= 1 each
/// out  scene    ids run from 0: walls, then bodies, copy by copy; not partitioned
/// Throws UsageError when the scene has no box wall or several walls, or the frame is of another scene.
Scene tile_scene(const Scene& scene, const FrameBodies& frame, const std::array<int, 3>& copies);

}  // namespace scree
