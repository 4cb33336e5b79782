// Names and formats of the files of a run folder that other tools look for. The page of the files is RUN_FORMAT.md.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace scree {

inline constexpr const char* kCheckpointFormat = "scree-checkpoint";
inline constexpr std::int64_t kCheckpointFormatVersion = 7;  // 3 to 6 are still read

inline constexpr const char* kSceneOfRun = "scene.h5";

std::string frame_name(std::int64_t number);     ///< frame_000123.hdf
std::string checkpoint_name(std::int64_t step);  ///< checkpoint_000000123456.h5
/// The number in a name that these functions give; nothing for any other name, such as checkpoint_backup.h5.
std::optional<std::int64_t> frame_number_of(const std::string& name);
std::optional<std::int64_t> checkpoint_step_of(const std::string& name);

/// Paths of the checkpoints of a run folder, by ascending step.
std::vector<std::string> list_checkpoints(const std::string& folder);

}  // namespace scree
