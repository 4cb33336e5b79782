// The X display that pictures are drawn through: the one of this session, else one without a screen that the tool starts for itself.
#pragma once

#include <string>

namespace scree {

/// Makes sure that DISPLAY names an X display that answers. Debian's VTK draws through X only, and aborts without one.
///
/// How: where DISPLAY is not set, or does not answer, an Xvfb is started, with a cookie of its own and no network; it chooses a free number
/// itself and writes it when it is ready, so that there is no wait for a signal that may come too early. It ends with this process, in
/// whatever way that ends, and says nothing. DISPLAY and XAUTHORITY of this process, and of those it starts, then name it.
/// Returns "", or why there is no display and what to do.
/// Threads: call it before any are started.   Cost: some tenths of a second when a display is started, once in a process.
std::string display_obstacle();

}  // namespace scree
