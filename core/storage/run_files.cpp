#include "core/storage/run_files.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <filesystem>
#include <string_view>
#include <utility>

namespace scree {

namespace {

namespace fs = std::filesystem;

/// The number between the two ends of a name, when `name_of` gives the same name for it.
std::optional<std::int64_t> number_in(const std::string& name, std::string_view front, std::string_view back,
                                      std::string (*name_of)(std::int64_t)) {
  if (name.size() <= front.size() + back.size() || !name.starts_with(front) || !name.ends_with(back)) return {};
  const char *first = name.data() + front.size(), *last = name.data() + name.size() - back.size();
  std::int64_t number = -1;
  const auto [end, error] = std::from_chars(first, last, number);
  if (error != std::errc() || end != last || number < 0 || name_of(number) != name) return {};
  return number;
}

}  // namespace

std::string frame_name(std::int64_t number) { return fmt::format("frame_{:06}.hdf", number); }
std::string checkpoint_name(std::int64_t step) { return fmt::format("checkpoint_{:012}.h5", step); }
std::optional<std::int64_t> frame_number_of(const std::string& name) { return number_in(name, "frame_", ".hdf", frame_name); }
std::optional<std::int64_t> checkpoint_step_of(const std::string& name) { return number_in(name, "checkpoint_", ".h5", checkpoint_name); }

std::vector<std::string> list_checkpoints(const std::string& folder) {
  std::vector<std::pair<std::int64_t, std::string>> found;
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(folder, error)) {
    if (const auto step = checkpoint_step_of(entry.path().filename().string())) found.emplace_back(*step, entry.path().string());
  }
  std::sort(found.begin(), found.end());
  std::vector<std::string> paths;
  for (auto& [step, path] : found) paths.push_back(std::move(path));
  return paths;
}

}  // namespace scree
