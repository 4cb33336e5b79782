// What a scene begins with beside its table of bodies, when bodies come from a run ([start] of a case): the digits that the table cannot
// hold, and what pairs of these bodies remember. Which kinds of pair state there are and what their rows mean only the solver knows; here
// they are columns with names, copied as they lie in its checkpoint.
#pragma once

#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "core/storage/h5.hpp"
#include "core/storage/scene.hpp"

namespace scree {

/// Of scene files that hold such a state; others have kSceneFormatVersion, so that older solvers read them.
inline constexpr std::int64_t kSceneFormatVersionWithStart = 4;  // 2 and 3 are still read

struct PairColumn {
  std::string name, unit;
  std::variant<std::vector<std::int64_t>, std::vector<double>, std::vector<Vec3>> values;
};

/// Rows of one kind of pair state. Row n belongs to the bodies a and b, or to body a and zone `zone` of the wall with the id b.
struct PairTable {
  std::string kind;                      ///< its group in checkpoints
  std::vector<std::int64_t> a, b, zone;  ///< zone -1: two bodies
  std::vector<PairColumn> columns;

  std::size_t size() const { return a.size(); }
  /// Leaves the rows with these indices, in this order.
  void take(const std::vector<std::size_t>& rows);
};

/// Tables of a group: what in it has columns a, b and zone.   Throws InputError when columns differ in length.
std::vector<PairTable> read_pair_tables(const h5::Group& group);
void write_pair_tables(const h5::Group& group, const std::vector<PairTable>& tables);

struct StartState {
  std::string run, file;      ///< the folder as the case names it, and the checkpoint or frame in it
  double time = 0;            ///< that the run had reached [s]
  std::int64_t bodies = 0;    ///< that come from it: the first rows of the table of bodies
  std::int64_t left_out = 0;  ///< bodies of that run that are not among them
  std::int64_t left = 0;      ///< pairs whose state was not taken over, since the wall or the way of gathering is another
  double clock = 0;           ///< of a case that goes on where that run ended: 0 s of it, on the clock of the first run of the chain [s]
  // of a checkpoint, one for each of these bodies; empty of a frame
  std::vector<Vec3> x_remainder;  ///< what rounding took from the position [m]
  std::vector<Quat> q_principal;  ///< principal frame to world, from which the orientation follows
  std::vector<Quat> q_remainder;  ///< what rounding took from it
  std::vector<PairTable> pairs;

  /// Pairs that remember something.
  std::int64_t pair_count() const;
};

void write_start_state(const h5::Group& group, const StartState& start);
/// A scene and what it begins with. Writes whole or not at all.
void write_scene_file(const std::string& path, const Scene& scene, const std::optional<StartState>& start);
/// What a scene file holds of it: a scene is read by many tools, this part by those that start or copy it.
/// in   body_count   of the scene
/// Throws InputError when it cannot be right.
std::optional<StartState> read_start_state(const std::string& scene_path, std::size_t body_count);
/// For run.json.
nlohmann::json start_json(const StartState& start);

}  // namespace scree
