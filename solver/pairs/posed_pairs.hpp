// Pairs of two meshes that wait for others, so that the poses of some of them are found at once (lanes/mesh_poses.hpp).
#pragma once

#include <cstdint>

#include "solver/lanes/mesh_poses.hpp"
#include "solver/neighbours/pair_list.hpp"
#include "solver/pairs/pair_pass.hpp"

namespace scree {

/// One thread's part of a pass that has lanes for meshes.
class PosedPairs {
 public:
  explicit PosedPairs(PairPass& pass) : pass_(pass) {}

  /// Whether a pair may wait: two bodies that are meshes, with lists of candidates.
  bool may_take(const BodyPair& pair) const {
    const auto is_mesh = [&](std::int32_t row) {
      return pass_.scene.shape(pass_.p.shape[static_cast<std::size_t>(row)]).kind != ShapeKind::sphere;
    };
    return pair.b >= 0 && !pass_.continues && pair.lists != nullptr && pair.lists->skin >= 0 && is_mesh(pair.a) && is_mesh(pair.b);
  }
  /// There is room for it.   in   k   in the list of pairs
  void add(std::int32_t k, const BodyPair& pair) {
    const std::size_t n = poses_.count++;
    poses_.index[n] = k;
    poses_.a[n] = pair.a;
    poses_.b[n] = pair.b;
    poses_.lists[n] = pair.lists.get();
  }
  bool is_full() const { return poses_.count == MeshPoses::kPairs; }

  /// Finds all poses and calls work(k, pose, moved, squared speed), numbers as in MeshPoses; begins again.
  template <class Work>
  void finish(Work&& work) {
    if (poses_.count == 0) return;
    find_mesh_poses(pass_.p, poses_);
    for (std::size_t n = 0; n < poses_.count; ++n) work(poses_.index[n], poses_.pose[n], poses_.moved[n], poses_.squared_speed[n]);
    poses_.count = 0;
  }

 private:
  PairPass& pass_;
  MeshPoses poses_;
};

}  // namespace scree
