// What the loop over pairs does with pairs of meshes whose features are found: collects those with as many features each, and finds the
// forces of some of them at once (lanes/mesh_forces.hpp). The bits are those of PairEvaluation, which computes what is left to it.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "solver/lanes/mesh_forces.hpp"
#include "solver/pairs/pair_pass.hpp"

namespace scree {

/// Pairs with more features than this go the general way: their own loops are long enough.
inline constexpr std::size_t kMaxFeatures = 16;

/// Pairs of meshes of a pass, and what all threads read of their laws.
class MeshPass {
 public:
  explicit MeshPass(PairPass& pass);
  /// Whether any pairs go in lanes in this pass: not where more is asked for than forces, or where each pair is timed.
  bool has_lanes() const { return has_lanes_; }
  PairPass& pass() const { return pass_; }
  const BallScene& scene() const { return scene_; }

 private:
  PairPass& pass_;
  bool has_lanes_;
  BallScene scene_;
};

/// One thread's part of a pass.
class MeshEvaluation {
 public:
  explicit MeshEvaluation(const MeshPass& meshes);

  /// Takes a pair with the features that were found.   Returns false for one that it cannot take.
  bool take(std::int32_t k, const BodyPair& pair, const PairView& view, const PairFeatures& features) {
    if (view.geometry != PairGeometry::two_meshes || pair.b < 0 || features.has_cells || features.list.size() > kMaxFeatures) return false;
    std::size_t law = 0;
    const LaneLaws& laws = meshes_.scene().laws;
    if (laws.laws.size() > 1)
      law = laws.row(pass_.p.material[static_cast<std::size_t>(pair.a)], pass_.p.material[static_cast<std::size_t>(pair.b)]);
    if (laws.holds[law] == 0) return false;
    add(k, law, pair, view, features);
    return true;
  }

  /// Computes what has been taken and not yet been.
  void finish();

  /// Pairs that were taken, and that the general path is to compute.
  const std::vector<std::int32_t>& left() const { return left_; }
  double largest_overlap() const { return largest_overlap_; }  ///< over the maximum overlap of its pair
  bool too_deep() const { return too_deep_; }

 private:
  /// By the number of features less one. Kept from pass to pass, so that nothing is allocated for each.
  using Batches = std::array<MeshPairs, kMaxFeatures>;
  static Batches& batches_of_thread();

  void add(std::int32_t k, std::size_t law, const BodyPair& pair, const PairView& view, const PairFeatures& features);
  void evaluate(MeshPairs& batch);

  const MeshPass& meshes_;
  PairPass& pass_;
  Batches& batches_;
  MeshForces forces_;
  std::vector<std::int32_t> left_;
  double largest_overlap_ = 0;
  bool too_deep_ = false;
};

}  // namespace scree
