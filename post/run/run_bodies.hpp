// Which bodies a run has, of what kinds they are, and where they are, over all frames: of the scene, and those that came in later.
//
// Whoever asks this of the scene or of the first frame alone is wrong as soon as bodies come in: everything that needs it asks here.
#pragma once

#include <string>
#include <unordered_map>
#include <vector>

#include "post/run/frame_pool.hpp"
#include "post/run/within.hpp"

namespace scree {

/// A body that the run has or had.
struct RunBody {
  std::int64_t id = 0;
  std::int32_t shape = 0, material = 0;
  double scale = 1;
  std::int32_t origin = 0;  ///< index of RunBodies::origins
  bool is_fixed = false;
  Vec3 start;  ///< where it was at the start, or came in [m]; NaN where no table says
};

/// The bodies of the scene, and those that came in.
class RunBodies {
 public:
  /// From the scene and inserted.csv; where that table is missing though bodies came in, and of a run that did not end, from the frames
  /// too.
  /// Fails: InputError (a damaged table or frame, named).
  explicit RunBodies(const Run& run);

  std::vector<RunBody> all;  ///< those of the scene in its order, then in order of coming in
  /// "population 0" ..., "[[bodies]]", "inlet feed" ..., whether any body is of them or not; "inserted by the program" where a program did;
  /// "came in" where no table says through what.
  std::vector<std::string> origins;
  /// Null: no body of the run has this id.
  const RunBody* find(std::int64_t id) const;

  /// Which shapes, materials and origins there are, ascending.
  std::vector<std::int32_t> shapes() const { return kinds(&RunBody::shape); }
  std::vector<std::int32_t> materials() const { return kinds(&RunBody::material); }
  std::vector<std::int32_t> used_origins() const { return kinds(&RunBody::origin); }

 private:
  void add(const RunBody& body);
  void add_scene(const Scene& scene);
  void add_inserted(const Run& run);
  void add_frames(const Run& run);
  std::int32_t origin_called(const std::string& name);
  std::vector<std::int32_t> kinds(std::int32_t RunBody::*kind) const;
  std::unordered_map<std::int64_t, std::size_t> row_;
};

/// Where the particles of some frames are, without those that have left.
struct BodyExtent {
  Box3 box;                      ///< around them in all frames, as they are turned [m]; empty: no particle in any frame
  std::size_t most = 0;          ///< particles at one time
  std::size_t most_of_all = 0;   ///< the same of all bodies, fixed ones and those that have left included
  double diameter = 0;           ///< number mean over the particles of all frames, of balls of equal volume [m]; 0: none
  std::size_t left = 0;          ///< of the last frame: particles that have left
  std::size_t left_at_most = 0;  ///< of any frame
  std::int32_t ranks = 1;        ///< of any frame
  double farthest = 0;           ///< of those of the last frame, from the box around the others [m]
};

/// Reads bodies and walls of the frames once, several frames at a time.
/// in   left_out   ids that do not count
/// Fails: InputError (a damaged frame, named), unless the pool leaves such frames out.
BodyExtent extent_of_bodies(const Run& run, const std::vector<std::size_t>& frames, const Within& within, const FramePool& pool,
                            const std::unordered_set<std::int64_t>& left_out = {});

/// Box around those rows of the bodies that count, as they are turned [m].
Box3 box_around(const FrameBodies& bodies, const Scene& scene, const std::vector<std::uint8_t>& counts);

/// "4 bodies have left the equipment, the farthest by 20 m": of the last frame, else of the one with the most; empty: none has.
std::string words_of_left(const BodyExtent& extent, const Within& within);

}  // namespace scree
