#include "core/base/expect_ending.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "core/base/error.hpp"

namespace scree {

void expect_ending(const std::string& option, const std::string& path, const std::string& what,
                   std::initializer_list<const char*> endings) {
  std::string stem = path, known;
  for (const std::string ending : endings) {
    if (path.size() > ending.size() && path.ends_with(ending)) return;
    known += (known.empty() ? "NAME" : ", ") + ending;
  }
  // what there is of an ending goes: x, x.h5 and x.scene become x.scene.h5
  for (const std::string ending : {".h5", ".scene", ".shape"}) {
    if (stem.ends_with(ending)) stem.resize(stem.size() - ending.size());
  }
  if (stem.empty() || stem.ends_with('/')) stem += "NAME";
  throw UsageError("{} {}: {} is called {}; write {} {}{}", option, path, what, known, option, stem, *endings.begin());
}

}  // namespace scree
