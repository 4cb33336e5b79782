#include "core/base/near_file.hpp"

#include <algorithm>
#include <filesystem>
#include <vector>

#include "core/base/error.hpp"
#include "core/base/nearest_name.hpp"

namespace scree {

std::string near_file(const std::string& path) {
  const std::filesystem::path asked(path);
  const std::filesystem::path folder = asked.has_parent_path() ? asked.parent_path() : std::filesystem::path(".");
  std::error_code failed;
  std::vector<std::string> names;
  for (std::filesystem::directory_iterator entry(folder, failed), end; !failed && entry != end; entry.increment(failed))
    names.push_back(entry->path().filename().string());
  std::sort(names.begin(), names.end());  // a folder has no order of its own
  const std::string near = nearest_name(asked.filename().string(), names);
  if (near.empty()) return "";
  return fmt::format(", did you mean '{}'?", (asked.parent_path() / near).string());
}

}  // namespace scree
