// Triangle pairs of two bodies kept from step to step, so that a step looks at the few that can have come close.
//
//   list      pairs of triangles within margin + skin, found by descent (mesh_descent.hpp) and a single-precision filter
//   expiry    per pair: the way the bodies may go before it can come within the margin; a step scans one array of floats
//   filter    distances in single precision of the pairs that expired: most are put off again
//   decision  distances in double precision of the rest: exact, whatever the list or the filter did
//
// The way is the sum over steps of how far any point of the listed triangles has moved against the other body. It holds
// translation and rotation: |shift of their middle| + (chord of the turn) * (largest distance from it), in the frame of
// either body, whichever is smaller.
//
// The list is used up, and made again, when a triangle that is not in it may have come within the margin. The skin at a
// point p of B is s (1 + |p - c| / lever), c being where the bodies touched last: points far from there move more when
// bodies roll, and are farther apart. So the list serves while c has not moved further than s, and B not turned by more
// than a chord of s / lever, both from when it was made: bodies that roll on one another keep it long.
//
// Skin: a wide one makes longer lists, a narrow one makes them often. With n pairs within the margin, n' s^2 more in a
// skin s (the patch and the pairs of each of its triangles both grow with s), and v the way of a step, a step costs about
//   C(s) = scan (n + n' s^2) + (descent + listing (n + n' s^2)) v / s + constant,
// least at s^3 = descent v / (2 n' (scan + listing v / (2 s))). Every new list measures n' and v and takes that skin, with
// the last one on the right.
// Source: M. P. Allen, D. J. Tildesley, Computer Simulation of Liquids, section 5.3 (neighbour lists); the expiry of a
// single pair is that of docs/reference/candidates.md section 4. Departure: the way is measured at the listed triangles.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "core/distance/mesh_distance.hpp"

namespace scree {

/// A pair of triangles within the margin [units of A's shape].
struct ClosePair {
  TrianglePair pair;
  double distance;  ///< 0: they intersect
};

/// A ball that holds a part of a shape, in the shape's own frame and units.
struct SurfacePatch {
  Vec3 centre;
  double radius = 0;
};

/// Reusable scratch memory; one per thread.
struct KeptPairsScratch;
struct KeptPairsScratchDeleter {
  void operator()(KeptPairsScratch*) const;
};
using KeptPairsScratchPtr = std::unique_ptr<KeptPairsScratch, KeptPairsScratchDeleter>;
KeptPairsScratchPtr make_kept_pairs_scratch();

/// What one pair of bodies keeps. Movable; two bodies, always in the same order.
class KeptPairs {
 public:
  /// What the list has done since it was made first: for tests, logs and benchmarks.
  struct Counts {
    std::int64_t steps = 0, lists = 0;
    std::int64_t listed = 0;    ///< pairs in all lists, added up
    std::int64_t scanned = 0;   ///< pairs whose expiry was looked at
    std::int64_t filtered = 0;  ///< distances in single precision
    std::int64_t decided = 0;   ///< distances in double precision
  };

  /// All triangle pairs whose distance is below `margin` or which intersect, in some order; true when one intersects.
  ///
  /// in   a, b      the same at every call, or forget() in between
  /// in   b_in_a    placement of B in A's frame; lengths are in units of A's shape
  /// in   margin    sum of both margins, >= 0; another one than last time makes a new list
  /// out  close     exactly the pairs of triangle_pairs_within, but for their order
  /// Cost: 1 microsecond for two rocks of 1280 triangles near contact; a new list 10 to 20. A list of another length
  /// than the last allocates.   Threads: distinct lists and scratch.
  bool update(const MeshView& a, const MeshView& b, const Placement& b_in_a, double margin, KeptPairsScratch& scratch,
              std::vector<ClosePair>& close);

  /// Takes this skin [units of A's shape] for all lists from now on, instead of tuning it; 0: tune.
  void fix_skin(double skin);
  void forget() { has_list_ = false; }

  double skin() const { return skin_; }
  std::size_t pair_count() const { return expiry_.size(); }
  /// Bytes of the kept pairs: 8 a pair, 12 when a shape has more than 65 536 triangles. Besides these, sizeof(KeptPairs).
  std::size_t memory() const {
    return expiry_.capacity() * sizeof(float) + narrow_.capacity() * sizeof(NarrowPair) + wide_.capacity() * sizeof(TrianglePair);
  }
  const Counts& counts() const { return counts_; }

 private:
  struct NarrowPair {
    std::uint16_t a, b;
  };
  void make_list(const MeshView& a, const MeshView& b, const Placement& b_in_a, double margin, KeptPairsScratch& scratch);
  void choose_skin(double smallest_radius, double margin);
  void find_patches(const Placement& b_in_a, const Vec3& middle, double allowance, KeptPairsScratch& scratch);
  TrianglePair pair_at(std::size_t k) const { return wide_.empty() ? TrianglePair{narrow_[k].a, narrow_[k].b} : wide_[k]; }

  std::vector<float> expiry_;
  std::vector<NarrowPair> narrow_;  // one of the two
  std::vector<TrianglePair> wide_;
  Placement listed_at_, last_;
  SurfacePatch patch_a_, patch_b_;  // the listed triangles
  Vec3 centre_;                     // of B, in its own frame: what the skin is measured at
  double lever_ = 0;                // at this distance from it the skin is twice as wide; 0: the same everywhere
  double margin_ = 0, skin_ = 0, fixed_skin_ = 0;
  double way_ = 0, moved_ = 0;     // of the listed triangles, step by step; of the bodies, from where they were listed
  std::int64_t steps_listed_ = 0;  // steps that the list has served
  std::size_t close_count_ = 0;    // pairs within the margin when listed
  bool has_list_ = false;
  Counts counts_;
};

}  // namespace scree
