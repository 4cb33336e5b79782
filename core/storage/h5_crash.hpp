// HDF5 1.10 crashes on some damaged files: a flipped bit makes it read address 0. A user then sees a signal, and not which file is damaged.
#pragma once

#include <string>

namespace scree::h5 {

/// From now on a crash within the HDF5 library ends the process with a message that names the file opened last, and with the exit code of
/// damaged data. Other crashes end as without this. For programs only: a library leaves signals to its program. Does nothing in builds with
/// sanitizers, which report crashes themselves.
/// in   program   for the message; kept
void explain_crashes(const char* program);

/// The file that the message names.
void set_opened(const std::string& path);

}  // namespace scree::h5
