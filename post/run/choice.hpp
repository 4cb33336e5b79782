// Which frames and which bodies a command works on.
#pragma once

#include <cstdint>
#include <string>
#include <unordered_set>
#include <vector>

#include "post/run/region.hpp"
#include "post/run/run_folder.hpp"

namespace scree {

/// Indices of the frames that a text names: "all", "last", "7", "0,5,-1", "10:50", "::5" (first:last:step, both ends
/// included). Numbers are those in the names of the frames, -1 is the last.
/// Fails: UsageError when the text is no such list or names no frame of the run.
std::vector<std::size_t> choose_frames(const Run& run, const std::string& text);

/// Bodies by what they are. Empty lists choose all.
struct BodyChoice {
  std::vector<std::string> ids;                ///< "7", "10-20"
  std::vector<std::string> materials, shapes;  ///< by name
  std::vector<Region> regions;                 ///< their centre lies in one of them
};

class ChosenBodies {
 public:
  /// Fails: UsageError when a material or shape is not in the scene; the names that are in it are told.
  ChosenBodies(const BodyChoice& choice, const Scene& scene);
  bool all() const { return all_; }
  bool holds(const FrameBodies& bodies, std::size_t index) const;
  /// The frame with only these bodies, the contacts between two of them or with one and a wall, and all walls.
  Frame part_of(Frame frame, const std::unordered_set<std::int64_t>& boundary) const;

 private:
  bool all_ = true;
  std::vector<std::pair<std::int64_t, std::int64_t>> ids_;
  std::vector<bool> material_, shape_;
  std::vector<Region> regions_;
};

}  // namespace scree
