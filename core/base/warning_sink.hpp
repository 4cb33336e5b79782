// Where warnings go.
#pragma once

#include <functional>
#include <string>

namespace scree {

/// Warnings of warn_once() go there in place of stderr; an empty function: to stderr. Of the whole process.
void set_warning_sink(std::function<void(const std::string& text)> sink);
/// Every text is new again: for a process that begins another run.
void forget_warnings();

}  // namespace scree
