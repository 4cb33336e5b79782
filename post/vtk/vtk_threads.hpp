// Threads that VTK has of its own.
#pragma once

namespace scree {

/// VTK computes without threads from now on. To be called before frames are shared out over processes (run/frame_pool.hpp): a thread that
/// VTK started before is not in them, and they would wait for it, now and then, forever.
void keep_vtk_to_one_thread();
/// Whether it does.
bool vtk_has_threads();

}  // namespace scree
